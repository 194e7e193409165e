//! `FaceoffPlugins` beside Bevy's own groups, as a game adds them.

use crate::app::{Sim, ball_like, sorted, start_of};
use bevy::diagnostic::DiagnosticsStore;
use bevy::ecs::schedule::{LogLevel, ScheduleBuildSettings};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::plugin::diagnostics::{COUNTS, stage_path};
use bevy_faceoff::plugin::queries::SpatialQueryPlugin;
use bevy_faceoff::prelude::*;
use bevy_faceoff::types::stage::Stage;
use std::panic::{AssertUnwindSafe, catch_unwind};

fn default_app() -> App {
    let mut app = App::new();
    app.add_plugins((DefaultPlugins, FaceoffPlugins::default()));
    app
}

/// What a panic says.
fn panic_of(run: impl FnOnce()) -> String {
    let payload = catch_unwind(AssertUnwindSafe(run)).expect_err("no panic");
    match payload.downcast::<String>() {
        Ok(text) => *text,
        Err(payload) => (*payload.downcast::<&str>().expect("a message")).to_string(),
    }
}

/// Two tori on their way to each other; returns where they end and what was told.
fn meet(mut sim: Sim) -> (Vec<Transform>, Vec<CollisionStart>, Vec<CollisionEnd>) {
    let torus = sim.mesh(&shapes::torus_240());
    let bodies = [-1.0, 1.0].map(|x| sim.spawn(ball_like(&torus, Vec3::new(x, 0.1 * x, 0.0), Vec3::X * -x)));
    sim.step(120);
    let pair = sorted(bodies[0], bodies[1]);
    assert!(sim.started.contains(&start_of(pair)));
    assert!(sim.position(bodies[0]).x < 0.0, "they bounce");
    (bodies.map(|b| sim.get(b)).into(), sim.started, sim.ended)
}

#[test]
fn no_two_systems_of_ours_run_in_an_unknown_order() {
    let mut app = default_app();
    app.edit_schedule(FaceoffStep, |schedule| {
        // An ambiguity is then an error, with which the schedule cannot run.
        schedule.set_build_settings(ScheduleBuildSettings {
            ambiguity_detection: LogLevel::Error,
            ..default()
        });
    });
    let mut sim = Sim::of(app);
    sim.step(1);
    assert_eq!(sim.world().resource::<StepReport>().step, 1);
}

#[test]
fn bodies_collide_under_default_plugins_as_they_do_headless() {
    let (poses, started, ended) = meet(Sim::of(default_app()));
    let headless = meet(Sim::new());
    // Other plugins spawn entities of their own, so entities may differ, and nothing else.
    assert_eq!(poses, headless.0);
    assert_eq!((started.len(), ended.len()), (headless.1.len(), headless.2.len()));
}

#[test]
fn the_order_of_minimal_plugins_and_ours_does_not_matter() {
    let mut app = App::new();
    app.add_plugins(FaceoffHeadlessPlugins {
        step: StepPlugin {
            threads: 1,
            ..default()
        },
        ..default()
    })
    .add_plugins(MinimalPlugins);
    assert_eq!(meet(Sim::of(app)).0, meet(Sim::new()).0);
}

#[test]
fn without_an_asset_plugin_the_panic_says_what_to_add() {
    let message = panic_of(|| {
        App::new().add_plugins((MinimalPlugins, FaceoffPlugins::default()));
    });
    for word in [
        "AssetPlugin",
        "DefaultPlugins before FaceoffPlugins",
        "FaceoffHeadlessPlugins",
    ] {
        assert!(message.contains(word), "{message}");
    }
}

#[test]
fn adding_the_plugins_twice_panics_with_bevys_message() {
    let message = panic_of(|| {
        App::new()
            .add_plugins((MinimalPlugins, FaceoffHeadlessPlugins::default()))
            .add_plugins(FaceoffPlugins::default());
    });
    assert!(message.contains("already added"), "{message}");
    assert!(message.contains("bevy_faceoff"), "{message}");
}

#[test]
fn the_headless_group_over_default_plugins_panics_with_bevys_message() {
    let message = panic_of(|| {
        App::new().add_plugins((DefaultPlugins, FaceoffHeadlessPlugins::default()));
    });
    assert!(
        message.contains("already added") && message.contains("AssetPlugin"),
        "{message}"
    );
}

#[test]
fn diagnostics_tell_each_stages_time_and_the_counts() {
    for app in [default_app(), {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, FaceoffHeadlessPlugins::default()));
        app
    }] {
        let mut sim = Sim::of(app);
        let cube = sim.mesh(&shapes::cube(1.0));
        for x in [0.0, 0.3, 5.0] {
            sim.spawn((ball_like(&cube, Vec3::new(x, x, 0.0), Vec3::ZERO), Sensor));
        }
        sim.step(5);
        let store = sim.app.world().resource::<DiagnosticsStore>();
        for stage in Stage::ALL {
            let diagnostic = store.get(&stage_path(stage)).expect("each stage has a diagnostic");
            assert_eq!(diagnostic.history_len(), 5, "one measurement for each step");
            assert!(diagnostic.value().unwrap() >= 0.0);
            assert_eq!(diagnostic.suffix, "ms");
        }
        let report = sim.report();
        assert_eq!(report.touching_pairs, 1);
        let counts = [
            report.sphere_pairs as f64,
            report.touching_pairs as f64,
            report.triangle_tests as f64,
            report.face_pairs as f64,
        ];
        for (path, count) in COUNTS.iter().zip(counts) {
            assert_eq!(
                store.get(path).expect("each count has a diagnostic").value(),
                Some(count)
            );
        }
    }
}

#[test]
fn the_diagnostics_can_be_left_out() {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        FaceoffHeadlessPlugins::default()
            .build()
            .disable::<bevy_faceoff::plugin::diagnostics::FaceoffDiagnosticsPlugin>(),
    ));
    let (poses, ..) = meet(Sim::of(app));
    assert_eq!(poses, meet(Sim::new()).0);
}

#[test]
fn the_step_or_the_questions_can_be_left_out() {
    fn ask(world: SpatialQuery, mut hits: Local<Vec<RayHitData>>) {
        *hits = world.ray_hits(Vec3::ZERO, Dir3::X, 1.0, &SpatialQueryFilter::default());
    }
    let plugins = || FaceoffHeadlessPlugins::default().build();
    for plugins in [
        plugins().disable::<StepPlugin>(),
        plugins().disable::<SpatialQueryPlugin>(),
    ] {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, plugins)).add_systems(Update, ask);
        app.finish();
        let character = Character::new(0.3, 0.5);
        let character = app.world_mut().spawn((character, Transform::default())).id();
        for _ in 0..5 {
            app.update();
            app.world_mut().run_schedule(bevy::app::FixedMain);
        }
        let stays = app.world().get::<Transform>(character).unwrap().translation;
        assert_eq!(stays, Vec3::ZERO);
    }
}

/// A plugin that is added before ours knows the schedule by its name.
#[test]
fn systems_that_were_added_to_the_step_before_the_plugins_run() {
    #[derive(Resource, Default)]
    struct Ran(u32);
    let mut app = App::new();
    app.init_resource::<Ran>()
        .add_systems(FaceoffStep, |mut ran: ResMut<Ran>| ran.0 += 1)
        .add_plugins((MinimalPlugins, FaceoffHeadlessPlugins::default()));
    let mut sim = Sim::of(app);
    sim.step(3);
    assert_eq!(sim.world().resource::<Ran>().0, 3);
}

#[test]
fn resources_set_before_the_plugins_are_kept() {
    let mut app = App::new();
    app.insert_resource(Response::None).insert_resource(Culling::Exact);
    app.add_plugins((MinimalPlugins, FaceoffHeadlessPlugins::default()));
    let sim = Sim::of(app);
    assert_eq!(*sim.app.world().resource::<Response>(), Response::None);
    assert_eq!(*sim.app.world().resource::<Backend>(), Backend::Auto);
}

#[test]
fn all_components_and_settings_can_be_reflected() {
    let app = default_app();
    let registry = app.world().resource::<AppTypeRegistry>().read();
    for name in [
        "RigidBody",
        "MeshCollider",
        "PlaneCollider",
        "LinearVelocity",
        "AngularVelocity",
        "Mass",
        "Restitution",
        "GravityScale",
        "CollisionLayers",
        "Sensor",
        "CollidingEntities",
        "CollisionEventsEnabled",
    ] {
        let registration = registry
            .get_with_short_type_path(name)
            .unwrap_or_else(|| panic!("{name} is not registered"));
        assert!(registration.data::<ReflectComponent>().is_some(), "{name}");
    }
    for name in ["Culling", "Gravity", "Response", "Backend"] {
        let registration = registry.get_with_short_type_path(name).unwrap();
        assert!(registration.data::<ReflectResource>().is_some(), "{name}");
    }
}
