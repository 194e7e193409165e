//! Impacts of balls: outgoing speeds by Newton's law, averaged over how the balls are turned.

use super::world::{Engine, Run};
use super::{Case, HZ};
use bevy::math::{DVec3, Vec3};
use bevy_faceoff::testing::scenes::flight;

const RADIUS: f64 = 0.5;

/// Balls on a wall and on each other, each `turns` times.
pub fn cases(turns: usize) -> Vec<Case> {
    let mut cases = Vec::new();
    for restitution in [0.0, 0.5, 1.0] {
        for degrees in [0.0, 30.0, 60.0] {
            cases.push(on_wall(restitution, degrees, turns));
        }
    }
    for restitution in [0.0, 0.5, 1.0] {
        for sideways in [0.0, 0.5] {
            cases.push(on_ball(restitution, sideways, turns));
        }
    }
    cases
}

const QUANTITY: &str = "error of the outgoing velocity, of the incoming speed: of the mean (of the worst)";

/// A ball that flies at a wall, so many degrees off its normal.
fn on_wall(restitution: f32, degrees: f32, turns: usize) -> Case {
    let angle = degrees.to_radians();
    let velocity = 3.0 * Vec3::new(angle.sin(), -angle.cos(), 0.0);
    let scenes = move |_| {
        let mut random = fastrand::Rng::with_seed(8);
        let scene = |_| flight::ball_on_wall(velocity, restitution, &mut || random.f32());
        (0..turns).map(scene).collect()
    };
    let judge = move |runs: &[Run]| {
        let found = runs.iter().map(|run| run.last()[0].velocity);
        error(found, velocity.as_dvec3(), DVec3::Y, restitution)
    };
    Case {
        name: format!("ball on wall at {degrees} degrees, restitution {restitution}"),
        quantity: QUANTITY,
        steps: HZ,
        other: Some(Engine::Primitives),
        scenes: Box::new(scenes),
        judge: Box::new(judge),
    }
}

/// Two balls that fly at each other, so many metres off the line of their centres.
fn on_ball(restitution: f32, sideways: f32, turns: usize) -> Case {
    let speeds = [Vec3::X * 2.0, Vec3::X * -1.0];
    let scenes = move |_| {
        let mut random = fastrand::Rng::with_seed(7);
        let scene = |_| flight::ball_on_ball(speeds, sideways, restitution, &mut || random.f32());
        (0..turns).map(scene).collect()
    };
    let judge = move |runs: &[Run]| {
        // From the first centre to the second when true balls touch.
        let side = f64::from(sideways);
        let normal = DVec3::new((4.0 * RADIUS * RADIUS - side * side).sqrt(), side, 0.0) / (2.0 * RADIUS);
        let incoming = (speeds[1] - speeds[0]).as_dvec3();
        let found = runs.iter().map(|run| run.last()[1].velocity - run.last()[0].velocity);
        error(found, incoming, normal, restitution)
    };
    Case {
        name: format!("ball on ball, {sideways} m off centre, restitution {restitution}"),
        quantity: QUANTITY,
        steps: HZ,
        other: Some(Engine::Primitives),
        scenes: Box::new(scenes),
        judge: Box::new(judge),
    }
}

/// How far off are velocities that should be that of a mirror, but for the part that restitution takes.
fn error(found: impl ExactSizeIterator<Item = DVec3>, incoming: DVec3, normal: DVec3, restitution: f32) -> String {
    let wanted = incoming - (1.0 + f64::from(restitution)) * incoming.dot(normal) * normal;
    let count = found.len() as f64;
    let (mut mean, mut most) = (DVec3::ZERO, 0.0f64);
    for velocity in found {
        let off = (velocity - wanted) / incoming.length();
        mean += off / count;
        most = most.max(off.length());
    }
    format!("{:.2} % ({:.1} %)", 100.0 * mean.length(), 100.0 * most)
}
