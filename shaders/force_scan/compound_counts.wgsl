// ForceScan: the colliders of a compound share its mass, so each gets the number of contacts of all of them. One thread
// per compound.
#import faceoff::dispatch::group_index
#import faceoff::types as t

@group(0) @binding(0) var<uniform> step: t::Step;
@group(0) @binding(1) var<storage, read> compounds: array<t::Compound>;
@group(0) @binding(2) var<storage, read> parts: array<t::CompoundPart>;
@group(0) @binding(3) var<storage, read_write> body_contacts: array<t::BodyContacts>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let number = group_index(group) * 64u + thread;
    if number >= step.compounds {
        return;
    }
    let first = compounds[number].first_part;
    let end = first + compounds[number].part_count;
    var all = 0u;
    for (var k = first; k < end; k += 1u) {
        all += body_contacts[parts[k].collider].active_contacts;
    }
    for (var k = first; k < end; k += 1u) {
        body_contacts[parts[k].collider].active_contacts = all;
    }
}
