// Contact generation: which features count. Near a patch all must agree with it; and of the faces under which a vertex is,
// the one through which it came is meant. A workgroup a pair.
#import faceoff::constants::manifolds::AGREES
#import faceoff::dispatch::group_index
#import faceoff::types as t

@group(0) @binding(0) var<storage, read_write> contact_counters: array<atomic<u32>>;
@group(0) @binding(1) var<storage, read> settings: array<t::ContactSetting>;
@group(0) @binding(2) var<storage, read_write> features: array<t::Feature>;
@group(0) @binding(3) var<storage, read_write> patches: array<t::Patch>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let index = group_index(group);
    if index >= atomicLoad(&contact_counters[t::MARGIN_PAIRS]) {
        return;
    }
    let setting = settings[index];
    if setting.valid == 0u || setting.patch_count == 0u {
        return;
    }
    for (var i = thread; i < setting.feature_count; i += 64u) {
        let at = setting.first_feature + i;
        for (var k = 0u; k < setting.patch_count; k += 1u) {
            let spoken = patches[setting.first_segment + k];
            if is_near(spoken, features[at]) && dot(features[at].normal, spoken.normal) < AGREES {
                features[at].separation = t::DROPPED;
            }
        }
    }
    // What is dropped is only marked at first: `distance` says so, since others still compare.
    var compared = thread;
    while compared < setting.deep_count {
        let at = setting.first_deep + compared;
        features[at].distance = select(0.0, t::DROPPED, has_shallower(setting, at));
        compared += 64u;
    }
    storageBarrier();
    workgroupBarrier();
    for (var i = thread; i < setting.deep_count; i += 64u) {
        let at = setting.first_deep + i;
        if features[at].distance == t::DROPPED {
            features[at].separation = t::DROPPED;
        }
    }
    storageBarrier();
    workgroupBarrier();
    var asked = thread;
    while asked < setting.patch_count {
        let at = setting.first_segment + asked;
        asked += 64u;
        let spoken = patches[at];
        for (var i = setting.first_deep; i < setting.first_deep + setting.deep_count; i += 1u) {
            if features[i].separation != t::DROPPED && is_near(spoken, features[i]) {
                patches[at].kept = 1u;
                break;
            }
        }
    }
    // Some devices leave a loop that takes long.
    if compared < setting.deep_count || asked < setting.patch_count {
        atomicOr(&contact_counters[t::CONTACTS_CUT_SHORT], 1u);
    }
}

fn is_near(spoken: t::Patch, feature: t::Feature) -> bool {
    let way = 0.5 * (feature.point_a + feature.point_b) - spoken.center;
    return dot(way, way) < spoken.reach * spoken.reach;
}

// Whether the vertex of an overlapping feature is nearer to another face.
fn has_shallower(setting: t::ContactSetting, at: u32) -> bool {
    let own = features[at].vertex;
    if own == t::NOTHING {
        return false;
    }
    let depth = features[at].separation;
    for (var i = setting.first_deep; i < setting.first_deep + setting.deep_count; i += 1u) {
        if features[i].vertex == own && i != at {
            let other = features[i].separation;
            if other > depth || (other == depth && i < at) {
                return true;
            }
        }
    }
    return false;
}
