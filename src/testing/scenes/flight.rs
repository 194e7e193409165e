//! Scenes without gravity: bouncing balls, colliding knots, a spinning body.

use super::{Body, Scene, Shape, any_turn, any_vector};
use crate::types::material::Friction;
use glam::{Quat, Vec3};

/// A ball without friction.
fn smooth(at: Vec3, turn: Quat, velocity: Vec3, restitution: f32) -> Body {
    Body {
        velocity,
        friction: Friction::new(0.0),
        restitution,
        ..Body::new(Shape::Ball, at, turn)
    }
}

/// A ball that flies with `velocity` at a wall, which is the second body.
pub fn ball_on_wall(velocity: Vec3, restitution: f32, random: &mut impl FnMut() -> f32) -> Scene {
    let mut scene = Scene::weightless();
    // A random offset, so that the impact falls at any time of a step.
    let at = Vec3::Y * (1.0 + 0.05 * random());
    scene.add(smooth(at, any_turn(random), velocity, restitution));
    let wall = scene.floor(Vec3::new(20.0, 1.0, 20.0), Quat::IDENTITY);
    (wall.friction, wall.restitution) = (Friction::new(0.0), restitution);
    scene
}

/// Two balls that collide with these velocities along x; the second is offset by `sideways` metres.
pub fn ball_on_ball(velocities: [Vec3; 2], sideways: f32, restitution: f32, random: &mut impl FnMut() -> f32) -> Scene {
    let mut scene = Scene::weightless();
    for (k, velocity) in velocities.into_iter().enumerate() {
        // A random offset, so that the impact falls at any time of a step.
        let at = Vec3::new([-1.0 - 0.05 * random(), 1.0][k], [0.0, sideways][k], 0.0);
        scene.add(smooth(at, any_turn(random), velocity, restitution));
    }
    scene
}

/// `count` knots that fly towards the centre and past each other. `surface` sets each one's material before it gets its
/// velocities.
pub fn cloud<R: FnMut() -> f32>(count: usize, random: &mut R, mut surface: impl FnMut(&mut Body, &mut R)) -> Scene {
    let mut scene = Scene::weightless();
    let side = (count as f32).cbrt().ceil() as usize;
    for i in 0..count {
        let cell = Vec3::new((i % side) as f32, (i / side % side) as f32, (i / side / side) as f32);
        let at = 1.05 * (cell - 0.5 * (side - 1) as f32);
        // Random rotations: identical bodies in a lattice would collide so symmetrically that errors cancel out.
        let knot = scene.add(Body::new(Shape::Knot, at, any_turn(random)));
        surface(knot, random);
        knot.velocity = -0.5 * at + any_vector(random) * 1.5;
        knot.spin = any_vector(random) * 3.0;
    }
    scene
}

/// A non-uniformly scaled knot with the angular velocity `spin` in its own axes.
pub fn squeezed_knot(spin: Vec3) -> Scene {
    let mut scene = Scene::weightless();
    let turn = Quat::from_scaled_axis(Vec3::new(0.5, 0.2, 0.9));
    let knot = scene.add(Body::new(Shape::Knot, Vec3::new(1.0, 2.0, 3.0), turn));
    knot.scale = Vec3::new(0.5, 1.0, 1.7);
    knot.spin = turn * spin;
    scene
}
