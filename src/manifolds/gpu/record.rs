//! The calls of contact generation, in order.

use super::*;
use crate::broad_phase::gpu::SORT;
use crate::gpu::buffers::Capacity;
use crate::gpu::layout::{
    CONTACT_PAIRS, CONTACT_POINTS, CONTACT_SLOTS, GROUPS_PER_64_MARGIN_PAIRS, GROUPS_PER_64_PAIRS, GROUPS_PER_64_SLOTS,
    GROUPS_PER_DIGIT_BLOCK, GROUPS_PER_MARGIN_PAIR, GROUPS_PER_SLOT_BLOCK, GROUPS_PER_SORT_BLOCK, PAIRS,
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
    let per_pair = per(GROUPS_PER_MARGIN_PAIR);
    calls.call(&ARGUMENTS, Groups::Exactly(1));
    let counted = per(GROUPS_PER_64_MARGIN_PAIRS);
    calls.call(&PLACE, Groups::per_64(capacity.margin_pairs, counted));
    for search in 0..2 {
        let constants = [search, 0, 0, 0];
        calls.call(&NEAR, per_pair).constants(constants);
        calls.call(&FEATURES, per_pair).constants(constants);
        if search == 0 {
            calls.call(&CONTOUR, per_pair);
        }
    }
    for kernel in [&ADMIT, &RAY, &INSIDE] {
        calls.call(kernel, per_pair);
    }
    reduce::record(calls);
    calls.call(&PLANES, Groups::PerBodies(1)).for_planes();
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
