//! The device's contact points against the CPU's: the same pairs, the same depths, and points near each other that push
//! the same way.

#[allow(dead_code)]
#[path = "../../manifolds/scene.rs"]
mod scene;

mod approach;
mod bad;
mod batches;
mod compare;
mod concave;
mod convex;
mod deepest;
mod inside;
mod nearest;
#[allow(dead_code)]
#[path = "../../core/nearest.rs"]
mod nearest_pairs;
mod planes;
mod rims;
mod rounded;
mod same_bits;

use crate::gpu::Test;

pub const TESTS: &[Test] = &[
    ("cubes_face_on_face", convex::cubes_face_on_face),
    ("cubes_that_touch", convex::cubes_that_touch),
    ("cubes_aligned", convex::cubes_aligned),
    ("cubes_edge_on_edge", convex::cubes_edge_on_edge),
    ("cubes_at_any_gap", convex::cubes_at_any_gap),
    ("balls", convex::balls),
    ("small_on_large", convex::small_on_large),
    ("tori", concave::tori),
    ("knots", concave::knots),
    ("rings", concave::rings),
    ("any_shapes_of_any_scale", concave::any_shapes_of_any_scale),
    ("heaps", concave::heaps),
    ("fine_meshes", concave::fine_meshes),
    ("hundreds_of_patches", concave::hundreds_of_patches),
    ("patches_too_deep_for_features", concave::patches_too_deep_for_features),
    ("slender_bodies", deepest::slender_bodies),
    ("overlaps_of_any_size", concave::overlaps_of_any_size),
    ("far_from_the_origin", convex::far_from_the_origin),
    ("one_inside_the_other", inside::one_inside_the_other),
    ("nearest_points", nearest::are_found),
    ("rims_are_pushed_out", rims::are_pushed_out),
    ("half_spaces", planes::half_spaces),
    ("half_spaces_under_round_ones", planes::round_ones),
    ("half_spaces_among_pairs", planes::among_pairs),
    ("rounded_balls_and_others", rounded::balls_and_others),
    ("rounded_capsules_and_others", rounded::capsules_and_others),
    ("rounded_boxes_and_others", rounded::rounded_boxes_and_others),
    ("rounded_ones_of_any_scale", rounded::of_any_scale),
    ("rounded_ones_of_large_meshes", rounded::of_large_meshes),
    ("rounded_balls_in_one_place", rounded::balls_in_one_place),
    ("rounded_half_spaces", rounded::half_spaces),
    ("bad_pairs", bad::bad_pairs),
    ("a_margin_around_everything", bad::a_margin_around_everything),
    ("nothing_at_all", bad::nothing_at_all),
    ("hostile_scenes", bad::hostile_scenes),
    ("equal_meshes_in_two_slots", bad::equal_meshes_in_two_slots),
    (
        "same_bits_twice_and_with_little_room",
        same_bits::twice_and_with_little_room,
    ),
    ("same_bits_in_batches_of_a_heap", batches::of_a_heap),
    ("same_bits_in_batches_of_large_meshes", batches::of_large_meshes),
];
