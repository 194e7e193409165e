//! Impacts of balls of 5,120 faces: outgoing speeds by Newton's law, averaged over the rotations of the balls.

use crate::world::World;
use bevy_faceoff::testing::scenes::flight;
use bevy_faceoff::types::solver_settings::SolverSettings;
use glam::{DVec3, Vec3};

const RADIUS: f32 = 0.5;

/// Speeds along a normal and tangential to it, in the plane of motion. Deviations out of the plane, by facets, cancel
/// on average.
fn split(velocity: DVec3, normal: DVec3) -> [f64; 2] {
    [normal, DVec3::Z.cross(normal)].map(|direction| velocity.dot(direction))
}

/// Checks the mean of the `outgoing` normal and tangential speeds, with a tolerance of 3 % of the incoming speed.
fn check(name: &str, restitution: f32, incoming: [f64; 2], outgoing: &[[f64; 2]]) {
    let mean = [0, 1].map(|k| outgoing.iter().map(|speeds| speeds[k]).sum::<f64>() / outgoing.len() as f64);
    let wanted = [-f64::from(restitution) * incoming[0], incoming[1]];
    let error = [0, 1].map(|k| (mean[k] - wanted[k]) / incoming[0].hypot(incoming[1]));
    println!(
        "{name}, restitution {restitution}: {:.4} and {:.4} m/s along the normal and tangential, off by {:+.2} % and \
         {:+.2} % of the incoming speed",
        mean[0],
        mean[1],
        100.0 * error[0],
        100.0 * error[1]
    );
    assert!(error.iter().all(|e| e.abs() < 0.03), "{name} {restitution}: {error:?}");
}

#[test]
fn balls_leave_each_other_by_their_restitution() {
    let mut random = fastrand::Rng::with_seed(7);
    for restitution in [0.0, 0.5, 1.0] {
        for sideways in [0.0, 0.3, 0.5, 0.7] {
            ball_on_ball(restitution, sideways, 12, &mut random);
        }
    }
}

/// A ball that hits another, `sideways` off the line of centres, with `turns` random rotations.
pub fn ball_on_ball(restitution: f32, sideways: f32, turns: usize, random: &mut fastrand::Rng) {
    let gap = SolverSettings::default().rest_offset * 2.0 * RADIUS;
    let speeds = [Vec3::X * 2.0, Vec3::X * -1.0];
    // Positions at the moment of contact, a rest offset apart.
    let reach = f64::from(2.0 * RADIUS + gap);
    let side = f64::from(sideways);
    let normal = DVec3::new((reach * reach - side * side).sqrt(), side, 0.0) / reach;
    let incoming = split((speeds[1] - speeds[0]).as_dvec3(), normal);
    let outgoing: Vec<[f64; 2]> = (0..turns)
        .map(|_| {
            let mut world = World::of(&flight::ball_on_ball(speeds, sideways, restitution, &mut || {
                random.f32()
            }));
            world.seconds(1);
            split((world.velocity(1) - world.velocity(0)).as_dvec3(), normal)
        })
        .collect();
    let name = format!("ball on ball, {sideways} m off");
    check(&name, restitution, incoming, &outgoing);
}

#[test]
fn balls_leave_a_wall_by_their_restitution() {
    let mut random = fastrand::Rng::with_seed(8);
    for restitution in [0.0, 0.5, 1.0] {
        for angle in [0.0, 30.0, 60.0] {
            ball_on_wall(restitution, angle, 12, &mut random);
        }
    }
}

/// A ball that hits a wall at `angle` degrees from its normal, with `turns` random rotations.
pub fn ball_on_wall(restitution: f32, angle: f32, turns: usize, random: &mut fastrand::Rng) {
    let velocity = 3.0 * Vec3::new(angle.to_radians().sin(), -angle.to_radians().cos(), 0.0);
    let outgoing: Vec<[f64; 2]> = (0..turns)
        .map(|_| {
            let mut world = World::of(&flight::ball_on_wall(velocity, restitution, &mut || random.f32()));
            world.seconds(1);
            split(world.velocity(0).as_dvec3(), DVec3::Y)
        })
        .collect();
    let incoming = split(velocity.as_dvec3(), DVec3::Y);
    check(
        &format!("ball on wall, {angle} degrees"),
        restitution,
        incoming,
        &outgoing,
    );
}
