//! Invariance under scale, winding, order and small motions.

use super::scene::{body, first_touch, points, state};
use crate::oracle::body::{Body, Mesh};
use crate::oracle::product::Product;
use crate::oracle::rng::Rng;
use crate::oracle::shapes::Shapes;
use bevy_faceoff::manifolds::ManifoldPoint;
use glam::{Quat, Vec3};
use std::sync::Arc;

/// Requires that each point of one list has an equal one in the other.
fn require_same(name: &str, found: &[ManifoldPoint], wanted: &[ManifoldPoint], tolerance: f32) {
    assert!(!wanted.is_empty(), "{name}");
    let same = |p: &ManifoldPoint, q: &ManifoldPoint| {
        (0..2).all(|i| p.anchors[i].distance(q.anchors[i]) < tolerance)
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
                anchors: [p.anchors[1], p.anchors[0]],
                normal: -p.normal,
                separation: p.separation,
                curvature_radii: [p.curvature_radii[1], p.curvature_radii[0]],
                bulge: p.bulge,
                normal_rotation: p.normal_rotation,
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
        let frames = state(&product, &[&a, &b]).input.bodies.frame;
        for point in points(&product, &a, &b, 0.005) {
            for (i, body) in [&a, &b].into_iter().enumerate() {
                let world = body.world();
                let t = world.triangle(point.faces[i]).expect("a face");
                let normal = (t[1] - t[0]).cross(t[2] - t[0]).normalize();
                let p = frames[i].center + point.anchors[i].as_dvec3();
                assert!(normal.dot(p - t[0]).abs() < 1e-5, "{point:?}");
            }
            let way = (frames[1].center - frames[0].center) + (point.anchors[1] - point.anchors[0]).as_dvec3();
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
                        .any(|q| p.anchors[0].distance(q.anchors[0]) < 0.05 && p.normal.dot(q.normal) > 0.7)
                })
                .count();
            before = after;
        }
    }
    println!("{stayed} of {all} points stayed");
    assert!(stayed * 100 >= all * 90, "{stayed} of {all}");
}
