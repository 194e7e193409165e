//! [`ContactWorker`]: contact points of two placed meshes.

use super::placed::Placed;
use crate::geometry::mesh::MAX_COORDINATE;
use crate::manifolds;
use crate::manifolds::cpu::{Feature, Kept, Pair, PairPoint, Worker, feature_ids};
use crate::types::feature_id::FeatureId;
use glam::{DVec3, Vec3};

/// A contact point of two placed meshes that touch, overlap or are near each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshContact {
    /// Anchors: the point on each mesh's surface relative to the mesh's [`Placed::translation`], in world axes, metres.
    /// Where a vertex of a finely tessellated curved surface touches, the anchor lies on the smooth surface that the
    /// mesh approximates. A point that stands for a deep overlap ([`FeatureKind::Overlap`]) may lie within the meshes.
    ///
    /// [`FeatureKind::Overlap`]: crate::types::feature_id::FeatureKind::Overlap
    pub anchors: [DVec3; 2],
    /// Unit vector from the first mesh to the second, in world axes.
    pub normal: Vec3,
    /// Signed distance from the first anchor to the second along the normal, metres; negative where the meshes overlap.
    pub separation: f32,
    /// Faces on which the anchors lie, indices of the source meshes.
    pub faces: [u32; 2],
    /// Features of each mesh that touch. The same two ids identify the same point after a small motion. Ids of overlaps
    /// may not: see [`FeatureKind::Overlap`].
    ///
    /// [`FeatureKind::Overlap`]: crate::types::feature_id::FeatureKind::Overlap
    pub features: [FeatureId; 2],
}

/// Data about a pair that is kept from one call of [`ContactWorker::manifold`] to the next.
///
/// Keep one for each pair of bodies, in their order, and use a default one for a new pair. The memory never changes the
/// points that are found.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct PairMemory {
    kept: Kept,
}

/// Finds contact points of placed meshes.
///
/// A worker keeps its memory, so a call as large as earlier ones allocates nothing. It starts no threads and runs on
/// the caller's: give each thread its own worker.
///
/// The `margin` of its methods is the speculative margin, metres: points are found where the surfaces are no farther
/// apart. Use 0 for surfaces that touch or overlap, more for those that may touch within the next step. A margin that
/// is negative or NaN counts as 0. Overlapping meshes have points whatever their depth and the margin. Meshes more than
/// [`MAX_COORDINATE`] metres apart have none. The time grows with the area of the surfaces within the margin.
///
/// Equal meshes with equal poses give the same bits, also if both are translated together, however far: see [`Placed`].
#[derive(Default)]
pub struct ContactWorker {
    worker: Worker,
    /// Memory for calls without a [`PairMemory`].
    one_call: Kept,
}

impl ContactWorker {
    /// Maximum number of points of a manifold.
    pub const MAX_POINTS: usize = manifolds::MAX_POINTS;

    /// A worker without allocated memory.
    pub fn new() -> Self {
        Self::default()
    }

    /// Appends all contact points within `margin`, each once: vertex-face and edge-edge features, and points that stand
    /// for deep overlaps. Finely tessellated surfaces that lie on each other have thousands.
    pub fn points(&mut self, a: &Placed, b: &Placed, margin: f32, points: &mut Vec<MeshContact>) {
        let Self { worker, one_call } = self;
        find([a, b], margin, points, |pair| {
            worker.all(pair, margin, one_call.for_one_call(), 1)
        });
    }

    /// Appends the reduced contact manifold: the points of [`ContactWorker::points`] that a solver needs, at most
    /// [`ContactWorker::MAX_POINTS`]. The deepest comes first, then repeatedly the one farthest from those before it.
    /// Normals may differ: concave meshes touch in several places.
    pub fn manifold(
        &mut self,
        a: &Placed,
        b: &Placed,
        margin: f32,
        memory: &mut PairMemory,
        points: &mut Vec<MeshContact>,
    ) {
        let worker = &mut self.worker;
        find([a, b], margin, points, |pair| {
            worker.reduced(pair, margin, &mut memory.kept, 1)
        });
    }
}

/// Appends the points of the features that `of_pair` finds.
fn find<'w>(
    [a, b]: [&Placed; 2],
    margin: f32,
    points: &mut Vec<MeshContact>,
    of_pair: impl FnOnce(&Pair) -> &'w [Feature],
) {
    // The points of an edge-edge feature may be slightly farther apart than the edges.
    let most = (1.01 * f64::from(margin.max(0.0))).min(f64::from(MAX_COORDINATE));
    if a.is_beyond(b, most) {
        return;
    }
    let frames = [a, b].map(|placed| placed.frame_about(a.translation()));
    let [mesh_a, mesh_b] = [a.in_frame(&frames[0]), b.in_frame(&frames[1])];
    let pair = Pair::new([&mesh_a, &mesh_b]);
    points.extend(of_pair(&pair).iter().map(|feature| {
        // The points lie on the meshes, not on the smooth surfaces for which these may stand.
        let PairPoint { point, on_meshes, .. } = pair.point(feature, DVec3::ZERO);
        MeshContact {
            anchors: [a.center_offset() + on_meshes[0], b.center_offset() + on_meshes[1]],
            normal: point.normal,
            separation: point.separation,
            faces: point.faces,
            features: feature_ids(&pair.sides, feature),
        }
    }));
}
