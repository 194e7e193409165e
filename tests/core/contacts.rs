//! Contact points of two placed meshes, as another engine requests them.

use crate::scene::{self, identity, manifold, meshes, points, touching};
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::queries::{ContactWorker, FeatureKind, MeshContact, PairMemory, Placed};
use glam::{DVec3, Quat, Vec3};
use scene::Pose;

fn triangle(placed: &Placed, pose: &Pose, face: u32) -> [DVec3; 3] {
    let mesh = &placed.mesh().mesh;
    let t = mesh
        .face_ids()
        .iter()
        .position(|id| *id == face)
        .expect("a face of the mesh");
    mesh.corners(t)
        .map(|p| pose.rotation.as_dquat() * (pose.scale.as_dvec3() * p.as_dvec3()))
}

/// Requires that points lie on the planes of their faces and have the separation that they report.
fn require_sane(placed: [&Placed; 2], poses: [&Pose; 2], points: &[MeshContact]) {
    for point in points {
        for i in 0..2 {
            let [a, b, c] = triangle(placed[i], poses[i], point.faces[i]);
            let normal = (b - a).cross(c - a).normalize();
            assert!(normal.dot(point.anchors[i] - a).abs() < 1e-6, "{point:?}");
        }
        let way = placed[1].translation() - placed[0].translation() + point.anchors[1] - point.anchors[0];
        let along = way.dot(point.normal.as_dvec3());
        assert!((along - f64::from(point.separation)).abs() < 1e-6, "{point:?}");
        assert!((point.normal.length() - 1.0).abs() < 1e-6);
    }
}

#[test]
fn two_knots_have_contacts() {
    let mut random = fastrand::Rng::with_seed(1);
    let (knot, mut worker) = (CollisionMesh::new(&shapes::knot_1120()), ContactWorker::new());
    for _ in 0..20 {
        let poses = touching(&mut random, &knot, &knot);
        let [a, b] = poses
            .each_ref()
            .map(|pose| pose.place(&knot, DVec3::new(10.0, 0.0, -3.0)));
        let all = points(&mut worker, &a, &b, 0.02);
        let few = manifold(&mut worker, &a, &b, 0.02);
        require_sane([&a, &b], poses.each_ref(), &all);
        assert!((1..=16).contains(&few.len()) && few.len() <= all.len());
        assert!(few.iter().all(|point| all.contains(point)));
        let deepest = |points: &[MeshContact]| points.iter().map(|p| p.separation).fold(f32::INFINITY, f32::min);
        assert_eq!(few[0].separation, deepest(&all));
        assert!(deepest(&all) < 0.0 && all.iter().all(|p| p.separation <= 0.02));
    }
}

#[test]
fn the_margin_says_how_far_apart_points_are() {
    let (cube, mut worker) = (CollisionMesh::new(&shapes::cube(1.0)), ContactWorker::new());
    let [a, b] = [0.0, 1.125].map(|x| identity(&cube, DVec3::X * x));
    for margin in [0.0, 0.12, -1.0, f32::NAN] {
        assert_eq!(points(&mut worker, &a, &b, margin), []);
        assert_eq!(manifold(&mut worker, &a, &b, margin), []);
    }
    for margin in [0.13, 10.0, f32::INFINITY] {
        let found = points(&mut worker, &a, &b, margin);
        let facing: Vec<_> = found.iter().filter(|point| point.normal == Vec3::X).collect();
        assert!(facing.len() >= 4, "{found:?}");
        assert!(facing.iter().all(|point| point.separation == 0.125), "{facing:?}");
    }
    let far = identity(&cube, DVec3::X * 1e300);
    assert_eq!(points(&mut worker, &a, &far, f32::INFINITY), []);
}

#[test]
fn points_are_appended() {
    let (cube, mut worker) = (CollisionMesh::new(&shapes::cube(1.0)), ContactWorker::new());
    let [a, b] = [0.0, 1.0].map(|x| identity(&cube, DVec3::X * x));
    let mut points = Vec::new();
    worker.manifold(&a, &b, 0.1, &mut PairMemory::default(), &mut points);
    let once = points.clone();
    worker.manifold(&a, &b, 0.1, &mut PairMemory::default(), &mut points);
    assert_eq!(points, [&once[..], &once[..]].concat());
}

#[test]
fn far_from_the_origin_nothing_is_lost() {
    let mut random = fastrand::Rng::with_seed(2);
    let mut worker = ContactWorker::new();
    // Adding these to the bodies' 24-bit coordinates does not round.
    let offsets = [DVec3::new(1.0e6, -1.0e6, 1.0e6), DVec3::new(-3.0e6, 12.0, 0.25)];
    let meshes = meshes();
    for case in 0..200 {
        let [mesh_a, mesh_b] = [0, 1].map(|i| &meshes[(case + i * case / 4) % 4].1);
        let poses = touching(&mut random, mesh_a, mesh_b).map(|pose| Pose {
            translation: ((pose.translation + 1.0) * 4096.0).round() / 4096.0,
            ..pose
        });
        let mut at = |offset: DVec3| {
            let (a, b) = (poses[0].place(mesh_a, offset), poses[1].place(mesh_b, offset));
            assert_eq!(a.translation() - offset, poses[0].translation.as_dvec3());
            assert_eq!(b.translation() - offset, poses[1].translation.as_dvec3());
            [points(&mut worker, &a, &b, 0.02), manifold(&mut worker, &a, &b, 0.02)]
        };
        let here = at(DVec3::ZERO);
        for offset in offsets {
            assert_eq!(at(offset), here, "case {case}");
        }
    }
}

#[test]
fn one_inside_the_other_has_one_point() {
    let (ball, mut worker) = (CollisionMesh::new(&shapes::ball(0.5, 3)), ContactWorker::new());
    let outer = identity(&ball, DVec3::ZERO);
    let pose = Pose {
        scale: Vec3::splat(0.3),
        ..Pose::new(Vec3::X * 0.2, Quat::IDENTITY)
    };
    let found = points(&mut worker, &outer, &pose.place(&ball, DVec3::ZERO), 0.01);
    let [point] = &found[..] else { panic!("{found:?}") };
    assert_eq!(point.features.map(|id| id.kind()), [FeatureKind::Containment; 2]);
    assert!((point.separation + 0.45).abs() < 0.01, "{point:?}");
}

#[test]
fn a_worker_goes_to_another_thread() {
    fn is_send<T: Send>(_: &T) {}
    is_send(&ContactWorker::new());
    is_send(&PairMemory::default());
}
