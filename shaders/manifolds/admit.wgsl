// Contact generation: drops features that disagree with a nearby patch. Of the overlapping features of a vertex only
// the shallowest stays: the face through which it entered. One workgroup per pair.
#import faceoff::agree::agree
#import faceoff::constants::manifolds::MIN_AGREEMENT
#import faceoff::dispatch::group_index
#import faceoff::types as t

@group(0) @binding(0) var<storage, read_write> contact_counters: array<atomic<u32>>;
@group(0) @binding(1) var<storage, read> pair_setups: array<t::PairSetup>;
@group(0) @binding(2) var<storage, read_write> features: array<t::Feature>;
@group(0) @binding(3) var<storage, read_write> patches: array<t::Patch>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let index = group_index(group);
    if index >= agree(thread, atomicLoad(&contact_counters[t::MARGIN_PAIRS])) {
        return;
    }
    let setup = pair_setups[index];
    if setup.valid == 0u || setup.patch_count == 0u {
        return;
    }
    for (var i = thread; i < setup.feature_count; i += 64u) {
        let at = setup.first_feature + i;
        for (var k = 0u; k < setup.patch_count; k += 1u) {
            let patch_near = patches[setup.first_segment / 2u + k];
            if is_near(patch_near, features[at]) && dot(features[at].normal, patch_near.normal) < MIN_AGREEMENT {
                features[at].separation = t::DROPPED;
            }
        }
    }
    // Dropped features are only marked in `distance` at first, because other threads still compare with them.
    var deep_index = thread;
    while deep_index < setup.deep_count {
        let at = setup.first_deep + deep_index;
        features[at].distance = select(0.0, t::DROPPED, has_shallower(setup, at));
        deep_index += 64u;
    }
    storageBarrier();
    workgroupBarrier();
    for (var i = thread; i < setup.deep_count; i += 64u) {
        let at = setup.first_deep + i;
        if features[at].distance == t::DROPPED {
            features[at].separation = t::DROPPED;
        }
    }
    storageBarrier();
    workgroupBarrier();
    var patch_index = thread;
    while patch_index < setup.patch_count {
        let at = setup.first_segment / 2u + patch_index;
        patch_index += 64u;
        let patch_near = patches[at];
        for (var i = setup.first_deep; i < setup.first_deep + setup.deep_count; i += 1u) {
            if features[i].separation != t::DROPPED && is_near(patch_near, features[i]) {
                patches[at].kept = 1u;
                break;
            }
        }
    }
    // Some devices abort long loops.
    if deep_index < setup.deep_count || patch_index < setup.patch_count {
        atomicOr(&contact_counters[t::CONTACTS_CUT_SHORT], 1u);
    }
}

fn is_near(patch_near: t::Patch, feature: t::Feature) -> bool {
    let offset = 0.5 * (feature.point_a + feature.point_b) - patch_near.center;
    return dot(offset, offset) < patch_near.reach * patch_near.reach;
}

// Whether the vertex of an overlapping feature has a shallower one.
fn has_shallower(setup: t::PairSetup, at: u32) -> bool {
    let own = features[at].vertex;
    if own == t::NOTHING {
        return false;
    }
    let depth = features[at].separation;
    for (var i = setup.first_deep; i < setup.first_deep + setup.deep_count; i += 1u) {
        if features[i].vertex == own && i != at {
            let other = features[i].separation;
            if other > depth || (other == depth && i < at) {
                return true;
            }
        }
    }
    return false;
}
