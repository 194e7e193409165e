//! What a bake decides about a mesh, seen in an app: rooms, and seams that hold.

use crate::app::{Sim, resting};
use bevy::prelude::*;
use bevy_faceoff::geometry::{Orientation, TriMesh, shapes};
use bevy_faceoff::prelude::*;
use bevy_faceoff::projection::Inward;
use std::f32::consts::{PI, TAU};

fn baked(sim: &mut Sim, mesh: &TriMesh, settings: BakeSettings) -> MeshCollider {
    let mut meshes = sim.world().resource_mut::<Assets<CollisionMesh>>();
    MeshCollider(meshes.add(CollisionMesh::without_faces(mesh, settings)))
}

/// A cube of edge 4 whose faces look inward.
fn room() -> TriMesh {
    let cube = shapes::cube(4.0);
    let faces = cube.triangles().iter().map(|&[a, b, c]| [a, c, b]).collect();
    TriMesh::new(cube.vertices().to_vec(), faces).unwrap()
}

/// Nobody leaves, however the room is placed, and nobody is told to be inside of anything.
pub fn a_ball_dropped_in_a_room_rests_on_its_floor() {
    for scale in [Vec3::ONE, Vec3::new(-1.0, 1.0, 1.0), Vec3::new(1.0, 1.0, 1.5)] {
        let mut sim = Sim::new();
        sim.world().insert_resource(Gravity(Vec3::NEG_Y * 10.0));
        let walls = baked(&mut sim, &room(), BakeSettings::default());
        let walls = sim.spawn((RigidBody::Static, walls, Transform::from_scale(scale)));
        let ball = sim.mesh(&shapes::ball(0.5, 3));
        let ball = sim.spawn((resting(&ball, Vec3::new(0.4, 0.2, -0.3)), LinearVelocity(Vec3::X * 4.0)));
        let mut bounces = 0;
        for step in 0..400 {
            sim.step(1);
            assert!(sim.collisions().iter().all(|c| !c.contained), "step {step}");
            let at = sim.position(ball).abs();
            assert!(at.cmple(scale.abs() * 2.0 - 0.45).all(), "step {step}: {at}");
            bounces += usize::from(sim.position(ball).x > 1.45);
        }
        assert!(bounces > 0, "it met a wall");
        // The floor is at -2.
        let height = sim.position(ball).y + 2.0;
        assert!((0.49..0.51).contains(&height), "{height}");
        let points = sim.collisions().manifolds().find(|(a, b, _)| [*a, *b].contains(&walls));
        assert!(points.is_some_and(|(_, _, points)| !points.is_empty()));
    }
}

/// A body that starts in the wall is pushed back into the room.
pub fn the_walls_of_a_room_push_inward() {
    let mut sim = Sim::new();
    let walls = baked(&mut sim, &room(), BakeSettings::default());
    sim.spawn((RigidBody::Static, walls, Transform::default()));
    let ball = sim.mesh(&shapes::ball(0.5, 3));
    let ball = sim.spawn(resting(&ball, Vec3::X * 1.55));
    sim.step(100);
    let x = sim.position(ball).x;
    assert!((1.4..1.51).contains(&x), "{x}");
}

/// With faces turned by the bake, it is the cube that looks outward, to the bit.
pub fn the_same_mesh_as_a_solid_is_the_outward_one() {
    let fates = [
        (
            room(),
            BakeSettings {
                inward: Inward::Solid,
                ..BakeSettings::default()
            },
        ),
        (shapes::cube(4.0), BakeSettings::default()),
    ]
    .map(|(mesh, settings)| {
        let mut sim = Sim::new();
        let block = baked(&mut sim, &mesh, settings);
        let block = sim.spawn((RigidBody::Static, block, Transform::default()));
        let ball = sim.mesh(&shapes::ball(0.5, 3));
        let ball = sim.spawn((resting(&ball, Vec3::X * 1.2), SleepingDisabled));
        sim.step(1);
        assert!(sim.collisions().get(block, ball).is_some_and(|c| c.contained));
        sim.step(300);
        sim.position(ball)
    });
    assert!(fates[0].x > 2.49, "{}", fates[0]);
    assert_eq!(fates[0], fates[1]);
}

/// A ball made as Bevy makes its UV spheres: the corners where it closes, and those at its poles, differ in their last
/// bits.
pub fn with_a_seam(radius: f32, sectors: u32, stacks: u32) -> TriMesh {
    let mut vertices = Vec::new();
    for i in 0..=stacks {
        let up = PI / 2.0 - i as f32 * PI / stacks as f32;
        for j in 0..=sectors {
            let around = j as f32 * TAU / sectors as f32;
            let out = radius * up.cos();
            vertices.push(Vec3::new(out * around.cos(), out * around.sin(), radius * up.sin()));
        }
    }
    let mut faces = Vec::new();
    for i in 0..stacks {
        for j in 0..sectors {
            let (k, l) = (i * (sectors + 1) + j, (i + 1) * (sectors + 1) + j);
            if i != 0 {
                faces.push([k, l, k + 1]);
            }
            if i != stacks - 1 {
                faces.push([k + 1, l, l + 1]);
            }
        }
    }
    TriMesh::new(vertices, faces).unwrap()
}

/// A body in the middle of a ball with a seam is inside, though the axis leads through its open pole, and is pushed
/// out.
pub fn no_ray_slips_through_a_seam() {
    let ball = with_a_seam(1.0, 32, 18);
    assert_eq!(ball.orientation(), Orientation::Outward);
    for at in [Vec3::ZERO, Vec3::Z * 0.25, Vec3::new(0.3, 0.0, 0.1)] {
        let mut sim = Sim::new();
        let (outer, inner) = (sim.mesh(&ball), sim.mesh(&with_a_seam(0.1, 12, 6)));
        let outer = sim.spawn((RigidBody::Static, outer, Transform::default()));
        let inner = sim.spawn((resting(&inner, at), SleepingDisabled));
        sim.step(1);
        let found = sim.collisions().get(outer, inner);
        assert!(found.is_some_and(|c| c.contained), "at {at}");
        sim.step(200);
        assert!(sim.position(inner).length() > 1.05, "{}", sim.position(inner));
    }
}
