//! The device's step against the CPU's: the same pairs, faces, contacts and motion, whatever the scene, however often.

mod band;
mod batches;
mod churn;
mod compare;
mod contacts;
mod inputs;
mod large;
mod overflow;
mod pairs;
mod rounded;
mod same_bits;
mod scene;
mod scenes;
mod steps;
mod work;

use crate::gpu::Test;

pub const TESTS: &[Test] = &[
    ("same_as_on_the_cpu", pairs::same_as_on_the_cpu),
    ("bits_do_not_depend_on_room", same_bits::again_and_with_other_room),
    ("growing_lists_change_nothing", overflow::growing_lists_change_nothing),
    ("lists_become_shorter", overflow::lists_become_shorter),
    ("room_to_read_follows_use", overflow::room_to_read_follows_use),
    (
        "faces_that_are_only_counted_need_no_room",
        overflow::faces_that_are_only_counted_need_no_room,
    ),
    ("fifty_steps_without_response", steps::fifty_steps_without_response),
    ("bodies_and_meshes_come_and_go", churn::bodies_and_meshes_come_and_go),
    ("meshes_of_any_size", inputs::meshes_of_any_size),
    ("none_and_one_of_everything", inputs::none_and_one_of_everything),
    (
        "an_impulse_that_is_no_number_has_no_effect",
        inputs::an_impulse_that_is_no_number_has_no_effect,
    ),
    (
        "hundreds_of_thousands_of_triangles",
        large::hundreds_of_thousands_of_triangles,
    ),
    (
        "one_pair_is_shared_by_many_workgroups",
        large::one_pair_is_shared_by_many_workgroups,
    ),
    ("large_and_small", large::large_and_small),
    (
        "pieces_that_do_not_fit_ask_for_nothing",
        large::pieces_that_do_not_fit_ask_for_nothing,
    ),
    (
        "too_many_places_are_found_or_an_error",
        overflow::too_many_places_are_found_or_an_error,
    ),
    (
        "too_much_is_an_error_that_leaves_no_trace",
        overflow::too_much_is_an_error_that_leaves_no_trace,
    ),
    (
        "a_crowd_is_refused_and_leaves_no_trace",
        overflow::a_crowd_is_refused_and_leaves_no_trace,
    ),
    (
        "small_worlds_take_few_dispatches",
        work::small_worlds_take_few_dispatches,
    ),
    (
        "half_spaces_alone_have_dispatches_for_them",
        work::half_spaces_alone_have_dispatches_for_them,
    ),
    ("bytes_and_lists_are_counted", work::bytes_and_lists_are_counted),
    ("repetitions_count", work::repetitions_count),
    ("a_pile_in_batches", batches::a_pile_in_batches),
    ("groups_in_batches", batches::groups_in_batches),
    ("large_meshes_in_batches", batches::large_meshes_in_batches),
    ("batches_become_fewer", batches::batches_become_fewer),
    (
        "little_memory_suffices_for_many_pairs",
        batches::little_memory_suffices_for_many_pairs,
    ),
    ("rounded_bodies_touch_as_on_the_cpu", rounded::same_pairs),
    ("the_cpu_asks_for_nothing", work::the_cpu_asks_for_nothing),
];
