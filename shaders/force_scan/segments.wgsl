// ForceScan: the range of each body among the sorted entries.
#import faceoff::dispatch::group_index
#import faceoff::types as t

@group(0) @binding(0) var<uniform> step: t::Step;
@group(0) @binding(1) var<storage, read> counters: array<u32>;
@group(0) @binding(2) var<storage, read> keys: array<u32>;
@group(0) @binding(3) var<storage, read_write> body_contacts: array<t::BodyContacts>;

// One thread per entry. There are two entries per pair, so a dispatch with a workgroup per 64 pairs covers all.
@compute @workgroup_size(128)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 128u + thread;
    let length = counters[t::ENTRIES];
    if i >= length {
        return;
    }
    let key = keys[i];
    if key >= step.bodies {
        return;
    }
    if i == 0u || keys[i - 1u] != key {
        body_contacts[key].first_entry = i;
    }
    if i + 1u == length || keys[i + 1u] != key {
        body_contacts[key].last_entry = i + 1u;
    }
}
