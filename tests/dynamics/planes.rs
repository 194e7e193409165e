//! Meshes on half-spaces.

use crate::world::{GAP, World};
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::manifolds::cpu::planes::MAX_POINTS;
use bevy_faceoff::state::Plane;
use bevy_faceoff::types::body::RigidBody;
use glam::{Quat, Vec3};

fn on_the_ground() -> World {
    let mut world = World::new();
    world.state.input.planes.push(Plane::default());
    world
}

#[test]
fn a_cube_lies_on_four_corners() {
    let mut world = on_the_ground();
    let cube = world.mesh(&shapes::cube(1.0));
    let at = Vec3::new(3.0, 0.51, 1.0);
    let body = world.add(RigidBody::Dynamic, cube, Vec3::ONE, at, Quat::from_rotation_y(0.3));
    world.step();
    assert_eq!(world.state.results.manifolds.pairs[0].bodies, [0, 1]);
    assert_eq!(world.state.results.manifolds.points.len(), 4);
    world.seconds(10);
    let position = world.state.input.bodies.position[body];
    assert!((position.y - 0.5 - GAP).abs() < 0.001, "{position}");
    assert!((position.x - 3.0).hypot(position.z - 1.0) < 0.001, "{position}");
    for point in &world.state.results.manifolds.points {
        assert_eq!(point.normal, Vec3::NEG_Y);
        assert!((point.anchors[0].y + 0.5).abs() < 0.002);
        assert!(point.anchors[1].y.abs() < 1.0e-5);
    }
    let contact = world.state.results.contacts.planes[0];
    assert_eq!((contact.body, contact.plane), (0, 0));
}

#[test]
fn meshes_dropped_on_a_plane_come_to_rest() {
    let bodies = [
        (shapes::ball(0.5, 3), Vec3::ONE, 0.2),
        (shapes::torus_240(), Vec3::ONE, 0.02),
        (shapes::cube(1.0), Vec3::new(0.4, -0.6, 1.0), 0.02),
    ];
    for (k, (mesh, scale, slowest)) in bodies.iter().enumerate() {
        let mut world = on_the_ground();
        let mesh = world.mesh(mesh);
        let turn = Quat::from_scaled_axis(Vec3::new(0.5, 0.2, 0.9));
        world.add(RigidBody::Dynamic, mesh, *scale, Vec3::Y * 1.5, turn);
        world.seconds(8);
        let (speed, deepest) = (world.fastest(), world.deepest());
        assert!(speed < *slowest, "mesh {k} moves with {speed} m/s");
        assert!(deepest < 0.001, "mesh {k} is {deepest} m deep");
        assert!(world.state.results.manifolds.points.len() <= MAX_POINTS);
    }
}
