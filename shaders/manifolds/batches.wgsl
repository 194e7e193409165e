#define_import_path faceoff::batches

// Contact points are made for a batch of the active pairs at a time, in the same lists. Batch k of n has the pairs k, n
// + k, 2 n + k and so on of their list. The list is nearly ascending, so all batches share a crowd.
//
// `batch` is the number of the batch and the number of batches.

#import faceoff::dispatch::divide_up
#import faceoff::types as t

@group(0) @binding(1) var<storage, read_write> contact_counters: array<u32>;

// The number of the i-th pair of a batch in the list of active pairs.
fn active_pair_of(i: u32, batch: vec2<u32>) -> u32 {
    return i * batch.y + batch.x;
}

// Number of pairs of a batch.
fn pairs_in(batch: vec2<u32>) -> u32 {
    let pairs = contact_counters[t::ACTIVE_PAIRS];
    return divide_up(pairs - min(batch.x, pairs), batch.y);
}

// Adds the lengths of a batch's lists to the totals, and zeroes them. For one thread.
fn end_batch() {
    let pieces = contact_counters[t::NEAR_PIECES] + contact_counters[t::DEEP_PIECES];
    add(contact_counters[t::NEAR_TRIANGLES], t::MAX_NEAR_TRIANGLES, t::TOTAL_NEAR_TRIANGLES);
    add(contact_counters[t::FEATURES], t::MAX_FEATURES, t::TOTAL_FEATURES);
    add(contact_counters[t::SEGMENTS], t::MAX_SEGMENTS, t::TOTAL_SEGMENTS);
    add(pieces, t::MAX_NEAR_PIECES, t::TOTAL_NEAR_PIECES);
    contact_counters[t::NEAR_TRIANGLES] = 0u;
    contact_counters[t::FEATURES] = 0u;
    contact_counters[t::SEGMENTS] = 0u;
    contact_counters[t::NEAR_PIECES] = 0u;
    contact_counters[t::DEEP_PIECES] = 0u;
}

fn add(length: u32, largest: u32, total: u32) {
    contact_counters[largest] = max(contact_counters[largest], length);
    // A sum of more than a word does not become small.
    let room = 0xffffffffu - contact_counters[total];
    contact_counters[total] += min(length, room);
}
