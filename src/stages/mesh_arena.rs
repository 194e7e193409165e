//! The meshes in use, laid out as the CPU's triangle test reads them: eight triangles, or eight boxes, at a time.

mod slab;

pub use slab::SlabGroup;

use crate::asset::CollisionMesh;
use crate::geometry::Aabb;
use crate::geometry::cluster::{CLUSTER, compact_order};
use crate::geometry::features::MeshFeatures;
use glam::Vec3;
use std::collections::HashSet;
use std::ops::Index;
use std::sync::OnceLock;
use wide::f32x8;

/// Three coordinates of eight points.
pub type Points = [f32x8; 3];

/// The meshes in use, by slot.
#[derive(Default)]
pub struct MeshArena {
    slots: Vec<Option<MeshSlot>>,
    /// Meshes put into slots so far.
    versions: u64,
}

/// A mesh and its lanes.
pub struct MeshSlot {
    /// The asset.
    pub mesh: CollisionMesh,
    /// Derived from it.
    pub lanes: MeshLanes,
    /// Another one for every mesh that an arena gets, in whatever slot.
    pub version: u64,
    features: OnceLock<MeshFeatures>,
}

impl MeshSlot {
    /// Derives what the stages need from a mesh.
    pub fn new(mesh: CollisionMesh) -> Self {
        Self {
            lanes: MeshLanes::new(&mesh),
            mesh,
            version: 0,
            features: OnceLock::new(),
        }
    }

    /// Its vertices and edges; found at the first call, as only contact points need them.
    pub fn features(&self) -> &MeshFeatures {
        self.features.get_or_init(|| MeshFeatures::of(&self.mesh.mesh))
    }
}

/// A mesh cut into eights. Coordinates are relative to the centre of mass, but those of a cluster's corners relative to one of
/// them: close to zero `f32` keeps the most digits.
pub struct MeshLanes {
    /// Triangles in clusters of eight.
    pub clusters: Vec<Cluster>,
    /// The corners of all triangles, each position once, and one bit for each lane that holds one. In the order of
    /// [`MeshFeatures::vertices`].
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

impl MeshArena {
    /// Adds a mesh and tells its slot.
    pub fn add(&mut self, mesh: CollisionMesh) -> u32 {
        let free = self.slots.iter().position(Option::is_none);
        let slot = free.unwrap_or(self.slots.len());
        if free.is_none() {
            self.slots.push(None);
        }
        self.replace(slot as u32, mesh);
        slot as u32
    }

    /// Puts another mesh into a slot.
    pub fn replace(&mut self, slot: u32, mesh: CollisionMesh) {
        self.versions += 1;
        self.slots[slot as usize] = Some(MeshSlot {
            version: self.versions,
            ..MeshSlot::new(mesh)
        });
    }

    /// What is in a slot.
    pub fn get(&self, slot: u32) -> Option<&MeshSlot> {
        self.slots.get(slot as usize)?.as_ref()
    }

    /// Slots, in use or free.
    pub fn len(&self) -> usize {
        self.slots.len()
    }

    /// Whether there is no slot.
    pub fn is_empty(&self) -> bool {
        self.slots.is_empty()
    }

    /// Frees a slot, which no body may name any more.
    pub fn remove(&mut self, slot: u32) {
        self.slots[slot as usize] = None;
    }
}

impl Index<u32> for MeshArena {
    type Output = MeshSlot;
    fn index(&self, slot: u32) -> &MeshSlot {
        self.slots[slot as usize]
            .as_ref()
            .expect("bodies name only slots in use")
    }
}

impl MeshLanes {
    /// Cuts a mesh up.
    pub fn new(baked: &CollisionMesh) -> Self {
        let mesh = &baked.mesh;
        let center = baked.mass.center;
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
        let mut seen = HashSet::new();
        let positions: Vec<Vec3> = mesh
            .used_positions()
            // Adding zero turns -0 into 0.
            .filter(|p| seen.insert((*p + Vec3::ZERO).to_array().map(f32::to_bits)))
            .map(|p| p - center)
            .collect();
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
    use crate::geometry::{TriMesh, shapes};
    use crate::stages::triangle_test::cpu::lanes::lane_of;

    #[test]
    fn lanes_hold_vertices_in_the_order_of_features() {
        let torus = shapes::torus_240();
        let turned = torus.triangles().iter().map(|&[a, b, c]| [a, c, b]).collect();
        let inward = TriMesh::new(torus.vertices().to_vec(), turned).unwrap();
        for mesh in [torus, inward] {
            let slot = MeshSlot::new(CollisionMesh::new(&mesh));
            let held = slot.lanes.vertices.iter().flat_map(|(points, lanes)| {
                let held = (0..CLUSTER).filter(move |lane| lanes >> lane & 1 == 1);
                held.map(move |lane| lane_of(points, lane))
            });
            let center = slot.mesh.mass.center;
            let wanted = slot.features().vertices.iter().map(|p| *p - center);
            assert!(held.eq(wanted));
        }
    }
}
