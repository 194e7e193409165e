// Contact generation, before inactive pairs get their points: anchors on colliders of compounds are measured from the
// compound's centre of mass. One thread per slot.
#import faceoff::dispatch::group_index
#import faceoff::types as t

@group(0) @binding(0) var<uniform> limits: t::ContactLimits;
@group(0) @binding(1) var<storage, read> contact_counters: array<u32>;
@group(0) @binding(2) var<storage, read> body_contacts: array<t::BodyContacts>;
@group(0) @binding(3) var<storage, read> slots: array<t::ContactPair>;
@group(0) @binding(4) var<storage, read_write> staged: array<t::ContactPoint>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= contact_counters[t::CONTACT_SLOTS] {
        return;
    }
    let slot = slots[i];
    let offset_a = offset_of(slot.a);
    var offset_b = vec3(0.0);
    if slot.b < limits.bodies {
        offset_b = offset_of(slot.b);
    }
    for (var k = slot.first_point; k < slot.first_point + slot.point_count; k += 1u) {
        staged[k].anchor_a += offset_a;
        staged[k].anchor_b += offset_b;
    }
}

// From the centre of mass of the body to the collider's, in world axes.
fn offset_of(collider: u32) -> vec3<f32> {
    let contacts = body_contacts[collider];
    return vec3(contacts.offset_x, contacts.offset_y, contacts.offset_z);
}
