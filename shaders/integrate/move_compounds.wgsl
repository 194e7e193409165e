// Integrate: the same for compounds and their colliders. One thread per compound.
#import faceoff::compound::{CompoundMotion, placed_part}
#import faceoff::dispatch::group_index
#import faceoff::math::{compose, pushed, rotate, rotation_by}
#import faceoff::types as t

@group(0) @binding(0) var<uniform> step: t::Step;
@group(0) @binding(1) var<storage, read> counters: array<u32>;
@group(0) @binding(2) var<storage, read> impulses: array<t::Impulse>;
@group(0) @binding(3) var<storage, read> compounds: array<t::Compound>;
@group(0) @binding(4) var<storage, read> parts: array<t::CompoundPart>;
@group(0) @binding(5) var<storage, read> bodies: array<t::Body>;
@group(0) @binding(6) var<storage, read_write> moved: array<t::Moved>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let number = group_index(group) * 64u + thread;
    if number >= step.compounds || counters[t::SKIPPED] != 0u {
        return;
    }
    let compound = compounds[number];
    let first = compound.first_part;
    let end = first + compound.part_count;
    var v = compound.linear_velocity;
    var w = compound.angular_velocity;
    let body = bodies[compound.collider];
    if (body.flags & t::KIND_MASK) == t::DYNAMIC {
        var push: t::Impulse;
        // Without response nobody sums impulses.
        for (var k = first; k < end && step.response != 0u; k += 1u) {
            push.linear += impulses[parts[k].collider].linear;
            push.angular += impulses[parts[k].collider].angular;
        }
        v = pushed(v, step.gravity * (body.gravity_scale * step.dt) + push.linear);
        w = pushed(w, push.angular);
    }
    // The centre of mass moves along a line, and the origin rotates about it.
    let before = rotate(compound.rotation, compound.center);
    var position = compound.position + v * step.dt;
    var rotation = compound.rotation;
    var center = before;
    if any(w != vec3(0.0)) {
        let next = compose(rotation_by(w * step.dt), rotation);
        rotation = next / sqrt(dot(next, next));
        center = rotate(rotation, compound.center);
        position += before - center;
    }
    let motion = CompoundMotion(position, center, rotation, v, w);
    for (var k = first; k < end; k += 1u) {
        let i = parts[k].collider;
        let part = placed_part(bodies[i], parts[k], motion);
        moved[i] = t::Moved(part.position, 0u, part.rotation, part.linear_velocity, 0u, w, 0u);
    }
    moved[step.bodies + number] = t::Moved(position, 0u, rotation, v, 0u, w, 0u);
}
