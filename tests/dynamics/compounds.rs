//! Bodies of several colliders: mass, flight, rest, and continuous collision.

use super::hammers::{self, hammer_at, merged, put};
use crate::world::World;
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::state::Body;
use bevy_faceoff::types::body::RigidBody;
use glam::{DVec3, Mat3, Quat, Vec3};

#[test]
fn mass_centre_and_inertia_are_those_of_the_merged_mesh() {
    let mut world = World::new();
    let turn = Quat::from_scaled_axis(Vec3::new(0.4, -1.1, 0.7));
    let number = hammer_at(&mut world, Vec3::new(3.0, -2.0, 1.0), turn);
    let merged = CollisionMesh::new(&merged()).mass;
    let bodies = &world.state.input.bodies;
    let compound = &bodies.compounds[0];
    assert_eq!((compound.number as usize, bodies.parts.len()), (number, 2));
    let mass = 1.0 / bodies.inverse_mass[number];
    assert!((mass / merged.volume - 1.0).abs() < 1.0e-5, "{mass}");
    assert!(compound.local_center.distance(merged.center.as_dvec3()) < 1.0e-6);
    let inertia = merged.inertia(DVec3::ONE, f64::from(merged.volume)).as_mat3();
    let own = compound.local_inverse_inertia.inverse();
    assert!(own.abs_diff_eq(inertia, 1.0e-4 * inertia.x_axis.x), "{own} {inertia}");
    // The tensor in the world is the same for both colliders.
    let axes = Mat3::from_quat(turn);
    let in_world = axes * compound.local_inverse_inertia * axes.transpose();
    for i in 0..2 {
        assert!(bodies.inverse_inertia[i].abs_diff_eq(in_world, 1.0e-3 * in_world.x_axis.x.abs()));
    }
}

#[test]
fn mass_inertia_and_centre_can_be_set() {
    let mut world = World::new();
    let cube = world.mesh(&shapes::cube(1.0));
    let mut body = Body::at_rest(cube, Vec3::ZERO, Quat::IDENTITY, Vec3::ONE);
    body.mass = Some(4.0);
    let center = Vec3::new(0.0, -1.0, 0.0);
    put(
        &mut world,
        &body,
        Some(center),
        &[(cube, (Vec3::ZERO, Quat::IDENTITY), Vec3::ONE)],
    );
    body.inertia = Some(Mat3::from_diagonal(Vec3::new(1.0, 2.0, 3.0)));
    put(
        &mut world,
        &body,
        None,
        &[(cube, (Vec3::ZERO, Quat::IDENTITY), Vec3::ONE)],
    );
    let bodies = &world.state.input.bodies;
    let [lowered, given] = [0, 1].map(|i| bodies.compounds[i]);
    assert_eq!(lowered.center, center.as_dvec3());
    // A cube about an axis at a distance of 1 from its centre: m (1/6 + 1).
    let moments = lowered.local_inverse_inertia.inverse();
    let wanted = 4.0 * Vec3::new(7.0 / 6.0, 1.0 / 6.0, 7.0 / 6.0);
    assert!(moments.abs_diff_eq(Mat3::from_diagonal(wanted), 1.0e-4), "{moments}");
    let wanted = Mat3::from_diagonal(Vec3::new(1.0, 0.5, 1.0 / 3.0));
    assert!(given.local_inverse_inertia.abs_diff_eq(wanted, 1.0e-6));
    assert_eq!([bodies.inverse_mass[0], bodies.inverse_mass[1]], [0.25; 2]);
}

#[test]
fn a_hammer_flies_about_its_centre_of_mass() {
    hammers::flies();
}

#[test]
fn a_hammer_falls_comes_to_rest_and_sleeps() {
    hammers::rests();
}

#[test]
fn it_hits_like_the_merged_mesh() {
    hammers::hits_like_the_merged_mesh();
}

#[test]
fn a_fast_dumbbell_does_not_pass_through_a_thin_wall() {
    for spin in [0.0, 40.0] {
        let mut world = World::weightless();
        let ball = world.mesh(&shapes::ball(0.1, 2));
        let cube = world.mesh(&shapes::cube(1.0));
        let ends = [Vec3::Y, Vec3::NEG_Y].map(|end| (ball, (0.5 * end, Quat::IDENTITY), Vec3::ONE));
        let mut body = Body::at_rest(ball, Vec3::NEG_X * 4.0, Quat::IDENTITY, Vec3::ONE);
        body.linear_velocity = Vec3::X * 300.0;
        body.angular_velocity = Vec3::Z * spin;
        body.params.continuous = true;
        put(&mut world, &body, None, &ends);
        // Only one of the two balls meets the wall.
        let size = if spin == 0.0 { 0.8 } else { 4.0 };
        world.add(
            RigidBody::Static,
            cube,
            Vec3::new(0.01, size, size),
            Vec3::new(0.0, 0.5 - 0.5 * (size - 0.8), 0.0),
            Quat::IDENTITY,
        );
        // In the first step it meets the wall. Later it may swing around the edge.
        world.step();
        let bodies = &world.state.input.bodies;
        let before_wall = |i: usize| bodies.frame[i].center.x < 0.0;
        let stopped = before_wall(0) || before_wall(1);
        assert!(
            stopped && before_wall(0),
            "spin {spin}: {} {}",
            bodies.frame[0].center,
            bodies.frame[1].center
        );
    }
}
