//! Containment and degenerate input.

use super::scene::{body, cube, degrees, depth, oracle_mesh, points, push, require_sane, state};
use crate::oracle::body::{Body, Mesh};
use crate::oracle::product::Product;
use crate::oracle::rng::Rng;
use crate::oracle::shapes::Shapes;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::manifolds::{ManifoldPoint, Manifolds, MarginPair, cpu};
use glam::{DVec3, Quat, Vec3};
use std::sync::Arc;

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

/// A mesh may have been loaded twice. Bodies of the two coincide as two of one do, and are pushed apart in the same
/// way.
#[test]
fn coincident_equal_meshes_have_the_points_of_one_mesh() {
    let shapes = Shapes::new();
    let mut meshes: Vec<(&Arc<Mesh>, bool)> = shapes.solids().into_iter().map(|mesh| (mesh, true)).collect();
    meshes.extend([(&shapes.hollow_ball, false), (&shapes.unwelded_torus, false)]);
    for (mesh, is_solid) in meshes {
        let at = body(mesh, DVec3::new(1.0, 2.0, 3.0), Quat::from_rotation_y(0.7));
        // Each bakes its own.
        let [mut two_slots, other] = [(); 2].map(|()| state(&Product::default(), &[&at, &at]));
        let mut one_slot = state(&Product::default(), &[&at, &at]);
        one_slot.input.bodies.mesh.fill(0);
        two_slots.input.meshes.replace(1, other.input.meshes[1].mesh.clone());
        let [twice, once] = [two_slots, one_slot].map(|state| -> Vec<ManifoldPoint> {
            let pair = MarginPair {
                bodies: [0, 1],
                margin: 0.01,
            };
            let found = cpu::of_pair(&state.input.bodies, &state.input.meshes, pair);
            require_sane(&found);
            found.points
        });
        assert_eq!(twice, once, "{}", mesh.name);
        assert!(!(is_solid && twice.is_empty()), "{}", mesh.name);
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

/// A square sheet of `quads` by `quads` quads in the plane z = 0, facing up.
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
        assert_eq!(
            cpu::of_pair(&state.input.bodies, &state.input.meshes, pair),
            Manifolds::default()
        );
    }
}
