//! Tori, knots and rings, against a search over all separating directions.

use super::scene::{bar_on_a_foot, body, degrees, depth, first_touch, oracle_mesh, points, push, uneven_legs, way_out};
use crate::oracle::body::{Body, Mesh};
use crate::oracle::brute::surfaces_meet;
use crate::oracle::parallel;
use crate::oracle::product::Product;
use crate::oracle::rng::Rng;
use crate::oracle::shapes::Shapes;
use bevy_faceoff::geometry::shapes;
use glam::{DVec3, Quat, Vec3};
use std::f32::consts::TAU;
use std::sync::Arc;

#[test]
fn a_ring_through_a_ring_touches_on_two_sides() {
    let product = Product::default();
    // The tube is wider than the remaining hole: it touches the hole's inner side and its far side.
    let outer = oracle_mesh("outer", &shapes::torus(24, 12, 0.7, 0.3));
    let inner = oracle_mesh("inner", &shapes::torus(24, 12, 1.2, 0.41));
    let a = body(&outer, DVec3::ZERO, Quat::IDENTITY);
    let b = body(&inner, DVec3::X * 1.2, Quat::from_rotation_x(TAU / 4.0));
    assert!(surfaces_meet(&a, &b));
    let found = points(&product, &a, &b, 0.005);
    let sum: Vec3 = found.iter().map(|p| p.normal).sum();
    let opposite = found.iter().any(|p| {
        found
            .iter()
            .any(|q| p.normal.dot(q.normal) < -0.8 && p.anchors[0].distance(q.anchors[0]) > 0.5)
    });
    assert!(opposite, "{found:?}");
    assert!(sum.length() < 0.5 * found.len() as f32, "{sum} {found:?}");
    for point in &found {
        // From the wall of the hole into the tube inside it.
        let inward = -point.anchors[0] * Vec3::new(1.0, 1.0, 0.0);
        assert!(point.normal.dot(inward.normalize()) > 0.7, "{point:?}");
        assert!(point.separation > -0.03, "{point:?}");
    }
}

/// A slab with its top at the height 0, in this frame.
fn slab(frame: Quat) -> Body {
    let mesh = oracle_mesh("slab", &shapes::cube(2.0));
    body(&mesh, (frame * Vec3::NEG_Z).as_dvec3(), frame)
}

#[test]
fn a_deep_patch_takes_no_features_from_a_shallow_one() {
    // One leg reaches deeper than features may, and the other does not.
    let (product, legs) = (Product::default(), uneven_legs());
    for case in 0..20 {
        let frame = Rng::new(28, case).rotation();
        let a = slab(frame);
        let b = body(&legs, frame.as_dquat() * (DVec3::Z * 0.4), frame);
        for (bodies, of_slab, up) in [([&a, &b], 0, 1.0), ([&b, &a], 1, -1.0)] {
            let found = points(&product, bodies[0], bodies[1], 0.01);
            let (mut corners, mut shallow, mut deep) = (0, 0, 0);
            for point in &found {
                assert!(point.normal.dot(frame * Vec3::Z) * up > 0.999, "case {case}: {point:?}");
                let at = frame.inverse() * point.anchors[of_slab];
                if at.x > 0.0 {
                    assert!((point.separation + 0.01).abs() < 1e-4, "case {case}: {point:?}");
                    let is_corner = (at.x - 0.4).abs() > 0.0999 && at.y.abs() > 0.0999;
                    corners += usize::from(is_corner);
                    shallow += 1;
                } else {
                    assert!((point.separation + 0.1).abs() < 1e-4, "case {case}: {point:?}");
                    deep += 1;
                }
            }
            assert!(corners == 4 && shallow >= 4 && deep >= 4, "case {case}: {found:?}");
        }
    }
}

#[test]
fn shallow_features_do_not_hide_a_deep_middle() {
    // The ends of the bar overlap by little, its foot by more than features may, and both share a contour.
    let (product, bar) = (Product::default(), bar_on_a_foot());
    for case in 0..20 {
        let frame = Rng::new(29, case).rotation();
        let a = slab(frame);
        let b = body(&bar, frame.as_dquat() * (DVec3::NEG_Z * 0.01), frame);
        for (a, b) in [(&a, &b), (&b, &a)] {
            let found = points(&product, a, b, 0.01);
            assert!((depth(&found) - 0.07).abs() < 1e-4, "case {case}: {found:?}");
        }
    }
}

/// Quality of the contacts of slightly overlapping bodies, relative to a search over all separating directions.
struct Quality {
    /// Angles between the separating directions, degrees.
    mean: f64,
    worst: f64,
    /// Errors of the depth, relative to the true depth.
    depth: f64,
    points: f64,
    missed: usize,
    cases: usize,
}

/// Two bodies, and the range of directions along which the second approaches the first.
struct Approach {
    bodies: [Body; 2],
    way: DVec3,
    from: f64,
    to: f64,
}

/// An approach from any direction outside.
fn from_outside(mesh: &Arc<Mesh>, rng: &mut Rng) -> Approach {
    let a = body(mesh, DVec3::ZERO, rng.rotation());
    let b = body(mesh, rng.in_ball(0.1), rng.rotation());
    Approach {
        bodies: [a, b],
        way: -rng.direction(),
        from: -1.1,
        to: 0.0,
    }
}

/// An approach like that of two links of a chain under tension.
fn in_a_chain(mesh: &Arc<Mesh>, rng: &mut Rng) -> Approach {
    let mut spin = |range: f64| rng.range(-range, range) as f32;
    let across = Quat::from_rotation_x(TAU / 4.0 + spin(0.4)) * Quat::from_rotation_z(spin(0.5));
    let a = body(mesh, DVec3::ZERO, Quat::from_rotation_z(spin(3.0)));
    Approach {
        bodies: [a, body(mesh, DVec3::X * 0.44, across)],
        way: (DVec3::X + rng.direction() * 0.3).normalize(),
        from: 0.0,
        to: 0.6,
    }
}

/// The second body approaches until it overlaps by `overlap` of its diameter.
fn quality(
    mesh: &Arc<Mesh>,
    approach: fn(&Arc<Mesh>, &mut Rng) -> Approach,
    overlap: f64,
    cases: usize,
    seed: u64,
) -> Quality {
    let product = Product::default();
    let results = parallel::map(cases, |case| {
        let Approach {
            bodies: [a, b],
            way,
            from,
            to,
        } = approach(mesh, &mut Rng::new(seed, case as u64));
        let touch = first_touch(&a, &b, way, from, to, 0.004)?;
        let b = b.moved(way * (touch + overlap));
        let truth = way_out(&a, &b, -way, 1.5 * overlap);
        let found = points(&product, &a, &b, 0.005);
        Some((truth, found))
    });
    let mut quality = Quality {
        mean: 0.0,
        worst: 0.0,
        depth: 0.0,
        points: 0.0,
        missed: 0,
        cases: 0,
    };
    for ((way, length), found) in results.into_iter().flatten() {
        quality.cases += 1;
        if found.is_empty() || depth(&found) <= 0.0 {
            quality.missed += 1;
            continue;
        }
        let angle = degrees(push(&found), way);
        quality.mean += angle;
        quality.worst = quality.worst.max(angle);
        quality.depth += (depth(&found) / length - 1.0).abs();
        quality.points += found.len() as f64;
    }
    let count = (quality.cases - quality.missed) as f64;
    quality.mean /= count;
    quality.depth /= count;
    quality.points /= count;
    quality
}

fn require_quality(
    name: &str,
    mesh: &Arc<Mesh>,
    approach: fn(&Arc<Mesh>, &mut Rng) -> Approach,
    rows: &[(f64, f64, f64)],
) {
    for &(overlap, most_degrees, most_depth) in rows {
        let q = quality(mesh, approach, overlap, 30, 11);
        println!(
            "{name} {:.1} %: mean {:.2} and worst {:.1} degrees, depth off by {:.1} %, {:.1} points, {} of {} missed",
            overlap * 100.0,
            q.mean,
            q.worst,
            q.depth * 100.0,
            q.points,
            q.missed,
            q.cases
        );
        assert!(q.cases >= 20, "{name}: only {} cases meet", q.cases);
        assert_eq!(q.missed, 0, "{name} {overlap}");
        assert!(q.mean < most_degrees && q.depth < most_depth, "{name} {overlap}");
    }
}

#[test]
fn tori_are_pushed_the_shortest_way() {
    let torus = oracle_mesh("torus", &shapes::torus_240());
    require_quality(
        "torus",
        &torus,
        from_outside,
        &[(0.001, 4.0, 0.1), (0.01, 3.0, 0.1), (0.03, 6.0, 0.2)],
    );
}

#[test]
fn knots_are_pushed_the_shortest_way() {
    let knot = oracle_mesh("knot", &shapes::knot_1120());
    require_quality("knot", &knot, from_outside, &[(0.01, 6.0, 0.15), (0.03, 10.0, 0.3)]);
}

#[test]
fn links_of_a_chain_are_pushed_the_shortest_way() {
    let ring = oracle_mesh("ring", &shapes::ring());
    require_quality(
        "rings",
        &ring,
        in_a_chain,
        &[(0.001, 5.0, 0.1), (0.01, 5.0, 0.1), (0.1, 10.0, 0.2)],
    );
}

#[test]
fn moving_by_the_depth_parts_convex_bodies() {
    let (product, shapes) = (Product::default(), Shapes::new());
    for mesh in [&shapes.cube, &shapes.tetrahedron, &shapes.ball] {
        let (mut apart, mut left) = (0, 0.0f64);
        for case in 0..40 {
            let mut rng = Rng::new(5, case);
            let a = body(mesh, DVec3::ZERO, rng.rotation());
            let b = body(mesh, rng.in_ball(0.05), rng.rotation());
            let way = rng.direction();
            let touch = first_touch(&a, &b, -way, -1.1, 0.0, 0.01).expect("they meet");
            let b = b.moved(way * (-touch - 0.01));
            let found = points(&product, &a, &b, 0.005);
            let deepest = found
                .iter()
                .min_by(|p, q| p.separation.total_cmp(&q.separation))
                .unwrap();
            let out = deepest.normal.as_dvec3();
            let depth = -f64::from(deepest.separation);
            let b = b.moved(out * (depth * 1.001));
            apart += usize::from(!surfaces_meet(&a, &b));
            left = left.max(way_out(&a, &b, out, 0.01).1 / depth);
        }
        println!(
            "{}: {apart} of 40 apart, at most {:.2} of the depth left",
            mesh.name, left
        );
        assert!(apart >= 32, "{}: {apart} of 40", mesh.name);
        assert!(left < 0.2, "{}: {left}", mesh.name);
    }
}
