//! Overlaps of shapes against every triangle, in double precision.

use crate::support::{
    Random, contains, hills, mixed, open_torus, random_pose, room, segment_distance, surfaces_cross, triangles,
};
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::queries::{Placed, QueryShape};
use glam::{DQuat, DVec3, Vec3};

/// Meshes of at most 300 triangles, and whether they are closed.
fn meshes() -> [(&'static str, TriMesh, bool); 5] {
    [
        ("cube", shapes::cube(1.0), true),
        ("torus", shapes::torus_240(), true),
        ("hills", hills(12), false),
        ("mixed", mixed(), true),
        ("open", open_torus(), false),
    ]
}

#[test]
fn balls_and_capsules_overlap_what_a_test_of_all_faces_says() {
    let mut random = Random::new(21);
    let (mut touching, mut apart) = (0, 0);
    for (name, mesh, is_closed) in meshes() {
        let baked = CollisionMesh::new(&mesh);
        let size = f64::from(baked.radius);
        for round in 0..40 {
            let pose = random_pose(&mut random, if round % 8 == 7 { 1e5 } else { 1.0 });
            let placed = Placed::new(&baked, pose.translation, pose.rotation, pose.scale).unwrap();
            let faces = triangles(&mesh, &pose, pose.translation);
            for _ in 0..100 {
                let (translation, rotation) = (pose.translation + random.vector() * 1.5 * size, random.rotation());
                let radius = random.0.f64() * 0.5 * size;
                let half_length = if random.0.bool() { 0.0 } else { random.0.f64() * size };
                let shape = if half_length == 0.0 {
                    QueryShape::Ball { radius }
                } else {
                    QueryShape::Capsule { radius, half_length }
                };
                let axis = rotation.normalize() * DVec3::Y * half_length;
                let [p, q] = [-axis, axis].map(|end| translation - pose.translation + end);
                let least = faces
                    .iter()
                    .map(|t| segment_distance(p, q, t))
                    .fold(f64::INFINITY, f64::min);
                let expected = least <= radius || (is_closed && contains(&faces, p, name == "mixed"));
                if (least - radius).abs() > 1e-9 {
                    assert_eq!(
                        placed.overlaps(&shape, translation, rotation),
                        expected,
                        "{name}: {shape:?}"
                    );
                }
                if expected {
                    touching += 1;
                } else {
                    apart += 1;
                }
            }
        }
    }
    assert!(touching > 3000 && apart > 10_000, "{touching} {apart}");
}

#[test]
fn meshes_and_boxes_overlap_what_a_test_of_all_faces_says() {
    let mut random = Random::new(22);
    let (mut touching, mut apart) = (0, 0);
    let bakes = meshes().map(|(name, mesh, is_closed)| (name, CollisionMesh::new(&mesh), mesh, is_closed));
    let cube = shapes::cube(1.0);
    for (name, baked, mesh, is_closed) in &bakes {
        for round in 0..150 {
            let pose = random_pose(&mut random, if round % 8 == 7 { 1e5 } else { 1.0 });
            let placed = Placed::new(baked, pose.translation, pose.rotation, pose.scale).unwrap();
            let (other_name, other, other_mesh, other_closed) = &bakes[random.0.usize(0..bakes.len())];
            let mut other_pose = random_pose(&mut random, 0.0);
            let reach = f64::from(baked.radius + other.radius);
            other_pose.translation = pose.translation + random.vector() * 0.7 * reach;
            let half_size = (random.vector().abs() + 0.1) * 0.5 * reach;
            let is_box = random.0.u8(0..3) == 0;
            let (shape, other_mesh, is_mixed, other_closed) = if is_box {
                other_pose.scale = (2.0 * half_size).as_vec3();
                (QueryShape::Box { half_size }, &cube, false, true)
            } else {
                let shape = QueryShape::Mesh(other, other_pose.scale);
                (shape, other_mesh, *other_name == "mixed", *other_closed)
            };
            let faces = triangles(mesh, &pose, pose.translation);
            let others = triangles(other_mesh, &other_pose, pose.translation);
            let expected = surfaces_cross(&faces, &others)
                || (*is_closed && contains(&faces, others[0][0], *name == "mixed"))
                || (other_closed && contains(&others, faces[0][0], is_mixed));
            let found = placed.overlaps(&shape, other_pose.translation, other_pose.rotation);
            assert_eq!(found, expected, "{name} {other_name} {round} {is_box}");
            if expected {
                touching += 1;
            } else {
                apart += 1;
            }
        }
    }
    assert!(touching > 200 && apart > 150, "{touching} {apart}");
}

#[test]
fn degenerate_shapes_have_the_documented_answers() {
    let cube = CollisionMesh::new(&shapes::cube(2.0));
    let placed = Placed::new(&cube, DVec3::ZERO, DQuat::IDENTITY, Vec3::ONE).unwrap();
    let overlaps = |shape: QueryShape, at: DVec3| placed.overlaps(&shape, at, DQuat::IDENTITY);
    let out = DVec3::new(3.0, 0.2, 0.1);
    for radius in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(!overlaps(QueryShape::Ball { radius }, DVec3::ZERO));
        let half_length = 1.0;
        assert!(!overlaps(QueryShape::Capsule { radius, half_length }, DVec3::ZERO));
        let (radius, half_length) = (1.0, radius);
        assert!(!overlaps(QueryShape::Capsule { radius, half_length }, DVec3::ZERO));
    }
    for half_size in [
        DVec3::ZERO,
        DVec3::NEG_ONE,
        DVec3::NAN,
        DVec3::INFINITY,
        DVec3::new(1.0, 0.0, 1.0),
    ] {
        assert!(!overlaps(QueryShape::Box { half_size }, DVec3::ZERO), "{half_size}");
    }
    for scale in [Vec3::ZERO, Vec3::NAN, Vec3::new(1.0, 0.0, 1.0)] {
        assert!(!overlaps(QueryShape::Mesh(&cube, scale), DVec3::ZERO), "{scale}");
    }
    let valid = [
        QueryShape::Mesh(&cube, Vec3::ONE),
        QueryShape::Ball { radius: 1.0 },
        QueryShape::Capsule {
            radius: 1.0,
            half_length: 1.0,
        },
        QueryShape::Box { half_size: DVec3::ONE },
    ];
    for shape in valid {
        for at in [DVec3::NAN, DVec3::INFINITY, DVec3::splat(1e200)] {
            assert!(!overlaps(shape, at), "{shape:?}");
        }
        for rotation in [DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0), DQuat::NAN] {
            assert!(!placed.overlaps(&shape, DVec3::ZERO, rotation), "{shape:?}");
        }
        // Touching counts.
        assert!(
            overlaps(shape, DVec3::X * 2.0) && !overlaps(shape, DVec3::X * 2.000001),
            "{shape:?}"
        );
        let [low, high] = shape.bounding_box(out, DQuat::IDENTITY).unwrap();
        let half = DVec3::new(
            1.0,
            if matches!(shape, QueryShape::Capsule { .. }) {
                2.0
            } else {
                1.0
            },
            1.0,
        );
        assert!(low.distance(out - half) < 1e-12 && high.distance(out + half) < 1e-12);
    }
    // A point inside, and things within each other.
    assert!(overlaps(QueryShape::Ball { radius: 0.0 }, DVec3::splat(0.5)));
    assert!(!overlaps(QueryShape::Ball { radius: 0.0 }, out));
    assert!(overlaps(QueryShape::Ball { radius: 100.0 }, out));
    assert!(overlaps(
        QueryShape::Box {
            half_size: DVec3::splat(0.1)
        },
        DVec3::ZERO
    ));
    assert!(overlaps(
        QueryShape::Box {
            half_size: DVec3::splat(100.0)
        },
        DVec3::ZERO
    ));
    let room = CollisionMesh::new(&room(2.0));
    let room = Placed::new(&room, DVec3::ZERO, DQuat::IDENTITY, Vec3::ONE).unwrap();
    for shape in [
        QueryShape::Ball { radius: 0.5 },
        QueryShape::Box {
            half_size: DVec3::splat(0.1),
        },
    ] {
        assert!(!room.overlaps(&shape, DVec3::ZERO, DQuat::IDENTITY));
    }
}
