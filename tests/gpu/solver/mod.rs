//! The solver on a device against the solver on the CPU: the same contact points, made from spheres, boxes and planes, and
//! the same motion.

#[path = "../../solver/shapes.rs"]
mod shapes;
#[allow(dead_code, reason = "shared with tests that need more of it")]
#[path = "../../solver/world.rs"]
mod world;

mod bad;
mod contacts;
mod far;
mod free;
mod many;
mod meshes;
mod overlap;
mod same_bits;
mod sleeping;
mod twin;

use crate::gpu::Test;

pub const TESTS: &[Test] = &[
    ("a_free_body_turns_the_same", free::a_free_body_turns_the_same),
    (
        "a_needle_that_spins_madly_stays_bounded",
        free::a_needle_that_spins_madly_stays_bounded,
    ),
    ("forces_and_limits_do_the_same", free::forces_and_limits_do_the_same),
    ("locked_axes_do_the_same", free::locked_axes_do_the_same),
    ("kinematic_and_static_bodies", free::kinematic_and_static_bodies),
    ("slow_motion_far_from_the_origin", far::slow_motion_far_from_the_origin),
    ("slow_turns_are_not_lost", far::slow_turns_are_not_lost),
    ("a_box_on_a_floor_far_away", far::a_box_on_a_floor_far_away),
    ("a_cube_on_a_half_space", contacts::a_cube_on_a_half_space),
    ("a_ball_rolls", contacts::a_ball_rolls),
    ("a_box_slides_down_a_slope", contacts::a_box_slides_down_a_slope),
    ("balls_bounce", contacts::balls_bounce),
    ("balls_meet_off_their_centres", contacts::balls_meet_off_their_centres),
    ("a_brick_tumbles_and_bounces", contacts::a_brick_tumbles_and_bounces),
    ("bodies_of_all_kinds_touch", contacts::bodies_of_all_kinds_touch),
    ("substeps_of_changing_length", contacts::substeps_of_changing_length),
    ("overlapping_balls_part", overlap::overlapping_balls_part),
    (
        "a_box_sunk_into_the_floor_comes_up",
        overlap::a_box_sunk_into_the_floor_comes_up,
    ),
    ("points_that_disagree", overlap::points_that_disagree),
    (
        "impulses_are_those_that_hold_a_box",
        contacts::impulses_are_those_that_hold_a_box,
    ),
    ("a_stack_of_ten_boxes", many::a_stack_of_ten_boxes),
    ("a_cloud_of_balls", many::a_cloud_of_balls),
    ("a_pile_of_meshes", meshes::a_pile_of_meshes),
    ("a_block_of_balls", many::a_block_of_balls),
    ("a_heap_in_one_place_comes_apart", many::a_heap_in_one_place_comes_apart),
    ("the_same_bits_again", same_bits::the_same_bits_again),
    ("bits_do_not_depend_on_room", same_bits::bits_do_not_depend_on_room),
    (
        "new_numbers_keep_the_impulses",
        same_bits::new_numbers_keep_the_impulses,
    ),
    (
        "a_stack_falls_asleep_as_on_the_cpu",
        sleeping::a_stack_falls_asleep_as_on_the_cpu,
    ),
    (
        "a_hit_wakes_the_whole_stack_and_nothing_else",
        sleeping::a_hit_wakes_the_whole_stack_and_nothing_else,
    ),
    ("what_else_wakes", sleeping::what_else_wakes),
    ("islands_are_those_of_the_cpu", sleeping::islands_are_those_of_the_cpu),
    (
        "a_kinematic_body_wakes_what_lies_on_it",
        sleeping::a_kinematic_body_wakes_what_lies_on_it,
    ),
    ("bad_input_is_left_out", bad::bad_input_is_left_out),
    ("nothing_at_all", bad::nothing_at_all),
    ("empty_intervals_change_nothing", bad::empty_intervals_change_nothing),
    ("too_much_is_an_error", bad::too_much_is_an_error),
    ("lists_that_lie", bad::lists_that_lie),
];
