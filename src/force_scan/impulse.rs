//! How one contact answers with [`Response::Impulse`](crate::types::settings::Response::Impulse).

use crate::state::{Bodies, Contacts, Impulse, PairContact, Plane, PlaneContact, StepConfig};
use crate::types::body::RigidBody;
use glam::Vec3;

/// How fast a plane pushes a body out: share of the depth per step, and the largest speed in m/s.
pub(super) const PUSH: [f32; 2] = [0.2, 1.0];

/// What falls for so many steps does not bounce.
pub(super) const BOUNCE_STEPS: f32 = 2.0;

/// Contacts per body that push in this step. One that parts already takes no share of the mass.
pub(super) fn count_contacts(
    bodies: &Bodies,
    config: &StepConfig,
    planes: &[Plane],
    contacts: &Contacts,
    counts: &mut Vec<u32>,
) {
    counts.clear();
    counts.resize(bodies.len(), 0);
    for pair in &contacts.pairs {
        if pair_closes(bodies, config, pair) {
            for body in pair.bodies {
                counts[body as usize] += 1;
            }
        }
    }
    for contact in &contacts.planes {
        if plane_pushes(bodies, config, &planes[contact.plane as usize], contact) {
            counts[contact.body as usize] += 1;
        }
    }
}

/// Whether a pair's bodies are solid and closing in.
pub(super) fn pair_closes(bodies: &Bodies, config: &StepConfig, pair: &PairContact) -> bool {
    let (n, point) = (pair.contact.normal, pair.contact.point);
    let [a, b] = pair.bodies.map(|i| speed(bodies, config, i, point, n));
    a > b && pair.bodies.iter().all(|&i| !bodies.sensor[i as usize])
}

/// Whether a body is solid and slower than a plane wants it to leave.
pub(super) fn plane_pushes(bodies: &Bodies, config: &StepConfig, plane: &Plane, contact: &PlaneContact) -> bool {
    let speed = speed(bodies, config, contact.body, contact.point, plane.normal);
    speed < wanted_speed(bodies, config, plane, contact, speed) && !bodies.sensor[contact.body as usize]
}

/// Velocity of a body's point along `n` at the end of the step if nothing is touched.
fn speed(bodies: &Bodies, config: &StepConfig, i: u32, point: Vec3, n: Vec3) -> f32 {
    let i = i as usize;
    let spin = match bodies.kind[i] {
        RigidBody::Static => Vec3::ZERO,
        _ => bodies.angular_velocity[i],
    };
    (free_velocity(bodies, config, i) + spin.cross(point - bodies.center[i])).dot(n)
}

/// The speed at which a plane wants a body to leave that arrives with `speed`.
fn wanted_speed(bodies: &Bodies, config: &StepConfig, plane: &Plane, contact: &PlaneContact, speed: f32) -> f32 {
    let bounce = if -speed > bounce_threshold(config) {
        0.5 * (bodies.restitution[contact.body as usize] + plane.restitution) * -speed
    } else {
        0.0
    };
    bounce.max((PUSH[0] * contact.depth / config.dt).min(PUSH[1]))
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
    BOUNCE_STEPS * config.gravity.length() * config.dt
}

/// One end of a contact: velocity at the point along `n`, and how much a unit impulse along `n` changes it.
struct End {
    speed: f32,
    inverse_mass: f32,
    turn: Vec3,
}

impl End {
    fn new(bodies: &Bodies, config: &StepConfig, counts: &[u32], i: u32, point: Vec3, n: Vec3) -> Self {
        let speed = speed(bodies, config, i, point, n);
        let i = i as usize;
        let arm = point - bodies.center[i];
        let turn = bodies.inverse_inertia[i] * arm.cross(n);
        Self {
            speed,
            inverse_mass: counts[i] as f32 * (bodies.inverse_mass[i] + turn.cross(arm).dot(n)),
            turn,
        }
    }
}

/// The changes of velocity of both bodies; zero if they part already.
pub(super) fn pair_impulses(bodies: &Bodies, config: &StepConfig, counts: &[u32], pair: &PairContact) -> [Impulse; 2] {
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
pub(super) fn plane_impulse(
    bodies: &Bodies,
    config: &StepConfig,
    counts: &[u32],
    plane: &Plane,
    contact: &PlaneContact,
) -> Impulse {
    let n = plane.normal;
    let end = End::new(bodies, config, counts, contact.body, contact.point, n);
    let i = contact.body as usize;
    let wanted = wanted_speed(bodies, config, plane, contact, end.speed);
    if !(end.speed < wanted && end.inverse_mass > 0.0) {
        return Impulse::default();
    }
    let size = (wanted - end.speed) / end.inverse_mass;
    Impulse {
        linear: n * (size * bodies.inverse_mass[i]),
        angular: end.turn * size,
    }
}
