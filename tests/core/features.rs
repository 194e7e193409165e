//! Feature ids identify what touches, and persist under small motions.

use crate::scene::{Pose, identity, manifold, meshes, points, touching};
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::queries::{ContactWorker, FeatureId, FeatureKind, MeshContact, Placed};
use glam::{DVec3, Quat, Vec3};
use std::collections::{BTreeMap, HashMap};

/// Counts points that exist before and after a small motion, and those of equal ids.
#[derive(Debug, Default)]
struct Share {
    same: usize,
    all: usize,
}

impl Share {
    fn add(&mut self, before: &[MeshContact], after: &[MeshContact]) {
        for point in after {
            let apart = |other: &&MeshContact| point.anchors[0].distance(other.anchors[0]);
            let is_it = |other: &&MeshContact| apart(other) < 0.01 && point.normal.dot(other.normal) > 0.97;
            let candidates: Vec<_> = before.iter().filter(is_it).collect();
            self.all += usize::from(!candidates.is_empty());
            self.same += usize::from(candidates.iter().any(|other| other.features == point.features));
        }
    }

    fn percent(&self) -> f64 {
        100.0 * self.same as f64 / self.all as f64
    }
}

/// The point of each pair of ids; ids are unique.
fn by_ids(points: &[MeshContact]) -> HashMap<[FeatureId; 2], &MeshContact> {
    let all: HashMap<_, _> = points.iter().map(|point| (point.features, point)).collect();
    assert_eq!(all.len(), points.len(), "{points:?}");
    all
}

#[test]
fn ids_last_while_bodies_move_a_little() {
    // Motions of a step of 1/60 s at 1 cm/s and at 10 cm/s; `least` is the least percentage of ids that must persist.
    for (motion, least) in [(2.0e-4, 99.5), (2.0e-3, 95.0)] {
        for (name, mesh) in &meshes()[..3] {
            for depth in [0.0, 0.03] {
                let share = ids_that_last(mesh, depth, motion);
                println!("{name}, {depth} m deeper, moved by {motion} m: {share:?}");
                assert!(share.all.all > 1000 && share.all.percent() > least);
                assert!(share.chosen.percent() > least);
                assert_eq!(share.far, 0);
            }
        }
    }
}

#[derive(Debug, Default)]
struct Shares {
    /// Share among all points.
    all: Share,
    /// Share among manifold points, some of which are newly selected.
    chosen: Share,
    /// Number of points whose ids existed before, and of those that moved far. In an overlap the points of a patch may
    /// swap their numbers.
    named: usize,
    far: usize,
    far_in_overlaps: usize,
    kinds: BTreeMap<[FeatureKind; 2], usize>,
}

fn ids_that_last(mesh: &CollisionMesh, depth: f32, motion: f32) -> Shares {
    let mut random = fastrand::Rng::with_seed(5);
    let mut worker = ContactWorker::new();
    let mut shares = Shares::default();
    for _ in 0..50 {
        let [first, mut second] = touching(&mut random, mesh, mesh);
        second.translation *= 1.0 - depth;
        let a = first.place(mesh, DVec3::ZERO);
        let mut find = |b: &Pose| {
            let b = b.place(mesh, DVec3::ZERO);
            [points(&mut worker, &a, &b, 0.01), manifold(&mut worker, &a, &b, 0.01)]
        };
        let mut before = find(&second);
        for _ in 0..20 {
            second = second.moved(&mut random, motion, 2.0 * motion);
            let after = find(&second);
            shares.all.add(&before[0], &after[0]);
            shares.chosen.add(&before[1], &after[1]);
            let names = by_ids(&before[0]);
            for point in &after[0] {
                *shares.kinds.entry(point.features.map(|id| id.kind())).or_default() += 1;
                if let Some(other) = names.get(&point.features) {
                    shares.named += 1;
                    let is_far = point.anchors[0].distance(other.anchors[0]) > 0.05;
                    let is_overlap = matches!(point.features[0].kind(), FeatureKind::Overlap { .. });
                    shares.far += usize::from(is_far && !is_overlap);
                    shares.far_in_overlaps += usize::from(is_far && is_overlap);
                }
            }
            before = after;
        }
    }
    shares
}

#[test]
fn a_box_at_rest_keeps_all_its_ids() {
    let mut random = fastrand::Rng::with_seed(6);
    let [large, small] = [2.0, 1.0].map(|size| CollisionMesh::new(&shapes::cube(size)));
    let mut worker = ContactWorker::new();
    let ground = identity(&large, DVec3::ZERO);
    for turn in 0..20 {
        // Away from the diagonal of the ground's face, so that no corner crosses it.
        let rest = Pose::new(
            Vec3::new(0.03, 1.5, 0.01),
            Quat::from_rotation_y(0.1 + 0.06 * turn as f32),
        );
        let mut wanted: Option<Vec<[FeatureId; 2]>> = None;
        for _ in 0..100 {
            let pose = rest.moved(&mut random, 1.0e-4, 1.0e-4);
            let mut found = manifold(&mut worker, &ground, &pose.place(&small, DVec3::ZERO), 0.01);
            // Where a corner penetrates by a thousandth of a millimetre, overlap points exist beside it.
            found.retain(|point| point.features[1].kind() == FeatureKind::Vertex);
            let mut ids: Vec<_> = found.iter().map(|point| point.features).collect();
            ids.sort_unstable();
            assert_eq!(ids.len(), 4, "{found:?}");
            assert_eq!(*wanted.get_or_insert_with(|| ids.clone()), ids, "{found:?}");
        }
    }
}

/// Requires that the id identifies the feature of the input mesh at the anchor.
fn names(placed: &Placed, pose: &Pose, input: &TriMesh, id: FeatureId, anchor: DVec3) {
    let place = |v: u32| pose.rotation.as_dquat() * input.vertices()[v as usize].as_dvec3();
    let index = id.index();
    let face = |face: u32| {
        let at = input.face_ids().iter().position(|id| *id == face).expect("a face");
        input.triangles()[at].map(place)
    };
    match id.kind() {
        FeatureKind::Vertex => assert!(place(index).distance(anchor) < 1e-6, "{id:?}"),
        FeatureKind::Edge => {
            let corners = face(index / 3);
            let (from, to) = (corners[index as usize % 3], corners[(index as usize + 1) % 3]);
            let apart = (anchor - from).cross(to - from).length() / (to - from).length();
            assert!(apart < 1e-6, "{id:?} {apart}");
        }
        FeatureKind::Face => {
            let [a, b, c] = face(index);
            let normal = (b - a).cross(c - a).normalize();
            assert!(normal.dot(anchor - a).abs() < 1e-6, "{id:?}");
        }
        _ => {}
    }
    assert_eq!(placed.mesh().mesh.face_ids().len(), input.face_ids().len());
}

#[test]
fn ids_name_corners_edges_and_faces_of_the_input() {
    let mut random = fastrand::Rng::with_seed(7);
    let mut worker = ContactWorker::new();
    // Coarse meshes: their anchors are not moved to a smooth surface. The bake flips the second one.
    let cube = shapes::cube(0.8);
    let knob = shapes::torus(8, 6, 0.4, 0.15);
    let inward = knob.clone().flipped();
    let inward = TriMesh::new(inward.vertices().to_vec(), inward.triangles().to_vec()).unwrap();
    let solid = bevy_faceoff::projection::BakeSettings {
        inward: bevy_faceoff::projection::Inward::Solid,
        ..Default::default()
    };
    let baked = [
        (CollisionMesh::new(&cube), cube),
        (CollisionMesh::new(&knob), knob),
        (CollisionMesh::without_faces(&inward, solid), inward),
    ];
    assert!((0..baked[2].1.triangles().len()).all(|t| baked[2].0.mesh.is_turned(t)));
    let mut kinds = BTreeMap::new();
    for case in 0..300 {
        let [(mesh_a, input_a), (mesh_b, input_b)] = [&baked[case % 3], &baked[case / 3 % 3]];
        let poses = touching(&mut random, mesh_a, mesh_b);
        let (a, b) = (poses[0].place(mesh_a, DVec3::ZERO), poses[1].place(mesh_b, DVec3::ZERO));
        for point in points(&mut worker, &a, &b, 0.01) {
            names(&a, &poses[0], input_a, point.features[0], point.anchors[0]);
            names(&b, &poses[1], input_b, point.features[1], point.anchors[1]);
            *kinds.entry(point.features[0].kind()).or_insert(0) += 1;
        }
    }
    for kind in [FeatureKind::Vertex, FeatureKind::Edge, FeatureKind::Face] {
        assert!(kinds[&kind] > 50, "{kinds:?}");
    }
}
