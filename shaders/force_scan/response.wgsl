#define_import_path faceoff::response

// The impulse of one contact. The twin of `src/force_scan/impulse.rs`.

#import faceoff::constants::force_scan::{RESTITUTION_STEPS, PUSH}
#import faceoff::math::{conjugate, rotate}
#import faceoff::types as t

// Velocity of the point at `anchor` from a body's centre of mass at the end of the step, without contacts.
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

// Closing speed below which there is no restitution. Otherwise a body at rest would bounce with the speed that gravity
// adds within a step.
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

// The speed at which a body should leave a plane that it reaches with `speed`.
fn target_speed(step: t::Step, body: t::Body, plane: t::Plane, depth: f32, speed: f32) -> f32 {
    var rebound = 0.0;
    if -speed > restitution_threshold(step) {
        rebound = 0.5 * (body.restitution + plane.restitution) * -speed;
    }
    return max(rebound, min(PUSH.x * depth / step.dt, PUSH.y));
}

// Whether a body and a plane are solid and the body leaves the plane more slowly than it should.
fn plane_pushes(step: t::Step, body: t::Body, plane: t::Plane, contact: t::PlaneContact) -> bool {
    if !(contact.depth > 0.0) || (body.flags & t::SENSOR) != 0u || plane.sensor != 0u {
        return false;
    }
    let speed = dot(velocity(step, body, contact.anchor), plane.normal);
    return speed < target_speed(step, body, plane, contact.depth, speed);
}
