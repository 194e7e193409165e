//! A chain of rings that hangs from a fixed one, and a test of whether it is intact.

use super::{Body, RING_LINE, Scene, Shape};
use glam::{DQuat, DVec3, Quat, Vec3};
use std::f32::consts::FRAC_PI_2;

/// `count` linked rings, their centres `link` metres apart; the first is fixed. At rest the distance is 0.76 m.
pub fn chain(count: usize, link: f32) -> Scene {
    let mut scene = Scene::new();
    for i in 0..count {
        let turn = Quat::from_rotation_y(if i % 2 == 0 { 0.0 } else { FRAC_PI_2 });
        let at = Vec3::NEG_Y * (link * i as f32);
        scene.add(Body::new(Shape::Ring, at, turn)).fixed = i == 0;
    }
    scene
}

/// Length of a hanging chain of `count` rings, from the first centre to the last: inside each ring two tubes touch.
pub fn length(count: usize) -> f64 {
    (count - 1) as f64 * 2.0 * (RING_LINE - super::RING_TUBE)
}

/// The linking number of the centre lines of two rings, each given by its centre and rotation: the number of times that
/// the second passes through the disc of the first, with sign.
pub fn linking_number((from, a): (DVec3, DQuat), (center, b): (DVec3, DQuat)) -> i32 {
    let normal = a * DVec3::Z;
    // Height of the second line's points above the disc's plane: mean + x cos(t) + y sin(t).
    let mean = normal.dot(center - from);
    let [x, y] = [DVec3::X, DVec3::Y].map(|axis| RING_LINE * normal.dot(b * axis));
    let swing = x.hypot(y);
    if mean.abs() >= swing {
        return 0;
    }
    let (middle, half) = (y.atan2(x), (-mean / swing).acos());
    let passes = |t: f64| {
        let point = center + b * (RING_LINE * DVec3::new(t.cos(), t.sin(), 0.0));
        i32::from(point.distance(from) < RING_LINE)
    };
    // The line is above the plane between the two crossings.
    passes(middle - half) - passes(middle + half)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_linking_number_tells_links_from_neighbours() {
        let rotations: Vec<DQuat> = chain(3, 0.74).bodies.iter().map(|b| b.rotation.as_dquat()).collect();
        let ring = |i: usize, y: f64| (DVec3::Y * y, rotations[i]);
        assert_eq!(linking_number(ring(0, 0.0), ring(1, -0.74)).abs(), 1);
        assert_eq!(linking_number(ring(1, -0.74), ring(2, -1.48)).abs(), 1);
        assert_eq!(linking_number(ring(0, 0.0), ring(2, -1.48)), 0);
        let below = -2.0 * (RING_LINE + 0.01);
        assert_eq!(linking_number(ring(0, 0.0), ring(1, below)), 0, "just out of it");
    }
}
