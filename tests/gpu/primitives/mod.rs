//! Scan, sort and dispatches of any size, each against the plainest code that does the same; and compiled kernels on
//! disk.

mod dispatch;
mod kernel_cache;
mod scan_sort;

use crate::gpu::Test;

pub const TESTS: &[Test] = &[
    ("kernels_are_kept_on_disk", kernel_cache::kernels_are_kept_on_disk),
    (
        "a_folder_that_cannot_be_written_is_no_error",
        kernel_cache::a_folder_that_cannot_be_written_is_no_error,
    ),
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
