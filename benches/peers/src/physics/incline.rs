//! What happens on a slope: Coulomb's law, and rolling.

use super::world::{Engine, Run};
use super::{Case, HZ, mean};
use bevy::math::{DVec3, Quat, Vec3};
use bevy_faceoff::testing::scenes::incline::slope;
use bevy_faceoff::testing::scenes::{Body, Scene, Shape, any_turn};
use std::f32::consts::FRAC_PI_2;

const GRAVITY: f64 = 9.81;
/// Friction coefficient of all bodies.
const FRICTION: f64 = 0.5;

/// Cubes that stick and slide, and balls that roll, `turns` at each angle.
pub fn cases(turns: usize) -> Vec<Case> {
    let angle = FRICTION.atan().to_degrees();
    let mut cases = vec![sticks(angle - 2.0, turns)];
    cases.extend([angle + 2.0, 35.0, 50.0].map(|degrees| slides(degrees, turns)));
    cases.extend([5.0, 10.0, 20.0].map(|degrees| rolls(degrees, turns)));
    cases
}

/// Cubes of edge 1 that lie on it, askew, `turns` of them on slopes of their own.
fn cubes(degrees: f64, turns: usize, gap: f32) -> Vec<Scene> {
    let mut random = fastrand::Rng::with_seed(10);
    let scene = |_| {
        let (mut scene, turn) = slope(degrees.to_radians());
        let [x, z] = std::array::from_fn(|_| 2.0 * random.f32() - 1.0);
        let at = turn * Vec3::new(x, 0.5 + gap * 3.0f32.sqrt(), z);
        let askew = Quat::from_rotation_y(FRAC_PI_2 * random.f32());
        scene.add(Body::new(Shape::Cube, at, turn * askew));
        scene
    };
    (0..turns).map(scene).collect()
}

/// The speed of the second body down the slope after so many steps.
fn speed(run: &Run, degrees: f64, step: usize) -> f64 {
    let angle = degrees.to_radians();
    let down = DVec3::new(angle.cos(), -angle.sin(), 0.0);
    run.states
        .get(step)
        .map_or(f64::NAN, |states| states[1].velocity.dot(down))
}

fn sticks(degrees: f64, turns: usize) -> Case {
    let judge = |runs: &[Run]| {
        let moved = |run: &Run| run.last()[1].center.distance(run.states[0][1].center);
        format!("{:.3} mm", 1e3 * runs.iter().map(moved).fold(0.0, f64::max))
    };
    Case {
        name: format!("cube on a slope of {degrees:.1} degrees, friction {FRICTION}, 10 s"),
        quantity: "creeps at most",
        steps: 10 * HZ,
        other: Some(Engine::Primitives),
        scenes: Box::new(move |gap| cubes(degrees, turns, gap)),
        judge: Box::new(judge),
    }
}

fn slides(degrees: f64, turns: usize) -> Case {
    let judge = move |runs: &[Run]| {
        let angle = degrees.to_radians();
        let wanted = GRAVITY * (angle.sin() - FRICTION * angle.cos());
        let found = |run: &Run| speed(run, degrees, 2 * HZ) - speed(run, degrees, HZ);
        errors(runs.iter().map(|run| found(run) / wanted - 1.0))
    };
    Case {
        name: format!("cube slides at {degrees:.1} degrees"),
        quantity: "error of the acceleration in the second s, mean (largest)",
        steps: 2 * HZ,
        other: Some(Engine::Primitives),
        scenes: Box::new(move |gap| cubes(degrees, turns, gap)),
        judge: Box::new(judge),
    }
}

/// Balls that should roll down without sliding, as they do up to the tangent 7/2 of friction's.
fn rolls(degrees: f64, turns: usize) -> Case {
    let scenes = move |gap: f32| {
        let mut random = fastrand::Rng::with_seed(9);
        let scene = |_| {
            let (mut scene, turn) = slope(degrees.to_radians());
            let at = turn * (Vec3::Y * (0.5 + gap));
            scene.add(Body::new(Shape::Ball, at, any_turn(&mut || random.f32())));
            scene
        };
        (0..turns).map(scene).collect()
    };
    let judge = move |runs: &[Run]| {
        let wanted = 2.0 * 5.0 / 7.0 * GRAVITY * degrees.to_radians().sin();
        errors(runs.iter().map(|run| speed(run, degrees, 2 * HZ) / wanted - 1.0))
    };
    Case {
        name: format!("ball rolls at {degrees} degrees"),
        quantity: "error of the acceleration over 2 s, mean (largest)",
        steps: 2 * HZ,
        other: Some(Engine::Primitives),
        scenes: Box::new(scenes),
        judge: Box::new(judge),
    }
}

/// The mean, and the one farthest from zero.
fn errors(all: impl Iterator<Item = f64> + Clone) -> String {
    let largest = all.clone().map(f64::abs).fold(0.0, f64::max);
    format!("{:+.3} % ({:.2} %)", 100.0 * mean(all), 100.0 * largest)
}
