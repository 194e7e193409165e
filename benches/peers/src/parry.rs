//! parry3d: first hits and contact manifolds of pairs of triangle meshes, and pairs of overlapping boxes from its
//! bounding volume hierarchy.

use crate::scene::{STEP, Scene};
use parry3d::bounding_volume::Aabb;
use parry3d::math::{Pose, Rotation, Vector};
use parry3d::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};
use parry3d::query::details::ContactManifoldsWorkspace;
use parry3d::query::{self, ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher, RayCast};
use parry3d::shape::{Shape, TriMesh};
use serde::Serialize;

/// The distances in metres within which contacts are reported: 0, and the default of rapier3d.
pub const PREDICTIONS: [f32; 2] = [0.0, 0.02];

/// The bodies. Each has its own mesh, scaled in advance, because parry has no scaled view of a mesh.
pub struct Parry {
    meshes: Vec<TriMesh>,
    poses: Vec<Pose>,
    boxes: Vec<Aabb>,
    /// The boxes one step later.
    later: Vec<Aabb>,
}

/// The result of contact manifolds.
#[derive(Clone, Copy, Default, Serialize)]
pub struct Manifolds {
    /// The number of pairs with contacts within the prediction distance.
    pub near: usize,
    /// The number of pairs with contacts whose distance is not positive.
    pub touching: usize,
}

impl Parry {
    /// Adds the bodies of `scene`.
    pub fn new(scene: &Scene) -> Self {
        let mesh = |body| {
            let (vertices, triangles) = scene.scaled_mesh(body);
            TriMesh::new(vertices.map(|v| Vector::from(v.to_array())).collect(), triangles).expect("a valid mesh")
        };
        let meshes: Vec<TriMesh> = scene.bodies.iter().map(mesh).collect();
        let poses: Vec<Pose> = scene.bodies.iter().map(|b| pose(&b.pose)).collect();
        let boxes: Vec<Aabb> = meshes.iter().zip(&poses).map(|(m, p)| m.compute_aabb(p)).collect();
        let later = boxes.iter().zip(&scene.bodies).map(|(aabb, body)| {
            let way = Vector::from((body.velocity * STEP.as_secs_f32()).to_array());
            Aabb::new(aabb.mins + way, aabb.maxs + way)
        });
        Self {
            later: later.collect(),
            meshes,
            poses,
            boxes,
        }
    }

    /// Puts the body of the larger box first in each pair. The order matters, because parry visits all triangles of the
    /// first mesh near the second. It sorts pairs in this way itself, but only for contact manifolds.
    pub fn larger_first(&self, pairs: &[[u32; 2]]) -> Vec<[u32; 2]> {
        let size = |i: u32| self.boxes[i as usize].half_extents().length_squared();
        let sorted = |&[a, b]: &[u32; 2]| if size(a) < size(b) { [b, a] } else { [a, b] };
        pairs.iter().map(sorted).collect()
    }

    /// The pairs whose surfaces intersect. The test of a pair ends at the first hit.
    pub fn first_hits(&self, pairs: &[[u32; 2]]) -> Vec<[u32; 2]> {
        let hit = |pair: &&[u32; 2]| {
            let [a, b] = pair.map(|i| i as usize);
            query::intersection_test(&self.poses[a], &self.meshes[a], &self.poses[b], &self.meshes[b])
                .expect("meshes are supported")
                .intersecting
        };
        pairs.iter().filter(hit).copied().collect()
    }

    /// A tree over the boxes of all bodies, for rays.
    pub fn tree_of_boxes(&self) -> Bvh {
        Bvh::from_leaves(BvhBuildStrategy::Binned, &self.boxes)
    }

    /// The distance of a ray's first hit on any body, infinite if there is none. The normal is computed too. `way` has unit
    /// length.
    pub fn first_hit_of_ray(&self, tree: &Bvh, origin: [f32; 3], way: [f32; 3]) -> f32 {
        let ray = query::Ray::new(Vector::from(origin), Vector::from(way));
        let hit = |body: u32, most: f32| {
            let (mesh, pose) = (&self.meshes[body as usize], &self.poses[body as usize]);
            let hit = mesh.cast_ray_and_get_normal(pose, &ray, most, false)?;
            Some(hit.time_of_impact)
        };
        tree.cast_ray(&ray, f32::MAX, hit)
            .map_or(f32::INFINITY, |(_, distance)| distance)
    }

    /// Moves all bodies to where they are after so many steps. The boxes stay.
    pub fn move_to(&mut self, scene: &Scene, step: usize) {
        for (at, body) in self.poses.iter_mut().zip(&scene.bodies) {
            *at = pose(&body.pose_after(step));
        }
    }

    /// The contact manifolds of all `pairs`, computed from scratch without those of an earlier round.
    pub fn manifolds(&self, pairs: &[[u32; 2]], prediction: f32) -> Manifolds {
        let mut found = Manifolds::default();
        for &pair in pairs {
            let mut kept = KeptPair::default();
            self.update(pair, prediction, &mut kept);
            found.add(&kept);
        }
        found
    }

    /// The contact manifolds of all `pairs`, with what is kept of the same pairs from the step before.
    pub fn update_manifolds(&self, pairs: &[[u32; 2]], prediction: f32, kept: &mut Kept) {
        for (&pair, kept) in pairs.iter().zip(&mut kept.pairs) {
            self.update(pair, prediction, kept);
        }
    }

    fn update(&self, pair: [u32; 2], prediction: f32, kept: &mut KeptPair) {
        let [a, b] = pair.map(|i| i as usize);
        DefaultQueryDispatcher
            .contact_manifolds(
                &self.poses[a].inv_mul(&self.poses[b]),
                &self.meshes[a],
                &self.meshes[b],
                prediction,
                &mut kept.manifolds,
                &mut kept.workspace,
            )
            .expect("meshes are supported");
    }
}

/// What parry3d keeps of each pair.
pub struct Kept {
    pairs: Vec<KeptPair>,
}

#[derive(Default)]
struct KeptPair {
    manifolds: Vec<ContactManifold<(), ()>>,
    workspace: Option<ContactManifoldsWorkspace>,
}

impl Kept {
    /// Nothing, for so many pairs.
    pub fn new(pairs: usize) -> Self {
        Self {
            pairs: std::iter::repeat_with(KeptPair::default).take(pairs).collect(),
        }
    }
}

impl Manifolds {
    fn add(&mut self, kept: &KeptPair) {
        let points = || kept.manifolds.iter().flat_map(|m| &m.points);
        self.near += usize::from(points().next().is_some());
        self.touching += usize::from(points().any(|p| p.dist <= 0.0));
    }
}

/// The broad phase. Boxes are computed in advance, as are the bounding spheres of bevy_faceoff.
pub struct BroadPhase<'a> {
    parry: &'a Parry,
    tree: Bvh,
    workspace: BvhWorkspace,
}

impl<'a> BroadPhase<'a> {
    /// A tree around the bodies.
    pub fn new(parry: &'a Parry) -> Self {
        Self {
            parry,
            tree: Bvh::from_leaves(BvhBuildStrategy::Binned, &parry.boxes),
            workspace: BvhWorkspace::default(),
        }
    }

    /// Rebuilds the tree, then finds all pairs of overlapping boxes.
    pub fn rebuilt(&mut self) -> Vec<[u32; 2]> {
        self.tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &self.parry.boxes);
        self.pairs()
    }

    /// Refits the tree to the boxes one step later, so that [`Self::refitted`] has work to do.
    pub fn misfit(&mut self) {
        self.fit(&self.parry.later);
    }

    /// Refits the tree to bodies that have all moved by one step, then finds all pairs of overlapping boxes.
    pub fn refitted(&mut self) -> Vec<[u32; 2]> {
        self.fit(&self.parry.boxes);
        self.pairs()
    }

    fn fit(&mut self, boxes: &[Aabb]) {
        for (aabb, leaf) in boxes.iter().zip(0..) {
            self.tree.insert_or_update_partially(*aabb, leaf, 0.0);
        }
        self.tree.refit(&mut self.workspace);
    }

    fn pairs(&mut self) -> Vec<[u32; 2]> {
        let mut pairs = Vec::new();
        self.tree
            .traverse_bvtt_single_tree::<false>(&mut self.workspace, &mut |a, b| pairs.push([a.min(b), a.max(b)]));
        pairs
    }
}

fn pose(transform: &bevy::prelude::Transform) -> Pose {
    Pose::from_parts(
        Vector::from(transform.translation.to_array()),
        Rotation::from_array(transform.rotation.to_array()),
    )
}
