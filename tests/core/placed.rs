//! Placed meshes: validation, bounding boxes, mass.

use crate::scene::{meshes, rotation, vector};
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::queries::{BodyFault, Placed};
use glam::{DMat3, DQuat, DVec3, Vec3};

#[test]
fn the_box_fits_exactly() {
    let mut random = fastrand::Rng::with_seed(3);
    let meshes = meshes();
    for case in 0..400 {
        let (name, mesh) = &meshes[case % 4];
        let scale = Vec3::ONE + 0.7 * vector(&mut random);
        let (turn, at) = (rotation(&mut random).as_dquat(), 1e3 * vector(&mut random).as_dvec3());
        let placed = Placed::new(mesh, at, turn, scale).unwrap();
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for p in mesh.mesh.used_positions() {
            let p = at + turn.normalize() * (scale.as_dvec3() * p.as_dvec3());
            (low, high) = (low.min(p), high.max(p));
        }
        let [least, largest] = placed.bounding_box();
        let wrong = (least - low).abs().max((largest - high).abs()).max_element();
        assert!(wrong < 1e-12, "{name}: {wrong}");
    }
}

#[test]
fn mass_follows_density_and_scale() {
    let cube = CollisionMesh::new(&shapes::cube(1.0));
    let (at, scale) = (DVec3::new(1e7, 2.0, 3.0), Vec3::new(1.0, 2.0, -3.0));
    let placed = Placed::new(&cube, at, DQuat::from_rotation_x(1.0), scale).unwrap();
    let mass = placed.mass(500.0);
    assert!((mass - 3000.0).abs() < 1e-3);
    let expected = DMat3::from_diagonal(DVec3::new(4.0 + 9.0, 1.0 + 9.0, 1.0 + 4.0) * (mass / 12.0));
    assert!(
        placed.inertia(mass).abs_diff_eq(expected, 0.01),
        "{}",
        placed.inertia(mass)
    );
    assert!(placed.center_of_mass().abs_diff_eq(at, 1e-6));
}

#[test]
fn what_cannot_be_placed_is_an_error() {
    let cube = CollisionMesh::new(&shapes::cube(1.0));
    let (at, turn, size) = (DVec3::ZERO, DQuat::IDENTITY, Vec3::ONE);
    let fault = |at, turn, size| Placed::new(&cube, at, turn, size).err();
    assert_eq!(fault(at, turn, size), None);
    assert_eq!(fault(DVec3::splat(1e300), turn, size), None);
    assert_eq!(fault(DVec3::NAN, turn, size), Some(BodyFault::NonFinitePose));
    assert_eq!(fault(at, DQuat::NAN, size), Some(BodyFault::NonFinitePose));
    assert_eq!(fault(at, turn, Vec3::INFINITY), Some(BodyFault::NonFinitePose));
    assert_eq!(
        fault(at, DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0), size),
        Some(BodyFault::ZeroRotation)
    );
    let flat = Vec3::new(1.0, 0.0, 1.0);
    assert_eq!(fault(at, turn, flat), Some(BodyFault::ZeroScale(flat)));
    assert_eq!(fault(at, turn, Vec3::splat(1e10)), Some(BodyFault::TooFar));
}
