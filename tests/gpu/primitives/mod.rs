//! Scan, sort and dispatches of any size, each against the plainest code that does the same.

mod dispatch;
mod scan_sort;

use crate::gpu::Test;

pub const TESTS: &[Test] = &[
    ("scan", scan_sort::scans),
    (
        "a_total_beyond_a_word_is_the_largest",
        scan_sort::a_total_beyond_a_word_is_the_largest,
    ),
    ("sort", scan_sort::sorts),
    ("sort_of_any_number_of_bits", scan_sort::sorts_keys_of_any_width),
    ("sort_is_stable", scan_sort::a_sort_is_stable),
    ("direct_dispatches", dispatch::direct),
    ("indirect_dispatches", dispatch::indirect),
    ("arguments_that_the_broad_phase_writes", dispatch::of_the_broad_phase),
    ("no_work_for_lists_that_do_not_fit", dispatch::nothing_after_overflow),
    (
        "no_pairs_are_searched_after_overflow",
        dispatch::no_pairs_after_overflow,
    ),
];
