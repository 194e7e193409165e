//! The list of physical tests: analytic solutions that the solver meets on the CPU and on a device.

/// Calls the macro `each` with all physical tests, by module.
macro_rules! physical_tests {
    ($each:ident) => {
        $each! {
            bodies {
                free_fall,
                damping_decays_exponentially,
                speed_limits_hold,
                a_force_at_a_point_pushes_and_turns,
                an_impulse_at_a_point_works_once,
                locked_translation_resists_impulses,
                the_bearing_of_a_locked_axis_balances_moments_about_it,
                a_heavy_ball_pushes_a_light_one_away,
                nothing_moves_a_static_body_and_nothing_stops_a_kinematic_one,
                invalid_input_is_ignored,
            }
            cloud {
                boxes_that_tumble_into_each_other_keep_momentum,
            }
            friction {
                a_box_sticks_to_a_slope_below_the_friction_angle,
                a_box_slides_down_a_slope_above_the_friction_angle,
                a_ball_rolls_down_a_slope_without_sliding,
                a_ball_that_slides_comes_to_roll_at_five_sevenths_of_its_speed,
                a_box_stops_after_the_distance_that_friction_allows,
                a_platform_carries_a_box,
                a_turntable_carries_a_box,
                a_slab_tips_over_its_edge_as_a_pendulum_does,
            }
            overlap {
                overlapping_balls_separate_slowly,
                a_heap_spawned_in_one_place_comes_apart,
                a_box_sunk_into_the_floor_comes_up,
                two_boxes_in_one_place_separate,
                points_whose_normals_conflict_with_the_last_contact_are_ignored,
                a_new_pair_with_opposed_normals_is_in_deep_penetration,
            }
            rest {
                a_box_stays_on_the_floor_for_a_minute,
                a_box_far_from_the_origin_stays_too,
                a_stack_of_ten_boxes_stands_for_half_a_minute,
                a_pyramid_stands,
                a_heavy_box_rests_on_a_light_one,
                a_very_heavy_box_rests_on_five_light_ones,
                a_dropped_stack_comes_to_rest,
                the_impulse_that_supports_a_box_is_its_weight,
                a_stack_stands_while_the_step_changes,
            }
            restitution {
                balls_leave_by_their_restitution_head_on_and_oblique,
                a_ball_that_bounces_on_a_floor_keeps_its_height,
                a_flat_box_bounces_without_turning,
                slow_impacts_do_not_bounce,
                the_stronger_rule_combines,
                a_fast_ball_does_not_get_through_a_thin_wall,
            }
            warm_start {
                impulses_survive_a_renumbering,
                bodies_come_and_go,
            }
        }
    };
}
