//! Free rotation of a body with three different moments of inertia.

use super::motion::{Motion, inertia};
use crate::world::World;
use bevy_faceoff::testing::scenes::flight::squeezed_knot;
use glam::{DMat3, DVec3, Vec3};

/// A knot that rotates with `spin` in its own axes.
fn knot(spin: Vec3) -> (World, usize) {
    (World::of(&squeezed_knot(spin)), 0)
}

/// Moments of inertia about the body's own axes. They are principal axes, because the squeezed knot is symmetric.
fn moments(world: &World, body: usize) -> DVec3 {
    let axes = world.state.input.bodies.frame[body].rotation;
    let own = axes.transpose() * inertia(world, body) * axes;
    let diagonal = own.to_cols_array();
    let moments = DVec3::new(diagonal[0], diagonal[4], diagonal[8]);
    let mixed = own - DMat3::from_diagonal(moments);
    println!("moments {moments}");
    assert!(
        mixed
            .to_cols_array()
            .iter()
            .all(|m| m.abs() < 0.02 * moments.min_element()),
        "{mixed}"
    );
    moments
}

#[test]
fn a_squeezed_knot_keeps_angular_momentum_and_energy_for_a_minute() {
    for spin in [
        Vec3::new(1.0, 2.0, 3.0),
        Vec3::new(6.0, 0.5, 6.0),
        Vec3::new(0.1, 12.0, 0.3),
    ] {
        keeps_turning(spin, 60);
    }
}

/// Checks angular momentum and energy of a knot that rotates with `spin`.
pub fn keeps_turning(spin: Vec3, seconds: usize) {
    let (mut world, body) = knot(spin);
    let moments = moments(&world, body);
    assert!(moments.max_element() > 1.2 * moments.min_element());
    let before = Motion::of(&world);
    let own = |motion: &Motion, world: &World| motion.angular - world.center(body).cross(motion.linear);
    let start = own(&before, &world);
    let (mut drift, mut low, mut high) = (0.0f64, f64::INFINITY, 0.0f64);
    for _ in 0..64 * seconds {
        world.step();
        let now = Motion::of(&world);
        drift = drift.max(own(&now, &world).distance(start) / start.length());
        low = low.min(now.kinetic / before.kinetic);
        high = high.max(now.kinetic / before.kinetic);
    }
    println!("{spin}: angular momentum drifts by {drift:.2e}, energy {low:.5} to {high:.5} of the start");
    assert!(drift < 1.0e-3, "{drift}");
    assert!(low > 0.995 && high < 1.005, "{low} {high}");
}

#[test]
fn a_knot_that_spins_about_its_middle_axis_flips() {
    let counts = axes().map(|axis| flips(axis, 60));
    println!("flips in a minute about the axes of the smallest, the middle and the largest moment: {counts:?}");
    assert!(counts[1] >= 4 && counts[0] == 0 && counts[2] == 0, "{counts:?}");
}

/// The body's axes, in ascending order of the moment of inertia.
pub fn axes() -> [usize; 3] {
    let (world, body) = knot(Vec3::ZERO);
    let moments = moments(&world, body).to_array();
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| moments[i].total_cmp(&moments[j]));
    order
}

/// How often the angular velocity about an axis of the body changes sign, in the body's axes.
pub fn flips(axis: usize, seconds: usize) -> usize {
    let (mut world, body) = knot(Vec3::AXES[axis] * 5.0 + Vec3::splat(0.02));
    let (mut flips, mut up) = (0, true);
    for _ in 0..64 * seconds {
        world.step();
        let bodies = &world.state.input.bodies;
        let spin = bodies.rotation[body].conjugate() * bodies.angular_velocity[body];
        if spin[axis].abs() > 2.5 && up != (spin[axis] > 0.0) {
            (flips, up) = (flips + 1, spin[axis] > 0.0);
        }
    }
    flips
}
