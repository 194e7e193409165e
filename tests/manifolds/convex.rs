//! Balls and cubes, against analytic results.

use super::scene::{body, cube, degrees, depth, first_touch, oracle_mesh, points, push, turn};
use crate::oracle::product::Product;
use crate::oracle::rng::Rng;
use bevy_faceoff::geometry::shapes;
use glam::{DVec3, Quat, Vec3};
use std::f64::consts::{FRAC_PI_4, SQRT_2};

/// Mean and largest angle to the line of centres, and the mean error of the depth relative to the true depth.
fn balls(overlap: f64, margin: f64, cases: usize) -> [f64; 3] {
    let product = Product::default();
    let ball = oracle_mesh("ball", &shapes::ball(0.5, 4));
    let mut rng = Rng::new(1, overlap.to_bits());
    let mut errors = [0.0f64; 3];
    for _ in 0..cases {
        let way = rng.direction();
        let a = body(&ball, DVec3::new(0.3, -0.2, 0.9), rng.rotation());
        let b = body(&ball, DVec3::new(0.3, -0.2, 0.9), rng.rotation());
        // A tessellated ball is up to 3 in 10,000 flatter than a sphere, so the true depth is measured from the first
        // contact of the meshes.
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

#[test]
fn cubes_edge_to_edge() {
    let (product, cube) = (Product::default(), cube());
    let mut rng = Rng::new(3, 0);
    for depth in [0.02, 0.003, -0.003] {
        for _ in 0..20 {
            // Each stands on an edge; seen from above, the edges cross at some angle.
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
                (found[0].anchors[0] - (aside + Vec3::Z * 0.5 * SQRT_2 as f32)).length() < 1e-3,
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
            let on_b = b.translation + found[0].anchors[1];
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

#[test]
fn edges_of_cubes_that_nearly_lie_flat_push_along_a_face() {
    let (product, cube) = (Product::default(), cube());
    let mut rng = Rng::new(18, 0);
    let mut crossing_edges = 0;
    for case in 0..40 {
        let tilt = Quat::from_axis_angle(rng.in_ball(1.0).with_z(0.0).normalize().as_vec3(), 0.01);
        let rotation = tilt * Quat::from_rotation_z(rng.range(0.3, 1.2) as f32);
        let a = body(&cube, DVec3::ZERO, Quat::IDENTITY);
        let b = body(&cube, DVec3::new(0.2, 0.1, 1.0), rotation);
        let found = points(&product, &a, &b, 0.01);
        assert!(!found.is_empty());
        for point in &found {
            // Edges of both cross at angles at which their common normal differs from both faces' normals.
            let faces = [Vec3::Z, rotation * Vec3::Z].map(|n| point.normal.distance(n));
            assert!(faces[0].min(faces[1]) < 1e-5, "case {case}: {point:?}");
            let rims = [point.anchors[0], rotation.inverse() * point.anchors[1]];
            let on_edge = |p: &Vec3| p.x.abs().max(p.y.abs()) > 0.499;
            crossing_edges += usize::from(rims.iter().all(on_edge));
        }
    }
    assert!(crossing_edges > 20, "{crossing_edges}");
}

#[test]
fn what_reaches_through_a_flat_face_is_as_deep_as_it_is() {
    // Deeper than features may overlap, so rays find the depth; the contour lies in the face.
    let (product, cube) = (Product::default(), cube());
    let ball = oracle_mesh("ball", &shapes::ball(0.5, 4));
    let mut rng = Rng::new(19, 0);
    for case in 0..40 {
        let frame = rng.rotation();
        let aside = DVec3::new(rng.range(-0.2, 0.2), rng.range(-0.2, 0.2), 0.94);
        let a = body(&cube, DVec3::ZERO, frame);
        let b = body(&ball, frame.as_dquat() * aside, rng.rotation());
        for (a, b) in [(&a, &b), (&b, &a)] {
            let found = points(&product, a, b, 0.01);
            assert!((depth(&found) - 0.06).abs() < 0.003, "case {case}: {found:?}");
        }
    }
}
