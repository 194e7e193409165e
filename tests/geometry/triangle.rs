//! `geometry::triangle::intersect` against exact predicates.

use crate::oracle::data;
use crate::oracle::lattice::{self, all_triangles};
use crate::oracle::margin::{margin, point_to_triangle};
use crate::oracle::parallel;
use crate::oracle::tritri::{Triangle, coplanar, degenerate, edge_meets, general_position, meet, side};
use bevy_faceoff::geometry::triangle::{Intersection, intersect};
use glam::DVec3;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// A disagreement or an error of a segment's end below this part of the pair's size is rounding.
const ROUNDING: f64 = 1e-9;

fn size(a: &Triangle, b: &Triangle) -> f64 {
    let points = || a.iter().chain(b);
    points()
        .flat_map(|p| points().map(|q| p.distance(*q)))
        .fold(0.0, f64::max)
}

/// The verdict is right, and what is returned with it fits the triangles.
fn right(a: &Triangle, b: &Triangle, allowed_margin: f64) -> Result<(), TestCaseError> {
    let found = intersect(a, b);
    if found.is_some() != meet(a, b) {
        let margin = margin(a, b);
        prop_assert!(margin < allowed_margin, "{found:?} with margin {margin:e}: {a:?} {b:?}");
        return Ok(());
    }
    let Some(found) = found else { return Ok(()) };
    for end in [found.start, found.end] {
        for t in [a, b] {
            let off = point_to_triangle(end, t);
            prop_assert!(
                off <= ROUNDING * size(a, b),
                "{found:?} has an end {off:e} off: {a:?} {b:?}"
            );
        }
    }
    Ok(())
}

/// The two ends of the common segment of triangles in general position: where edges pierce the other triangle.
fn segment(a: &Triangle, b: &Triangle) -> [DVec3; 2] {
    let mut ends = vec![];
    for (s, t) in [(a, b), (b, a)] {
        for i in 0..3 {
            let [p, q] = [s[i], s[(i + 1) % 3]];
            let sides = [side(t, p), side(t, q)];
            if edge_meets([p, q], sides, t) {
                ends.push(p + (q - p) * (sides[0] / (sides[0] - sides[1])));
            }
        }
    }
    // In general position two edges pierce; an edge through an edge pierces twice, so take the farthest two.
    let pairs = ends.iter().flat_map(|&p| ends.iter().map(move |&q| [p, q]));
    pairs
        .max_by(|x, y| x[0].distance(x[1]).total_cmp(&y[0].distance(y[1])))
        .unwrap()
}

fn any_point() -> impl Strategy<Value = DVec3> {
    (-1.0..1.0, -1.0..1.0, -1.0..1.0).prop_map(|(x, y, z)| DVec3::new(x, y, z))
}

fn any_triangle() -> impl Strategy<Value = Triangle> {
    [any_point(), any_point(), any_point()].prop_filter("has an area", |t| {
        let [e, f] = [t[1] - t[0], t[2] - t[0]];
        e.cross(f).length() > 1e-3 * e.length() * f.length()
    })
}

fn lattice_triangle(n: i32) -> impl Strategy<Value = Triangle> {
    let point = (-n..=n, -n..=n, -n..=n).prop_map(|(x, y, z)| DVec3::new(x.into(), y.into(), z.into()));
    [point.clone(), point.clone(), point].prop_filter("has an area", |t| !degenerate(t))
}

/// A second triangle that shares something with the first: corners, or points of its plane, or nothing.
fn lattice_pair(n: i32) -> impl Strategy<Value = [Triangle; 2]> {
    let weights = [(-2..=3i32, -2..=3i32), (-2..=3, -2..=3), (-2..=3, -2..=3)];
    (lattice_triangle(n), lattice_triangle(n), weights, 0..8u8)
        .prop_map(|(a, mut b, weights, shared)| {
            for (i, (u, v)) in weights.into_iter().enumerate() {
                if shared >> i & 1 == 1 {
                    b[i] = a[0] + (a[1] - a[0]) * f64::from(u) + (a[2] - a[0]) * f64::from(v);
                }
            }
            [a, b]
        })
        .prop_filter("has an area", |[_, b]| !degenerate(b))
}

/// Fixed cases, so that a failure comes back.
fn config() -> ProptestConfig {
    ProptestConfig {
        cases: 20_000,
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(1),
        ..ProptestConfig::default()
    }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn random_triangles(a in any_triangle(), b in any_triangle(), scale in -6..6i32, shift in any_point()) {
        // From small and near to a thousand sizes away.
        let place = |t: &Triangle| t.map(|p| (p + shift) * 10f64.powi(scale));
        let [a, b] = [place(&a), place(&b)];
        right(&a, &b, ROUNDING * size(&a, &b))?;
    }

    #[test]
    fn far_triangles(a in any_triangle(), b in any_triangle(), shift in any_point()) {
        // Moving far away rounds the corners, to the same values for both sides of the comparison.
        let far = |t: &Triangle| t.map(|p| p + shift * 1e4);
        let [a, b] = [far(&a), far(&b)];
        right(&a, &b, ROUNDING * size(&a, &b))?;
    }

    #[test]
    fn the_segment_is_the_whole_segment(a in any_triangle(), b in any_triangle()) {
        if let (Some(found), true) = (intersect(&a, &b), meet(&a, &b) && general_position(&a, &b)) {
            prop_assert!(!found.coplanar);
            let [p, q] = segment(&a, &b);
            let ends = |x: DVec3, y: DVec3| x.distance(found.start).max(y.distance(found.end));
            let off = ends(p, q).min(ends(q, p));
            // Nearly parallel triangles have a common line that rounding turns.
            let normal = |t: &Triangle| (t[1] - t[0]).cross(t[2] - t[0]).normalize();
            let allowed = 1e-9 / normal(&a).cross(normal(&b)).length();
            prop_assert!(off <= allowed, "{found:?} should reach from {p} to {q}: {a:?} {b:?}");
        }
    }

    #[test]
    fn lattice_triangles(a in lattice_triangle(4), b in lattice_triangle(4)) {
        right(&a, &b, 0.0)?;
    }

    #[test]
    fn lattice_triangles_that_share_something([a, b] in lattice_pair(3)) {
        right(&a, &b, 0.0)?;
        if let Some(found) = intersect(&a, &b) {
            prop_assert_eq!(found.coplanar, coplanar(&a, &b));
        }
    }

    #[test]
    fn order_and_place_do_not_matter([a, b] in lattice_pair(3), by in (-64..64i32, -64..64i32, -64..64i32)) {
        let expected = intersect(&a, &b).is_some();
        prop_assert_eq!(intersect(&b, &a).is_some(), expected, "swapped");
        for [i, j, k] in [[1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]] {
            prop_assert_eq!(intersect(&[a[i], a[j], a[k]], &b).is_some(), expected, "corners of a reordered");
            prop_assert_eq!(intersect(&a, &[b[i], b[j], b[k]]).is_some(), expected, "corners of b reordered");
        }
        let by = DVec3::new(by.0.into(), by.1.into(), by.2.into());
        prop_assert_eq!(intersect(&a.map(|p| p + by), &b.map(|p| p + by)).is_some(), expected, "moved");
    }
}

/// Every way in which two triangles on three by three by three points can lie, in both orders.
#[test]
fn a_small_lattice_all_against_all() {
    let triangles: Vec<Triangle> = all_triangles(3).iter().map(lattice::real).collect();
    let wrong_with = |i: usize| -> Vec<(Triangle, Triangle)> {
        let a = triangles[i];
        let wrong = |b: &&Triangle| {
            let found = intersect(&a, b);
            found.is_some() != meet(&a, b) || found.is_some_and(|f| f.coplanar != coplanar(&a, b))
        };
        triangles.iter().filter(wrong).map(|b| (a, *b)).collect()
    };
    let wrong = parallel::map(triangles.len(), wrong_with).concat();
    assert!(
        wrong.is_empty(),
        "{} of {} wrong: {:?}",
        wrong.len(),
        triangles.len().pow(2),
        wrong[0]
    );
}

const FLAT: Triangle = [DVec3::ZERO, DVec3::new(4.0, 0.0, 0.0), DVec3::new(0.0, 4.0, 0.0)];

#[track_caller]
fn common(b: [[f64; 3]; 3], start: [f64; 3], end: [f64; 3]) {
    let b = b.map(DVec3::from_array);
    let Intersection {
        start: s,
        end: e,
        coplanar,
    } = intersect(&FLAT, &b).expect("they meet");
    let ends = [start, end].map(DVec3::from_array);
    let near = |p: DVec3, q: DVec3| p.distance(q) < 1e-12;
    let equal = (near(s, ends[0]) && near(e, ends[1])) || (near(s, ends[1]) && near(e, ends[0]));
    assert!(equal && !coplanar, "{s} to {e}, should be {ends:?}");
}

#[test]
fn known_segments() {
    // Through the middle, from inside to the slanted edge, and wholly inside.
    common(
        [[1.0, -1.0, -1.0], [1.0, 9.0, -1.0], [1.0, 4.0, 9.0]],
        [1.0, 0.0, 0.0],
        [1.0, 3.0, 0.0],
    );
    common(
        [[1.0, 1.0, 0.0], [1.0, 9.0, 0.0], [1.0, 4.0, 9.0]],
        [1.0, 1.0, 0.0],
        [1.0, 3.0, 0.0],
    );
    common(
        [[1.0, 1.0, 1.0], [1.0, 2.0, 1.0], [1.0, 1.5, -1.0]],
        [1.0, 1.25, 0.0],
        [1.0, 1.75, 0.0],
    );
    // A common edge, and a part of one.
    common(
        [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [1.0, 0.0, 5.0]],
        [0.0, 0.0, 0.0],
        [4.0, 0.0, 0.0],
    );
    common(
        [[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [1.0, 0.0, 5.0]],
        [1.0, 0.0, 0.0],
        [2.0, 0.0, 0.0],
    );
}

#[test]
fn known_points() {
    // A corner on the face, on an edge, on a corner, and an edge across an edge.
    common(
        [[1.0, 1.0, 0.0], [1.0, 2.0, 3.0], [2.0, 1.0, 3.0]],
        [1.0, 1.0, 0.0],
        [1.0, 1.0, 0.0],
    );
    common(
        [[2.0, 0.0, 0.0], [1.0, -2.0, 3.0], [2.0, -1.0, 3.0]],
        [2.0, 0.0, 0.0],
        [2.0, 0.0, 0.0],
    );
    common(
        [[0.0, 0.0, 0.0], [-1.0, -2.0, 3.0], [-2.0, -1.0, 3.0]],
        [0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0],
    );
    common(
        [[2.0, 0.0, -1.0], [2.0, 0.0, 1.0], [2.0, -3.0, 0.0]],
        [2.0, 0.0, 0.0],
        [2.0, 0.0, 0.0],
    );
}

#[test]
fn the_same_triangle_twice_and_one_in_the_other() {
    let small = FLAT.map(|p| p * 0.25 + DVec3::new(0.5, 0.5, 0.0));
    for b in [FLAT, small] {
        let found = intersect(&FLAT, &b).expect("they overlap");
        assert!(found.coplanar && found.start != found.end, "{found:?}");
    }
}

/// `TriMesh` drops triangles without an area, so no verdict is promised. But one that gets here ends nothing.
#[test]
fn triangles_without_an_area_give_finite_answers() {
    let inside = DVec3::new(0.25, 0.25, 0.0);
    let above = inside + DVec3::Z;
    let without_area = [
        [inside; 3],
        [above; 3],
        [inside, inside, above],
        [above, inside - DVec3::Z, inside],
        [FLAT[0], FLAT[1], FLAT[1]],
        [FLAT[0], FLAT[1], FLAT[0].lerp(FLAT[1], 0.5)],
        [DVec3::ZERO; 3],
    ];
    for (i, a) in without_area.iter().enumerate() {
        assert!(degenerate(a), "{a:?}");
        for b in without_area[i..].iter().chain([&FLAT]) {
            for found in [intersect(a, b), intersect(b, a)].into_iter().flatten() {
                assert!(
                    found.start.is_finite() && found.end.is_finite(),
                    "{found:?}: {a:?} {b:?}"
                );
            }
        }
    }
}

#[test]
fn cases_of_another_library() {
    let Some(path) = data::file("tritri/three-mesh-bvh_cases.json") else {
        return;
    };
    let cases: Vec<serde_json::Value> = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    assert!(!cases.is_empty());
    let mut tested = 0;
    for case in &cases {
        let triangle = |key: &str| -> Triangle {
            let corners: [[f64; 3]; 3] = serde_json::from_value(case[key].clone()).unwrap();
            corners.map(DVec3::from_array)
        };
        let [a, b] = [triangle("t1"), triangle("t2")];
        let found = intersect(&a, &b);
        if case["degenerate"] == true {
            // `TriMesh` drops those; that the test returns at all is what counts.
            continue;
        }
        tested += 1;
        let expected = case["expected"].as_bool().unwrap();
        assert_eq!(meet(&a, &b), expected, "the oracle on {}", case["name"]);
        // Decimal fractions make some cases nearly degenerate.
        let far_enough = margin(&a, &b) > ROUNDING * size(&a, &b);
        assert!(
            found.is_some() == expected || !far_enough,
            "{}: {found:?}",
            case["name"]
        );
    }
    println!("{tested} of {} cases without degenerate triangles", cases.len());
    assert!(tested > 20);
}
