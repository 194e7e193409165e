//! Scenes on an inclined plane.

use super::{Body, Scene, Shape};
use crate::types::material::{CombineRule, Friction};
use glam::{Quat, Vec3};

/// A fixed box whose top passes through the origin and slopes down along x by `angle` radians; and its rotation.
pub fn slope(angle: f64) -> (Scene, Quat) {
    let turn = Quat::from_rotation_z(-angle as f32);
    let mut scene = Scene::new();
    scene.floor(Vec3::new(80.0, 1.0, 20.0), turn);
    (scene, turn)
}

/// Cubes of edge 1 with friction 0.1 to 0.9 side by side on a slope of 25 degrees, and a ball beside them.
pub fn frictions() -> Scene {
    let mut scene = Scene::new();
    let slope = Quat::from_rotation_z(-25.0f32.to_radians());
    let ground = scene.block(Vec3::ZERO, Vec3::new(24.0, 1.0, 11.0));
    ground.rotation = slope;
    // The friction of a pair is that of the body on the slope.
    ground.friction = Friction::new(1.0).with_combine(CombineRule::Multiply);
    let mut on_slope = |shape, z: f32, height: f32, friction: f32| {
        let at = slope * Vec3::new(-9.0, 0.5 + height, z);
        scene.add(Body::new(shape, at, slope)).friction = Friction::new(friction);
    };
    for i in 0..5 {
        on_slope(Shape::Cube, -4.2 + 1.6 * i as f32, 0.509, 0.1 + 0.2 * i as f32);
    }
    on_slope(Shape::LargeBall, 4.2, 0.606, 0.9);
    scene
}
