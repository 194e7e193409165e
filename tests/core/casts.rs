//! Casts of shapes against every pair of features, in double precision.

use crate::support::{
    Pose, Random, contains, hills, mixed, nearest_on_triangle, open_torus, random_pose, room, segment_distance,
    surfaces_cross, triangles,
};
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::queries::{CastHit, CastScratch, Placed, QueryShape};
use glam::{DMat3, DQuat, DVec3, Vec3};
use std::collections::BTreeSet;

/// A mesh of at most 300 triangles.
struct Case {
    name: &'static str,
    mesh: TriMesh,
    baked: CollisionMesh,
    is_closed: bool,
}

fn cases() -> Vec<Case> {
    let knot = shapes::torus_knot(2, 3, 48, 3, 0.5);
    let case = |name, mesh: TriMesh, is_closed| Case {
        name,
        baked: CollisionMesh::new(&mesh),
        mesh,
        is_closed,
    };
    vec![
        case("cube", shapes::cube(1.0), true),
        case("knot", knot, true),
        case("hills", hills(12), false),
        case("mixed", mixed(), true),
        case("open", open_torus(), false),
    ]
}

/// The features of a placed mesh.
struct Features {
    faces: Vec<[DVec3; 3]>,
    points: Vec<DVec3>,
    edges: Vec<[DVec3; 2]>,
}

impl Features {
    fn new(mesh: &TriMesh, pose: &Pose, origin: DVec3) -> Self {
        let faces = triangles(mesh, pose, origin);
        let corner = |v: u32| {
            let holds = |t: &[u32; 3]| t.iter().position(|&w| w == v);
            let mut found = mesh.triangles().iter().zip(&faces);
            found.find_map(|(t, face)| Some(face[holds(t)?])).unwrap()
        };
        let points: BTreeSet<u32> = mesh.triangles().iter().flatten().copied().collect();
        let ends = |t: &[u32; 3]| [0, 1, 2].map(|k| (t[k].min(t[(k + 1) % 3]), t[k].max(t[(k + 1) % 3])));
        let edges: BTreeSet<(u32, u32)> = mesh.triangles().iter().flat_map(ends).collect();
        Self {
            points: points.into_iter().map(corner).collect(),
            edges: edges.into_iter().map(|(a, b)| [corner(a), corner(b)]).collect(),
            faces,
        }
    }

    fn of_face(face: [DVec3; 3]) -> Self {
        let [a, b, c] = face;
        Self {
            faces: vec![face],
            points: face.to_vec(),
            edges: vec![[a, b], [b, c], [c, a]],
        }
    }
}

/// The first time at which features of a moving mesh meet those of a resting one. `slack` enlarges them.
fn brute(resting: &Features, moving: &Features, way: DVec3, slack: f64) -> f64 {
    let mut first = f64::INFINITY;
    let range = -slack..=1.0 + slack;
    // Moeller and Trumbore.
    let mut corners = |points: &[DVec3], faces: &[[DVec3; 3]], way: DVec3| {
        for [a, b, c] in faces {
            let (e, f) = (b - a, c - a);
            let p = way.cross(f);
            let determinant = e.dot(p);
            if determinant.abs() < 1e-12 * e.length() * f.length() {
                continue;
            }
            for point in points {
                let t = point - a;
                let u = t.dot(p) / determinant;
                let q = t.cross(e);
                let (v, distance) = (way.dot(q) / determinant, f.dot(q) / determinant);
                let inside = u >= -slack && v >= -slack && u + v <= 1.0 + slack;
                if inside && distance > -1e-7 && distance < first {
                    first = distance;
                }
            }
        }
    };
    corners(&moving.points, &resting.faces, way);
    corners(&resting.points, &moving.faces, -way);
    for [a, a_end] in &resting.edges {
        for [b, b_end] in &moving.edges {
            // b + s u + t way = a + r v, after Cramer.
            let columns = DMat3::from_cols(b_end - b, way, a - a_end);
            let (determinant, target) = (columns.determinant(), a - b);
            if determinant.abs() < 1e-12 * columns.x_axis.length() * columns.z_axis.length() {
                continue;
            }
            let with = |k: usize| {
                let mut columns = columns;
                *columns.col_mut(k) = target;
                columns.determinant() / determinant
            };
            let time = with(1);
            if time > -1e-7 && time < first && range.contains(&with(0)) && range.contains(&with(2)) {
                first = time;
            }
        }
    }
    first
}

fn random_way(random: &mut Random, from: DVec3, to: DVec3) -> DVec3 {
    let aim = to - from;
    if aim.length() > 1e-3 && random.0.u8(0..8) != 0 {
        aim * (0.1 + random.0.f64())
    } else {
        random.direction()
    }
}

#[test]
fn meshes_and_boxes_stop_where_their_features_first_meet() {
    let mut random = Random::new(31);
    let mut scratch = CastScratch::default();
    let cases = cases();
    let cube = shapes::cube(1.0);
    let (mut hits, mut misses, mut starts) = (0, 0, 0);
    for round in 0..2000 {
        let case = &cases[round % cases.len()];
        let other = &cases[random.0.usize(0..cases.len())];
        let pose = random_pose(&mut random, if round % 16 == 15 { 1e5 } else { 1.0 });
        let mut other_pose = random_pose(&mut random, 0.0);
        let size = f64::from(case.baked.radius + other.baked.radius);
        let far = if round % 50 == 49 { 1000.0 } else { 1.0 };
        other_pose.translation = pose.translation + random.direction() * size * far * (0.4 + 1.2 * random.0.f64());
        let is_box = random.0.u8(0..4) == 0;
        let half_size = (random.vector().abs() + 0.1) * 0.3 * size;
        let (shape, other_mesh) = if is_box {
            other_pose.scale = (2.0 * half_size).as_vec3();
            (QueryShape::Box { half_size }, &cube)
        } else {
            (QueryShape::Mesh(&other.baked, other_pose.scale), &other.mesh)
        };
        let aim = pose.translation + random.vector() * 0.5 * f64::from(case.baked.radius);
        let direction = random_way(&mut random, other_pose.translation, aim);
        let way = direction.normalize();
        let max_distance = if random.0.bool() {
            f64::INFINITY
        } else {
            random.0.f64() * 2.0 * size * far
        };
        let placed = Placed::new(&case.baked, pose.translation, pose.rotation, pose.scale).unwrap();
        let Pose {
            translation, rotation, ..
        } = other_pose;
        let hit = placed.cast(&shape, translation, rotation, direction, max_distance, &mut scratch);
        let name = format!("{round}: {} {} {hit:?}", case.name, other.name);

        let resting = Features::new(&case.mesh, &pose, pose.translation);
        let moving = Features::new(other_mesh, &other_pose, pose.translation);
        let is_mixed = |name: &str| name == "mixed";
        let overlaps = surfaces_cross(&resting.faces, &moving.faces)
            || (case.is_closed && contains(&resting.faces, moving.points[0], is_mixed(case.name)))
            || ((is_box || other.is_closed)
                && contains(&moving.faces, resting.points[0], !is_box && is_mixed(other.name)));
        if overlaps {
            starts += 1;
            assert_eq!(hit.unwrap().distance, 0.0, "{name}");
            continue;
        }
        let tolerance = 1e-8 * size * far.sqrt();
        let [wide, narrow] = [1e-7, -1e-7].map(|slack| brute(&resting, &moving, way, slack));
        let Some(hit) = hit else {
            misses += 1;
            assert!(narrow >= max_distance - tolerance, "{name} {narrow}");
            continue;
        };
        hits += 1;
        let CastHit {
            distance,
            face,
            shape_face,
            ..
        } = hit;
        assert!(
            distance <= max_distance && distance <= narrow + tolerance,
            "{name} {narrow}"
        );
        assert!(distance >= wide - tolerance, "{name} {wide}");
        let normal = hit.normal.as_dvec3();
        assert!((normal.length() - 1.0).abs() < 1e-6 && normal.dot(way) < 1e-6, "{name}");
        // The faces touch there, and at the point.
        let on_face = resting.faces[face as usize];
        let point = hit.point - pose.translation;
        assert!(
            nearest_on_triangle(point, &on_face).distance(point) < tolerance + 1e-10,
            "{name}"
        );
        assert_eq!(shape_face.is_some(), !is_box);
        if let Some(moved) = shape_face {
            let moved = moving.faces[moved as usize];
            let pair = brute(&Features::of_face(on_face), &Features::of_face(moved), way, 1e-7);
            assert!((pair - distance).abs() < tolerance, "{name} {pair}");
            let moved = moved.map(|p| p + way * distance);
            assert!(
                nearest_on_triangle(point, &moved).distance(point) < 10.0 * tolerance,
                "{name}"
            );
        }
        // It does not end in an overlap, and a little farther it would.
        let step = 1e-5 * size;
        let at = |distance: f64| placed.overlaps(&shape, translation + way * distance, rotation);
        if distance > step {
            assert!(!at(distance - step), "{name}");
        }
        if normal.dot(way) < -0.1 && far == 1.0 {
            assert!(at(distance + step), "{name}");
        }
    }
    assert!(hits > 900 && misses > 200 && starts > 100, "{hits} {misses} {starts}");
}

#[test]
fn balls_and_capsules_stop_at_their_radius_from_the_mesh() {
    let mut random = Random::new(32);
    let mut scratch = CastScratch::default();
    let cases = cases();
    let (mut hits, mut misses, mut starts) = (0, 0, 0);
    for round in 0..2000 {
        let case = &cases[round % cases.len()];
        let pose = random_pose(&mut random, if round % 16 == 15 { 1e5 } else { 1.0 });
        let size = f64::from(case.baked.radius);
        let placed = Placed::new(&case.baked, pose.translation, pose.rotation, pose.scale).unwrap();
        let faces = triangles(&case.mesh, &pose, pose.translation);
        let radius = if round % 7 == 0 {
            0.0
        } else {
            random.0.f64() * 0.4 * size
        };
        let half_length = if random.0.bool() {
            0.0
        } else {
            random.0.f64() * 0.5 * size
        };
        let shape = if half_length == 0.0 {
            QueryShape::Ball { radius }
        } else {
            QueryShape::Capsule { radius, half_length }
        };
        let (translation, rotation) = (
            pose.translation + random.direction() * size * (0.5 + 2.0 * random.0.f64()),
            random.rotation(),
        );
        let aim = pose.translation + random.vector() * 0.6 * size;
        let direction = random_way(&mut random, translation, aim);
        let way = direction.normalize();
        let axis = rotation.normalize() * DVec3::Y * half_length;
        let ends = [-axis, axis].map(|end| translation - pose.translation + end);
        let hit = placed.cast(&shape, translation, rotation, direction, 5.0 * size, &mut scratch);
        let name = format!("{round}: {} {shape:?} {hit:?}", case.name);
        let gap = |distance: f64| {
            let [p, q] = ends.map(|end| end + way * distance);
            let distances = faces.iter().map(|t| segment_distance(p, q, t));
            distances.fold(f64::INFINITY, f64::min) - radius
        };
        if gap(0.0) <= 0.0 || (case.is_closed && contains(&faces, ends[0], case.name == "mixed")) {
            starts += 1;
            assert_eq!(hit.unwrap().distance, 0.0, "{name}");
            continue;
        }
        // Steps of the gap never pass a touch.
        let tolerance = 1e-8 * size;
        let (mut traced, mut left) = (0.0, gap(0.0));
        for _ in 0..200 {
            if left < tolerance || traced > 5.0 * size {
                break;
            }
            traced += left;
            left = gap(traced);
        }
        let Some(hit) = hit else {
            misses += 1;
            assert!(left >= tolerance || traced > 5.0 * size - tolerance, "{name} {traced}");
            continue;
        };
        hits += 1;
        assert!(hit.distance >= traced - tolerance, "{name} {traced}");
        assert!(gap(hit.distance).abs() < tolerance, "{name} {}", gap(hit.distance));
        let cosine = -hit.normal.as_dvec3().dot(way);
        assert!(cosine > -1e-6, "{name}");
        if left < tolerance && cosine > 0.05 {
            assert!(hit.distance < traced + 40.0 * tolerance, "{name} {traced}");
        }
        let point = hit.point - pose.translation;
        let face = faces[hit.face as usize];
        assert!(nearest_on_triangle(point, &face).distance(point) < tolerance, "{name}");
        let [p, q] = ends.map(|end| end + way * hit.distance);
        assert!((segment_distance(p, q, &face) - radius).abs() < tolerance, "{name}");
        if radius > 0.05 * size {
            // From the point along the normal it is the radius to the segment.
            let center = point + hit.normal.as_dvec3() * radius;
            let along = if p == q {
                p
            } else {
                crate::support::nearest_on_segment(center, p, q)
            };
            assert!(center.distance(along) < 1e-6 * size, "{name}");
        }
    }
    assert!(hits > 1000 && misses > 150 && starts > 100, "{hits} {misses} {starts}");
}

#[test]
fn degenerate_casts_have_the_documented_answers() {
    let mut scratch = CastScratch::default();
    let cube = CollisionMesh::new(&shapes::cube(2.0));
    let placed = Placed::new(&cube, DVec3::ZERO, DQuat::IDENTITY, Vec3::ONE).unwrap();
    let out = DVec3::X * 4.0;
    let valid = [
        QueryShape::Mesh(&cube, Vec3::splat(0.5)),
        QueryShape::Ball { radius: 0.5 },
        QueryShape::Capsule {
            radius: 0.5,
            half_length: 0.25,
        },
        QueryShape::Box {
            half_size: DVec3::splat(0.5),
        },
    ];
    let mut cast = |mesh: &Placed, shape: &QueryShape, at: DVec3, direction: DVec3, max_distance: f64| {
        mesh.cast(shape, at, DQuat::IDENTITY, direction, max_distance, &mut scratch)
    };
    for shape in &valid {
        for direction in [DVec3::ZERO, DVec3::NAN, DVec3::new(f64::INFINITY, 0.0, 0.0)] {
            assert_eq!(cast(&placed, shape, out, direction, 10.0), None, "{shape:?}");
        }
        for max_distance in [-1.0, f64::NAN, 2.499] {
            assert_eq!(cast(&placed, shape, out, DVec3::NEG_X, max_distance), None, "{shape:?}");
        }
        for at in [DVec3::NAN, DVec3::INFINITY, DVec3::splat(1e200)] {
            assert_eq!(cast(&placed, shape, at, DVec3::NEG_X, 10.0), None, "{shape:?}");
        }
        // Any length of the direction, and any distance.
        for (length, max_distance) in [(1e-200, 2.500001), (1.0, f64::INFINITY), (1e200, 1e300)] {
            let hit = cast(&placed, shape, out, DVec3::NEG_X * length, max_distance).unwrap();
            assert!((hit.distance - 2.5).abs() < 1e-12, "{shape:?} {hit:?}");
            assert!(
                hit.normal.distance(Vec3::X) < 1e-6 && hit.point.x == 1.0,
                "{shape:?} {hit:?}"
            );
            assert_eq!(hit.shape_face.is_some(), matches!(shape, QueryShape::Mesh(..)));
        }
        let far = cast(&placed, shape, DVec3::X * 1e8, DVec3::NEG_X, f64::INFINITY).unwrap();
        assert!((far.distance - (1e8 - 1.5)).abs() < 1e-6, "{shape:?} {far:?}");
        assert_eq!(cast(&placed, shape, out, DVec3::X, f64::INFINITY), None);
        assert_eq!(
            cast(&placed, shape, out, DVec3::new(-1.0, 1.0, 0.0), f64::INFINITY),
            None
        );
        // In an overlap, also for a way out, and inside.
        for (at, direction) in [(DVec3::X * 1.4, DVec3::X), (DVec3::X * 0.1, DVec3::NEG_X)] {
            let hit = cast(&placed, shape, at, direction, 0.0).unwrap();
            assert_eq!((hit.distance, hit.shape_face), (0.0, None));
            assert!(
                hit.normal.distance(Vec3::X) < 1e-6 && hit.point.x == 1.0,
                "{shape:?} {hit:?}"
            );
        }
        // A shape that stands on the floor touches it. A little above it slides, and leaves.
        let half = if matches!(shape, QueryShape::Capsule { .. }) {
            0.75
        } else {
            0.5
        };
        let on = DVec3::new(-0.2, 1.0 + half, 0.1);
        for direction in [DVec3::X, DVec3::Y, DVec3::NEG_Y] {
            let hit = cast(&placed, shape, on, direction, 1.0).unwrap();
            assert_eq!(hit.distance, 0.0);
            assert!(hit.normal.distance(Vec3::Y) < 1e-6);
            let above = cast(&placed, shape, on + DVec3::Y * 1e-6, direction, 1.0);
            assert_eq!(above.is_some(), direction == DVec3::NEG_Y, "{shape:?} {above:?}");
        }
        // Inside a room it hits the walls.
        let room = CollisionMesh::new(&room(8.0));
        let room = Placed::new(&room, DVec3::ZERO, DQuat::IDENTITY, Vec3::ONE).unwrap();
        let hit = cast(&room, shape, DVec3::X, DVec3::X, f64::INFINITY).unwrap();
        assert!((hit.distance - 2.5).abs() < 1e-12 && hit.normal.distance(Vec3::NEG_X) < 1e-6);
    }
    // A point that moves is a ray.
    let hit = cast(&placed, &QueryShape::Ball { radius: 0.0 }, out, DVec3::NEG_X, 10.0).unwrap();
    assert!((hit.distance - 3.0).abs() < 1e-12 && hit.normal == Vec3::X);
    // A flat fall onto two triangles, obliquely.
    let way = DVec3::new(0.3, -1.0, 0.2);
    let hit = cast(&placed, &valid[3], DVec3::Y * 3.0, way, 10.0).unwrap();
    assert!(
        (hit.distance - 1.5 * way.length()).abs() < 1e-12 && hit.normal.distance(Vec3::Y) < 1e-6,
        "{hit:?}"
    );
}
