//! ForceScan: one impulse per contact, one entry per body and contact, sorted by body, summed by a segmented scan.
//!
//! For now a contact answers with a single impulse along its normal that turns the closing speed round by the mean
//! restitution. All contacts are answered at once from the same velocities, so a body in `n` contacts counts as `n`
//! bodies of `1/n` its mass, one for each contact (mass splitting): their mean velocity is the body's new one, and
//! kinetic energy cannot grow.

pub mod cpu;

use super::state::{Bodies, Contacts, Impulse, Plane, PlaneContact, StepConfig, TouchingPair};
use crate::components::RigidBody;
use glam::Vec3;

/// How fast a plane pushes a body out: share of the depth per step, and the largest speed in m/s.
const PUSH: (f32, f32) = (0.2, 1.0);

/// Contacts per body that push.
fn count_contacts(bodies: &Bodies, contacts: &Contacts, counts: &mut Vec<u32>) {
    counts.clear();
    counts.resize(bodies.len(), 0);
    for pair in &contacts.pairs {
        if pushes(bodies, pair) {
            for body in pair.bodies {
                counts[body as usize] += 1;
            }
        }
    }
    for contact in &contacts.planes {
        if !bodies.sensor[contact.body as usize] {
            counts[contact.body as usize] += 1;
        }
    }
}

fn pushes(bodies: &Bodies, pair: &TouchingPair) -> bool {
    pair.bodies.iter().all(|&i| !bodies.sensor[i as usize])
}

/// Velocity at the end of the step if nothing is touched.
fn free_velocity(bodies: &Bodies, config: &StepConfig, i: usize) -> Vec3 {
    let v = bodies.linear_velocity[i];
    match bodies.kind[i] {
        RigidBody::Dynamic => v + config.gravity * (bodies.gravity_scale[i] * config.dt),
        RigidBody::Kinematic => v,
        RigidBody::Static => Vec3::ZERO,
    }
}

/// Closing speeds below this do not bounce, or a body at rest would bounce off what gravity gave it within the step.
fn bounce_threshold(config: &StepConfig) -> f32 {
    2.0 * config.gravity.length() * config.dt
}

/// One end of a contact: velocity at the point along `n`, and how much a unit impulse along `n` changes it.
struct End {
    speed: f32,
    inverse_mass: f32,
    turn: Vec3,
}

impl End {
    fn new(bodies: &Bodies, config: &StepConfig, counts: &[u32], i: u32, point: Vec3, n: Vec3) -> Self {
        let i = i as usize;
        let arm = point - bodies.center[i];
        let spin = match bodies.kind[i] {
            RigidBody::Static => Vec3::ZERO,
            _ => bodies.angular_velocity[i],
        };
        let turn = bodies.inverse_inertia[i] * arm.cross(n);
        Self {
            speed: (free_velocity(bodies, config, i) + spin.cross(arm)).dot(n),
            inverse_mass: counts[i] as f32 * (bodies.inverse_mass[i] + turn.cross(arm).dot(n)),
            turn,
        }
    }
}

/// The changes of velocity of both bodies; zero if they part already.
fn pair_impulses(bodies: &Bodies, config: &StepConfig, counts: &[u32], pair: &TouchingPair) -> [Impulse; 2] {
    let (n, point) = (pair.contact.normal, pair.contact.point);
    let [a, b] = pair.bodies.map(|i| End::new(bodies, config, counts, i, point, n));
    let closing = a.speed - b.speed;
    let resistance = a.inverse_mass + b.inverse_mass;
    if !(closing > 0.0 && resistance > 0.0) {
        return [Impulse::default(); 2];
    }
    let [ia, ib] = pair.bodies.map(|i| i as usize);
    let restitution = if closing > bounce_threshold(config) {
        0.5 * (bodies.restitution[ia] + bodies.restitution[ib])
    } else {
        0.0
    };
    let size = (1.0 + restitution) * closing / resistance;
    let along = |i: usize, turn: Vec3, size: f32| Impulse {
        linear: n * (size * bodies.inverse_mass[i]),
        angular: turn * size,
    };
    [along(ia, a.turn, -size), along(ib, b.turn, size)]
}

/// The change of velocity of a body that reaches into a half-space.
fn plane_impulse(
    bodies: &Bodies,
    config: &StepConfig,
    counts: &[u32],
    plane: &Plane,
    contact: &PlaneContact,
) -> Impulse {
    let n = plane.normal;
    let end = End::new(bodies, config, counts, contact.body, contact.point, n);
    let i = contact.body as usize;
    let bounce = if -end.speed > bounce_threshold(config) {
        0.5 * (bodies.restitution[i] + plane.restitution) * -end.speed
    } else {
        0.0
    };
    let wanted = bounce.max((PUSH.0 * contact.depth / config.dt).min(PUSH.1));
    if !(end.speed < wanted && end.inverse_mass > 0.0) {
        return Impulse::default();
    }
    let size = (wanted - end.speed) / end.inverse_mass;
    Impulse {
        linear: n * (size * bodies.inverse_mass[i]),
        angular: end.turn * size,
    }
}
