//! Contact reduction: the few points that are kept of a patch span it.

use super::scene::{body, cube, points};
use crate::oracle::product::Product;
use crate::oracle::rng::Rng;
use bevy_faceoff::manifolds::ManifoldPoint;
use glam::{DVec3, Quat, Vec3};

#[test]
fn cubes_face_to_face() {
    let (product, cube) = (Product::default(), cube());
    let mut rng = Rng::new(2, 0);
    for case in 0..60 {
        // Rotated about the axis, shifted sideways, and rotated together.
        let frame = rng.rotation();
        let axis = (frame * Vec3::Z).as_dvec3();
        let depth = [0.01, 0.001, 0.0, -0.003][case % 4];
        let aside = DVec3::new(rng.range(-0.4, 0.4), rng.range(-0.4, 0.4), 1.0 - depth);
        let at = DVec3::new(5.0, -3.0, 2.0);
        let a = body(&cube, at, frame);
        let b = body(
            &cube,
            at + frame.as_dquat() * aside,
            frame * Quat::from_rotation_z(rng.range(0.0, 6.0) as f32),
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
        // The points surround the middle of the common area.
        let middle: Vec3 = found.iter().map(|p| p.anchors[0]).sum::<Vec3>() / found.len() as f32;
        assert!(
            found.iter().any(|p| (p.anchors[0] - middle).length() > 0.1),
            "case {case}"
        );
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
            let near = |p: &ManifoldPoint| p.anchors[0].distance(corner) < 1e-4 + gap.abs() as f32;
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
