//! `queries::Check`: a check in batches.

use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::queries::{self, Check, CheckOptions, Placement};
use glam::{Quat, Vec3};

#[test]
fn the_bits_of_a_check_are_small_and_together_the_whole() {
    let torus = CollisionMesh::new(&shapes::torus_240());
    // Sixty coinciding bodies, with 3120 pairs of faces each, and a row of others.
    let placement = |i: usize| Placement {
        mesh: torus.clone(),
        translation: Vec3::X * if i < 60 { 0.0 } else { 0.5 * i as f32 },
        rotation: Quat::IDENTITY,
        scale: Vec3::ONE,
    };
    let placements: Vec<_> = (0..100).map(placement).collect();
    let mut check = Check::new(&placements, &CheckOptions::default()).unwrap();
    let (mut found, mut before, all) = (Vec::new(), 0, check.progress().1);
    assert!(all >= 60 * 59 / 2);
    while let Some(bit) = check.next() {
        let (done, of) = check.progress();
        assert!(before < done && of == all);
        before = done;
        let faces: usize = bit.iter().map(|pair| pair.faces.len()).sum();
        assert!(faces < 3 << 20, "{faces} at once");
        found.extend(bit);
    }
    assert_eq!(before, all);
    assert_eq!(found, queries::check(&placements).unwrap());
}
