//! The panel with times, counts and rejected bodies.

use crate::app::Sim;
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::plugin::panel::{FaceoffPanel, FaceoffPanelNode, FaceoffPanelPlugin};
use bevy_faceoff::prelude::*;
use bevy_faceoff::types::stage::Stage;
use std::time::Duration;

/// A panel that is written in every frame.
fn panel() -> FaceoffPanelPlugin {
    FaceoffPanelPlugin {
        panel: FaceoffPanel {
            refresh: Duration::ZERO,
            ..default()
        },
    }
}

/// The texts that are shown; `None` if the panel is not.
fn text(app: &mut App) -> Option<String> {
    let world = app.world_mut();
    let mut panels = world.query_filtered::<(&Node, &Children), With<FaceoffPanelNode>>();
    let mut texts = Vec::new();
    let (node, children) = panels.single(world).ok()?;
    if node.display == Display::None {
        return None;
    }
    for child in children {
        let (Some(text), Some(node)) = (world.get::<Text>(*child), world.get::<Node>(*child)) else {
            continue;
        };
        if node.display != Display::None {
            texts.push(text.0.clone());
        }
    }
    Some(texts.join("\n"))
}

/// The words after `name` in its line.
#[track_caller]
fn row(text: &str, name: &str) -> Vec<String> {
    let rest = text.lines().find_map(|line| line.strip_prefix(name));
    let rest = rest.unwrap_or_else(|| panic!("no {name} in:\n{text}"));
    rest.split_whitespace().map(str::to_string).collect()
}

fn spawn_pair(sim: &mut Sim) {
    let cube = sim.mesh(&shapes::cube(1.0));
    for x in [0.0, 0.9] {
        sim.spawn((RigidBody::Dynamic, cube.clone(), Transform::from_xyz(x, 0.0, 0.0)));
    }
}

#[test]
fn it_shows_the_figures_of_the_last_step() {
    let mut sim = Sim::with_plugin(panel());
    spawn_pair(&mut sim);
    sim.spawn(PlaneCollider::through(-0.45 * Vec3::Y, Vec3::Y));
    sim.app.update();
    sim.app.update();
    let text = text(&mut sim.app).unwrap();
    let report = sim.world().resource::<StepReport>().clone();
    assert_eq!((report.bodies, report.touching_pairs), (2, 1));
    assert!(report.contact_points > 0 && report.face_pairs > 0 && report.triangle_tests > 0);
    for (name, count) in [
        ("bodies", report.bodies as u64),
        ("asleep", report.sleeping as u64),
        ("islands", 1),
        ("largest island", 2),
        ("sphere pairs", report.sphere_pairs as u64),
        ("touching pairs", report.touching_pairs as u64),
        ("touching planes", 2),
        ("triangle tests", report.triangle_tests),
        ("face pairs", report.face_pairs as u64),
        ("contact pairs", 3),
        ("contact points", report.contact_points as u64),
        ("substeps", report.collision_substeps.into()),
    ] {
        assert_eq!(row(&text, name), [count.to_string()], "{name}");
    }
    let millis = |time: Duration| format!("{:.3}", 1e3 * time.as_secs_f64());
    assert_eq!(row(&text, "whole step"), vec![millis(report.total); 2]);
    for stage in Stage::ALL {
        let name = stage.name().replace('_', " ");
        assert_eq!(row(&text, &name), vec![millis(report.time(stage)); 2]);
    }
    assert!(text.contains("1 threads: Backend::Cpu asks for it"), "{text}");
    assert!(text.contains(&format!("step {}, 64/s, speed 1", report.step)), "{text}");
    assert!(!text.contains("GPU memory") && !text.contains("rejected"), "{text}");
}

#[test]
fn it_shows_the_clock() {
    let mut sim = Sim::with_plugin(panel());
    sim.world().resource_mut::<Time<Physics>>().set_relative_speed(0.25);
    sim.app.update();
    assert!(text(&mut sim.app).unwrap().contains("speed 0.25"));
    sim.world().resource_mut::<Time<Physics>>().pause();
    sim.app.update();
    assert!(text(&mut sim.app).unwrap().contains("physics paused"));
    sim.world().resource_mut::<Time<Virtual>>().pause();
    sim.app.update();
    assert!(text(&mut sim.app).unwrap().contains("game paused"));
}

#[test]
fn rejected_bodies_are_named_as_long_as_they_are_rejected() {
    let mut sim = Sim::with_plugin(panel());
    let cube = sim.mesh(&shapes::cube(1.0));
    let invalid = LinearVelocity(Vec3::NAN);
    let body = sim.spawn((RigidBody::Dynamic, cube.clone(), Name::new("crate"), invalid));
    sim.app.update();
    let shown = text(&mut sim.app).unwrap();
    assert!(shown.contains("1 rejected"), "{shown}");
    let line = shown.lines().find(|line| line.contains("\"crate\"")).unwrap();
    assert!(
        line.starts_with(&body.to_string()) && line.contains("not finite"),
        "{line}"
    );

    sim.set(body, LinearVelocity::default());
    sim.app.update();
    assert!(!text(&mut sim.app).unwrap().contains("rejected"));

    // The last ones are shown.
    for number in 0..7 {
        let name = Name::new(format!("crate {number}"));
        sim.spawn((RigidBody::Dynamic, cube.clone(), name, invalid));
        sim.app.update();
    }
    let shown = text(&mut sim.app).unwrap();
    assert!(shown.contains("7 rejected") && shown.contains("and 3 more"), "{shown}");
    for number in 0..7 {
        assert_eq!(shown.contains(&format!("crate {number}")), number >= 3, "{shown}");
    }
    let last = shown.find("crate 6").unwrap();
    assert!(last < shown.find("crate 5").unwrap(), "{shown}");
}

#[test]
fn a_key_and_the_resource_show_and_hide_it() {
    let mut sim = Sim::with_plugin(panel());
    sim.world().init_resource::<ButtonInput<KeyCode>>();
    sim.app.update();
    assert!(text(&mut sim.app).is_some());
    let press = |sim: &mut Sim, key| {
        sim.world().resource_mut::<ButtonInput<KeyCode>>().press(key);
        sim.app.update();
        sim.world().resource_mut::<ButtonInput<KeyCode>>().reset_all();
    };
    press(&mut sim, KeyCode::F3);
    assert_eq!(text(&mut sim.app), None);
    press(&mut sim, KeyCode::F4);
    assert_eq!(text(&mut sim.app), None);
    press(&mut sim, KeyCode::F3);
    let step = sim.world().resource::<StepReport>().step;
    assert!(text(&mut sim.app).unwrap().contains(&format!("step {step},")));

    sim.world().resource_mut::<FaceoffPanel>().visible = false;
    sim.app.update();
    assert_eq!(text(&mut sim.app), None);
    sim.world().resource_mut::<FaceoffPanel>().visible = true;
    sim.app.update();
    assert!(text(&mut sim.app).is_some());
    sim.world().resource_mut::<FaceoffPanel>().key = Some(KeyCode::F4);
    press(&mut sim, KeyCode::F4);
    assert_eq!(text(&mut sim.app), None);
    sim.world().resource_mut::<FaceoffPanel>().key = None;
    press(&mut sim, KeyCode::F4);
    assert_eq!(text(&mut sim.app), None);
}

/// Until it is shown there is no panel.
#[test]
fn a_hidden_panel_is_not_made() {
    let hidden = FaceoffPanelPlugin {
        panel: FaceoffPanel::hidden(),
    };
    let mut sim = Sim::with_plugin(hidden);
    sim.app.update();
    let world = sim.world();
    assert_eq!(world.query::<&Node>().iter(world).len(), 0);
}

/// Figures that change in every frame cannot be read.
#[test]
fn the_text_changes_four_times_a_second() {
    let mut sim = Sim::with_plugin(FaceoffPanelPlugin::default());
    let mut texts = Vec::new();
    for _ in 0..64 {
        sim.app.update();
        texts.extend(text(&mut sim.app));
    }
    assert_eq!(texts.len(), 64);
    texts.dedup();
    assert_eq!(texts.len(), 4 + 1);
    assert!(texts[4].contains("64/s"), "{}", texts[4]);
}

#[test]
fn without_the_step_it_says_so() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, panel()));
    app.finish();
    app.cleanup();
    app.update();
    app.update();
    assert_eq!(text(&mut app).unwrap(), "no StepPlugin: add FaceoffPlugins");
}

/// Without time, too.
#[test]
fn without_any_plugin_it_does_no_harm() {
    let mut app = App::new();
    app.add_plugins(panel());
    app.finish();
    app.cleanup();
    app.update();
    app.update();
    assert!(text(&mut app).is_some());
}
