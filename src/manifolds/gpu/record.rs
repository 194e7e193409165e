//! The calls of contact generation, in order.

use super::*;
use crate::broad_phase::gpu::SORT;
use crate::gpu::buffers::Capacity;
use crate::gpu::layout::{
    CONTACT_PAIRS, CONTACT_POINTS, CONTACT_SLOTS, GROUPS_PER_64_BATCH_PAIRS, GROUPS_PER_64_PAIRS, GROUPS_PER_64_SLOTS,
    GROUPS_PER_BATCH_PAIR, GROUPS_PER_DIGIT_BLOCK, GROUPS_PER_SLOT_BLOCK, GROUPS_PER_SORT_BLOCK, PAIRS,
};
use crate::gpu::program::{Calls, Groups};
use crate::gpu::radix_sort::KeysAndValues;
use crate::gpu::scan::{Length, Scan};

/// Adds the calls that select the pairs of a step, in ascending order. The broad phase finds them in the order of its
/// buckets.
pub fn record_select(calls: &mut Calls, capacity: &Capacity) {
    // These workgroup counts are for two keys per pair: more than enough.
    let [per_pair, per_block, per_digit_block] = [GROUPS_PER_64_PAIRS, GROUPS_PER_SORT_BLOCK, GROUPS_PER_DIGIT_BLOCK]
        .map(|slot| Groups::Indirect("arguments", slot));
    let per_pair = Groups::per_64(capacity.pairs, per_pair);
    let sort = |calls: &mut Calls, input: KeysAndValues| {
        let scratch = if input == SORT.input { SORT.scratch } else { SORT.input };
        let sort = SORT.between(input, scratch);
        sort.record(
            calls,
            PAIRS,
            capacity.body_bits(),
            capacity.pairs,
            [per_block, per_digit_block],
        )
    };
    calls.call(&SELECT_KEYS, per_pair);
    let [keys, values] = sort(calls, SORT.input);
    calls
        .call(&SELECT_ORDER, per_pair)
        .bind("keys", keys)
        .bind("values", values);
    let [_, values] = sort(calls, [keys, values]);
    calls.call(&SELECT_PAIRS, per_pair).bind("values", values);
}

/// Adds the calls that find contact points, in any order, for the bodies in `limits`.
pub fn record_points(calls: &mut Calls, capacity: &ContactCapacity) {
    for batch in 0..capacity.batches {
        record_batch(calls, capacity, batch);
    }
    calls.call(&PLANES, Groups::PerBodies(1)).for_planes();
}

/// Adds the calls that find contact points of one batch of pairs.
fn record_batch(calls: &mut Calls, capacity: &ContactCapacity, batch: u32) {
    let per_pair = per(GROUPS_PER_BATCH_PAIR);
    let constants = [batch, capacity.batches, 0, 0];
    calls.call(&ARGUMENTS, Groups::Exactly(1)).constants(constants);
    let counted = per(GROUPS_PER_64_BATCH_PAIRS);
    calls
        .call(&PLACE, Groups::per_64(capacity.batch_pairs(), counted))
        .constants(constants);
    record_search(calls, 0);
    calls
        .call(&NEAR_FEATURES, per_pair)
        .bind_words("feature_words", "features");
    calls.call(&ARRIVAL, per_pair);
    calls.call(&FIRST_CONTACT, per_pair);
    calls.call(&CONTOUR, per_pair);
    calls.call(&DEPTH, per_pair);
    record_search(calls, 1);
    calls.call(&ADMIT, per_pair).bind_words("feature_words", "features");
    calls.call(&RAY, per_pair);
    calls.call(&INSIDE, per_pair);
    reduce::record(calls, constants);
}

/// Adds the calls that find all features, or overlapping ones in the second search.
fn record_search(calls: &mut Calls, search: u32) {
    let per_pair = per(GROUPS_PER_BATCH_PAIR);
    let per_piece = Groups::Indirect("near_arguments", search);
    let [count, write] = [0, 1].map(|phase| [phase, 0, 0, 0]);
    let constants = [search, 0, 0, 0];
    let [of_pairs, of_pieces] = [&FEATURES, &FEATURES_OF_PIECES].map(|kernels| &kernels[search as usize]);
    calls.call(&SPLIT, per_pair).constants(constants).for_large_meshes();
    calls
        .call(&NEAR_PIECES, per_piece)
        .constants(constants)
        .for_large_meshes();
    calls.call(&NEAR, per_pair).constants(constants);
    calls.call(of_pieces, per_piece).constants(count).for_large_meshes();
    calls.call(of_pairs, per_pair);
    calls.call(of_pieces, per_piece).constants(write).for_large_meshes();
}

/// Adds the call that measures anchors from the centres of mass of bodies.
pub fn record_compounds(calls: &mut Calls, capacity: &ContactCapacity) {
    calls.call(&COMPOUND_ANCHORS, per_64_slots(capacity)).for_compounds();
}

/// Adds the calls that write the lists of pairs and points in order.
pub fn record_lists(calls: &mut Calls, capacity: &ContactCapacity) {
    calls.call(&COUNTS, per_64_slots(capacity));
    for (values, total) in [("pair_places", CONTACT_PAIRS), ("point_places", CONTACT_POINTS)] {
        let scan = Scan {
            counters: "contact_counters",
            values,
            sums: "slot_sums",
        };
        scan.record(
            calls,
            CONTACT_SLOTS,
            Length::Counter,
            Some(total),
            capacity.slots,
            per(GROUPS_PER_SLOT_BLOCK),
        );
    }
    calls.call(&EMIT, per_64_slots(capacity));
}

/// One thread per slot.
pub fn per_64_slots(capacity: &ContactCapacity) -> Groups {
    Groups::per_64(capacity.slots, per(GROUPS_PER_64_SLOTS))
}

/// The workgroup count in this slot of `contact_arguments`.
pub const fn per(slot: u32) -> Groups {
    Groups::Indirect("contact_arguments", slot)
}
