//! A `ContactWorker` finds the same points as a step.

use crate::scene::{Pose, manifold, meshes, touching};
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::manifolds::{ManifoldPoint, MarginPair, cpu};
use bevy_faceoff::queries::{ContactWorker, MeshContact};
use bevy_faceoff::state::mesh_arena::MeshArena;
use bevy_faceoff::state::{Bodies, Body};
use glam::{DVec3, Vec3};

/// The points of the manifold in a step.
fn of_step(meshes: [&CollisionMesh; 2], poses: &[Pose; 2], margin: f32) -> Vec<ManifoldPoint> {
    let (mut arena, mut bodies) = (MeshArena::default(), Bodies::default());
    let first = arena.add(meshes[0].clone());
    let second = if meshes[0].is_same(meshes[1]) {
        first
    } else {
        arena.add(meshes[1].clone())
    };
    for (slot, pose) in [first, second].into_iter().zip(poses) {
        let body = Body::at_rest(slot, pose.translation, pose.rotation, pose.scale);
        bodies.push(&body, &arena).expect("a usable body");
    }
    let bodies_of_pair = MarginPair { bodies: [0, 1], margin };
    cpu::of_pair(&bodies, &arena, bodies_of_pair).points
}

/// Compares both to the bit. Returns the number of points.
fn require_same(case: usize, meshes: [&CollisionMesh; 2], poses: &[Pose; 2], margin: f32) -> usize {
    let wanted = of_step(meshes, poses, margin);
    let [a, b] = [0, 1].map(|i| poses[i].place(meshes[i], DVec3::ZERO));
    let found = manifold(&mut ContactWorker::new(), &a, &b, margin);
    // A step keeps one of several points at which finely tessellated surfaces touch.
    let is_round = |point: &ManifoldPoint| {
        point
            .curvature_radii
            .iter()
            .any(|radius| *radius > 0.0 && radius.is_finite())
    };
    if !wanted.iter().any(is_round) {
        assert_eq!(found.len(), wanted.len(), "case {case}");
    }
    let mut next = found.iter();
    for wanted in &wanted {
        let same = |found: &&MeshContact| {
            (found.normal, found.separation, found.faces) == (wanted.normal, wanted.separation, wanted.faces)
        };
        let found = next
            .find(same)
            .unwrap_or_else(|| panic!("case {case}: {wanted:?} of {found:?}"));
        let anchors = [0, 1].map(|i| {
            let center = [a, b][i].center_of_mass() - [a, b][i].translation();
            (found.anchors[i] - center).as_vec3()
        });
        // In a step the anchors of finely tessellated surfaces lie on the smooth surface, in a query on the mesh.
        if wanted.bulge == 0.0 {
            assert_eq!(anchors, wanted.anchors, "case {case}");
        } else {
            let [a, b] = [0, 1].map(|i| wanted.anchors[i] - anchors[i]);
            let bulges = [a.dot(found.normal), -b.dot(found.normal)];
            assert!(bulges.iter().all(|bulge| *bulge > -1.0e-6), "case {case}: {bulges:?}");
            assert!(
                (bulges[0] + bulges[1] - wanted.bulge).abs() < 1.0e-6,
                "case {case}: {bulges:?}"
            );
            let aside = [a - bulges[0] * found.normal, b + bulges[1] * found.normal];
            assert!(
                aside.iter().all(|aside| aside.length() < 1.0e-6),
                "case {case}: {aside:?}"
            );
        }
    }
    found.len()
}

#[test]
fn the_manifolds_are_the_steps_to_the_bit() {
    let mut random = fastrand::Rng::with_seed(4);
    let meshes = meshes();
    let mut count = 0;
    for case in 0..400 {
        let pair = [&meshes[case % 4].1, &meshes[case / 4 % 4].1];
        let mut poses = touching(&mut random, pair[0], pair[1]);
        poses[1] = poses[1].moved(&mut random, 0.1, 0.0);
        if case % 3 == 0 {
            poses[0].scale = Vec3::new(1.1, 0.9, -1.2);
        }
        count += require_same(case, pair, &poses, [0.0, 0.01, 0.1][case % 3]);
    }
    assert!(count > 1000, "{count} points");
}

#[test]
fn so_are_those_of_a_mesh_in_itself_and_in_another() {
    for (case, (_, mesh)) in meshes().iter().enumerate() {
        let outer = Pose::new(Vec3::ZERO, glam::Quat::from_rotation_z(0.3));
        assert!(require_same(case, [mesh, mesh], &[outer, outer], 0.01) > 0);
        let inner = Pose {
            scale: Vec3::splat(0.2),
            ..outer
        };
        require_same(case, [mesh, mesh], &[outer, inner], 0.01);
        require_same(case, [mesh, mesh], &[inner, outer], 0.01);
    }
}
