//! Support heights are upper bounds in every direction, and not much more.

use bevy_faceoff::projection::SupportHeights;
use glam::{DVec3, Vec3};

use super::meshes::*;

/// Directions of all lengths, on axes and borders of the baked triangles, and all over.
fn directions() -> Vec<Vec3> {
    let mut out = Vec::new();
    for x in -8_i32..=8 {
        for y in -8_i32..=8 {
            for z in -8_i32..=8 {
                let u = Vec3::new(x as f32, y as f32, z as f32);
                if u != Vec3::ZERO {
                    out.extend([u, u / 3.0, u * 1.0e20, u * 1.0e-20]);
                    out.push(u + Vec3::new(1.0e-7, -1.0e-7, 1.0e-7));
                }
            }
        }
    }
    let mut noise = Noise(11);
    while out.len() < 150_000 {
        let u = noise.vector();
        let flat = u * [Vec3::ONE, Vec3::new(0.0, 1.0, 1.0), Vec3::new(1.0, -0.0, 1.0e-20)][out.len() % 3];
        if flat != Vec3::ZERO {
            out.push(flat);
        }
    }
    out
}

#[test]
fn support_heights_are_upper_bounds() {
    let flat: Vec<Vec3> = torus().0.iter().map(|v| v.with_y(0.0)).collect();
    let sets = [
        ("torus", torus().0, 0.02),
        ("knot", knot().0, 0.02),
        ("cube", cube(Vec3::ZERO, 1.0).0, 0.04),
        ("far", cube(Vec3::new(100.0, -40.0, 3.0), 1.0).0, 0.02),
        ("flat", flat, 0.02),
        ("one point", vec![Vec3::new(0.3, -2.0, 0.7); 3], 1.0e-5),
        ("segment", vec![Vec3::X, -Vec3::X], 0.04),
        ("origin", vec![Vec3::ZERO], 1.0),
        ("tiny", torus().0.iter().map(|v| *v * 1.0e-15).collect(), 0.02),
        ("huge", torus().0.iter().map(|v| *v * 1.0e9).collect(), 0.02),
    ];
    let directions = directions();
    for (name, points, most) in sets {
        let heights = SupportHeights::of(points.iter().copied());
        let radius = points.iter().map(|v| v.length()).fold(0.0, f32::max).max(1.0e-30);
        let (mut slack, mut count) = (0.0, 0);
        for &u in &directions {
            let p = heights.support(u);
            let bound = p.dot(u);
            let true_height = |e: DVec3| {
                points
                    .iter()
                    .map(|v| v.as_dvec3().dot(e))
                    .fold(f64::NEG_INFINITY, f64::max)
            };
            let height = true_height(u.as_dvec3());
            assert!(p.as_dvec3().dot(u.as_dvec3()) >= height, "{name}: {u}");
            // Products that underflow are no longer a matter of rounding.
            if u.length() * radius > 1.0e-30 {
                let in_f32 = points.iter().map(|v| v.dot(u)).fold(f32::NEG_INFINITY, f32::max);
                assert!(
                    bound >= in_f32 && f64::from(bound) >= height,
                    "{name}: {u}: {bound} < {height}"
                );
            }
            let length = u.as_dvec3().length();
            slack += (p.as_dvec3().dot(u.as_dvec3()) - height) / length / f64::from(radius);
            count += 1;
        }
        let mean = slack / f64::from(count);
        println!(
            "{name}: mean slack {:.3} % of the radius, {} bytes",
            100.0 * mean,
            heights.memory_bytes()
        );
        assert!(mean < most, "{name}: {mean}");
        assert_eq!(heights.heights().len(), 258);
        assert_eq!(
            SupportHeights::from_heights(heights.heights().to_vec()).as_ref(),
            Some(&heights)
        );
    }
}

#[test]
fn support_heights_survive_odd_input() {
    let heights = SupportHeights::of(torus().0.into_iter());
    for u in [
        Vec3::ZERO,
        -Vec3::ZERO,
        Vec3::NAN,
        Vec3::INFINITY,
        Vec3::splat(f32::MAX),
        Vec3::splat(-f32::MIN_POSITIVE),
        Vec3::X * f32::from_bits(1),
        Vec3::new(f32::MAX, f32::from_bits(1), -1.0),
        Vec3::new(f32::NAN, 1.0, 0.0),
    ] {
        assert!(heights.support(u).is_finite());
    }
    // Exact in f64, where neither end of f32's range matters.
    let points = torus().0;
    for scale in [f32::from_bits(40), 1.0e-38, 1.0e37, 1.0e38] {
        for u in [
            Vec3::new(1.0, -1.0, 0.5),
            Vec3::new(0.1, 0.7, 1.0),
            Vec3::ONE,
            Vec3::new(0.0, 1.0, -1.0),
        ] {
            let u = (u * scale).as_dvec3();
            let height = points
                .iter()
                .map(|v| v.as_dvec3().dot(u))
                .fold(f64::NEG_INFINITY, f64::max);
            assert!(heights.support(u.as_vec3()).as_dvec3().dot(u) >= height, "{u}");
        }
    }
    assert!(SupportHeights::from_heights(vec![]).is_none());
    assert!(SupportHeights::from_heights(vec![0.0; 257]).is_none());
    assert!(SupportHeights::from_heights(vec![f32::NAN; 258]).is_none());
    assert!(SupportHeights::from_heights(vec![1.0; 258]).is_some());
    assert!(SupportHeights::of(std::iter::empty()).support(Vec3::X).is_finite());
}
