//! Contact points of two placed meshes.

use super::placed::Placed;
use crate::geometry::mesh::MAX_COORDINATE;
use crate::manifolds;
use crate::manifolds::cpu::{Feature, Pair, Worker, feature_ids};
use crate::types::feature_id::FeatureId;
use glam::{DVec3, Vec3};

/// A point at which two placed meshes touch, overlap, or come near each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshContact {
    /// The point on each mesh's surface: from the mesh's own [`Placed::translation`], along the world's axes, metres. Where a
    /// corner of a finely cut round surface touches, it is the point where the round surface would touch.
    pub anchors: [DVec3; 2],
    /// Unit vector from the first mesh to the second, along the world's axes.
    pub normal: Vec3,
    /// How far the second mesh's point lies from the first's along the normal, metres; negative where they overlap.
    pub separation: f32,
    /// The faces on which the points lie, as indices of the input meshes.
    pub faces: [u32; 2],
    /// What of each mesh touches. The same two ids name the same point a little later.
    pub features: [FeatureId; 2],
}

/// What is remembered of two bodies from one call of [`ContactWorker::manifold`] to the next: nothing yet.
///
/// Keep one for each pair of bodies, in their order, and a default one for a pair that is new. What a memory holds never
/// changes the points that are found.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct PairMemory {}

/// Finds contact points of placed meshes. It keeps its memory, so that a call like one before allocates nothing. It starts no
/// thread and uses none but the caller's: give each thread a worker of its own.
///
/// In what it is asked, `margin` is how near the surfaces must come for points to be found, metres: 0 for those that touch or
/// overlap, more for those that may touch within the next step. A margin that is negative or not a number counts as 0. Meshes
/// that overlap have points however deep they do, whatever the margin is. Meshes more than
/// [`MAX_COORDINATE`] metres apart have none. Time grows with the surface within the margin.
///
/// The same meshes in the same places give the same bits, and so do both moved alike, however far: see [`Placed`].
#[derive(Default)]
pub struct ContactWorker {
    worker: Worker,
}

impl ContactWorker {
    /// The most points that a manifold has.
    pub const MAX_POINTS: usize = manifolds::MAX_POINTS;

    /// One without memory.
    pub fn new() -> Self {
        Self::default()
    }

    /// Appends all points at which the meshes are no farther apart than `margin`, each once: corners over faces, edges over
    /// edges, and those that stand for a deep overlap. Finely cut surfaces that lie on each other have thousands.
    pub fn points(&mut self, a: &Placed, b: &Placed, margin: f32, points: &mut Vec<MeshContact>) {
        self.find(a, b, margin, points, Worker::all);
    }

    /// Appends the contact manifold of the meshes: the few of [`ContactWorker::points`] that a solver needs, at most
    /// [`ContactWorker::MAX_POINTS`]. The deepest comes first, then always the one that is farthest from those before it.
    /// Their normals may differ: concave meshes touch in several places.
    pub fn manifold(
        &mut self,
        a: &Placed,
        b: &Placed,
        margin: f32,
        _memory: &mut PairMemory,
        points: &mut Vec<MeshContact>,
    ) {
        self.find(a, b, margin, points, Worker::reduced);
    }

    fn find(
        &mut self,
        a: &Placed,
        b: &Placed,
        margin: f32,
        points: &mut Vec<MeshContact>,
        of_pair: impl for<'w> FnOnce(&'w mut Worker, &Pair, f32) -> &'w [Feature],
    ) {
        // The points of two edges may be a little farther apart than the edges.
        let most = (1.01 * f64::from(margin.max(0.0))).min(f64::from(MAX_COORDINATE));
        if a.is_beyond(b, most) {
            return;
        }
        let frames = [a, b].map(|placed| placed.frame_about(a.translation()));
        let [mesh_a, mesh_b] = [a.in_frame(&frames[0]), b.in_frame(&frames[1])];
        let pair = Pair::new([&mesh_a, &mesh_b], a.mesh().is_same(b.mesh()));
        let features = of_pair(&mut self.worker, &pair, margin);
        points.extend(features.iter().map(|feature| {
            let (point, anchors) = pair.point(feature);
            MeshContact {
                anchors: [a.center_offset() + anchors[0], b.center_offset() + anchors[1]],
                normal: point.normal,
                separation: point.separation,
                faces: point.faces,
                features: feature_ids(&pair.sides, feature),
            }
        }));
    }
}
