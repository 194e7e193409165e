#define_import_path faceoff::known_vertices

// The vertices of a pair that have a feature over a face, each with the nearest of these features: a hash table in
// words of the features themselves, two slots each.

#import faceoff::types as t

// The features, 16 words each, because the threads share some of them.
@group(0) @binding(6) var<storage, read_write> feature_words: array<atomic<u32>>;

// Offsets of a feature's words.
const SEPARATION_WORD: u32 = 3u;
const VERTEX_WORD: u32 = 11u;
// The slots. Nothing else is in these words yet.
const SLOT_WORDS: vec2<u32> = vec2(7u, 15u);

fn word(at: u32, offset: u32) -> u32 {
    return atomicLoad(&feature_words[16u * at + offset]);
}

fn put(at: u32, offset: u32, value: u32) {
    atomicStore(&feature_words[16u * at + offset], value);
}

fn separation_of(at: u32) -> f32 {
    return bitcast<f32>(word(at, SEPARATION_WORD));
}

// Empties the slots of a feature.
fn clear(at: u32) {
    put(at, SLOT_WORDS.x, 0u);
    put(at, SLOT_WORDS.y, 0u);
}

// Index of the slot's word.
fn place_of(setup: t::PairSetup, slot: u32) -> u32 {
    return 16u * (setup.first_feature + slot / 2u) + SLOT_WORDS[slot % 2u];
}

fn first_slot(setup: t::PairSetup, vertex: u32) -> u32 {
    return ((vertex ^ (vertex >> 15u)) * 0x9e3779b1u) % (2u * setup.feature_count);
}

// Enters a feature, if it is one of a vertex.
fn enter(setup: t::PairSetup, at: u32) {
    let vertex = word(at, VERTEX_WORD);
    if vertex == t::NOTHING {
        return;
    }
    var slot = first_slot(setup, vertex);
    loop {
        let place = place_of(setup, slot);
        let held = atomicLoad(&feature_words[place]);
        if held != 0u && word(held - 1u, VERTEX_WORD) != vertex {
            slot = (slot + 1u) % (2u * setup.feature_count);
        } else if held != 0u && separation_of(held - 1u) <= separation_of(at) {
            break;
        } else if atomicCompareExchangeWeak(&feature_words[place], held, at + 1u).exchanged {
            break;
        }
    }
}

// The least separation of the features of a vertex over faces; `DROPPED` if there are none.
fn least_separation(setup: t::PairSetup, vertex: u32) -> f32 {
    if setup.feature_count == 0u {
        return t::DROPPED;
    }
    var slot = first_slot(setup, vertex);
    var least = t::DROPPED;
    loop {
        let held = atomicLoad(&feature_words[place_of(setup, slot)]);
        if held == 0u {
            break;
        }
        if word(held - 1u, VERTEX_WORD) == vertex {
            least = separation_of(held - 1u);
            break;
        }
        slot = (slot + 1u) % (2u * setup.feature_count);
    }
    return least;
}
