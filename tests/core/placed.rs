//! Placed meshes: validation, bounding boxes, mass.

use crate::scene::{meshes, rotation, vector};
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::queries::{BodyFault, Placed, Ray};
use bevy_faceoff::state::mesh_arena::MeshArena;
use bevy_faceoff::state::{Bodies, Body};
use bevy_faceoff::types::body::RigidBody;
use glam::{DMat3, DQuat, DVec3, Quat, Vec3};

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

/// A sheet in the plane z = 0, and one beside it.
fn sheet(z: f32) -> CollisionMesh {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| Vec3::new(x, y, z));
    CollisionMesh::new(&TriMesh::new(corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]]).unwrap())
}

#[test]
fn a_flat_mesh_may_have_a_scale_of_0_across_its_plane() {
    let place = |mesh: &CollisionMesh, scale: Vec3| Placed::new(mesh, DVec3::ZERO, DQuat::IDENTITY, scale).map(|_| ());
    let flat = sheet(0.0);
    for scale in [Vec3::new(2.0, 3.0, 0.0), Vec3::new(2.0, -3.0, -0.0)] {
        let placed = Placed::new(&flat, DVec3::Y, DQuat::IDENTITY, scale).unwrap();
        let [low, high] = placed.bounding_box();
        assert_eq!([low, high], [DVec3::new(-2.0, -2.0, 0.0), DVec3::new(2.0, 4.0, 0.0)]);
        let hit = placed
            .cast_ray(&Ray::new(DVec3::new(1.9, 3.9, 5.0), DVec3::NEG_Z))
            .unwrap();
        assert!(
            (hit.distance - 5.0).abs() < 1e-9 && hit.normal.z.abs() > 0.999_999,
            "{hit:?}"
        );
        assert!(placed.mass(1.0) > 0.0);
    }
    // Within its plane it may not, and neither may a mesh that would be moved.
    let within = Vec3::new(0.0, 1.0, 1.0);
    assert_eq!(place(&flat, within), Err(BodyFault::ZeroScale(within)));
    assert_eq!(place(&flat, Vec3::ZERO), Err(BodyFault::ZeroScale(Vec3::ZERO)));
    let across = Vec3::new(1.0, 1.0, 0.0);
    assert_eq!(place(&sheet(0.5), across), Err(BodyFault::ZeroScale(across)));
    assert_eq!(
        place(&CollisionMesh::new(&shapes::cube(1.0)), across),
        Err(BodyFault::ZeroScale(across))
    );
}

#[test]
fn bodies_that_nothing_can_push_need_no_mass() {
    let mut arena = MeshArena::default();
    let mesh = arena.add(CollisionMesh::new(&shapes::cube(1.0)));
    let push = |kind: RigidBody, density: f32, mass: Option<f32>| {
        let body = Body {
            kind,
            density,
            mass,
            ..Body::at_rest(mesh, Vec3::ZERO, Quat::IDENTITY, Vec3::ONE)
        };
        Bodies::default().push(&body, &arena)
    };
    for kind in [RigidBody::Static, RigidBody::Kinematic] {
        assert_eq!(push(kind, 0.0, None), Ok(()));
        assert_eq!(push(kind, 1.0, Some(0.0)), Ok(()));
        assert_eq!(push(kind, -1.0, None), Err(BodyFault::Mass(-1.0)));
        assert_eq!(push(kind, 1.0, Some(-2.0)), Err(BodyFault::Mass(-2.0)));
    }
    assert_eq!(push(RigidBody::Dynamic, 0.0, None), Err(BodyFault::Mass(0.0)));
    assert_eq!(push(RigidBody::Dynamic, 1.0, Some(0.0)), Err(BodyFault::Mass(0.0)));
}
