// Contact generation: the counts of pairs and points per slot, for the scans that give their positions. One thread per
// slot.
#import faceoff::dispatch::group_index
#import faceoff::types as t

@group(0) @binding(0) var<storage, read> contact_counters: array<u32>;
@group(0) @binding(1) var<storage, read> slots: array<t::ContactPair>;
@group(0) @binding(2) var<storage, read_write> pair_places: array<u32>;
@group(0) @binding(3) var<storage, read_write> point_places: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= contact_counters[t::CONTACT_SLOTS] {
        return;
    }
    pair_places[i] = u32(slots[i].point_count > 0u);
    point_places[i] = slots[i].point_count;
}
