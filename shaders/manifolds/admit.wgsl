// Contact generation: drops features that disagree with a nearby patch. Of the overlapping features of a vertex only
// the shallowest stays: the face through which it entered. Lists the patches without an overlapping feature. One
// workgroup per pair.
#import faceoff::agree::agree
#import faceoff::constants::manifolds::MIN_AGREEMENT
#import faceoff::dispatch::group_index
#import faceoff::empty_patches::{HAS_FEATURE, count_at, list_at}
#import faceoff::near_patches::{next_near, patches, search_unfinished}
#import faceoff::tree::rank_of
#import faceoff::types as t

@group(0) @binding(2) var<storage, read_write> contact_counters: array<atomic<u32>>;
@group(0) @binding(3) var<storage, read> pair_setups: array<t::PairSetup>;
// The features, 16 words each, because the threads share some of them.
@group(0) @binding(4) var<storage, read_write> feature_words: array<atomic<u32>>;
@group(0) @binding(5) var<storage, read_write> contour_links: array<atomic<u32>>;

// Offsets of a feature's words.
const SEPARATION_WORD: u32 = 3u;
// Overlapping features share a hash table, by their vertices: two slots each.
const TABLE_WORDS: u32 = 14u;
// The least of a vertex, kept by the feature that owns its slot.
const LEAST_WORD: u32 = 7u;
const VERTEX_WORD: u32 = 11u;

// An overlapping feature of a patch is kept.
const KEPT: u32 = 1u;
// A feature of it that touches or is apart is kept.
const TOUCHED: u32 = 2u;

var<workgroup> empty: array<atomic<u32>, 2>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let index = group_index(group);
    if index >= agree(thread, atomicLoad(&contact_counters[t::BATCH_PAIRS])) {
        return;
    }
    let setup = pair_setups[index];
    if setup.valid == 0u || setup.patch_count == 0u {
        return;
    }
    for (var k = thread; k < setup.patch_count; k += 64u) {
        atomicStore(&contour_links[flags_at(setup, k)], 0u);
    }
    for (var i = thread; i < setup.deep_count; i += 64u) {
        let at = setup.first_deep + i;
        put(at, LEAST_WORD, t::NOTHING);
        put(at, TABLE_WORDS, 0u);
        put(at, TABLE_WORDS + 1u, 0u);
    }
    sync();
    var i = thread;
    while i < setup.feature_count {
        admit(setup, setup.first_feature + i, TOUCHED);
        i += 64u;
    }
    var near_index = thread;
    while near_index < setup.nearest_count {
        admit(setup, setup.first_nearest + near_index, 0u);
        near_index += 64u;
    }
    // Separations of overlapping features are negative. Their bits are the smaller, the shallower a feature is.
    find_least(setup, thread, true);
    for (var k = thread; k < setup.deep_count; k += 64u) {
        put(setup.first_deep + k, LEAST_WORD, t::NOTHING);
    }
    sync();
    // The first of equally shallow features.
    find_least(setup, thread, false);
    var deep_index = thread;
    while deep_index < setup.deep_count {
        admit(setup, setup.first_deep + deep_index, KEPT);
        deep_index += 64u;
    }
    sync();
    list_empty_patches(setup, thread);
    // Some devices abort long loops.
    if i < setup.feature_count || near_index < setup.nearest_count || deep_index < setup.deep_count || search_unfinished {
        atomicOr(&contact_counters[t::CONTACTS_CUT_SHORT], 1u);
    }
}

fn word(at: u32, offset: u32) -> u32 {
    return atomicLoad(&feature_words[16u * at + offset]);
}

fn put(at: u32, offset: u32, value: u32) {
    atomicStore(&feature_words[16u * at + offset], value);
}

fn vector(at: u32, offset: u32) -> vec3<f32> {
    return bitcast<vec3<f32>>(vec3(word(at, offset), word(at, offset + 1u), word(at, offset + 2u)));
}

fn is_dropped(at: u32) -> bool {
    return bitcast<f32>(word(at, SEPARATION_WORD)) == t::DROPPED;
}

fn drop(at: u32) {
    put(at, SEPARATION_WORD, bitcast<u32>(t::DROPPED));
}

// The flags of the k-th patch.
fn flags_at(setup: t::PairSetup, k: u32) -> u32 {
    return 8u * setup.first_segment + k;
}

// Drops a feature if a nearby patch disagrees with it; else gives this flag, if any, to all patches nearby.
fn admit(setup: t::PairSetup, at: u32, flag: u32) {
    if is_dropped(at) {
        return;
    }
    let middle = 0.5 * (vector(at, 0u) + vector(at, 4u));
    let normal = vector(at, 8u);
    let first = setup.first_segment;
    let count = setup.patch_count;
    var agrees = true;
    // Overlapping features that disagree were never found.
    if flag != KEPT {
        for (var k = next_near(first, count, 0u, middle); k < count; k = next_near(first, count, k + 1u, middle)) {
            agrees = agrees && dot(normal, patches[first + k].normal) >= MIN_AGREEMENT;
        }
    }
    if !agrees {
        drop(at);
        return;
    }
    for (var k = next_near(first, count, 0u, middle); k < count; k = next_near(first, count, k + 1u, middle)) {
        // Patches that are too deep have no overlapping features.
        if flag != KEPT || patches[first + k].too_deep == 0u {
            atomicOr(&contour_links[flags_at(setup, k)], flag);
        }
    }
}

// Keeps the overlapping features of each vertex that have the least separation bits, or the first one.
fn find_least(setup: t::PairSetup, thread: u32, by_separation: bool) {
    for (var k = thread; k < setup.deep_count; k += 64u) {
        let at = setup.first_deep + k;
        if word(at, VERTEX_WORD) != t::NOTHING && !is_dropped(at) {
            let value = select(at, word(at, SEPARATION_WORD), by_separation);
            atomicMin(&feature_words[16u * owner_of(setup, at) + LEAST_WORD], value);
        }
    }
    sync();
    for (var k = thread; k < setup.deep_count; k += 64u) {
        let at = setup.first_deep + k;
        if word(at, VERTEX_WORD) != t::NOTHING && !is_dropped(at) {
            let value = select(at, word(at, SEPARATION_WORD), by_separation);
            if value != word(owner_of(setup, at), LEAST_WORD) {
                drop(at);
            }
        }
    }
    sync();
}

// The first feature that got a slot for its vertex, which may be this one.
fn owner_of(setup: t::PairSetup, at: u32) -> u32 {
    let own = word(at, VERTEX_WORD);
    let slots = 2u * setup.deep_count;
    var slot = ((own ^ (own >> 15u)) * 0x9e3779b1u) % slots;
    loop {
        let place = 16u * (setup.first_deep + slot / 2u) + TABLE_WORDS + slot % 2u;
        var held = atomicLoad(&feature_words[place]);
        if held == 0u {
            let exchange = atomicCompareExchangeWeak(&feature_words[place], 0u, at + 1u);
            if exchange.exchanged {
                break;
            }
            held = exchange.old_value;
        }
        // The slot may still be empty: weak exchanges can fail.
        if held != 0u {
            if word(held - 1u, VERTEX_WORD) == own {
                return held - 1u;
            }
            slot = (slot + 1u) % slots;
        }
    }
    return at;
}

// Lists the patches without an overlapping feature, for `ray.wgsl`.
fn list_empty_patches(setup: t::PairSetup, thread: u32) {
    var number = 0u;
    for (var round = 0u; round < setup.patch_count; round += 64u) {
        if thread < 2u {
            atomicStore(&empty[thread], 0u);
        }
        workgroupBarrier();
        let k = round + thread;
        var flags = KEPT;
        if k < setup.patch_count {
            flags = atomicLoad(&contour_links[flags_at(setup, k)]);
        }
        if (flags & KEPT) == 0u {
            atomicOr(&empty[thread / 32u], 1u << (thread % 32u));
        }
        workgroupBarrier();
        let mask = vec2(atomicLoad(&empty[0]), atomicLoad(&empty[1]));
        if (flags & KEPT) == 0u {
            let entry = k | select(0u, HAS_FEATURE, (flags & TOUCHED) != 0u);
            atomicStore(&contour_links[list_at(setup, number + rank_of(mask, thread))], entry);
        }
        number += countOneBits(mask.x) + countOneBits(mask.y);
        workgroupBarrier();
    }
    if thread == 0u {
        atomicStore(&contour_links[count_at(setup)], number);
    }
}

// Barrier for all threads, and for their writes to storage.
fn sync() {
    storageBarrier();
    workgroupBarrier();
}
