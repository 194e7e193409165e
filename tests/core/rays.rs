//! Rays against every triangle, in double precision.

use crate::support::{Pose, Random, hills, mixed, triangles};
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::queries::{Placed, Ray, RayHit};
use glam::{DQuat, DVec3, Vec3};

fn meshes() -> [(&'static str, TriMesh); 5] {
    [
        ("cube", shapes::cube(1.0)),
        ("knot", shapes::knot_1120()),
        ("ball", shapes::ball(0.7, 3)),
        ("hills", hills(40)),
        ("mixed", mixed()),
    ]
}

/// The meeting of the line of a ray and the plane of a face, after Moeller and Trumbore.
struct Meeting {
    distance: f64,
    face: u32,
    /// The least barycentric coordinate, and the distance if that is less: negative outside the face or behind the
    /// start.
    inside: f64,
}

/// The faces that a ray from `start` hits or nearly hits.
fn brute(triangles: &[[DVec3; 3]], start: DVec3, ray: &Ray) -> Vec<Meeting> {
    let way = ray.direction.normalize();
    let mut hits = Vec::new();
    for (face, [a, b, c]) in (0..).zip(triangles) {
        let (e, f) = (b - a, c - a);
        let p = way.cross(f);
        let determinant = e.dot(p);
        if determinant.abs() < 1e-30 {
            continue;
        }
        let t = start - a;
        let u = t.dot(p) / determinant;
        if !(-1e-7..=1.0 + 1e-7).contains(&u) {
            continue;
        }
        let q = t.cross(e);
        let v = way.dot(q) / determinant;
        let distance = f.dot(q) / determinant;
        let inside = u.min(v).min(1.0 - u - v).min(distance);
        if inside >= -1e-7 && distance <= ray.max_distance {
            hits.push(Meeting { distance, face, inside });
        }
    }
    hits.sort_by(|a, b| a.distance.total_cmp(&b.distance));
    hits
}

fn check(hit: &RayHit, mesh: &TriMesh, pose: (DVec3, DQuat, DVec3), ray: &Ray) {
    let (translation, rotation, scale) = pose;
    let [a, b, c] = mesh
        .corners(hit.face as usize)
        .map(|p| rotation * (scale * p.as_dvec3()) + translation);
    let size = (b - a).length() + (c - a).length();
    let weights = hit.barycentric.as_dvec3();
    // The weights are in single precision, and the corners may be far from the origin.
    let there = a + (b - a) * weights.y + (c - a) * weights.z;
    assert!(there.distance(hit.point) < 1e-6 * size + 1e-9 * hit.distance);
    assert!((weights.element_sum() - 1.0).abs() < 1e-6);
    let way = ray.direction.normalize();
    assert!((ray.origin + way * hit.distance).distance(hit.point) < 1e-12 + 1e-12 * hit.distance);
    let normal = hit.normal.as_dvec3();
    assert!((normal.length() - 1.0).abs() < 1e-5 && normal.dot(way) <= 0.0);
    for edge in [b - a, c - a] {
        assert!(normal.dot(edge).abs() < 1e-5 * edge.length());
    }
}

#[test]
fn rays_hit_the_face_that_a_test_of_all_faces_finds() {
    let mut random = Random::new(5);
    let (mut hits, mut misses) = (0, 0);
    for (name, mesh) in meshes() {
        let baked = CollisionMesh::new(&mesh);
        for round in 0..40 {
            let mut scale = DVec3::splat(1.0);
            if round % 2 == 1 {
                scale = DVec3::new(0.3, 1.7, 1.0) * if round % 4 == 1 { 1.0 } else { -1.0 };
            }
            let far = if round % 8 == 7 { 1e5 } else { 1.0 };
            let pose = (random.vector() * far, random.rotation(), scale);
            let placed = Placed::new(&baked, pose.0, pose.1, scale.as_vec3()).unwrap();
            let pose = (pose.0, pose.1, scale.as_vec3().as_dvec3());
            let faces = triangles(
                &mesh,
                &Pose {
                    translation: pose.0,
                    rotation: pose.1,
                    scale: scale.as_vec3(),
                },
                pose.0,
            );
            for _ in 0..250 {
                let size = f64::from(baked.radius);
                let origin = pose.0 + random.vector() * size * if random.0.bool() { 4.0 } else { 0.5 };
                let aim = pose.0 + random.vector() * size * 0.7;
                let mut ray = Ray::new(origin, (aim - origin) * (0.1 + random.0.f64()));
                if random.0.u8(0..4) == 0 {
                    ray.max_distance = random.0.f64() * 4.0 * size;
                }
                let hit = placed.cast_ray(&ray);
                let all = placed.ray_hits(&ray);
                assert_eq!(placed.hits_ray(&ray), hit.is_some());
                assert_eq!(all.first(), hit.as_ref(), "{name}");
                let tolerance = 1e-9 * (size + far);
                let near = brute(&faces, ray.origin - pose.0, &ray);
                let surely = || near.iter().filter(|meeting| meeting.inside > 1e-7);
                // All faces that are surely hit, and none that surely is not.
                for Meeting { face, .. } in surely() {
                    assert!(all.iter().any(|hit| hit.face == *face), "{name}: face {face}");
                }
                for hit in &all {
                    check(hit, &mesh, pose, &ray);
                    let same = near.iter().find(|meeting| meeting.face == hit.face);
                    let same = same.expect("a hit of all faces").distance;
                    assert!((same - hit.distance).abs() < tolerance, "{name}: {same} {hit:?}");
                }
                match (hit, surely().next()) {
                    (Some(hit), Some(first)) => {
                        hits += 1;
                        assert!(hit.distance < first.distance + tolerance);
                    }
                    (None, Some(first)) => panic!("{name}: missed face {}", first.face),
                    _ => misses += 1,
                }
            }
        }
    }
    assert!(hits > 12_500 && misses > 5000, "{hits} {misses}");
}

#[test]
fn no_ray_slips_through_an_edge_or_a_corner() {
    let mut random = Random::new(7);
    for (name, mesh) in meshes().into_iter().filter(|(name, _)| *name != "hills") {
        let baked = CollisionMesh::new(&mesh);
        let rotation = random.rotation();
        let placed = Placed::new(&baked, DVec3::ZERO, rotation, Vec3::ONE).unwrap();
        for t in mesh.triangles().iter().take(400) {
            let [a, b] = [t[0], t[1]].map(|v| rotation * mesh.vertices()[v as usize].as_dvec3());
            for aim in [a, 0.5 * (a + b)] {
                let origin = random.vector().normalize() * 5.0;
                let ray = Ray::new(origin, aim - origin);
                let hit = placed.cast_ray(&ray).unwrap_or_else(|| panic!("{name}: {ray:?}"));
                assert!(hit.distance <= aim.distance(origin) + 1e-6, "{name}: {hit:?}");
            }
        }
    }
}

#[test]
fn degenerate_rays_have_the_documented_answers() {
    let cube = CollisionMesh::new(&shapes::cube(2.0));
    let placed = Placed::new(&cube, DVec3::ZERO, DQuat::IDENTITY, Vec3::ONE).unwrap();
    let out = DVec3::new(3.0, 0.2, 0.1);
    for direction in [DVec3::ZERO, DVec3::NAN, DVec3::new(f64::INFINITY, 0.0, 0.0)] {
        assert_eq!(placed.cast_ray(&Ray::new(out, direction)), None);
    }
    assert_eq!(placed.cast_ray(&Ray::new(DVec3::NAN, DVec3::X)), None);
    for max_distance in [-1.0, f64::NAN] {
        let ray = Ray {
            max_distance,
            ..Ray::new(out, DVec3::NEG_X)
        };
        assert_eq!(placed.cast_ray(&ray), None);
    }
    // The length counts, the end included.
    for (max_distance, hits) in [(1.999, false), (2.0, true), (f64::INFINITY, true)] {
        let ray = Ray {
            max_distance,
            ..Ray::new(out, DVec3::NEG_X * 1e-9)
        };
        assert_eq!(placed.hits_ray(&ray), hits, "{max_distance}");
    }
    assert_eq!(placed.cast_ray(&Ray::between(out, DVec3::new(1.5, 0.2, 0.1))), None);
    let through = placed.ray_hits(&Ray::between(out, -out));
    assert_eq!(
        through.iter().map(|hit| hit.from_behind).collect::<Vec<_>>(),
        [false, true]
    );
    // From inside it hits the wall from behind, and from the wall at once.
    let inside = placed.cast_ray(&Ray::new(DVec3::new(0.0, 0.2, 0.1), DVec3::X)).unwrap();
    assert!(inside.from_behind && (inside.distance - 1.0).abs() < 1e-12);
    assert_eq!(inside.normal, Vec3::NEG_X);
    let on = placed.cast_ray(&Ray::new(DVec3::new(1.0, 0.2, 0.1), DVec3::X)).unwrap();
    assert_eq!(on.distance, 0.0);
    // A predicate looks behind the first face.
    let ray = Ray::new(out, DVec3::NEG_X);
    let behind = placed.cast_ray_predicate(&ray, |hit| hit.from_behind).unwrap();
    assert!((behind.distance - 4.0).abs() < 1e-12);
    assert_eq!(placed.cast_ray_predicate(&ray, |_| false), None);
}
