//! The SIMD layout of a mesh for the CPU's triangle test: eight triangles or eight boxes at a time.

mod points;
mod slab;

pub use points::{Stored, StoredPoints, points};
pub use slab::SlabGroup;

use super::cluster::{CLUSTER, compact_order};
use super::features::MeshFeatures;
use crate::geometry::{Aabb, TriMesh};
use glam::Vec3;

/// A mesh in groups of eight, with box hierarchies above them. Coordinates are relative to the centre of mass. The
/// corners of a cluster are relative to one of them, because `f32` is most precise near zero.
pub struct MeshLanes {
    /// The triangles, in clusters of eight.
    pub clusters: Vec<Cluster>,
    /// The vertices of [`MeshFeatures`] in groups of eight, in their order, each with one bit per lane in use.
    pub vertices: Vec<(StoredPoints, u32)>,
    /// The box hierarchy above the groups of vertices, in the layout of `levels`.
    pub vertex_levels: Vec<Vec<BoxGroup>>,
    /// One vertex of each connected component of the mesh, in a spatially compact order.
    pub components: Vec<u32>,
    /// The box hierarchy above groups of eight such vertices, in the layout of `levels`.
    pub component_levels: Vec<Vec<BoxGroup>>,
    /// The box hierarchy above groups of eight of the mesh's caps, in the layout of `levels`.
    pub cap_levels: Vec<Vec<BoxGroup>>,
    /// The box hierarchy above the clusters, from the leaves up: boxes of clusters in groups of eight, then boxes of
    /// those groups in groups of eight, and so on up to one group.
    pub levels: Vec<Vec<BoxGroup>>,
    /// A slab for each box of `levels`, at the same position.
    pub slabs: Vec<Vec<SlabGroup>>,
    /// For each level, the mean half diagonal of its boxes.
    pub sizes: Vec<f32>,
    /// The bounding box of the mesh.
    pub aabb: Aabb,
    /// The longest edge of any triangle's bounding box.
    pub longest_side: f32,
}

/// Eight triangles.
#[derive(Clone, Copy)]
pub struct Cluster {
    /// One of the corners, in mesh space.
    pub origin: Vec3,
    /// The first, second and third corners, relative to `origin`.
    pub corners: [StoredPoints; 3],
    /// One bit per lane that holds a triangle. The other lanes repeat the last triangle.
    pub lanes: u32,
}

/// Eight boxes by centre and half size. An unused lane has a half size of minus infinity: it overlaps nothing, because
/// all comparisons with it are false.
#[derive(Clone, Copy)]
pub struct BoxGroup {
    /// Centres.
    pub center: StoredPoints,
    /// Half sizes.
    pub half: StoredPoints,
}

impl MeshLanes {
    /// Builds the layout of `mesh` with its features and its centre of mass.
    pub fn new(mesh: &TriMesh, features: &MeshFeatures, center: Vec3) -> Self {
        let count = mesh.triangles().len();
        let corners: Vec<[Vec3; 3]> = (0..count).map(|t| mesh.corners(t).map(|p| p - center)).collect();
        let boxes: Vec<Aabb> = corners.iter().map(|&t| Aabb::around(t)).collect();
        let clusters = (0..count)
            .step_by(CLUSTER)
            .map(|first| {
                let origin = mesh.corners(first)[0];
                let corner = |t: usize, k: usize| mesh.corners(t.min(count - 1))[k] - origin;
                Cluster {
                    origin,
                    corners: [0, 1, 2].map(|k| points(|lane| corner(first + lane, k))),
                    lanes: (1u32 << (count - first).min(CLUSTER)) - 1,
                }
            })
            .collect();
        let positions: Vec<Vec3> = features.vertices.iter().map(|p| *p - center).collect();
        let vertices = positions
            .chunks(CLUSTER)
            .map(|run| {
                let held = points(|lane| run[lane.min(run.len() - 1)]);
                (held, (1u32 << run.len()) - 1)
            })
            .collect();

        let eights = |positions: &[Vec3]| {
            let boxes = positions.chunks(CLUSTER).map(|run| Aabb::around(run.iter().copied()));
            box_levels(boxes.collect()).0
        };
        let component = |v: u32| mesh.vertices()[v as usize] - center;
        let some: Vec<Vec3> = mesh.component_vertices().iter().map(|&v| component(v)).collect();
        let components: Vec<u32> = compact_order(&some)
            .into_iter()
            .map(|i| mesh.component_vertices()[i as usize])
            .collect();
        let some: Vec<Vec3> = components.iter().map(|&v| component(v)).collect();
        let caps: Vec<Aabb> = (mesh.caps().iter())
            .map(|cap| Aabb::around(cap.map(|p| p - center)))
            .collect();
        let nodes = merge(&boxes);
        let aabb = nodes.iter().copied().fold(Aabb::EMPTY, Aabb::union);
        let (levels, sizes) = box_levels(nodes);
        Self {
            clusters,
            vertices,
            vertex_levels: eights(&positions),
            component_levels: eights(&some),
            components,
            cap_levels: box_levels(merge(&caps)).0,
            levels,
            slabs: slab::levels(&corners),
            sizes,
            aabb,
            longest_side: boxes.iter().map(|b| (b.max - b.min).max_element()).fold(0.0, f32::max),
        }
    }
}

/// The box hierarchy above `nodes` in the layout of [`MeshLanes::levels`], and the mean half diagonal of the boxes of
/// each level.
pub(crate) fn box_levels(mut nodes: Vec<Aabb>) -> (Vec<Vec<BoxGroup>>, Vec<f32>) {
    let (mut levels, mut sizes) = (Vec::new(), Vec::new());
    loop {
        levels.push(nodes.chunks(CLUSTER).map(BoxGroup::new).collect());
        let sum: f32 = nodes.iter().map(|b| b.half_size().length()).sum();
        sizes.push(sum / nodes.len() as f32);
        if nodes.len() <= CLUSTER {
            return (levels, sizes);
        }
        nodes = merge(&nodes);
    }
}

/// The union of each run of eight boxes.
fn merge(boxes: &[Aabb]) -> Vec<Aabb> {
    boxes
        .chunks(CLUSTER)
        .map(|run| run.iter().copied().fold(Aabb::EMPTY, Aabb::union))
        .collect()
}

impl BoxGroup {
    fn new(boxes: &[Aabb]) -> Self {
        Self {
            center: points(|lane| boxes.get(lane).map_or(Vec3::ZERO, |b| b.center())),
            // Rounding the centre must not shrink the box.
            half: points(|lane| {
                boxes.get(lane).map_or(Vec3::NEG_INFINITY, |b| {
                    let c = b.center();
                    (b.max - c).max(c - b.min)
                })
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{OneSided, shapes};

    #[test]
    fn lanes_hold_the_vertices_of_the_features() {
        let torus = shapes::torus_240();
        for mesh in [torus.clone(), torus.flipped()] {
            let (features, center) = (MeshFeatures::of(&mesh, OneSided::All), Vec3::new(0.1, 0.2, 0.3));
            let lanes = MeshLanes::new(&mesh, &features, center);
            let held = lanes.vertices.iter().flat_map(|(points, lanes)| {
                let held = (0..CLUSTER).filter(move |lane| lanes >> lane & 1 == 1);
                held.map(move |lane| Vec3::from_array(points.each_ref().map(|x| x.0[lane])))
            });
            assert!(held.eq(features.vertices.iter().map(|p| *p - center)));
        }
    }
}
