//! Nearest points against every triangle, in double precision.

use crate::support::{
    Pose, Random, hills, mixed, nearest_on_triangle, open_torus, room, segment_distance, triangles, winding,
};
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::queries::{Placed, Scene};
use glam::{DQuat, DVec3, Vec3};

#[test]
fn the_nearest_point_is_that_of_a_test_of_all_faces() {
    let mut random = Random::new(11);
    let (mut inside, mut outside, mut beyond) = (0, 0, 0);
    let meshes = [
        ("cube", shapes::cube(1.0), true),
        ("torus", shapes::torus_240(), true),
        ("knot", shapes::knot_1120(), true),
        ("hills", hills(20), false),
        ("mixed", mixed(), false),
        ("open", open_torus(), false),
    ];
    for (name, mesh, is_solid) in meshes {
        let baked = CollisionMesh::new(&mesh);
        for round in 0..50 {
            let far = if round % 8 == 7 { 1e5 } else { 1.0 };
            let pose = Pose {
                translation: random.vector() * far,
                rotation: random.rotation(),
                scale: random.scale(),
            };
            let placed = Placed::new(&baked, pose.translation, pose.rotation, pose.scale).unwrap();
            let faces = triangles(&mesh, &pose, pose.translation);
            let size = f64::from(baked.radius);
            let tolerance = 1e-12 * size + 1e-15 * far;
            for _ in 0..170 {
                let offset = random.vector() * size * if random.0.bool() { 3.0 } else { 0.7 };
                let point = pose.translation + offset;
                let offset = point - pose.translation;
                let distance = |t: &[DVec3; 3]| nearest_on_triangle(offset, t).distance(offset);
                let least = faces.iter().map(distance).fold(f64::INFINITY, f64::min);
                let winds = winding(offset, &faces).abs() > 0.5;
                let max_distance = if random.0.bool() {
                    f64::INFINITY
                } else {
                    random.0.f64() * size
                };
                let hit = placed.closest_point(point, max_distance);
                let is_inside = hit.is_some_and(|hit| hit.is_inside);
                if is_solid {
                    assert_eq!(is_inside, winds, "{name}: {offset}");
                } else if name != "mixed" {
                    assert!(!is_inside);
                }
                let Some(hit) = hit else {
                    assert!(least > max_distance - tolerance, "{name}: {least} {max_distance}");
                    beyond += 1;
                    continue;
                };
                let there = hit.point - pose.translation;
                assert!((there.distance(offset) - least).abs() < 2.0 * tolerance + 1e-10 * far.log10());
                assert!(distance(&faces[hit.face as usize]) <= least + tolerance, "{name}");
                let [a, b, c] = faces[hit.face as usize];
                let weights = hit.barycentric.as_dvec3();
                let weighted = a + (b - a) * weights.y + (c - a) * weights.z;
                assert!(weighted.distance(there) < 1e-6 * size + 1e-10 * far.log10());
                assert!((weights.element_sum() - 1.0).abs() < 1e-6 && weights.min_element() > -1e-6);
                let way = (offset - nearest_on_triangle(offset, &[a, b, c])) * if is_inside { -1.0 } else { 1.0 };
                if least > 1e-6 * size {
                    assert!(hit.normal.as_dvec3().distance(way.normalize()) < 1e-6, "{name}");
                }
                if is_inside {
                    inside += 1;
                    assert_eq!(hit.distance, 0.0);
                } else {
                    outside += 1;
                    assert!((hit.distance - least).abs() < tolerance && hit.distance <= max_distance);
                }
            }
        }
    }
    assert!(
        inside > 3500 && outside > 20_000 && beyond > 5000,
        "{inside} {outside} {beyond}"
    );
}

#[test]
fn degenerate_points_have_the_documented_answers() {
    let cube = CollisionMesh::new(&shapes::cube(2.0));
    let placed = Placed::new(&cube, DVec3::ZERO, DQuat::IDENTITY, Vec3::ONE).unwrap();
    let out = DVec3::new(3.0, 0.2, 0.1);
    for max_distance in [f64::NAN, -1.0, f64::NEG_INFINITY, 1.999] {
        assert_eq!(placed.closest_point(out, max_distance), None);
    }
    for point in [DVec3::NAN, DVec3::INFINITY, DVec3::splat(1e19), DVec3::splat(1e300)] {
        assert_eq!(placed.closest_point(point, f64::INFINITY), None);
    }
    let hit = placed.closest_point(out, 2.0).unwrap();
    assert!(hit.distance == 2.0 && hit.normal.distance(Vec3::X) < 1e-6 && !hit.is_inside);
    assert!(hit.point.distance(DVec3::new(1.0, 0.2, 0.1)) < 1e-12);
    let far = placed.closest_point(DVec3::X * 1e17, f64::INFINITY).unwrap();
    assert!((far.distance - 1e17).abs() < 100.0);
    // Inside, any distance will do, and the normal still leads out.
    let inside = placed.closest_point(DVec3::new(0.9, 0.1, 0.2), 0.0).unwrap();
    assert!(inside.is_inside && inside.distance == 0.0 && inside.point.x == 1.0);
    assert!(inside.normal.distance(Vec3::X) < 1e-6);
    // On the surface it is the normal of the face.
    let on = placed.closest_point(DVec3::new(1.0, 0.1, 0.2), 1e-15).unwrap();
    assert!(on.distance < 1e-15 && on.normal == Vec3::X);
    let mirrored = Placed::new(&cube, DVec3::ZERO, DQuat::IDENTITY, Vec3::new(-1.0, 1.0, 1.0)).unwrap();
    let on = mirrored.closest_point(DVec3::new(1.0, 0.1, 0.2), 1e-15).unwrap();
    assert_eq!(on.normal, Vec3::X);
    // A room contains nothing.
    let room = CollisionMesh::new(&room(2.0));
    let room = Placed::new(&room, DVec3::ZERO, DQuat::IDENTITY, Vec3::ONE).unwrap();
    let hit = room.closest_point(DVec3::new(0.9, 0.1, 0.2), f64::INFINITY).unwrap();
    assert!(!hit.is_inside && (hit.distance - 0.1).abs() < 1e-12 && hit.normal.distance(Vec3::NEG_X) < 1e-6);
    assert_eq!(room.closest_point(DVec3::ZERO, 0.5), None);
}

#[test]
fn a_segment_beside_a_mesh_is_as_far_as_a_test_of_all_faces_says() {
    let mut random = Random::new(17);
    let (mut beside, mut overlaps) = (0, 0);
    for (mesh, is_solid) in [
        (shapes::cube(1.0), true),
        (shapes::torus_240(), true),
        (shapes::knot_1120(), true),
        (hills(20), false),
    ] {
        let baked = CollisionMesh::new(&mesh);
        for _ in 0..20 {
            let pose = Pose {
                translation: random.vector(),
                rotation: random.rotation(),
                scale: random.scale(),
            };
            let placed = Placed::new(&baked, pose.translation, pose.rotation, pose.scale).unwrap();
            let faces = triangles(&mesh, &pose, DVec3::ZERO);
            let size = f64::from(baked.radius);
            for _ in 0..50 {
                let [p, way] = [2.0, 0.6].map(|length| random.vector() * length * size);
                let (p, q) = (pose.translation + p, pose.translation + p + way);
                let distances = faces.iter().map(|face| segment_distance(p, q, face));
                let least = distances.fold(f64::INFINITY, f64::min);
                let hit = placed.closest_to_segment([p, q], f64::INFINITY).unwrap();
                let is_inside = is_solid && winding(p, &faces).abs() > 0.5;
                if least < 1e-12 || is_inside {
                    assert!(hit.distance <= 0.0, "{hit:?}");
                    overlaps += 1;
                    continue;
                }
                assert!((hit.distance - least).abs() < 1e-9 * size, "{hit:?} {least}");
                assert!(segment_distance(p, q, &faces[hit.face as usize]) < least + 1e-9 * size);
                // It is as far from the point of the surface, along the normal.
                let from = hit.point + hit.normal.as_dvec3() * hit.distance;
                let nearest = p + way * ((from - p).dot(way) / way.length_squared()).clamp(0.0, 1.0);
                assert!(nearest.distance(from) < 1e-6 * size);
                assert_eq!(placed.closest_to_segment([p, q], 0.999 * least), None);
                beside += 1;
            }
        }
    }
    assert!(beside > 1000 && overlaps > 50, "{beside} {overlaps}");
    let cube = CollisionMesh::new(&shapes::cube(1.0));
    let placed = Placed::new(&cube, DVec3::ZERO, DQuat::IDENTITY, Vec3::ONE).unwrap();
    // Through a wall and out again: it comes out over the nearest face of the part inside.
    let through = [DVec3::new(-2.0, 0.4, 0.0), DVec3::new(0.9, 0.4, 0.0)];
    let hit = placed.closest_to_segment(through, 1.0).unwrap();
    assert!((hit.distance + 0.1).abs() < 1e-9 && hit.normal == Vec3::Y);
    for ends in [[DVec3::NAN; 2], [DVec3::splat(1e19); 2]] {
        assert_eq!(placed.closest_to_segment(ends, f64::INFINITY), None);
    }
    assert_eq!(placed.closest_to_segment(through, -1.0), None);
}

/// However far away the point is, beside the scene and across from it.
#[test]
fn the_nearest_mesh_of_a_scene_is_that_of_a_test_of_all_meshes() {
    let mut random = Random::new(13);
    let meshes = [shapes::cube(1.0), shapes::torus_240(), open_torus()].map(|mesh| CollisionMesh::new(&mesh));
    let (mut near, mut beyond) = (0, 0);
    for round in 0..60 {
        let mut scene = Scene::default();
        for number in 0..[2, 3, 40][round % 3] {
            let (translation, rotation) = (random.vector() * 20.0, random.rotation());
            let scale = random.scale();
            scene
                .add_mesh(&meshes[number % 3], translation, rotation, scale)
                .unwrap();
        }
        for away in [1.0, 3.0, 10.0, 1e2, 1e3, 1e5, 1e7] {
            for _ in 0..20 {
                let point = random.vector().normalize() * 20.0 * away;
                let to_each = (0..scene.len()).filter_map(|number| {
                    let hit = scene.placed(number)?.closest_point(point, f64::INFINITY)?;
                    Some(hit.distance)
                });
                let least = to_each.fold(f64::INFINITY, f64::min);
                let hit = scene.closest_point(point, f64::INFINITY, |_| true).unwrap();
                assert_eq!(hit.distance, least, "from {point}");
                let within = scene.closest_point(point, least, |_| true);
                assert_eq!(within.map(|hit| hit.distance), Some(least), "from {point}");
                let most = least * (1.0 - 1e-9) - 1e-9;
                if most > 0.0 {
                    assert!(scene.closest_point(point, most, |_| true).is_none());
                    beyond += 1;
                }
                near += 1;
            }
        }
    }
    assert!(near == 8400 && beyond > 8000, "{near} {beyond}");
}
