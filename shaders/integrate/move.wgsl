// Integrate: semi-implicit Euler. If a list was too short nothing moves, and the host repeats the step. Compounds
// follow. One thread per collider.
#import faceoff::arena::meshes
#import faceoff::dispatch::group_index
#import faceoff::math::{compose, pushed, rotate, rotation_by}
#import faceoff::types as t

@group(0) @binding(2) var<uniform> step: t::Step;
@group(0) @binding(3) var<storage, read_write> status: array<u32>;
@group(0) @binding(4) var<storage, read_write> counters: array<u32>;
@group(0) @binding(5) var<storage, read> impulses: array<t::Impulse>;
@group(0) @binding(6) var<storage, read> bodies: array<t::Body>;
@group(0) @binding(7) var<storage, read_write> moved: array<t::Moved>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    let lacking = counters[t::HITS] > step.hit_limit
        || counters[t::PLANE_CONTACTS] > step.plane_contact_capacity
        || counters[t::PIECES] > step.piece_capacity;
    if lacking && i == 0u {
        status[t::OVERFLOW] = 1u;
        counters[t::SKIPPED] = 1u;
    }
    if i >= step.bodies || lacking || counters[t::SKIPPED] != 0u {
        return;
    }
    let body = bodies[i];
    if (body.flags & t::PART) != 0u {
        return;
    }
    let kind = body.flags & t::KIND_MASK;
    var v = body.linear_velocity;
    var w = body.angular_velocity;
    var position = body.position;
    var rotation = body.rotation;
    if kind == t::DYNAMIC {
        var push: t::Impulse;
        // Without response nobody sums impulses.
        if step.response != 0u {
            push = impulses[i];
        }
        v = pushed(v, step.gravity * (body.gravity_scale * step.dt) + push.linear);
        w = pushed(w, push.angular);
    }
    if kind != t::STATIC {
        // The centre of mass moves along a line, and the mesh's origin rotates about it.
        let anchor = body.scale * meshes[body.mesh].center;
        position += v * step.dt;
        if any(w != vec3(0.0)) {
            let next = compose(rotation_by(w * step.dt), rotation);
            let before = rotate(rotation, anchor);
            rotation = next / sqrt(dot(next, next));
            position += before - rotate(rotation, anchor);
        }
    }
    moved[i] = t::Moved(position, 0u, rotation, v, 0u, w, 0u);
}
