//! The solver on a device. It visits pairs in another order than the CPU, so both are held to the same physical tests,
//! those of `tests/solver`. What has no contacts must move as on the CPU.

#[macro_use]
#[path = "../../solver/physical.rs"]
mod physical;

#[allow(dead_code, reason = "some tests are of the CPU alone")]
#[path = "../../solver/bodies.rs"]
mod bodies;
#[allow(dead_code, reason = "some tests are of the CPU alone")]
#[path = "../../solver/cloud.rs"]
mod cloud;
#[allow(dead_code, reason = "some tests are of the CPU alone")]
#[path = "../../solver/friction.rs"]
mod friction;
#[allow(dead_code, reason = "some tests are of the CPU alone")]
#[path = "../../solver/overlap.rs"]
mod overlap;
#[allow(dead_code, reason = "some tests are of the CPU alone")]
#[path = "../../solver/rest.rs"]
mod rest;
#[allow(dead_code, reason = "some tests are of the CPU alone")]
#[path = "../../solver/restitution.rs"]
mod restitution;
#[path = "../../solver/shapes.rs"]
mod shapes;
#[allow(dead_code, reason = "some tests are of the CPU alone")]
#[path = "../../solver/warm_start.rs"]
mod warm_start;
#[allow(dead_code, reason = "shared with tests that need more of it")]
#[path = "../../solver/world.rs"]
mod world;

mod bad;
mod device;
mod far;
mod free;
mod many;
mod meshes;
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
    ("a_cloud_of_balls", many::a_cloud_of_balls),
    ("a_pile_of_meshes", meshes::a_pile_of_meshes),
    ("a_block_of_balls", many::a_block_of_balls),
    ("a_heap_in_one_place_comes_apart", many::a_heap_in_one_place_comes_apart),
    ("the_same_bits_again", same_bits::the_same_bits_again),
    ("bits_do_not_depend_on_room", same_bits::bits_do_not_depend_on_room),
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

macro_rules! on_device {
    ($($module:ident { $($test:ident,)* })*) => {
        &[$($((concat!(stringify!($module), "::", stringify!($test)), |gpu| device::run(gpu, $module::$test)),)*)*]
    };
}

/// The physical tests on the device.
pub const PHYSICAL_TESTS: &[Test] = physical_tests!(on_device);
