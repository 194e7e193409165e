//! Small games: a few bodies, default settings, 64 steps per second, as somebody writes them who starts with this
//! crate. What must come out is known from theory.
//!
//! One does not come out yet. It holds the true assertion and is ignored; the reason tells what comes out instead.
//! `cargo test --release --test small_games -- --ignored` runs it. On a device, in software on most machines, fewer
//! games are played; those of one row are solved alike.
//!
//! | game | theory | holds |
//! |---|---|---|
//! | balls that meet balls, restitution 1 | energy is kept within 1 % | on both; see also `tests/dynamics/elastic.rs` |
//! | 10 times the mass on a cube | sinks less than 1 % of an edge | on both |
//! | 100, 500, 1000 times the mass | the same | on the CPU |
//! | ten cubes, 1:100 in turn | stand | on the CPU |
//! | 10,000 times the mass, on a half-space | nothing sinks into it | on the CPU |
//! | a cube of 1 m on one of 0.1 m | the same | on both |
//! | a lift starts at 5 m/s under five cubes | 5 m/s each, none rises from it | on both |
//! | a mass of 1000 hits a row of five | all at 4.98 m/s | on both |
//! | towers of cubes of 5 mm to 100 m | stand, asleep | on both |
//! | a cube bounces in any pose | energy is kept within 1 %, never more | on both |
//! | a cube in a closed room for 30 s | the same | on the CPU |
//! | a coin spins on a half-space | slows down by 4/3 mu g / R | on both |
//! | a player looks around, another respawns | turning changes no velocity | on both, in each `Readback`; see also `tests/gpu/apps/writes.rs` |
//! | a bullet flies past sleepers | they sleep on | on both |
//! | a ball in a bowl without friction | gains no energy | on the CPU |
//! | a box on a turntable | rests | on the CPU |
//! | a ball slides over a T-junction of a flat floor | keeps its velocity | on both |
//! | meshes with cracks, missing faces, any winding | rest, push and contain as clean ones do | on both |
//! | balls in a box without a lid, of single faces | stay in it | on both |
//! | a cube on a slope that friction nearly holds, on ice, or alone in space | slides, turns round, goes on: it does not sleep | on both |
//! | piles of tori, of knots | fall asleep | on the CPU |
//! | one of three equal supports is made kinematic | carries a third | on both |
//! | a block is pulled from a tower | the tower stays | on the CPU |
//! | a body in a press | overlaps both walls evenly, with finite impulses | on the CPU |
//! | a pin in a hole with less play than the gap at rest | falls | on both |
//! | an open sheet on a ball | comes to rest | on neither: it rocks |
//!
//! Other tests play these, and they are not here again:
//!
//! | game | test |
//! |---|---|
//! | offset impacts and two dropped balls, on the CPU | `tests/dynamics/elastic.rs` |
//! | ten cubes on each other, pyramids | `tests/dynamics/rest.rs` |
//! | overlapping bodies, swarms | `tests/dynamics/small_games.rs` |
//! | what each write means in each `Readback` | `tests/gpu/apps/writes.rs`, `tests/gpu/apps/readback.rs` |
//! | a body turns about its centre of mass | `tests/plugin/motion.rs` |

mod balls;
mod bowl;
mod broken_meshes;
mod bullets;
mod dice_tower;
mod driven_stack;
mod elastic_box;
mod game;
mod heavy_on_light;
#[path = "../common/no_device.rs"]
mod no_device;
mod player;
mod press;
mod sheet;
mod slow_motion;
mod spinning_coin;
mod supports;
mod t_junction;
mod tight_fit;
mod turntable;

use bevy_faceoff::prelude::*;
use libtest_mimic::{Arguments, Completion, Trial};
use std::sync::OnceLock;

/// A game as a test.
struct Play {
    name: String,
    backend: Backend,
    play: fn(Backend),
    /// What comes out instead of what theory says.
    ignored: Option<&'static str>,
}

/// `Backend module::game;` or `Backend module::game, "what comes out today";`
macro_rules! plays {
    ($($backend:ident $module:ident::$game:ident $(, $today:literal)?;)*) => {
        vec![$(Play {
            name: format!("{}::{}::{}", stringify!($backend).to_lowercase(), stringify!($module), stringify!($game)),
            backend: Backend::$backend,
            play: $module::$game,
            ignored: [$($today)?].first().copied(),
        }),*]
    };
}

fn plays() -> Vec<Play> {
    plays! {
        Cpu balls::two_that_meet_head_on_exchange_their_velocities;
        Cpu balls::turned_balls_at_forty_metres_per_second_keep_their_energy;
        Cpu heavy_on_light::ten_times_the_mass_sinks_less_than_a_hundredth;
        Cpu heavy_on_light::a_hundred_times_the_mass_sinks_less_than_a_hundredth;
        Cpu heavy_on_light::five_hundred_times_the_mass_sinks_less_than_a_hundredth;
        Cpu heavy_on_light::a_thousand_times_the_mass_sinks_less_than_a_hundredth;
        Cpu heavy_on_light::ten_cubes_one_to_hundred_in_turn_stand;
        Cpu heavy_on_light::ten_thousand_times_the_mass_presses_nothing_through_a_plane;
        Cpu heavy_on_light::a_large_cube_does_not_press_a_small_one_through_a_mesh;
        Cpu driven_stack::a_stack_rises_with_its_lift;
        Cpu driven_stack::a_row_leaves_with_what_hits_it;
        Cpu dice_tower::three_of_a_centimetre_stand;
        Cpu dice_tower::five_of_a_centimetre_stand;
        Cpu dice_tower::three_of_five_millimetres_stand;
        Cpu dice_tower::five_of_five_millimetres_stand;
        Cpu dice_tower::five_of_two_centimetres_stand;
        Cpu dice_tower::five_of_a_metre_stand;
        Cpu dice_tower::five_of_a_hundred_metres_stand;
        Cpu elastic_box::one_bounce_on_a_plane_keeps_the_energy;
        Cpu elastic_box::one_bounce_on_a_mesh_keeps_the_energy;
        Cpu elastic_box::a_cube_between_six_planes_keeps_its_energy;
        Cpu elastic_box::a_cube_between_six_walls_keeps_its_energy;
        Cpu spinning_coin::with_a_vertex_in_the_middle_slows_down_by_theory;
        Cpu spinning_coin::without_a_vertex_in_the_middle_slows_down_by_theory;
        Cpu player::walks_and_respawns_as_told;
        Cpu bullets::sleepers_sleep_on_beside_a_bullet;
        Cpu bullets::a_stack_stands_beside_a_bullet;
        Cpu bowl::a_ball_in_a_bowl_gains_no_energy;
        Cpu turntable::a_box_rests_on_a_turntable;
        Cpu t_junction::a_ball_does_not_feel_it;
        Cpu t_junction::a_ball_does_not_feel_one_that_nothing_fills;
        Cpu broken_meshes::they_rest_as_clean_ones_do;
        Cpu broken_meshes::they_push_as_clean_ones_do;
        Cpu broken_meshes::they_contain_as_clean_ones_do;
        Cpu broken_meshes::a_box_without_a_lid_holds_balls;
        Cpu slow_motion::a_cube_slides_where_friction_nearly_holds_it;
        Cpu slow_motion::a_cube_turns_round_on_ice;
        Cpu slow_motion::what_touches_nothing_goes_on;
        Cpu slow_motion::a_pile_of_tori_falls_asleep;
        Cpu slow_motion::a_pile_of_small_tori_falls_asleep;
        Cpu slow_motion::a_pile_of_knots_falls_asleep;
        Cpu supports::one_that_is_made_kinematic_carries_its_part;
        Cpu supports::a_block_is_pulled_from_a_tower;
        Cpu press::a_ball_is_squeezed_evenly;
        Cpu press::a_cube_is_squeezed_evenly;
        Cpu tight_fit::a_pin_falls_through_its_hole;
        Cpu tight_fit::a_pin_slides_in_an_inclined_hole;
        Cpu sheet::an_open_sheet_on_a_ball_comes_to_rest, "turns at 0.34 rad/s after 20 s, awake";

        Gpu balls::two_dropped_on_each_other_keep_their_energy;
        Gpu balls::offset_impacts_keep_their_energy;
        Gpu balls::two_that_meet_head_on_exchange_their_velocities;
        Gpu heavy_on_light::ten_times_the_mass_sinks_less_than_a_hundredth;
        Gpu heavy_on_light::a_large_cube_does_not_press_a_small_one_through_a_mesh;
        Gpu driven_stack::a_stack_rises_with_its_lift;
        Gpu driven_stack::a_row_leaves_with_what_hits_it;
        Gpu dice_tower::three_of_a_centimetre_stand;
        Gpu elastic_box::one_bounce_on_a_plane_keeps_the_energy;
        Gpu spinning_coin::with_a_vertex_in_the_middle_slows_down_by_theory;
        Gpu t_junction::a_ball_does_not_feel_it;
        Gpu t_junction::a_ball_does_not_feel_one_that_nothing_fills;
        Gpu broken_meshes::they_rest_as_clean_ones_do;
        Gpu broken_meshes::they_push_as_clean_ones_do;
        Gpu broken_meshes::they_contain_as_clean_ones_do;
        Gpu broken_meshes::a_box_without_a_lid_holds_balls;
        Gpu slow_motion::what_touches_nothing_goes_on;
        Gpu supports::one_that_is_made_kinematic_carries_its_part;
        Gpu tight_fit::a_pin_falls_through_its_hole;
        Gpu player::walks_and_respawns_as_told;
        Gpu player::walks_and_respawns_as_told_with_latent_results;
        Gpu player::walks_and_respawns_as_told_with_resident_bodies;
        Gpu bullets::sleepers_sleep_on_beside_a_bullet;
        Gpu bullets::sleepers_sleep_on_beside_a_bullet_with_latent_results;
        Gpu bullets::a_stack_stands_beside_a_bullet;
    }
}

fn main() {
    let mut arguments = Arguments::from_args();
    // One after the other: a device in software uses all cores.
    arguments.test_threads = arguments.test_threads.or(Some(1));
    let trials = plays().into_iter().map(|play| play.trial(&arguments));
    libtest_mimic::run(&arguments, trials.collect()).exit()
}

impl Play {
    /// Like a function with `#[test]`, and with `#[ignore = "reason"]` if there is one.
    fn trial(self, arguments: &Arguments) -> Trial {
        let runs_anyway = arguments.ignored || arguments.include_ignored;
        let ignored = self.ignored.filter(|_| !runs_anyway);
        let flag = self.ignored.is_some() && runs_anyway;
        let run = move || {
            if let Some(today) = ignored {
                return Ok(Completion::ignored_with(today));
            }
            let missing = (self.backend == Backend::Gpu).then(why_no_device).flatten();
            match missing {
                Some(reason) => no_device::ignored_or_failed(reason),
                None => {
                    (self.play)(self.backend);
                    Ok(Completion::Completed)
                }
            }
        };
        Trial::ignorable_test(self.name, run).with_ignored_flag(flag)
    }
}

/// Why there is no device, if there is none.
fn why_no_device() -> Option<&'static str> {
    static REASON: OnceLock<Option<String>> = OnceLock::new();
    let reason = REASON.get_or_init(|| match game::Game::new(Backend::Gpu).backend() {
        ActiveBackend::None { reason } => Some(reason),
        _ => None,
    });
    reason.as_deref()
}
