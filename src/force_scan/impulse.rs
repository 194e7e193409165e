//! The impulse of one contact, for [`Response::Impulse`](crate::types::settings::Response::Impulse).

use crate::state::{Bodies, Contacts, Impulse, PairContact, Plane, PlaneContact, StepConfig};
use crate::types::body::RigidBody;
use glam::Vec3;

/// How fast a plane pushes a body out: fraction of the depth per step, and largest speed in m/s.
pub(super) const PUSH: [f32; 2] = [0.2, 1.0];

/// The speed that gravity adds in this many steps is the largest without restitution.
pub(super) const RESTITUTION_STEPS: f32 = 2.0;

/// Counts for each body the contacts that apply an impulse in this step. Contacts that already separate do not count,
/// so they take no part of the body's mass.
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
            for i in pair.bodies {
                counts[bodies.body_of(i) as usize] += 1;
            }
        }
    }
    for contact in &contacts.planes {
        if plane_pushes(bodies, config, &planes[contact.plane as usize], contact) {
            counts[bodies.body_of(contact.body) as usize] += 1;
        }
    }
}

/// Whether both bodies of a pair are solid and approach each other.
pub(super) fn pair_closes(bodies: &Bodies, config: &StepConfig, pair: &PairContact) -> bool {
    let (n, point) = (pair.contact.normal, pair.contact.point);
    let [a, b] = pair.bodies.map(|i| speed(bodies, config, i, point, n));
    a > b && pair.bodies.iter().all(|&i| !bodies.sensor[i as usize])
}

/// Whether a body and a plane are solid and the body leaves the plane more slowly than it should.
pub(super) fn plane_pushes(bodies: &Bodies, config: &StepConfig, plane: &Plane, contact: &PlaneContact) -> bool {
    let speed = speed(bodies, config, contact.body, contact.point, plane.normal);
    let is_solid = !plane.sensor && !bodies.sensor[contact.body as usize];
    is_solid && speed < target_speed(bodies, config, plane, contact, speed)
}

/// Velocity of a point of a body along `n` at the end of the step, without contacts.
fn speed(bodies: &Bodies, config: &StepConfig, i: u32, point: Vec3, n: Vec3) -> f32 {
    let i = i as usize;
    let spin = match bodies.kind[i] {
        RigidBody::Static => Vec3::ZERO,
        _ => bodies.angular_velocity[i],
    };
    (free_velocity(bodies, config, i) + spin.cross(point - bodies.center[i])).dot(n)
}

/// The speed at which a body should leave a plane that it reaches with `speed`.
fn target_speed(bodies: &Bodies, config: &StepConfig, plane: &Plane, contact: &PlaneContact, speed: f32) -> f32 {
    let rebound = if -speed > restitution_threshold(config) {
        0.5 * (bodies.restitution[contact.body as usize] + plane.restitution) * -speed
    } else {
        0.0
    };
    rebound.max((PUSH[0] * contact.depth / config.dt).min(PUSH[1]))
}

/// Velocity at the end of the step without contacts.
fn free_velocity(bodies: &Bodies, config: &StepConfig, i: usize) -> Vec3 {
    let v = bodies.linear_velocity[i];
    match bodies.kind[i] {
        RigidBody::Dynamic => v + config.gravity * (bodies.gravity_scale[i] * config.dt),
        RigidBody::Kinematic => v,
        RigidBody::Static => Vec3::ZERO,
    }
}

/// Closing speed below which there is no restitution, m/s. Otherwise a body at rest would bounce with the speed that
/// gravity adds within a step.
fn restitution_threshold(config: &StepConfig) -> f32 {
    RESTITUTION_STEPS * config.gravity.length() * config.dt
}

/// One body of a contact, along the direction `n`.
struct BodyResponse {
    /// Velocity of the contact point.
    speed: f32,
    /// Change of that velocity by a unit impulse.
    inverse_effective_mass: f32,
    /// Change of the angular velocity by a unit impulse.
    angular_response: Vec3,
}

impl BodyResponse {
    fn new(bodies: &Bodies, config: &StepConfig, counts: &[u32], i: u32, point: Vec3, n: Vec3) -> Self {
        let speed = speed(bodies, config, i, point, n);
        let i = i as usize;
        let anchor = point - bodies.frame[i].body_center.as_vec3();
        let angular_response = bodies.inverse_inertia[i] * anchor.cross(n);
        Self {
            speed,
            inverse_effective_mass: counts[bodies.body_of(i as u32) as usize] as f32
                * (bodies.inverse_mass[i] + angular_response.cross(anchor).dot(n)),
            angular_response,
        }
    }
}

/// The changes of velocity of both bodies; zero if they already separate.
pub(super) fn pair_impulses(bodies: &Bodies, config: &StepConfig, counts: &[u32], pair: &PairContact) -> [Impulse; 2] {
    let (n, point) = (pair.contact.normal, pair.contact.point);
    let [a, b] = pair
        .bodies
        .map(|i| BodyResponse::new(bodies, config, counts, i, point, n));
    let closing = a.speed - b.speed;
    let inverse_effective_mass = a.inverse_effective_mass + b.inverse_effective_mass;
    if !(closing > 0.0 && inverse_effective_mass > 0.0) {
        return [Impulse::default(); 2];
    }
    let [ia, ib] = pair.bodies.map(|i| i as usize);
    let restitution = if closing > restitution_threshold(config) {
        0.5 * (bodies.restitution[ia] + bodies.restitution[ib])
    } else {
        0.0
    };
    let impulse = (1.0 + restitution) * closing / inverse_effective_mass;
    let change = |i: usize, angular_response: Vec3, impulse: f32| Impulse {
        linear: n * (impulse * bodies.inverse_mass[i]),
        angular: angular_response * impulse,
    };
    [
        change(ia, a.angular_response, -impulse),
        change(ib, b.angular_response, impulse),
    ]
}

/// The change of velocity of a body that penetrates a plane.
pub(super) fn plane_impulse(
    bodies: &Bodies,
    config: &StepConfig,
    counts: &[u32],
    plane: &Plane,
    contact: &PlaneContact,
) -> Impulse {
    let n = plane.normal;
    let response = BodyResponse::new(bodies, config, counts, contact.body, contact.point, n);
    let i = contact.body as usize;
    let target = target_speed(bodies, config, plane, contact, response.speed);
    if !(response.speed < target && response.inverse_effective_mass > 0.0) {
        return Impulse::default();
    }
    let impulse = (target - response.speed) / response.inverse_effective_mass;
    Impulse {
        linear: n * (impulse * bodies.inverse_mass[i]),
        angular: response.angular_response * impulse,
    }
}
