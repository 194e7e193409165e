//! How bodies move when nothing touches them.

use crate::app::{DT, Sim, assert_near, resting};
use bevy::prelude::*;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::prelude::*;

/// Height lost after `steps` steps of semi-implicit Euler in substeps.
fn fallen(g: f32, steps: u32) -> f32 {
    let substeps = SolverSettings::default().substeps;
    let (h, n) = (DT / substeps as f32, steps * substeps);
    g * h * h * (n * (n + 1) / 2) as f32
}

#[test]
fn a_body_moves_by_its_velocity_alone_without_gravity() {
    let mut sim = Sim::new();
    let cube = sim.mesh(&shapes::cube(1.0));
    let body = sim.spawn((resting(&cube, Vec3::ONE), LinearVelocity(Vec3::new(1.0, -2.0, 0.5))));
    sim.step(64);
    assert_near(sim.position(body), Vec3::new(2.0, -1.0, 1.5), 1e-5);
    assert_eq!(sim.velocity(body), Vec3::new(1.0, -2.0, 0.5));
    assert_eq!(sim.get::<Transform>(body).rotation, Quat::IDENTITY);
}

#[test]
fn gravity_accelerates_by_its_vector_and_each_body_by_its_scale() {
    let mut sim = Sim::new();
    let cube = sim.mesh(&shapes::cube(1.0));
    sim.world().insert_resource(Gravity(Vec3::new(0.0, -8.0, 0.0)));
    let at = |x: f32| Vec3::new(x, 0.0, 0.0);
    let plain = sim.spawn(resting(&cube, at(0.0)));
    let floating = sim.spawn((resting(&cube, at(10.0)), GravityScale(0.0)));
    let rising = sim.spawn((resting(&cube, at(20.0)), GravityScale(-0.5)));
    let heavy = sim.spawn((resting(&cube, at(30.0)), Mass(1000.0)));
    sim.step(32);
    for (body, factor) in [(plain, 1.0), (floating, 0.0), (rising, -0.5), (heavy, 1.0)] {
        assert_near(sim.velocity(body), Vec3::Y * (-8.0 * factor * 0.5), 1e-5);
        let start = Vec3::X * sim.position(body).x;
        assert_near(sim.position(body), start - Vec3::Y * fallen(8.0 * factor, 32), 1e-4);
    }
    assert_eq!(sim.position(heavy).x, 30.0);
}

#[test]
fn earth_gravity_holds_unless_it_is_changed() {
    let mut sim = Sim::new();
    let cube = sim.mesh(&shapes::cube(1.0));
    sim.world().insert_resource(Gravity::default());
    let body = sim.spawn(resting(&cube, Vec3::ZERO));
    sim.step(64);
    assert_near(sim.velocity(body), Vec3::NEG_Y * 9.81, 1e-3);
}

#[test]
fn a_spinning_body_turns_about_its_axis_by_speed_times_time() {
    let mut sim = Sim::new();
    // All axes are alike to a cube: nothing tumbles.
    let cube = sim.mesh(&shapes::cube(1.0));
    let spin = Vec3::new(0.3, -1.1, 0.7);
    let body = sim.spawn((resting(&cube, Vec3::ZERO), AngularVelocity(spin)));
    sim.step(64);
    let wanted = Quat::from_scaled_axis(spin);
    let found = sim.get::<Transform>(body).rotation;
    assert!(found.angle_between(wanted) < 1e-3, "{found} instead of {wanted}");
    assert!(found.is_normalized());
    assert_eq!(sim.spin(body), spin);
}

#[test]
fn a_body_turns_about_its_centre_of_mass_not_its_origin() {
    let mut sim = Sim::new();
    let cube = shapes::cube(1.0);
    let moved = cube.vertices().iter().map(|v| *v + Vec3::X * 3.0).collect();
    let cube = sim.mesh(&TriMesh::new(moved, cube.triangles().to_vec()).unwrap());
    let body = sim.spawn((resting(&cube, Vec3::ZERO), AngularVelocity(Vec3::Z * 2.0)));
    sim.step(50);
    let pose = sim.get::<Transform>(body);
    assert_near(pose.transform_point(Vec3::X * 3.0), Vec3::X * 3.0, 1e-4);
    assert!(pose.translation.length() > 1.0, "the origin has moved about the centre");
}

#[test]
fn scale_survives_steps_bit_for_bit_also_uneven_and_mirrored() {
    let mut sim = Sim::new();
    let torus = sim.mesh(&shapes::torus_240());
    let scale = Vec3::new(-1.7, 0.3, 2.9);
    let body = sim.spawn((
        RigidBody::Dynamic,
        torus,
        Transform::from_scale(scale),
        LinearVelocity(Vec3::X),
        AngularVelocity(Vec3::ONE),
    ));
    sim.step(20);
    let pose = sim.get::<Transform>(body);
    assert_eq!(pose.scale, scale);
    assert!(pose.translation.x > 0.1);
}

#[test]
fn a_body_that_rests_is_not_marked_as_changed() {
    #[derive(Resource, Default)]
    struct Changes(usize);
    let mut sim = Sim::new();
    let cube = sim.mesh(&shapes::cube(1.0));
    let body = sim.spawn(resting(&cube, Vec3::ONE));
    sim.world().init_resource::<Changes>();
    sim.app.add_systems(
        Last,
        |query: Query<(), Or<(Changed<Transform>, Changed<LinearVelocity>)>>, mut changes: ResMut<Changes>| {
            changes.0 += query.iter().count();
        },
    );
    sim.step(1);
    assert_eq!(sim.world().resource::<Changes>().0, 1, "newly spawned");
    sim.step(5);
    assert_eq!(sim.world().resource::<Changes>().0, 1);
    sim.set(body, LinearVelocity(Vec3::X));
    sim.step(3);
    assert_eq!(sim.world().resource::<Changes>().0, 4);
}

/// A grenade is thrown before its mesh is loaded.
#[test]
fn an_impulse_waits_for_the_first_step_of_its_body() {
    let mut sim = Sim::new();
    let cube = sim.mesh(&shapes::cube(1.0));
    let to_come = sim.world().resource::<Assets<CollisionMesh>>().reserve_handle();
    let push = ExternalForces {
        impulse: Vec3::X * 6.0,
        angular_impulse: Vec3::Y,
        ..default()
    };
    let mut thrown = |z: f32| sim.spawn((RigidBody::Dynamic, Mass(2.0), push, Transform::from_xyz(0.0, 0.0, z)));
    let [bare, parent, disabled, loading, rejected] = [0.0, 5.0, 10.0, 15.0, 20.0].map(&mut thrown);
    sim.set(disabled, (cube.clone(), RigidBodyDisabled));
    sim.set(loading, MeshCollider(to_come.clone()));
    sim.set(rejected, (cube.clone(), Mass(f32::NAN)));
    let bodies = [bare, parent, disabled, loading, rejected];
    sim.step(5);
    for body in bodies {
        assert_eq!(sim.get::<ExternalForces>(body), push);
        assert_eq!(sim.velocity(body), Vec3::ZERO);
    }
    sim.set(bare, cube.clone());
    sim.spawn((cube.clone(), ChildOf(parent)));
    sim.world().entity_mut(disabled).remove::<RigidBodyDisabled>();
    sim.set(rejected, Mass(2.0));
    let mesh = CollisionMesh::new(&shapes::cube(1.0));
    let mut meshes = sim.world().resource_mut::<Assets<CollisionMesh>>();
    meshes.insert(&to_come, mesh).unwrap();
    for steps in [1, 5] {
        sim.step(steps);
        for (number, body) in bodies.into_iter().enumerate() {
            assert_near(sim.velocity(body), Vec3::X * 3.0, 1e-4);
            assert_near(sim.spin(body), Vec3::Y * 3.0, 1e-3);
            assert_eq!(sim.get::<ExternalForces>(body), ExternalForces::default(), "{number}");
        }
    }
    // It is used up in the same step from then on, of a body that does not move too.
    sim.set(bare, (RigidBody::Static, push));
    sim.set(parent, push);
    sim.step(1);
    assert_near(sim.velocity(parent), Vec3::X * 6.0, 1e-4);
    for body in [bare, parent] {
        assert_eq!(sim.get::<ExternalForces>(body), ExternalForces::default());
    }
}

#[test]
fn users_may_teleport_a_body_and_set_its_velocity_between_steps() {
    let mut sim = Sim::new();
    let cube = sim.mesh(&shapes::cube(1.0));
    let body = sim.spawn((resting(&cube, Vec3::ZERO), LinearVelocity(Vec3::X)));
    sim.step(10);
    sim.set(
        body,
        (Transform::from_xyz(50.0, 60.0, 70.0), LinearVelocity(Vec3::Y * 64.0)),
    );
    sim.step(1);
    assert_near(sim.position(body), Vec3::new(50.0, 61.0, 70.0), 1e-5);
}
