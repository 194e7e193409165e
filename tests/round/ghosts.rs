//! A floor of many pieces, as flat as a plane: after a public scene of Box3D, where bodies slide over two meshes that
//! meet at a line, T-junctions, and beams with chamfers and pits between them. Lengths are units of 0.0254 m.

use crate::world::World;
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::state::{Body, BodyParams};
use bevy_faceoff::types::body::{LockedAxes, RigidBody};
use bevy_faceoff::types::material::Friction;
use glam::{Quat, Vec3};

const UNIT: f32 = 0.0254;

/// The floor from one x to another as a profile: x and y.
fn profile(from: f32, to: f32, beams: bool) -> Vec<[f32; 2]> {
    let mut points = Vec::new();
    let mut add = |x: f32, y: f32| points.push([x, y]);
    let mut x = from;
    while x < to {
        add(x, 0.0);
        x += 32.0;
    }
    add(to, 0.0);
    if !beams {
        return points;
    }
    points.retain(|[x, _]| x.abs() > 94.0 || *x == 0.0);
    for beam in -4..=4 {
        let middle = 22.0 * beam as f32;
        let top = [[middle - 6.0, 0.0], [middle + 6.0, 0.0]];
        let inside = |[x, _]: &[f32; 2]| (from..=to).contains(x);
        points.extend(top.iter().filter(|p| inside(p)));
        if beam < 4 {
            let pit = [[7.5, -1.0], [7.5, -24.0], [14.5, -24.0], [14.5, -1.0]].map(|[x, y]| [middle + x, y]);
            points.extend(pit.iter().filter(|p| inside(p)));
        }
    }
    // Points above each other keep their order: down on the left side of a pit, up on the right.
    points.sort_by(|p, q| p[0].total_cmp(&q[0]));
    points
}

/// A profile drawn along z, with so many strips.
fn floor(profile: &[[f32; 2]], strips: u32) -> TriMesh {
    let at = |i: usize, k: u32| i as u32 * (strips + 1) + k;
    let vertices = profile
        .iter()
        .flat_map(|&[x, y]| (0..=strips).map(move |k| Vec3::new(x, y, 128.0 * k as f32 / strips as f32 - 64.0) * UNIT));
    let mut faces = Vec::new();
    for i in 0..profile.len() - 1 {
        for k in 0..strips {
            faces.push([at(i, k), at(i, k + 1), at(i + 1, k)]);
            faces.push([at(i + 1, k), at(i, k + 1), at(i + 1, k + 1)]);
        }
    }
    TriMesh::new(vertices.collect(), faces).unwrap()
}

/// Slides a body to and fro for 4 s. Returns how much its height changes, in units of its own height.
fn slide(mesh: CollisionMesh, scale: Vec3, beams: bool) -> f64 {
    let mut world = World::new();
    world.state.input.config.gravity = Vec3::NEG_Y * 20.32;
    let smooth = BodyParams {
        friction: Friction {
            coefficient: 0.0,
            ..Friction::default()
        },
        locked_axes: LockedAxes::ROTATION,
        ..BodyParams::default()
    };
    for (from, to, strips) in [(-256.0, 0.0, 4), (0.0, 256.0, 3)] {
        let mesh = world
            .state
            .input
            .meshes
            .add(CollisionMesh::new(&floor(&profile(from, to, beams), strips)));
        world.put(&Body {
            kind: RigidBody::Static,
            params: smooth,
            ..Body::at_rest(mesh, Vec3::ZERO, Quat::IDENTITY, Vec3::ONE)
        });
    }
    let mesh = world.state.input.meshes.add(mesh);
    let height = 72.0 * UNIT;
    let body = world.put(&Body {
        params: smooth,
        mass: Some(500.0),
        ..Body::at_rest(
            mesh,
            Vec3::new(-150.0 * UNIT, 0.5003 * height, 0.0),
            Quat::IDENTITY,
            scale,
        )
    });
    let (mut low, mut high) = (f64::INFINITY, 0.0f64);
    for step in 0..4 * 64 {
        let x = world.center(body).x as f32 / UNIT;
        let v = &mut world.state.input.bodies.linear_velocity[body];
        let forward = if !(-200.0..=200.0).contains(&x) {
            -x.signum()
        } else if v.x < 0.0 {
            -1.0
        } else {
            1.0
        };
        (v.x, v.z) = (
            forward * 350.0 * UNIT,
            if step / 64 % 2 == 0 { 20.0 } else { -20.0 } * UNIT,
        );
        world.step();
        if step > 32 {
            let y = world.center(body).y;
            (low, high) = (low.min(y), high.max(y));
        }
    }
    (high - low) / f64::from(height)
}

#[test]
fn bodies_slide_over_a_floor_of_pieces_at_one_height() {
    let size = Vec3::new(32.0, 72.0, 32.0) * UNIT;
    let cuboid = || CollisionMesh::cuboid(size, 0.0).unwrap();
    let rounded = || CollisionMesh::cuboid(size, 4.0 * UNIT).unwrap();
    let capsule = || CollisionMesh::capsule(16.0 * UNIT, 40.0 * UNIT).unwrap();
    let ball = || CollisionMesh::ball(36.0 * UNIT).unwrap();
    let mesh = || CollisionMesh::new(&shapes::ball(f64::from(36.0 * UNIT), 4));
    for (name, mesh, beams) in [
        ("cuboid", cuboid(), false),
        ("rounded cuboid", rounded(), false),
        ("capsule", capsule(), false),
        ("ball", ball(), false),
        ("ball of triangles", mesh(), false),
        ("cuboid on beams", cuboid(), true),
        ("rounded cuboid on beams", rounded(), true),
    ] {
        let change = slide(mesh, Vec3::ONE, beams);
        println!("{name}: its height changes by {change:.2e} of it");
        assert!(change < 1.0e-4, "{name}: {change}");
    }
}
