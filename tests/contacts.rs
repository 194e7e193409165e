//! Contact points between meshes: where they are, which way they push, and how deep, against formulas and against a
//! search over all ways out with exact predicates.

mod oracle;
#[path = "contacts/scene.rs"]
mod scene;

use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::stages::manifold::{ManifoldPoint, Manifolds};
use bevy_faceoff::stages::manifolds::{MarginPair, cpu};
use bevy_faceoff::stages::state::{Body as StageBody, StepState};
use glam::{DVec3, Quat, Vec3};
use oracle::body::{Body, Mesh};
use oracle::brute::surfaces_meet;
use oracle::product::Product;
use oracle::rng::Rng;
use oracle::shapes::Shapes;
use scene::{body, degrees, depth, first_touch, oracle_mesh, points, push, require_sane, state, turn, way_out};
use std::f64::consts::{FRAC_PI_4, SQRT_2};
use std::sync::Arc;

const TAU: f32 = std::f32::consts::TAU;

// ---- Balls.

/// Mean and worst angle to the line of centres, and mean error of the depth relative to the true one.
fn balls(overlap: f64, margin: f64, cases: usize) -> [f64; 3] {
    let product = Product::default();
    let ball = oracle_mesh("ball", &shapes::ball(0.5, 4));
    let mut rng = Rng::new(1, overlap.to_bits());
    let mut errors = [0.0f64; 3];
    for _ in 0..cases {
        let way = rng.direction();
        let a = body(&ball, DVec3::new(0.3, -0.2, 0.9), rng.rotation());
        let b = body(&ball, DVec3::new(0.3, -0.2, 0.9), rng.rotation());
        // A ball of triangles is up to 3 in 10,000 flatter than a ball, so the true depth starts where these touch.
        let touch = first_touch(&a, &b, -way, -1.002, -0.99, 0.001).expect("they meet");
        let points = points(&product, &a, &b.moved(way * (-touch - overlap)), margin);
        let angle = degrees(push(&points), way);
        errors[0] += angle / cases as f64;
        errors[1] = errors[1].max(angle);
        errors[2] += (depth(&points) / overlap - 1.0).abs() / cases as f64;
    }
    errors
}

#[test]
fn balls_push_along_the_line_of_centres_as_deep_as_they_are() {
    for (overlap, most) in [
        (0.001, [2.5, 6.0, 0.05]),
        (0.01, [1.0, 3.0, 0.05]),
        (0.05, [1.0, 3.0, 0.05]),
    ] {
        let errors = balls(overlap, 0.01, 30);
        println!(
            "overlap {overlap}: mean {:.2} and worst {:.2} degrees, depth {:.3}",
            errors[0], errors[1], errors[2]
        );
        assert!((0..3).all(|i| errors[i] <= most[i]), "{overlap}: {errors:?}");
    }
}

#[test]
fn balls_across_a_gap_know_how_far_they_are() {
    let errors = balls(-0.003, 0.01, 30);
    println!(
        "gap: mean {:.2} and worst {:.2} degrees, distance {:.3}",
        errors[0], errors[1], errors[2]
    );
    assert!(errors[0] < 1.5 && errors[1] < 4.0 && errors[2] < 0.03, "{errors:?}");
    let product = Product::default();
    let ball = oracle_mesh("ball", &shapes::ball(0.5, 4));
    let [a, b] = [0.0, 1.02].map(|x| body(&ball, DVec3::X * x, Quat::IDENTITY));
    assert_eq!(points(&product, &a, &b, 0.01), vec![]);
}

// ---- Cubes.

fn cube() -> Arc<Mesh> {
    Shapes::new().unit_cube
}

#[test]
fn cubes_face_to_face() {
    let (product, cube) = (Product::default(), cube());
    let mut rng = Rng::new(2, 0);
    for case in 0..60 {
        // Turned about the axis, shifted aside, and all of it turned any way.
        let frame = rng.rotation();
        let axis = (frame * Vec3::Z).as_dvec3();
        let depth = [0.01, 0.001, 0.0, -0.003][case % 4];
        let aside = DVec3::new(rng.range(-0.4, 0.4), rng.range(-0.4, 0.4), 1.0 - depth);
        let at = DVec3::new(5.0, -3.0, 2.0);
        let a = body(&cube, at, frame);
        let b = body(
            &cube,
            at + frame.as_dquat() * aside,
            frame * Quat::from_rotation_z(rng.range(0.0, 6.28) as f32),
        );
        let found = points(&product, &a, &b, 0.01);
        assert!(found.len() >= 4, "case {case}: {found:?}");
        for point in &found {
            assert!(point.normal.as_dvec3().distance(axis) < 1e-4, "case {case}: {point:?}");
            assert!(
                (f64::from(point.separation) + depth).abs() < 1e-4,
                "case {case}: {point:?}"
            );
        }
        // They hold the faces' common middle.
        let middle: Vec3 = found.iter().map(|p| p.arms[0]).sum::<Vec3>() / found.len() as f32;
        assert!(found.iter().any(|p| (p.arms[0] - middle).length() > 0.1), "case {case}");
    }
}

#[test]
fn aligned_cubes_rest_on_each_other_at_their_corners() {
    let (product, cube) = (Product::default(), cube());
    let mut rng = Rng::new(17, 0);
    for case in 0..40 {
        let gap = [0.0, 1e-3, -1e-3, -0.02][case % 4];
        let frame = if case < 4 { Quat::IDENTITY } else { rng.rotation() };
        let up = frame * Vec3::Z;
        let [a, b] = [0.0, 1.0 + gap].map(|z| body(&cube, up.as_dvec3() * z, frame));
        let found = points(&product, &a, &b, 0.01);
        for corner in [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]] {
            let corner = frame * Vec3::new(corner[0], corner[1], 1.0) * 0.5;
            let near = |p: &ManifoldPoint| p.arms[0].distance(corner) < 1e-4 + gap.abs() as f32;
            assert!(found.iter().any(near), "{case}, {gap}: {found:?}");
        }
        for point in &found {
            assert!(point.normal.distance(up) < 1e-5, "{case}, {gap}: {point:?}");
            assert!(
                (f64::from(point.separation) - gap).abs() < 1e-5,
                "{case}, {gap}: {point:?}"
            );
        }
    }
}

#[test]
fn cubes_edge_to_edge() {
    let (product, cube) = (Product::default(), cube());
    let mut rng = Rng::new(3, 0);
    for depth in [0.02, 0.003, -0.003] {
        for _ in 0..20 {
            // Each stands on an edge; seen from above the edges cross at some angle.
            let tilt = Quat::from_rotation_x(FRAC_PI_4 as f32);
            let above = Quat::from_rotation_z(rng.range(0.5, 2.6) as f32) * tilt;
            let aside = DVec3::X * rng.range(-0.2, 0.2);
            let a = body(&cube, DVec3::ZERO, tilt);
            let b = body(&cube, aside + DVec3::Z * (SQRT_2 - depth), above);
            let found = points(&product, &a, &b, 0.01);
            assert_eq!(found.len(), 1, "{depth}: {found:?}");
            assert!(found[0].normal.distance(Vec3::Z) < 1e-4, "{found:?}");
            assert!((f64::from(found[0].separation) + depth).abs() < 1e-4, "{found:?}");
            let aside = aside.as_vec3();
            assert!(
                (found[0].arms[0] - (aside + Vec3::Z * 0.5 * SQRT_2 as f32)).length() < 1e-3,
                "{found:?}"
            );
        }
    }
}

#[test]
fn a_cubes_corner_on_a_face() {
    let (product, cube) = (Product::default(), cube());
    let mut rng = Rng::new(4, 0);
    for depth in [0.02, 0.003, -0.003] {
        for _ in 0..20 {
            let tilt = Quat::from_rotation_x(rng.range(-0.15, 0.15) as f32) * turn(Vec3::ONE, Vec3::NEG_Z);
            let rotation = Quat::from_rotation_z(rng.range(0.0, 6.0) as f32) * tilt;
            let low = (rotation * Vec3::splat(0.5)).as_dvec3();
            let foot = DVec3::new(rng.range(-0.3, 0.3), rng.range(-0.3, 0.3), 0.5 - depth);
            let a = body(&cube, DVec3::ZERO, Quat::IDENTITY);
            let b = body(&cube, foot - low, rotation);
            let found = points(&product, &a, &b, 0.01);
            assert_eq!(found.len(), 1, "{depth}: {found:?}");
            assert!(found[0].normal.distance(Vec3::Z) < 1e-4, "{found:?}");
            assert!((f64::from(found[0].separation) + depth).abs() < 1e-4, "{found:?}");
            let on_b = b.translation + found[0].arms[1];
            assert!(on_b.as_dvec3().distance(foot) < 1e-4, "{found:?}");
        }
    }
}

#[test]
fn a_gap_counts_up_to_the_margin() {
    let (product, cube) = (Product::default(), cube());
    let [a, b] = [0.0, 1.003].map(|x| body(&cube, DVec3::X * x, Quat::IDENTITY));
    for (margin, any) in [(0.0, false), (0.0029, false), (0.0031, true), (0.05, true)] {
        let found = points(&product, &a, &b, margin);
        assert_eq!(!found.is_empty(), any, "{margin}: {found:?}");
        assert!(
            found.iter().all(|p| (p.separation - 0.003).abs() < 1e-6),
            "{margin}: {found:?}"
        );
    }
}

// ---- Concave shapes.

#[test]
fn a_ring_through_a_ring_touches_on_two_sides() {
    let product = Product::default();
    // The tube is wider than the hole that is left: it touches the hole's inner side and its far side.
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
            .any(|q| p.normal.dot(q.normal) < -0.8 && p.arms[0].distance(q.arms[0]) > 0.5)
    });
    assert!(opposite, "{found:?}");
    assert!(sum.length() < 0.5 * found.len() as f32, "{sum} {found:?}");
    for point in &found {
        // Into the tube in the hole: from the hole's wall to its middle.
        let inward = -point.arms[0] * Vec3::new(1.0, 1.0, 0.0);
        assert!(point.normal.dot(inward.normalize()) > 0.7, "{point:?}");
        assert!(point.separation > -0.03, "{point:?}");
    }
}

/// What is found about bodies that overlap a little, beside what a search over all ways out finds.
struct Quality {
    /// Degrees between the pushes.
    mean: f64,
    worst: f64,
    /// Of the depth, relative to the true one.
    depth: f64,
    points: f64,
    missed: usize,
    cases: usize,
}

/// Two bodies, and a range of ways that the second goes until it meets the first.
struct Approach {
    bodies: [Body; 2],
    way: DVec3,
    from: f64,
    to: f64,
}

/// From anywhere outside.
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

/// Like two links of a chain that is pulled.
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

/// The second goes until it overlaps by `overlap` of its diameter.
fn quality(
    mesh: &Arc<Mesh>,
    approach: fn(&Arc<Mesh>, &mut Rng) -> Approach,
    overlap: f64,
    cases: usize,
    seed: u64,
) -> Quality {
    let product = Product::default();
    let results = oracle::parallel::map(cases, |case| {
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

// ---- Scales, windings, orders.

/// Each point of one list has one in the other that says the same.
fn require_same(name: &str, found: &[ManifoldPoint], wanted: &[ManifoldPoint], tolerance: f32) {
    assert!(!wanted.is_empty(), "{name}");
    let same = |p: &ManifoldPoint, q: &ManifoldPoint| {
        (0..2).all(|i| p.arms[i].distance(q.arms[i]) < tolerance)
            && p.normal.distance(q.normal) < 10.0 * tolerance
            && (p.separation - q.separation).abs() < tolerance
    };
    for (some, others) in [(found, wanted), (wanted, found)] {
        for p in some {
            assert!(others.iter().any(|q| same(p, q)), "{name}: {p:?} is not in {others:?}");
        }
    }
}

fn scaled_mesh(mesh: &Mesh, scale: Vec3) -> Arc<Mesh> {
    let mirrors = scale.x * scale.y * scale.z < 0.0;
    let faces = mesh
        .faces
        .iter()
        .map(|&[a, b, c]| if mirrors { [a, c, b] } else { [a, b, c] });
    Mesh::new(
        "scaled",
        mesh.vertices.iter().map(|v| *v * scale).collect(),
        faces.collect(),
    )
}

fn turned_inward(mesh: &Mesh) -> Arc<Mesh> {
    Mesh::new(
        "inward",
        mesh.vertices.clone(),
        mesh.faces.iter().map(|&[a, b, c]| [a, c, b]).collect(),
    )
}

/// Pairs of tori and of cubes that overlap by about a hundredth.
fn some_pairs(cases: u64, seed: u64) -> Vec<[Body; 2]> {
    let shapes = Shapes::new();
    (0..cases)
        .map(|case| {
            let mut rng = Rng::new(seed, case);
            let mesh = [&shapes.torus, &shapes.cube, &shapes.knot][case as usize % 3];
            let a = body(mesh, rng.in_ball(3.0), rng.rotation());
            let b = body(mesh, a.translation.as_dvec3() + rng.in_ball(0.05), rng.rotation());
            let way = rng.direction();
            let touch = first_touch(&a, &b, -way, -1.1, 0.0, 0.01).unwrap_or(-0.5);
            [a, b.moved(way * (-touch - 0.01))]
        })
        .collect()
}

#[test]
fn scales_say_the_same_as_meshes_of_that_scale() {
    let product = Product::default();
    for (case, [a, b]) in some_pairs(24, 6).into_iter().enumerate() {
        let mut rng = Rng::new(7, case as u64);
        let mut scale = Vec3::from_array([0; 3].map(|_| rng.range(0.6, 1.6) as f32));
        if case % 2 == 0 {
            scale[case / 2 % 3] *= -1.0;
        }
        let placed = Body { scale, ..b.clone() };
        let baked = Body {
            mesh: scaled_mesh(&b.mesh, scale),
            ..b.clone()
        };
        let [found, wanted] = [&placed, &baked].map(|b| points(&product, &a, b, 0.05));
        if !wanted.is_empty() {
            require_same(&format!("case {case}, {scale}"), &found, &wanted, 2e-5);
        }
        let [found, wanted] = [&placed, &baked].map(|b| points(&product, b, &a, 0.05));
        if !wanted.is_empty() {
            require_same(&format!("case {case}, {scale}, first"), &found, &wanted, 2e-5);
        }
    }
}

#[test]
fn the_winding_does_not_matter_for_closed_meshes() {
    let product = Product::default();
    for (case, [a, b]) in some_pairs(12, 8).into_iter().enumerate() {
        let inward = Body {
            mesh: turned_inward(&b.mesh),
            ..b.clone()
        };
        let [found, wanted] = [&inward, &b].map(|b| points(&product, &a, b, 0.005));
        require_same(&format!("case {case}"), &found, &wanted, 1e-5);
    }
}

#[test]
fn the_order_of_bodies_only_turns_normals() {
    let product = Product::default();
    for (case, [a, b]) in some_pairs(24, 9).into_iter().enumerate() {
        let forth = points(&product, &a, &b, 0.005);
        let back: Vec<ManifoldPoint> = points(&product, &b, &a, 0.005)
            .iter()
            .map(|p| ManifoldPoint {
                arms: [p.arms[1], p.arms[0]],
                normal: -p.normal,
                separation: p.separation,
                faces: [p.faces[1], p.faces[0]],
            })
            .collect();
        require_same(&format!("case {case}"), &back, &forth, 1e-5);
    }
}

#[test]
fn points_lie_on_the_faces_they_name() {
    let product = Product::default();
    for [a, b] in some_pairs(24, 10) {
        let frames = state(&product, &[&a, &b]).bodies.frame;
        for point in points(&product, &a, &b, 0.005) {
            for (i, body) in [&a, &b].into_iter().enumerate() {
                let world = body.world();
                let t = world.triangle(point.faces[i]).expect("a face");
                let normal = (t[1] - t[0]).cross(t[2] - t[0]).normalize();
                let p = frames[i].center + point.arms[i].as_dvec3();
                assert!(normal.dot(p - t[0]).abs() < 1e-5, "{point:?}");
            }
            let way = (frames[1].center - frames[0].center) + (point.arms[1] - point.arms[0]).as_dvec3();
            let along = point.normal.as_dvec3().dot(way);
            assert!((along - f64::from(point.separation)).abs() < 1e-5, "{point:?}");
        }
    }
}

#[test]
fn small_motions_move_points_little() {
    let product = Product::default();
    let (mut all, mut stayed) = (0, 0);
    for (case, [a, mut b]) in some_pairs(30, 12).into_iter().enumerate() {
        let mut rng = Rng::new(13, case as u64);
        let mut before = points(&product, &a, &b, 0.005);
        for _ in 0..5 {
            b = Body {
                rotation: Quat::from_axis_angle(rng.direction().as_vec3(), 0.002) * b.rotation,
                ..b.moved(rng.direction() * 0.001)
            };
            let after = points(&product, &a, &b, 0.005);
            all += after.len();
            stayed += after
                .iter()
                .filter(|p| {
                    before
                        .iter()
                        .any(|q| p.arms[0].distance(q.arms[0]) < 0.05 && p.normal.dot(q.normal) > 0.7)
                })
                .count();
            before = after;
        }
    }
    println!("{stayed} of {all} points stayed");
    assert!(stayed * 100 >= all * 90, "{stayed} of {all}");
}

// ---- One inside the other.

#[test]
fn a_ball_in_a_ball_is_pushed_out_the_short_way() {
    let product = Product::default();
    let ball = oracle_mesh("ball", &shapes::ball(0.5, 3));
    let mut rng = Rng::new(14, 0);
    for _ in 0..20 {
        let way = rng.direction();
        let outer = body(&ball, DVec3::new(1.0, 2.0, 3.0), rng.rotation());
        let inner = Body {
            scale: Vec3::splat(0.4),
            ..body(&ball, outer.translation.as_dvec3() + way * 0.2, rng.rotation())
        };
        // From the far end of the small ball, at 0, to the surface.
        for (a, b, out) in [(&outer, &inner, way), (&inner, &outer, -way)] {
            let found = points(&product, a, b, 0.01);
            assert!(!found.is_empty());
            assert!(degrees(push(&found), out) < 6.0, "{out}: {found:?}");
            assert!((depth(&found) - 0.5).abs() < 0.02, "{found:?}");
        }
    }
}

#[test]
fn a_ball_in_the_middle_or_in_a_hollow() {
    let (product, shapes) = (Product::default(), Shapes::new());
    let outer = body(&shapes.ball, DVec3::ZERO, Quat::IDENTITY);
    let inner = Body::new(&shapes.ball, DVec3::ZERO, Quat::IDENTITY, 0.3);
    let found = points(&product, &outer, &inner, 0.01);
    assert!((depth(&found) - 0.65).abs() < 0.04, "{found:?}");
    let hollow = body(&shapes.hollow_ball, DVec3::ZERO, Quat::IDENTITY);
    assert_eq!(points(&product, &hollow, &inner, 0.01), vec![]);
}

// ---- Bad cases.

#[test]
fn coincident_meshes_have_finite_points() {
    let (product, shapes) = (Product::default(), Shapes::new());
    let mut meshes: Vec<&Arc<Mesh>> = shapes.solids().to_vec();
    meshes.extend([
        &shapes.triangle,
        &shapes.hollow_ball,
        &shapes.unwelded_torus,
        &shapes.soups[0],
    ]);
    for mesh in meshes {
        for rotation in [Quat::IDENTITY, Quat::from_rotation_y(0.7)] {
            let body = body(mesh, DVec3::new(1.0, 2.0, 3.0), rotation);
            points(&product, &body, &body, 0.01);
            points(&product, &body, &body.moved(DVec3::X * 1e-7), 0.0);
        }
    }
}

#[test]
fn anything_meets_anything_without_a_bad_number() {
    let (product, shapes) = (Product::default(), Shapes::new());
    let mut rng = Rng::new(15, 0);
    for _ in 0..1500 {
        let size = 10f64.powf(rng.range(-6.0, 3.0));
        let far = rng.chance(0.5);
        let at = rng.in_ball(if far { 1e4 } else { 1.0 });
        let two = shapes.two(&mut rng);
        let scale = |rng: &mut Rng| {
            let mut part = || (size * rng.range(0.3, 1.0) * if rng.chance(0.3) { -1.0 } else { 1.0 }) as f32;
            Vec3::new(part(), part(), part())
        };
        let (scale_a, scale_b) = (scale(&mut rng), scale(&mut rng));
        let a = Body {
            scale: scale_a,
            ..body(two[0], at, rng.rotation())
        };
        let b = Body {
            scale: scale_b,
            ..body(two[1], at + rng.in_ball(0.7 * size), rng.rotation())
        };
        let margin = [0.0, 0.01 * size, size, 1e30, f64::NAN, -1.0][rng.below(6)];
        points(&product, &a, &b, margin);
    }
}

#[test]
fn far_from_the_origin_only_the_poses_are_rounded() {
    let (product, cube) = (Product::default(), cube());
    for at in [DVec3::ZERO, DVec3::new(1e4, -1e4, 1e4)] {
        let [a, b] = [0.0, 0.9921875].map(|z| body(&cube, at + DVec3::Z * z, Quat::IDENTITY));
        let found = points(&product, &a, &b, 0.01);
        assert!(found.len() >= 4);
        assert!(found.iter().all(|p| p.normal.distance(Vec3::Z) < 1e-6), "{found:?}");
        assert!((depth(&found) - 0.0078125).abs() < 1e-6, "{found:?}");
    }
}

/// A square of so many quads a side in the plane z = 0, looking up.
fn sheet(quads: u32, size: f32) -> Arc<Mesh> {
    let at = |i: u32, j: u32| i * (quads + 1) + j;
    let mut vertices = vec![];
    let mut faces = vec![];
    for i in 0..=quads {
        for j in 0..=quads {
            let [x, y] = [i, j].map(|k| size * (k as f32 / quads as f32 - 0.5));
            vertices.push(Vec3::new(x, y, 0.0));
            if i < quads && j < quads {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                faces.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    Mesh::new("sheet", vertices, faces)
}

#[test]
fn an_open_sheet_pushes_to_the_side_on_which_the_other_is() {
    let product = Product::default();
    let sheet = body(&sheet(7, 4.0), DVec3::ZERO, Quat::IDENTITY);
    let ball = oracle_mesh("ball", &shapes::ball(0.5, 3));
    for side in [1.0, -1.0] {
        for depth_wanted in [0.02, 0.002, -0.003] {
            let b = body(
                &ball,
                DVec3::new(0.1, 0.2, side * (0.5 - depth_wanted)),
                Quat::from_rotation_x(0.3),
            );
            for (a, b, out) in [(&sheet, &b, side), (&b, &sheet, -side)] {
                let found = points(&product, a, b, 0.01);
                assert!(!found.is_empty(), "{side} {depth_wanted}");
                assert!(
                    degrees(push(&found), DVec3::Z * out) < 3.0,
                    "{side} {depth_wanted}: {found:?}"
                );
                assert!(
                    (depth(&found) - depth_wanted).abs() < 2e-3,
                    "{side} {depth_wanted}: {found:?}"
                );
            }
        }
    }
}

#[test]
fn numbers_of_no_bodies_have_no_points() {
    let (product, cube) = (Product::default(), cube());
    let body = body(&cube, DVec3::ZERO, Quat::IDENTITY);
    let state = state(&product, &[&body, &body]);
    for bodies in [[0, 0], [0, 2], [7, 9]] {
        let pair = MarginPair { bodies, margin: 0.1 };
        assert_eq!(cpu::of_pair(&state.bodies, &state.meshes, pair), Manifolds::default());
    }
}

// ---- Many pairs.

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let mut state = StepState::default();
    let slots = [shapes::torus_240(), shapes::cube(0.6), shapes::ball_320()]
        .map(|mesh| state.meshes.add(CollisionMesh::new(&mesh)));
    let mut rng = Rng::new(16, 0);
    for i in 0..80 {
        let at = rng.in_ball(1.6).as_vec3();
        let body = StageBody::at_rest(slots[i % 3], at, rng.rotation(), Vec3::ONE);
        state.bodies.push(&body, &state.meshes).unwrap();
    }
    let pairs: Vec<MarginPair> = (0..80)
        .flat_map(|a| (a + 1..80).map(move |b| [a, b]))
        .map(|bodies| MarginPair { bodies, margin: 0.01 })
        .collect();
    let mut scratch = cpu::Scratch::default();
    let mut runs = [1, 1, 2, 5].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut manifolds = Manifolds::default();
        pool.install(|| cpu::run(&state.bodies, &state.meshes, &pairs, &mut scratch, &mut manifolds));
        require_sane(&manifolds);
        manifolds
    });
    assert!(runs[0].pairs.len() > 300, "{}", runs[0].pairs.len());
    assert!(runs[0].pairs.is_sorted_by(|p, q| p.bodies < q.bodies));
    let bits = |m: &Manifolds| format!("{m:?}");
    let first = bits(&runs[0]);
    for run in &mut runs[1..] {
        assert_eq!(bits(run), first);
    }
    let pair = runs[0].pairs[100];
    let alone = cpu::of_pair(
        &state.bodies,
        &state.meshes,
        MarginPair {
            bodies: pair.bodies,
            margin: 0.01,
        },
    );
    assert_eq!(alone.points, runs[0].points_of(&pair));
}
