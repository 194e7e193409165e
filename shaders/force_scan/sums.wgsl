// ForceScan: each collider sums the impulses of its entries, in their order, and of its planes, as changes of its
// body's velocity. One thread per collider.
#import faceoff::arena::meshes
#import faceoff::dispatch::group_index
#import faceoff::math::rotate
#import faceoff::response as r
#import faceoff::types as t

@group(0) @binding(2) var<uniform> step: t::Step;
@group(0) @binding(3) var<storage, read> bodies: array<t::Body>;
@group(0) @binding(4) var<storage, read> results: array<t::PairResult>;
@group(0) @binding(5) var<storage, read> values: array<u32>;
@group(0) @binding(6) var<storage, read> planes: array<t::Plane>;
@group(0) @binding(7) var<storage, read> plane_contacts: array<t::PlaneContact>;
@group(0) @binding(8) var<storage, read> body_contacts: array<t::BodyContacts>;
@group(0) @binding(9) var<storage, read_write> impulses: array<t::Impulse>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= step.bodies {
        return;
    }
    var sum: t::Impulse;
    let body = bodies[i];
    let contacts = body_contacts[i];
    if body.inverse_mass > 0.0 {
        for (var k = contacts.first_entry; k < contacts.last_entry; k += 1u) {
            let value = values[k];
            let part = of_pair(results[value / 2u], value % 2u == 0u);
            sum.linear += part.linear;
            sum.angular += part.angular;
        }
        for (var k = contacts.first_plane; k < contacts.first_plane + contacts.planes; k += 1u) {
            if k < step.plane_contact_capacity {
                let part = of_plane(body, plane_contacts[k], contacts.active_contacts);
                sum.linear += part.linear;
                sum.angular += part.angular;
            }
        }
    }
    impulses[i] = sum;
}

// From the centre of mass of a collider's body to a point at `anchor` from the collider's centre of mass.
fn body_anchor(collider: u32, anchor: vec3<f32>) -> vec3<f32> {
    let contacts = body_contacts[collider];
    return vec3(contacts.offset_x, contacts.offset_y, contacts.offset_z) + anchor;
}

// Change of velocity along n by a unit impulse at `anchor` from the body's centre of mass, if the body's mass is split
// among its contacts.
fn side_inverse_effective_mass(body: t::Body, active_contacts: u32, anchor: vec3<f32>, n: vec3<f32>) -> f32 {
    let spin = r::inverse_inertia(body, cross(anchor, n));
    return f32(active_contacts) * (body.inverse_mass + dot(cross(spin, anchor), n));
}

fn impulse(body: t::Body, anchor: vec3<f32>, n: vec3<f32>, size: f32) -> t::Impulse {
    return t::Impulse(n * (size * body.inverse_mass), 0.0, r::inverse_inertia(body, cross(anchor, n)) * size, 0.0);
}

// The change of velocity of one body of a pair.
fn of_pair(result: t::PairResult, first: bool) -> t::Impulse {
    let a = bodies[result.a];
    let b = bodies[result.b];
    let n = result.normal;
    let center_a = rotate(a.rotation, a.scale * meshes[a.mesh].center);
    let center_b = rotate(b.rotation, b.scale * meshes[b.mesh].center);
    let anchor_a = result.point;
    let anchor_b = result.point - ((b.position - a.position) + (center_b - center_a));
    let closing = dot(r::velocity(step, a, anchor_a) - r::velocity(step, b, anchor_b), n);
    let arm_a = body_anchor(result.a, anchor_a);
    let arm_b = body_anchor(result.b, anchor_b);
    let inverse_effective_mass = side_inverse_effective_mass(a, body_contacts[result.a].active_contacts, arm_a, n)
        + side_inverse_effective_mass(b, body_contacts[result.b].active_contacts, arm_b, n);
    var none: t::Impulse;
    if !(closing > 0.0 && inverse_effective_mass > 0.0) {
        return none;
    }
    var restitution = 0.0;
    if closing > r::restitution_threshold(step) {
        restitution = 0.5 * (a.restitution + b.restitution);
    }
    let size = (1.0 + restitution) * closing / inverse_effective_mass;
    if first {
        return impulse(a, arm_a, n, -size);
    }
    return impulse(b, arm_b, n, size);
}

// The change of velocity of a body that penetrates a half-space.
fn of_plane(body: t::Body, contact: t::PlaneContact, active_contacts: u32) -> t::Impulse {
    let plane = planes[contact.plane];
    var none: t::Impulse;
    if !r::plane_pushes(step, body, plane, contact) {
        return none;
    }
    let speed = dot(r::velocity(step, body, contact.anchor), plane.normal);
    let arm = body_anchor(contact.body, contact.anchor);
    let inverse_effective_mass = side_inverse_effective_mass(body, active_contacts, arm, plane.normal);
    if !(inverse_effective_mass > 0.0) {
        return none;
    }
    let size = (r::target_speed(step, body, plane, contact.depth, speed) - speed) / inverse_effective_mass;
    return impulse(body, arm, plane.normal, size);
}
