//! Bodies that hang, stand, fall and slide.

use super::{Framing, Unseen};
use crate::scene::Scene;
use bevy::prelude::*;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::prelude::*;
use std::f32::consts::FRAC_PI_2;

/// From ring to ring, metres: a little less than what they hang apart.
const LINK: f32 = 0.75;

fn add(world: &mut World, mesh: &TriMesh) -> MeshCollider {
    let mut meshes = world.resource_mut::<Assets<CollisionMesh>>();
    MeshCollider(meshes.add(CollisionMesh::new(mesh)))
}

/// A box of these edges, which does not move.
fn block(world: &mut World, center: Vec3, edges: Vec3) -> Entity {
    let cube = add(world, &shapes::cube(1.0));
    let pose = Transform::from_translation(center).with_scale(edges);
    world.spawn((RigidBody::Static, cube, pose)).id()
}

/// Rings, each through the one above.
pub fn chain(world: &mut World, rings: usize) -> Framing {
    let ring = add(world, &shapes::ring());
    for i in 0..=rings {
        let kind = if i == 0 { RigidBody::Static } else { RigidBody::Dynamic };
        let turn = Quat::from_rotation_y(if i % 2 == 0 { 0.0 } else { FRAC_PI_2 });
        let pose = Transform::from_xyz(0.0, -LINK * i as f32, 0.0).with_rotation(turn);
        world.spawn((kind, ring.clone(), pose));
    }
    let length = LINK * rings as f32;
    Framing {
        center: Vec3::NEG_Y * (0.5 * length),
        side: 0.7 * length + 1.5,
        edges: false,
    }
}

/// Cubes of edge 1, each turned a little against the one below.
pub fn stack(world: &mut World, cubes: usize) -> Framing {
    block(world, Vec3::NEG_Y * 0.5, Vec3::new(20.0, 1.0, 20.0));
    let cube = add(world, &shapes::cube(1.0));
    for i in 0..cubes {
        let pose = Transform::from_xyz(0.0, 0.52 + 1.02 * i as f32, 0.0);
        let turned = pose.with_rotation(Quat::from_rotation_y(0.1 * i as f32));
        world.spawn((RigidBody::Dynamic, cube.clone(), turned));
    }
    let height = 1.02 * cubes as f32;
    Framing {
        center: Vec3::Y * (0.5 * height),
        side: height + 1.0,
        edges: false,
    }
}

/// Bodies of diameter 1 in layers above a bin that they will fill about as high as it is wide.
pub fn pour(world: &mut World, scene: &Scene, mesh: &CollisionMesh) -> Framing {
    const SPACING: f32 = 1.05;
    let across = (scene.bodies as f32).cbrt().ceil().max(2.0) as usize;
    let side = SPACING * across as f32 + 0.3;
    let layers = scene.bodies.div_ceil(across * across);
    let height = 1.0 + SPACING * layers as f32;
    let (half, middle) = (0.5 * side, 0.5 * height);
    block(world, Vec3::NEG_Y * 0.5, Vec3::new(side + 2.0, 1.0, side + 2.0));
    for normal in [Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z] {
        let edges = Vec3::Y * height + (Vec3::ONE - Vec3::Y - normal.abs()) * (side + 2.0) + normal.abs();
        let wall = block(world, normal * (half + 0.5) + Vec3::Y * middle, edges);
        if normal.x + normal.z > 0.0 {
            world.entity_mut(wall).insert(Unseen);
        }
    }
    let collider = MeshCollider(world.resource_mut::<Assets<CollisionMesh>>().add(mesh.clone()));
    let scale = 1.0 / (2.0 * mesh.radius);
    let mut random = fastrand::Rng::with_seed(scene.seed);
    for i in 0..scene.bodies {
        let at = [i % across, i / (across * across), i / across % across].map(|k| k as f32);
        let center = Vec3::new(at[0], at[1], at[2]) * SPACING
            + Vec3::new(0.5 * SPACING - half + 0.15, 1.0, 0.5 * SPACING - half + 0.15);
        let turn = Vec3::from_array([0; 3].map(|_| 4.0 * random.f32() - 2.0));
        let rotation = Quat::from_scaled_axis(turn);
        world.spawn((
            RigidBody::Dynamic,
            collider.clone(),
            Transform {
                translation: center - rotation * (scale * mesh.mass.center),
                rotation,
                scale: Vec3::splat(scale),
            },
        ));
    }
    Framing {
        center: Vec3::Y * (0.4 * height),
        side: height.max(side) + 1.0,
        edges: false,
    }
}

/// Cubes of edge 1 side by side, and a ball beside them.
pub fn incline(world: &mut World) -> Framing {
    let slope = Quat::from_rotation_z(-25.0f32.to_radians());
    let ground = block(world, Vec3::ZERO, Vec3::new(24.0, 1.0, 11.0));
    // What lies on it has its own friction.
    let rule = Friction::new(1.0).with_combine(CombineRule::Multiply);
    world.entity_mut(ground).insert((rule, Restitution::default()));
    if let Some(mut pose) = world.get_mut::<Transform>(ground) {
        pose.rotation = slope;
    }
    let cube = add(world, &shapes::cube(1.0));
    let on_slope = |z: f32, height: f32| {
        let at = slope * Vec3::new(-9.0, 0.5 + height, z);
        Transform::from_translation(at).with_rotation(slope)
    };
    for i in 0..5 {
        let pose = on_slope(-4.2 + 1.6 * i as f32, 0.509);
        let friction = Friction::new(0.1 + 0.2 * i as f32);
        world.spawn((RigidBody::Dynamic, cube.clone(), pose, friction));
    }
    let ball = add(world, &shapes::ball(0.6, 4));
    world.spawn((RigidBody::Dynamic, ball, on_slope(4.2, 0.606), Friction::new(0.9)));
    Framing {
        center: Vec3::ZERO,
        side: 15.0,
        edges: false,
    }
}
