//! What bodies do that lie on, hang on and fall onto each other, on the device: the scenes of `tests/dynamics`,
//! smaller, and the same scenes on both sides.

#[path = "../../dynamics/bounce.rs"]
mod bounce;
#[path = "../../dynamics/bullets.rs"]
#[allow(dead_code)]
mod bullets;
#[path = "../../dynamics/chain.rs"]
mod chain;
#[path = "../../dynamics/cloud.rs"]
mod cloud;
mod compounds;
mod fast_bodies;
mod flights;
#[path = "../../dynamics/fly_past.rs"]
#[allow(dead_code)]
mod fly_past;
#[path = "../../dynamics/groups.rs"]
mod groups;
#[path = "../../dynamics/hammers.rs"]
mod hammers;
#[path = "../../dynamics/incline.rs"]
mod incline;
#[path = "../../dynamics/motion.rs"]
mod motion;
mod parity;
#[path = "../../dynamics/pour.rs"]
mod pour;
mod reach;
#[path = "../../dynamics/rest.rs"]
mod rest;
#[path = "../../dynamics/rims.rs"]
mod rims;
#[path = "../../dynamics/rolling.rs"]
#[allow(dead_code, unused_imports)]
mod rolling;
mod rounded;
#[path = "../../dynamics/same_bits.rs"]
mod same_bits;
mod sleep;
#[path = "../../dynamics/small_games.rs"]
mod small_games;
#[path = "../../dynamics/spin.rs"]
mod spin;

use crate::gpu::Test;
use crate::world;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::gpu::device::Gpu;
use glam::Vec3;

macro_rules! tests {
    ($($name:ident: $work:expr;)*) => {
        [$((stringify!($name), (|gpu| world::on_device(gpu, || $work)) as fn(&Gpu))),*]
    };
}

pub const TESTS: &[Test] = &tests! {
    what_moves_freely_moves_as_on_the_cpu: parity::free();
    a_pile_comes_to_rest_as_on_the_cpu: parity::pile();
    the_same_pairs_points_and_touches_are_told: parity::reports();
    a_pile_moves_by_the_same_bits: assert!(same_bits::bits(1, 110, 15) == same_bits::bits(1, 110, 15));
    a_pile_falls_asleep_and_wakes: sleep::falls_asleep_and_wakes();
    nothing_runs_while_all_sleep: sleep::nothing_runs_while_all_sleep();
    what_sleeps_sleeps_on_while_steps_move_to_the_cpu_and_back: sleep::moves_to_the_cpu_and_back();
    what_lies_on_others_wakes_when_they_go: sleep::wakes_when_ground_goes();
    no_bullet_passes_a_thin_plate: fast_bodies::pass_no_plate();
    no_bullet_passes_a_plate_that_moves: fast_bodies::pass_no_plate_that_moves();
    bullets_stop_as_on_the_cpu: fast_bodies::stop_as_on_the_cpu();
    a_fast_dumbbell_stops_with_both_its_balls: fast_bodies::stop_with_all_their_colliders();
    a_hammer_flies_about_its_centre_of_mass: hammers::flies();
    a_hammer_falls_comes_to_rest_and_sleeps: hammers::rests();
    a_hammer_hits_like_the_merged_mesh: hammers::hits_like_the_merged_mesh();
    hammers_touch_as_on_the_cpu: compounds::touch_as_on_the_cpu();
    a_pile_of_hammers_comes_to_rest_as_on_the_cpu: compounds::pile();
    hammers_push_each_other_as_on_the_cpu: compounds::impulses();
    hammers_that_nobody_moves_have_the_same_points: compounds::points();
    hammers_go_on_from_what_the_device_knows: compounds::carried_over();
    a_hammer_sleeps_on_while_others_come_and_go: compounds::sleeps_on();
    a_hammer_that_loses_its_head_wakes: compounds::loses_its_head();
    compounds_have_dispatches_of_their_own: compounds::dispatches();
    nothing_is_carried_to_bodies_that_are_new: sleep::numbers_change();
    a_body_that_grows_does_not_jump: sleep::sizes_change();
    balls_leave_a_wall_by_their_restitution: bounce::ball_on_wall(1.0, 30.0, 2, &mut fastrand::Rng::with_seed(8));
    balls_leave_each_other_by_their_restitution: bounce::ball_on_ball(0.5, 0.5, 2, &mut fastrand::Rng::with_seed(7));
    a_cube_rests_on_a_mesh: rest::cube(1.0, 4);
    four_cubes_stand_on_each_other: rest::stack(4, 4);
    a_pyramid_of_six_stands: rest::pyramid(3, 4);
    five_rings_lie_on_each_other: rest::check("rings", &rest::rings(0.0, 0, 3), 0.02, 0.02);
    a_box_sticks_below_the_angle_of_friction: incline::sticks(3);
    a_box_slides_above_the_angle_of_friction: incline::slides(35.0);
    a_ball_rolls_down_a_mesh: assert!(incline::rolling_error(10.0, false, 1).abs() < 0.03);
    a_ball_rolls_down_a_half_space: assert!(incline::rolling_error(10.0, true, 1).abs() < 0.03);
    what_rolls_on_a_mesh_keeps_its_speed: rolling::keep_their_speed(rolling::Ground::Block, 48);
    what_rolls_on_a_half_space_keeps_its_speed: rolling::keep_their_speed(rolling::Ground::HalfSpace, 48);
    a_ball_keeps_its_speed_on_a_block: rounded::balls_roll(rounded::Ground::Block);
    a_ball_keeps_its_speed_on_a_half_space: rounded::balls_roll(rounded::Ground::HalfSpace);
    a_capsule_keeps_its_speed_on_a_block: rounded::capsules_roll(rounded::Ground::Block);
    rounded_bodies_touch_as_on_the_cpu: rounded::reports();
    a_heap_of_rounded_bodies_comes_to_rest: rounded::comes_to_rest();
    a_squeezed_knot_keeps_angular_momentum_and_energy: spin::keeps_turning(Vec3::new(6.0, 0.5, 6.0), 5);
    a_knot_that_spins_about_its_middle_axis_flips: assert!(spin::flips(spin::axes()[1], 12) >= 1);
    a_chain_of_four_hangs_is_shaken_and_holds: chain::hangs_and_is_shaken(4, [3, 2, 1]);
    thirty_mixed_knots_keep_momentum_and_gain_no_energy: cloud::keeps_momentum(30, 120, true);
    five_knots_poured_into_a_bin_come_to_rest: pour::pour(5, 2.3, 6);
    what_meets_nothing_needs_one_collision_substep: reach::meets_nothing();
    what_meets_a_plate_has_as_many_substeps_as_on_the_cpu: reach::meets_a_plate();
    hammers_need_as_many_substeps_as_on_the_cpu: reach::as_on_the_cpu();
    a_rim_holds_a_ball: [0.0, 1.0e-3, 0.02].into_iter().for_each(rims::hold_a_ball);
    sheets_that_meet_rim_to_rim_do_not_pass: rims::MEETINGS.into_iter().for_each(rims::meet_rim_to_rim);
    a_torus_on_a_rim_is_not_cut: rims::hold_a_torus();
    an_edge_holds_a_parallel_edge_with_the_same_ends: rims::EDGES.into_iter().for_each(rims::hold_an_edge);
    a_ball_flies_straight_on_over_a_ridge: fly_past::over_a_ridge(3, &[false]);
    a_ball_is_thrown_over_a_wall: fly_past::over_a_wall(3);
    a_box_slides_straight_on_over_a_groove: fly_past::over_a_groove(&[3.0], 2);
    pairs_that_pass_are_not_deflected_and_those_that_hit_are_not_missed: flights::pass_or_hit();
    an_impact_far_away_changes_nothing: groups::far_impact(4, 100);
    billiard_balls_pass_on_their_momentum: groups::billiards();
    a_formation_with_a_fast_spinner_stays_together: groups::spinner();
    a_wheel_on_its_axle_needs_few_collision_substeps: groups::wheel();
    groups_have_as_many_substeps_as_on_the_cpu: reach::groups_as_on_the_cpu();
    groups_that_come_near_each_other_have_the_same_number: reach::groups_near_each_other();
    commands_that_are_not_needed_change_nothing: reach::same_with_spare_substeps();
    what_falls_asleep_does_not_feel_them: reach::asleep_with_spare_substeps();
    what_all_bodies_have_in_common_changes_nothing: small_games::formation(&shapes::ball(0.25, 2), 2, 0.501, 8);
    what_is_pushed_out_does_not_sleep_before_it_is_out: small_games::pushed_out(&shapes::ball(0.5, 2), 0.6);
    two_that_overlap_part_before_they_sleep: small_games::overlapping(&shapes::cube(1.0), 2, Vec3::X * 0.3);
    three_in_the_same_place_part: small_games::overlapping(&shapes::torus_240(), 3, Vec3::ZERO);
    a_swarm_that_lands_is_not_looked_at_from_afar: small_games::swarm(2, 26.0);
};

/// Tests that make steps of their own.
pub const STEP_TESTS: &[Test] = &[
    ("lists_that_grow_in_a_flight_change_nothing", fast_bodies::overflow),
    ("a_bullet_that_meets_nothing_reads_little", fast_bodies::read_little),
];
