//! A mesh as the CPU's triangle test reads it: eight triangles, or eight boxes, at a time.

mod slab;

pub use slab::SlabGroup;

use super::cluster::{CLUSTER, compact_order};
use super::features::MeshFeatures;
use crate::geometry::{Aabb, TriMesh};
use glam::Vec3;
use wide::f32x8;

/// Three coordinates of eight points.
pub type Points = [f32x8; 3];

/// A mesh cut into eights. Coordinates are relative to the centre of mass, but those of a cluster's corners relative to one of
/// them: close to zero `f32` keeps the most digits.
pub struct MeshLanes {
    /// Triangles in clusters of eight.
    pub clusters: Vec<Cluster>,
    /// The vertices of [`MeshFeatures`], in their order, and one bit for each lane that holds one.
    pub vertices: Vec<(Points, u32)>,
    /// Boxes of the vertices' eights, in the same kind of groups as `levels`.
    pub vertex_levels: Vec<Vec<BoxGroup>>,
    /// A vertex of each connected component of the mesh, neighbours near each other.
    pub components: Vec<u32>,
    /// Boxes of the components' eights, in the same kind of groups as `levels`.
    pub component_levels: Vec<Vec<BoxGroup>>,
    /// Boxes of clusters in groups of eight, then boxes of those groups in groups of eight, and so on up to one group.
    pub levels: Vec<Vec<BoxGroup>>,
    /// Slabs around the same, in the same places.
    pub slabs: Vec<Vec<SlabGroup>>,
    /// For each level half the diagonal of its boxes, on average.
    pub sizes: Vec<f32>,
    /// Box of the whole mesh.
    pub aabb: Aabb,
    /// The longest side of any triangle's box.
    pub longest_side: f32,
}

/// Eight triangles.
#[derive(Clone, Copy)]
pub struct Cluster {
    /// One of the corners, in the mesh's own coordinates.
    pub origin: Vec3,
    /// First, second and third corners, relative to the origin.
    pub corners: [Points; 3],
    /// One bit for each lane that holds a triangle; the others repeat the last one.
    pub lanes: u32,
}

/// Eight boxes, by centre and half size. A lane without a box has a half size of minus infinity, which overlaps nothing:
/// all comparisons with what comes of it fail.
#[derive(Clone, Copy)]
pub struct BoxGroup {
    /// Centres.
    pub center: Points,
    /// Half sizes.
    pub half: Points,
}

impl MeshLanes {
    /// Cuts a mesh with these features and centre of mass up.
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
        let nodes = merge(&boxes);
        let aabb = nodes.iter().copied().fold(Aabb::EMPTY, Aabb::union);
        let (levels, sizes) = box_levels(nodes);
        Self {
            clusters,
            vertices,
            vertex_levels: eights(&positions),
            component_levels: eights(&some),
            components,
            levels,
            slabs: slab::levels(&corners),
            sizes,
            aabb,
            longest_side: boxes.iter().map(|b| (b.max - b.min).max_element()).fold(0.0, f32::max),
        }
    }
}

/// The boxes in groups of eight, then those groups in groups of eight, up to one group; with half the diagonal of the boxes of
/// each level, on average.
fn box_levels(mut nodes: Vec<Aabb>) -> (Vec<Vec<BoxGroup>>, Vec<f32>) {
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

/// The boxes of runs of eight.
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

/// Gathers eight points.
#[inline(always)]
pub fn points(at: impl Fn(usize) -> Vec3) -> Points {
    let (mut x, mut y, mut z) = ([0.0; CLUSTER], [0.0; CLUSTER], [0.0; CLUSTER]);
    for (lane, ((x, y), z)) in x.iter_mut().zip(&mut y).zip(&mut z).enumerate() {
        [*x, *y, *z] = at(lane).to_array();
    }
    [x, y, z].map(f32x8::new)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::shapes;

    #[test]
    fn lanes_hold_the_vertices_of_the_features() {
        let torus = shapes::torus_240();
        for mesh in [torus.clone(), torus.turned()] {
            let (features, center) = (MeshFeatures::of(&mesh), Vec3::new(0.1, 0.2, 0.3));
            let lanes = MeshLanes::new(&mesh, &features, center);
            let held = lanes.vertices.iter().flat_map(|(points, lanes)| {
                let held = (0..CLUSTER).filter(move |lane| lanes >> lane & 1 == 1);
                held.map(move |lane| Vec3::from_array(points.each_ref().map(|x| x.as_array()[lane])))
            });
            assert!(held.eq(features.vertices.iter().map(|p| *p - center)));
        }
    }
}
