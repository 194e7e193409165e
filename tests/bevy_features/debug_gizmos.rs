//! Gizmos of collisions, as Bevy gets them to draw.

use crate::asset_app::update_until;
use bevy::app::ScheduleRunnerPlugin;
use bevy::gizmos::{GizmoAsset, GizmoHandles, GizmoPlugin};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::plugin::debug::{FaceoffGizmos, FaceoffGizmosPlugin, ShowFacesTowards};
use bevy_faceoff::prelude::*;
use bevy_faceoff::projection::{Progress, bake_pool};
use std::any::TypeId;
use std::f32::consts::FRAC_PI_4;
use std::time::Duration;

/// An app that runs a step in every update, without gravity.
fn app(gizmos: bool) -> App {
    let mut app = App::new();
    let step = StepPlugin {
        backend: Backend::Cpu,
        threads: 1,
        ..default()
    };
    app.add_plugins((
        MinimalPlugins.build().disable::<ScheduleRunnerPlugin>(),
        TransformPlugin,
        FaceoffHeadlessPlugins { step, ..default() },
    ))
    .insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(Duration::from_nanos(
        15_625_000,
    )))
    .insert_resource(Gravity(Vec3::ZERO));
    add_gizmos(&mut app, gizmos);
    app.update();
    app
}

fn add_gizmos(app: &mut App, gizmos: bool) {
    // Bevy's own gizmos look for these, where there are meshes.
    #[cfg(feature = "bevy_mesh")]
    app.add_plugins(bevy::mesh::MeshPlugin)
        .init_asset::<bevy::mesh::skinning::SkinnedMeshInverseBindposes>();
    if gizmos {
        app.add_plugins(GizmoPlugin);
    }
    app.add_plugins(FaceoffGizmosPlugin);
    app.finish();
    app.cleanup();
}

/// Shows only the gizmos that `change` turns on.
fn show(app: &mut App, change: impl FnOnce(&mut FaceoffGizmos)) {
    let mut store = app.world_mut().resource_mut::<GizmoConfigStore>();
    let gizmos = store.config_mut::<FaceoffGizmos>().1;
    *gizmos = FaceoffGizmos::none();
    change(gizmos);
}

/// What the last frame left to draw.
#[derive(Default, Debug)]
struct Lines {
    /// The ends of single lines.
    ends: Vec<[Vec3; 2]>,
    colors: Vec<LinearRgba>,
    /// The points of strips.
    strips: Vec<Vec3>,
}

impl Lines {
    fn is_empty(&self) -> bool {
        self.ends.is_empty() && self.strips.is_empty()
    }

    fn points(&self) -> impl Iterator<Item = Vec3> {
        self.ends.iter().flatten().chain(&self.strips).copied()
    }

    fn bounds(&self) -> [Vec3; 2] {
        let low = self.points().fold(Vec3::INFINITY, Vec3::min);
        [low, self.points().fold(Vec3::NEG_INFINITY, Vec3::max)]
    }

    #[track_caller]
    fn all_have(&self, color: Color) {
        assert!(!self.colors.is_empty());
        let color = color.to_linear();
        assert!(self.colors.iter().all(|&c| near(c, color)), "{:?}", self.colors[0]);
    }
}

fn near(one: LinearRgba, other: LinearRgba) -> bool {
    one.to_vec4().distance(other.to_vec4()) < 1.0e-4
}

fn lines(app: &App) -> Lines {
    let handle = &app.world().resource::<GizmoHandles>().handles()[&TypeId::of::<FaceoffGizmos>()];
    let Some(handle) = handle else { return Lines::default() };
    let Some(asset) = app.world().resource::<Assets<GizmoAsset>>().get(handle) else {
        return Lines::default();
    };
    let buffer = asset.buffer().buffer();
    Lines {
        ends: buffer.list_positions.chunks(2).map(|pair| [pair[0], pair[1]]).collect(),
        colors: buffer.list_colors.clone(),
        // Not-a-numbers separate strips.
        strips: buffer
            .strip_positions
            .iter()
            .copied()
            .filter(|p| p.is_finite())
            .collect(),
    }
}

/// Runs two frames. What the first draws is of the step before.
fn draw(app: &mut App) -> Lines {
    app.update();
    app.update();
    lines(app)
}

fn add(app: &mut App, mesh: CollisionMesh) -> MeshCollider {
    MeshCollider(app.world_mut().resource_mut::<Assets<CollisionMesh>>().add(mesh))
}

fn cube(app: &mut App) -> MeshCollider {
    add(app, CollisionMesh::new(&shapes::cube(1.0)))
}

fn corners(to_world: impl Fn(Vec3) -> Vec3) -> Vec<Vec3> {
    shapes::cube(1.0).vertices().iter().map(|&v| to_world(v)).collect()
}

fn is_one_of(point: Vec3, points: &[Vec3]) -> bool {
    points.iter().any(|p| p.distance(point) < 1.0e-4)
}

/// Two bodies in each other, of which the second is a sensor, so that they stay there. They have face tables.
fn spawn_pair(app: &mut App) -> [Entity; 2] {
    let settings = BakeSettings {
        faces: true,
        degrees: 30,
        image: 64,
        ..BakeSettings::default()
    };
    let mesh = CollisionMesh::bake(&shapes::torus_240(), settings, bake_pool(), &Progress::default()).unwrap();
    let mesh = add(app, mesh);
    let pair = [0.0, 0.3].map(|x| {
        let velocities = (LinearVelocity(0.001 * Vec3::Z), AngularVelocity(0.001 * Vec3::Z));
        let body = (
            RigidBody::Dynamic,
            mesh.clone(),
            Transform::from_xyz(x, 0.0, 0.0),
            velocities,
        );
        app.world_mut().spawn(body).id()
    });
    app.world_mut().entity_mut(pair[1]).insert(Sensor);
    pair
}

/// Two bodies that are pressed against each other.
fn spawn_pressed(app: &mut App) {
    let cube = cube(app);
    for side in [-1.0, 1.0] {
        app.world_mut().spawn((
            RigidBody::Dynamic,
            cube.clone(),
            Transform::from_xyz(6.0 + 0.499 * side, 0.0, 0.0),
            ExternalForces {
                force: -side * Vec3::X,
                ..default()
            },
        ));
    }
}

type Switch = fn(&mut FaceoffGizmos, Option<Color>);

const KINDS: [(&str, Switch); 17] = [
    ("wireframes", |g, color| g.wireframes = color),
    ("boxes", |g, color| g.boxes = color),
    ("bounding_spheres", |g, color| g.bounding_spheres = color),
    ("planes", |g, color| g.planes = color),
    ("centers_of_mass", |g, color| g.centers_of_mass = color),
    ("linear_velocities", |g, color| g.linear_velocities = color),
    ("angular_velocities", |g, color| g.angular_velocities = color),
    ("islands", |g, color| g.islands = color),
    ("contacts", |g, color| g.contacts = color),
    ("contact_points", |g, color| g.contact_points = color),
    ("impulses", |g, color| g.impulses = color),
    ("intersections", |g, color| g.intersections = color),
    ("faces", |g, color| g.faces = color),
    ("rays", |g, color| g.rays = color),
    ("shapes", |g, color| g.shapes = color),
    ("hits", |g, color| g.hits = color),
    ("characters", |g, color| g.characters = color),
];

#[test]
fn each_kind_is_drawn_on_its_own() {
    let mut app = app(true);
    let [one, other] = spawn_pair(&mut app);
    spawn_pressed(&mut app);
    let world = app.world_mut();
    world.spawn(PlaneCollider::through(-5.0 * Vec3::Y, Vec3::Y));
    world.spawn((
        Transform::from_xyz(0.8, 3.0, 0.0),
        RayCaster::new(Vec3::ZERO, Dir3::NEG_Y),
    ));
    let ball = CasterShape::Ball { radius: 0.1 };
    world.spawn((
        Transform::from_xyz(0.8, 3.0, 0.0),
        ShapeCaster::new(ball, Vec3::ZERO, Dir3::NEG_Y),
    ));
    world.spawn((Transform::from_xyz(9.0, 0.0, 0.0), Character::new(0.3, 0.5)));
    for (name, switch) in KINDS {
        show(&mut app, |_| {});
        assert!(draw(&mut app).is_empty(), "before {name}");
        show(&mut app, |g| switch(g, Some(Color::WHITE)));
        let lines = draw(&mut app);
        if name == "faces" {
            assert!(lines.is_empty(), "nobody asked for any faces");
            app.world_mut().entity_mut(one).insert(ShowFacesTowards(other));
            assert!(!draw(&mut app).is_empty());
        } else {
            assert!(!lines.is_empty(), "{name}");
        }
        assert!(lines.points().all(Vec3::is_finite), "{name}");
    }
    // All of them, and with all of them switched off as a whole.
    show(&mut app, |g| *g = FaceoffGizmos::all());
    assert!(!draw(&mut app).is_empty());
    let mut store = app.world_mut().resource_mut::<GizmoConfigStore>();
    store.config_mut::<FaceoffGizmos>().0.enabled = false;
    assert!(draw(&mut app).is_empty());
    app.world_mut()
        .resource_mut::<GizmoConfigStore>()
        .config_mut::<FaceoffGizmos>()
        .0
        .enabled = true;
    // A partner that is gone, or has no shape, is none.
    show(&mut app, |g| g.faces = Some(Color::WHITE));
    assert!(!draw(&mut app).is_empty());
    app.world_mut().despawn(other);
    assert!(draw(&mut app).is_empty());
}

#[test]
fn by_default_few_kinds_are_drawn() {
    let (default, all, none) = (FaceoffGizmos::default(), FaceoffGizmos::all(), FaceoffGizmos::none());
    let shown = FaceoffGizmos {
        contacts: all.contacts,
        intersections: all.intersections,
        faces: all.faces,
        ..none.clone()
    };
    assert_eq!(default, shown);
    for (name, switch) in KINDS {
        let mut without = all.clone();
        switch(&mut without, None);
        assert_ne!(without, all, "{name} is not among all");
        let mut with = none.clone();
        switch(&mut with, None);
        assert_eq!(with, none, "{name} is among none");
    }
}

#[test]
fn a_wireframe_has_each_edge_once_where_the_collider_is() {
    let mut app = app(true);
    let cube = cube(&mut app);
    let pose = Transform::from_xyz(1.0, 2.0, 3.0).with_rotation(Quat::from_rotation_y(0.4));
    let place = Transform::from_xyz(0.0, 1.0, 0.0).with_scale(Vec3::new(2.0, 1.0, 0.5));
    app.world_mut()
        .spawn((RigidBody::Dynamic, pose, children![(cube, place)]));
    show(&mut app, |g| g.wireframes = Some(Color::WHITE));
    let lines = draw(&mut app);
    let corners = corners(|v| pose.transform_point(place.transform_point(v)));
    let mut edges: Vec<_> = (lines.ends.iter())
        .map(|ends| {
            let mut numbers = ends.map(|p| corners.iter().position(|c| c.distance(p) < 1.0e-4).unwrap());
            numbers.sort_unstable();
            numbers
        })
        .collect();
    edges.sort_unstable();
    edges.dedup();
    // Twelve edges, and a diagonal on each side.
    assert_eq!((edges.len(), lines.ends.len()), (18, 18));
    assert!(lines.strips.is_empty());
    // The box around them is that of an upright body, turned about y.
    show(&mut app, |g| g.boxes = Some(Color::WHITE));
    let [low, high] = draw(&mut app).bounds();
    for corner in &corners {
        assert!(corner.cmpge(low - 1.0e-4).all() && corner.cmple(high + 1.0e-4).all());
    }
    assert!((high.y - low.y - 1.0).abs() < 1.0e-3, "{low} to {high}");
}

#[test]
fn a_sheared_collider_is_left_out_until_its_copy_is_baked() {
    let mut app = app(true);
    let cube = cube(&mut app);
    let stretched = Transform::from_scale(Vec3::new(2.0, 1.0, 1.0));
    let turned = Transform::from_rotation(Quat::from_rotation_z(FRAC_PI_4));
    app.world_mut()
        .spawn((RigidBody::Static, stretched, children![(cube, turned)]));
    let (ready, waits) = (Color::srgb(1.0, 0.0, 0.0), Color::srgb(0.0, 0.0, 1.0));
    show(&mut app, |g| {
        g.wireframes = Some(ready);
        g.left_out = Some(waits);
    });
    let corners = corners(|v| stretched.transform_point(turned.transform_point(v)));
    let mut waited = false;
    update_until(&mut app, |app| {
        let lines = lines(app);
        assert!(lines.points().all(|point| is_one_of(point, &corners)));
        let is_blue = |color: &LinearRgba| near(*color, waits.to_linear());
        waited |= lines.colors.iter().any(is_blue);
        !lines.is_empty() && !lines.colors.iter().any(is_blue)
    });
    assert!(waited);
    let lines = draw(&mut app);
    lines.all_have(ready);
    assert!(lines.points().all(|point| is_one_of(point, &corners)));
}

/// The length of the diagonal of a body that turns below a stretched entity. In the step a body does not change its
/// shape.
#[test]
fn a_body_that_turns_below_a_stretched_entity_keeps_its_shape() {
    let mut app = app(true);
    let cube = cube(&mut app);
    let body = (RigidBody::Dynamic, cube, AngularVelocity(2.0 * Vec3::Z));
    app.world_mut()
        .spawn((Transform::from_scale(Vec3::new(2.0, 1.0, 1.0)), children![body]));
    show(&mut app, |g| g.wireframes = Some(Color::WHITE));
    let lengths = |lines: &Lines| {
        let mut lengths: Vec<f32> = lines.ends.iter().map(|[p, q]| p.distance(*q)).collect();
        lengths.sort_unstable_by(f32::total_cmp);
        lengths
    };
    let before = lengths(&draw(&mut app));
    for _ in 0..20 {
        app.update();
    }
    let after = lengths(&draw(&mut app));
    assert_eq!(before.len(), 18);
    assert!((before[17] - 5.0_f32.sqrt()).abs() < 1.0e-3, "{before:?}");
    for (one, other) in before.iter().zip(&after) {
        assert!((one - other).abs() < 1.0e-3, "{before:?} {after:?}");
    }
}

#[test]
fn colours_tell_the_state_of_colliders() {
    let mut app = app(true);
    let collider = cube(&mut app);
    let body = app.world_mut().spawn((RigidBody::Dynamic, collider)).id();
    let [awake, asleep, sensor, out] =
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 0.0]].map(Color::srgb_from_array);
    show(&mut app, |g| {
        g.wireframes = Some(awake);
        g.sleeping = Some(asleep);
        g.sensors = Some(sensor);
        g.left_out = Some(out);
    });
    draw(&mut app).all_have(awake);
    // It is at rest, and falls asleep.
    for _ in 0..80 {
        app.update();
    }
    assert!(app.world().get::<Sleeping>(body).unwrap().0);
    draw(&mut app).all_have(asleep);
    app.world_mut().entity_mut(body).insert(Sensor);
    draw(&mut app).all_have(sensor);
    app.world_mut().entity_mut(body).insert(ColliderDisabled);
    draw(&mut app).all_have(out);
    app.world_mut()
        .entity_mut(body)
        .remove::<(ColliderDisabled, Sensor)>()
        .insert(RigidBodyDisabled);
    draw(&mut app).all_have(out);
    app.world_mut()
        .entity_mut(body)
        .remove::<RigidBodyDisabled>()
        .insert(LinearVelocity(Vec3::NAN));
    draw(&mut app).all_have(out);
    show(&mut app, |g| {
        g.wireframes = Some(awake);
        g.left_out = None;
    });
    assert!(draw(&mut app).is_empty());
}

#[test]
fn bodies_of_one_island_share_a_colour() {
    let mut app = app(true);
    let collider = cube(&mut app);
    for x in [0.0, 0.999, 5.0] {
        let place = Transform::from_xyz(x, 0.0, 0.0);
        app.world_mut().spawn((RigidBody::Dynamic, collider.clone(), place));
    }
    // What does not move joins no islands.
    for x in [2.5, 3.499] {
        let place = Transform::from_xyz(x, 0.0, 0.0);
        app.world_mut().spawn((RigidBody::Static, collider.clone(), place));
    }
    let islands = Some(Color::srgb(1.0, 0.0, 0.0));
    show(&mut app, |g| g.islands = islands);
    let links = draw(&mut app);
    assert_eq!(links.ends.len(), 1, "{links:?}");
    let length = links.ends[0][0].distance(links.ends[0][1]);
    assert!((length - 1.0).abs() < 0.01, "{length}");

    show(&mut app, |g| {
        g.islands = islands;
        g.wireframes = Some(Color::WHITE);
    });
    let lines = draw(&mut app);
    let color_at = |x: f32| {
        let at = lines
            .ends
            .iter()
            .position(|ends| ends.iter().all(|p| (p.x - x).abs() < 0.6));
        lines.colors[2 * at.unwrap()]
    };
    let [one, other, far, fixed] = [0.0, 1.0, 5.0, 2.5].map(color_at);
    assert!(near(one, other) && !near(one, far), "{one:?} {other:?} {far:?}");
    assert!(near(fixed, LinearRgba::WHITE));
}

#[test]
fn arrows_show_velocities_from_the_centre_of_mass() {
    let mut app = app(true);
    let collider = cube(&mut app);
    let place = Transform::from_xyz(0.0, 3.0, 0.0).with_scale(Vec3::splat(2.0));
    let center = CenterOfMass(Vec3::X);
    let body = (
        RigidBody::Dynamic,
        collider,
        place,
        center,
        LinearVelocity(4.0 * Vec3::Y),
    );
    let body = app.world_mut().spawn(body).id();
    show(&mut app, |g| {
        g.linear_velocities = Some(Color::WHITE);
        g.velocity_scale = 0.5;
    });
    let lines = draw(&mut app);
    let [start, end] = lines.ends[0];
    let pose = app.world().get::<Transform>(body).unwrap();
    let center = app.world().get::<ComputedCenterOfMass>(body).unwrap().in_world(pose);
    assert!(start.distance(center) < 1.0e-4, "{start} {center}");
    assert!((end - start).distance(2.0 * Vec3::Y) < 1.0e-4, "{start} {end}");
    assert!((center.x - 2.0).abs() < 1.0e-4, "{center}");
    // What does not move has no arrow.
    show(&mut app, |g| g.angular_velocities = Some(Color::WHITE));
    assert!(draw(&mut app).is_empty());
}

#[test]
fn casters_are_drawn_as_far_as_they_reach() {
    let mut app = app(true);
    app.world_mut().spawn(PlaneCollider::default());
    let ray = RayCaster::new(Vec3::ZERO, Dir3::NEG_Y).with_max_hits(1);
    let caster = app.world_mut().spawn((Transform::from_xyz(1.0, 3.0, 0.0), ray)).id();
    show(&mut app, |g| g.rays = Some(Color::WHITE));
    let lines = draw(&mut app);
    assert_eq!(lines.ends, [[Vec3::new(1.0, 3.0, 0.0), Vec3::X]]);
    show(&mut app, |g| g.hits = Some(Color::WHITE));
    assert!(draw(&mut app).points().all(|p| p.distance(Vec3::X) < 0.3));
    app.world_mut().get_mut::<RayCaster>(caster).unwrap().max_distance = 2.0;
    assert!(draw(&mut app).is_empty());
    show(&mut app, |g| g.rays = Some(Color::WHITE));
    assert_eq!(draw(&mut app).ends[0][1], Vec3::X + Vec3::Y);
    app.world_mut().get_mut::<RayCaster>(caster).unwrap().enabled = false;
    assert!(draw(&mut app).is_empty());

    // Shapes at the start and at the hit: they reach from the ground to their own top.
    let mesh = cube(&mut app);
    for (shape, half_height) in [
        (CasterShape::Ball { radius: 0.25 }, 0.25),
        (
            CasterShape::Box {
                half_size: Vec3::new(0.1, 0.5, 0.1),
            },
            0.5,
        ),
        (
            CasterShape::Capsule {
                radius: 0.2,
                half_length: 0.3,
            },
            0.5,
        ),
        (
            CasterShape::Mesh {
                mesh: mesh.0.clone(),
                scale: Vec3::splat(2.0),
            },
            1.0,
        ),
    ] {
        app.world_mut()
            .entity_mut(caster)
            .insert(ShapeCaster::new(shape.clone(), Vec3::ZERO, Dir3::NEG_Y));
        show(&mut app, |g| g.shapes = Some(Color::WHITE));
        let [low, high] = draw(&mut app).bounds();
        assert!(
            low.y.abs() < 0.01 && (high.y - 3.0 - half_height).abs() < 0.01,
            "{shape:?}: {low} to {high}"
        );
    }
}

#[test]
fn a_character_is_a_capsule_on_its_ground() {
    let mut app = app(true);
    app.world_mut().spawn(PlaneCollider::default());
    app.world_mut()
        .spawn((Transform::from_xyz(0.0, 0.81, 0.0), Character::new(0.3, 0.5)));
    show(&mut app, |g| {
        g.characters = Some(Color::WHITE);
        g.marker_size = 0.001;
    });
    let [low, high] = draw(&mut app).bounds();
    assert!(low.y.abs() < 0.02 && (high.y - 1.6).abs() < 0.03, "{low} to {high}");
    assert!((high.x - 0.3).abs() < 0.01, "{low} to {high}");
}

#[test]
fn a_plane_is_a_grid_about_the_place_of_its_entity() {
    let mut app = app(true);
    let place = Transform::from_xyz(3.0, 0.0, 0.0).with_rotation(Quat::from_rotation_z(FRAC_PI_4));
    app.world_mut().spawn((
        place,
        PlaneCollider {
            normal: Vec3::Y,
            distance: 1.0,
        },
    ));
    show(&mut app, |g| {
        g.planes = Some(Color::WHITE);
        g.plane_size = 4.0;
    });
    let (normal, foot) = (place.rotation * Vec3::Y, place.transform_point(Vec3::Y));
    let lines = draw(&mut app);
    let heights = lines.points().map(|point| normal.dot(point - foot));
    let [low, high] = heights.fold([0.0_f32; 2], |[low, high], h| [low.min(h), high.max(h)]);
    // The arrow is as long as a square.
    assert!(low > -1.0e-4 && (high - 0.4).abs() < 1.0e-4, "{low} to {high}");
    let reach = lines.points().map(|point| point.distance(foot)).fold(0.0, f32::max);
    assert!((reach - 8.0_f32.sqrt()).abs() < 1.0e-3, "{reach}");
}

#[test]
fn lists_of_faces_are_made_only_while_they_are_drawn() {
    let enable = |app: &mut App, enabled| {
        let mut store = app.world_mut().resource_mut::<GizmoConfigStore>();
        store.config_mut::<FaceoffGizmos>().0.enabled = enabled;
    };
    for wanted in [false, true] {
        let mut app = app(true);
        show(&mut app, |_| {});
        app.update();
        app.insert_resource(FaceLists(wanted));
        let lists = |app: &mut App| {
            app.update();
            *app.world().resource::<FaceLists>()
        };
        assert_eq!(lists(&mut app), FaceLists(wanted));
        show(&mut app, |g| g.intersections = Some(Color::WHITE));
        assert_eq!(lists(&mut app), FaceLists(true));
        assert_eq!(lists(&mut app), FaceLists(true));
        show(&mut app, |g| g.contacts = Some(Color::WHITE));
        assert_eq!(lists(&mut app), FaceLists(wanted));
        show(&mut app, |g| g.intersections = Some(Color::WHITE));
        assert_eq!(lists(&mut app), FaceLists(true));
        enable(&mut app, false);
        assert_eq!(lists(&mut app), FaceLists(wanted));
    }
}

#[test]
fn without_bevys_gizmos_nothing_happens() {
    let mut app = app(false);
    app.update();
    app.update();
}

#[test]
fn without_the_step_nothing_happens() {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins.build().disable::<ScheduleRunnerPlugin>(),
        TransformPlugin,
        AssetPlugin::default(),
    ));
    add_gizmos(&mut app, true);
    app.world_mut().spawn((RigidBody::Dynamic, MeshCollider::default()));
    show(&mut app, |g| {
        *g = FaceoffGizmos::all();
        // A body has one, wherever its shape is.
        g.centers_of_mass = None;
    });
    assert!(draw(&mut app).is_empty());
}
