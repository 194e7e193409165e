//! Whole apps without window, renderer or GPU: `MinimalPlugins`, `FaceoffHeadlessPlugins` and a manual clock.

#[path = "../common/app.rs"]
mod app;
mod bad_bodies;
mod bakes;
#[cfg(feature = "bevy_scene")]
mod bsn;
mod character;
mod clock;
mod compounds;
mod contacts;
mod culling;
mod dormant;
mod driven;
mod energy;
mod extreme_masses;
mod groups;
mod hooks;
mod kinds;
mod levels;
#[path = "../common/log.rs"]
mod log;
mod many;
mod meshes;
mod motion;
mod registration;
mod reports;
mod response;
mod sensors;
mod shapes;
mod snapshots;
mod spatial_queries;
mod stable_keys;
mod sudden;
mod warnings;

/// `bakes`, `character`, `compounds`, `contacts`, `driven`, `hooks`, `sensors`, `spatial_queries` and `sudden` have no
/// tests but functions: some of them are tests on a GPU too.
macro_rules! tests_of {
    ($module:ident as $tests:ident: $($name:ident)*) => {
        mod $tests {
            $(#[test]
            fn $name() {
                super::$module::$name();
            })*
        }
    };
}

tests_of! {
    stable_keys as stable_keys_on_the_cpu:
    worlds_with_the_same_keys_stay_equal_to_the_bit
    without_keys_entities_matter
    collisions_are_found_by_entities
}

tests_of! {
    spatial_queries as spatial_queries_on_the_cpu:
    a_ray_finds_what_rays_against_each_collider_find
    a_filter_chooses_what_counts
    parts_are_where_their_body_is
    what_moved_since_the_step_is_seen_after_an_update
    systems_that_ask_may_write_transforms_and_run_in_parallel
    invalid_rays_hit_nothing
    a_ray_caster_keeps_what_it_hits
    the_nearest_point_is_that_of_the_nearest_collider
    shapes_overlap_what_they_touch_or_contain
    a_shape_caster_keeps_what_it_runs_into
}

tests_of! {
    bakes as bakes_on_the_cpu:
    a_ball_dropped_in_a_room_rests_on_its_floor
    the_walls_of_a_room_push_inward
    the_same_mesh_as_a_solid_is_the_outward_one
    no_ray_slips_through_a_seam
}

tests_of! {
    character as character_on_the_cpu:
    climbs_stairs_and_comes_down_again
    a_step_that_is_too_high_stops_it
    slides_along_a_wall_and_stops_in_a_corner
    stands_still_on_a_slope_and_walks_up_at_full_speed
    slides_down_a_steep_slope_and_does_not_climb_it
    rides_a_lift_and_a_turning_platform
    ground_that_is_placed_does_not_take_it_along
    a_character_that_is_placed_leaves_its_ground
    a_lift_that_meets_a_wall_leaves_it_there
    crosses_hills_without_a_bump
    does_not_catch_on_the_edges_of_a_flat_floor
    falls_lands_and_bumps_its_head
    comes_out_of_what_it_was_spawned_in
    comes_out_of_a_cube_wherever_it_is_in_it
    pushes_a_crate_and_ignores_itself
    bad_numbers_stop_it
    it_follows_the_physics_clock_and_repeats_to_the_bit
}

tests_of! {
    compounds as compounds_on_the_cpu:
    a_hammer_of_two_children_flies_like_the_merged_mesh
    it_falls_rests_sleeps_and_names_its_children
    events_reach_the_body_and_the_collider
    a_scene_under_a_moved_turned_and_scaled_parent_is_one_body
    a_dynamic_body_stays_in_place_while_its_parent_moves
    static_and_kinematic_bodies_follow_their_parents
    what_lies_on_a_part_falls_when_the_part_goes
    a_part_moves_to_another_body
    a_child_that_is_added_or_enabled_takes_part_in_the_next_step
    parts_have_their_own_density_friction_and_layers
    a_sheared_part_has_a_mesh_of_its_own
    a_mirrored_sheared_wall_pushes_outward
    a_snapshot_of_a_nested_hammer_repeats_to_the_bit
    a_body_without_colliders_of_its_own_waits_for_its_children
}

tests_of! {
    sudden as sudden_on_the_cpu:
    a_bullet_that_is_fired_does_not_pass_a_plate
    a_push_counts_for_collision_substeps
    a_flagged_kinematic_body_pushes_what_is_in_its_way
    an_impulse_into_a_sleeper_moves_it
    a_sleeper_wakes_when_what_carries_it_is_replaced
    a_sleeper_wakes_when_its_gravity_or_its_locks_change
}

tests_of! {
    contacts as contacts_on_the_cpu:
    what_lies_still_falls_asleep_and_does_not_move_at_all
    a_sleeper_wakes_by_whatever_disturbs_it
    a_sleeper_wakes_when_the_mesh_under_it_goes
    who_may_not_sleep_does_not
    collisions_hold_points_and_the_weight_on_them
    every_corner_carries_a_quarter_of_the_weight_on_meshes_and_planes
    points_of_a_step_in_several_intervals_add_up_to_the_whole_impulse
    without_response_points_lie_where_the_surfaces_are
    a_body_tells_its_centre_of_mass
    without_response_there_are_points_too
    friction_holds_or_lets_slide_by_the_rule_of_the_pair
    damping_limits_and_locks_hold
    forces_go_on_and_impulses_act_once
    density_mass_and_inertia_decide_how_an_impulse_answers
    a_platform_that_moves_carries_what_stands_on_it
    a_bullet_flagged_so_does_not_pass_a_sheet
    planes_obey_layers
    a_snapshot_of_a_pile_goes_on_to_the_bit
    settings_and_components_that_cannot_be_used_are_told
}

tests_of! {
    driven as driven_on_the_cpu:
    a_lift_moved_by_its_transform_carries_what_stands_on_it
    a_slab_that_is_moved_has_a_velocity_and_goes_on_with_it
    a_door_turned_by_its_transform_sweeps_a_ball_away
    a_slab_that_teleports_pushes_nothing_and_one_that_is_moved_does
    a_slab_that_teleports_while_it_is_left_out_pushes_nothing_when_it_returns
    a_body_of_several_colliders_is_moved_by_its_transform_too
    a_dynamic_body_that_is_put_elsewhere_ends_its_collisions_at_once
    a_sensor_is_tested_where_it_is_put
    a_plane_follows_its_entity
    without_response_a_body_is_tested_where_it_is_put
}

tests_of! {
    hooks as hooks_on_the_cpu:
    a_belt_carries_a_crate_at_its_speed
    a_ball_jumps_through_a_platform_from_below_and_lands_on_it
    friction_of_a_pair_is_what_the_hook_says
    friends_pass_through_each_other_and_foes_do_not
    a_sleeper_wakes_when_the_filter_changes_its_mind
    a_sleeper_beside_a_ghost_sleeps_on
    a_sleeper_sleeps_on_when_a_friend_passes_through
}

tests_of! {
    sensors as sensors_on_the_cpu:
    who_flies_in_company_is_noticed_by_a_sensor_too
    a_plane_can_be_a_sensor
    a_sensor_keeps_what_falls_asleep_in_it
    a_sensor_spawned_over_sleepers_reports_them_until_it_goes
    a_dynamic_sensor_that_falls_asleep_goes_on_reporting
    who_falls_asleep_beside_a_wall_does_not_begin_to_touch_it
    what_is_fast_and_flagged_is_noticed_by_a_sensor_and_not_stopped
    a_flagged_sensor_notices_what_it_passes
    a_bullet_that_is_stopped_is_noticed_up_to_there_and_no_farther
    touches_that_come_and_go_are_told_once_unless_they_are_to_be_exact
    an_end_is_told_when_it_has_lasted_and_again_after_going_back
    an_end_is_told_at_once_if_one_of_the_two_is_gone
}
