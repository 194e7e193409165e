#define_import_path faceoff::response

// How contacts answer; `src/force_scan/mod.rs` explains it.

#import faceoff::constants::force_scan::{RESTITUTION_STEPS, PUSH}
#import faceoff::math::{conjugate, rotate}
#import faceoff::types as t

// Velocity of a body's point, `anchor` from its centre, at the end of the step if nothing is touched.
fn velocity(step: t::Step, body: t::Body, anchor: vec3<f32>) -> vec3<f32> {
    let kind = body.flags & t::KIND_MASK;
    if kind == t::STATIC {
        return vec3(0.0);
    }
    var v = body.linear_velocity + cross(body.angular_velocity, anchor);
    if kind == t::DYNAMIC {
        v += step.gravity * (body.gravity_scale * step.dt);
    }
    return v;
}

// Closing speeds below this do not bounce, or a body at rest would bounce off what gravity gave it within the step.
fn restitution_threshold(step: t::Step) -> f32 {
    return RESTITUTION_STEPS * sqrt(dot(step.gravity, step.gravity)) * step.dt;
}

// The inverse inertia in world axes, times v.
fn inverse_inertia(body: t::Body, v: vec3<f32>) -> vec3<f32> {
    let w = rotate(conjugate(body.rotation), v);
    let d = body.inverse_inertia;
    let m = body.inverse_inertia_off_diagonal; // xy, xz, yz
    let local = vec3(
        d.x * w.x + m.x * w.y + m.y * w.z,
        m.x * w.x + d.y * w.y + m.z * w.z,
        m.y * w.x + m.z * w.y + d.z * w.z,
    );
    return rotate(body.rotation, local);
}

// The speed at which a plane wants a body to leave that arrives with `speed`.
fn target_speed(step: t::Step, body: t::Body, plane: t::Plane, depth: f32, speed: f32) -> f32 {
    var rebound = 0.0;
    if -speed > restitution_threshold(step) {
        rebound = 0.5 * (body.restitution + plane.restitution) * -speed;
    }
    return max(rebound, min(PUSH.x * depth / step.dt, PUSH.y));
}

// Whether a body is solid and slower than a plane wants it to leave.
fn plane_pushes(step: t::Step, body: t::Body, plane: t::Plane, contact: t::PlaneContact) -> bool {
    if !(contact.depth > 0.0) || (body.flags & t::SENSOR) != 0u {
        return false;
    }
    let speed = dot(velocity(step, body, contact.anchor), plane.normal);
    return speed < target_speed(step, body, plane, contact.depth, speed);
}
