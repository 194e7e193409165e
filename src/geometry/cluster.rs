//! The cluster order of triangles: neighbours in the list are neighbours in space.

use crate::geometry::{Aabb, TriMesh};
use glam::Vec3;

/// Triangles per cluster, and children per node of the tree above the clusters: one per SIMD lane.
pub const CLUSTER: usize = 8;

/// A permutation of the triangles that makes them an implicit 8-wide tree without pointers: each aligned run of
/// [`CLUSTER`] triangles is spatially compact, each aligned run of `CLUSTER * CLUSTER` is too, and so on.
///
/// Each split is along the longest axis of the centroids' bounding box. It is at the multiple of the largest such run
/// that is nearest to the median. The result depends only on the mesh.
pub(crate) fn cluster_order(mesh: &TriMesh) -> Vec<u32> {
    let centroids: Vec<Vec3> = (0..mesh.triangles().len())
        .map(|t| mesh.corners(t).map(|p| p / 3.0).iter().sum())
        .collect();
    compact_order(&centroids)
}

/// A permutation that orders points as [`cluster_order`] orders the centroids of triangles.
pub(crate) fn compact_order(points: &[Vec3]) -> Vec<u32> {
    let mut order: Vec<u32> = (0..points.len() as u32).collect();
    split(&mut order, points);
    order
}

fn split(order: &mut [u32], centroids: &[Vec3]) {
    if order.len() <= CLUSTER {
        // Selection leaves the order within a run unspecified. Sort it, so that the result does not depend on the
        // library.
        order.sort_unstable();
        return;
    }
    let mut run = CLUSTER;
    while run * CLUSTER < order.len() {
        run *= CLUSTER;
    }
    let runs = order.len().div_ceil(run);
    let middle = run * (runs / 2).max(1);
    let size = Aabb::around(order.iter().map(|&t| centroids[t as usize])).half_size();
    let axis = size.max_position();
    order.select_nth_unstable_by(middle, |&s, &t| {
        let at = |t: u32| centroids[t as usize][axis];
        at(s).total_cmp(&at(t)).then(s.cmp(&t))
    });
    let (left, right) = order.split_at_mut(middle);
    split(left, centroids);
    split(right, centroids);
}
