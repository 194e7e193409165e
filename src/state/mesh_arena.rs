//! The mesh arena: the meshes in use, by slot.

pub use crate::geometry::lanes::{BoxGroup, Cluster, MeshLanes, SlabGroup, Stored, StoredPoints, points};

use crate::asset::CollisionMesh;
use crate::geometry::features::MeshFeatures;
use std::ops::Index;
use std::sync::Arc;

/// Meshes by slot. Bodies refer to slots.
#[derive(Clone, Default)]
pub struct MeshArena {
    slots: Vec<Option<MeshSlot>>,
}

/// A mesh with the data derived from it when it was baked or loaded. A step derives nothing more.
#[derive(Clone)]
pub struct MeshSlot {
    /// The asset.
    pub mesh: CollisionMesh,
    /// Triangles in groups of eight, for SIMD.
    pub lanes: Arc<MeshLanes>,
    /// Vertices and edges, for contact features.
    pub features: Arc<MeshFeatures>,
}

impl MeshSlot {
    /// A slot for a mesh.
    pub fn new(mesh: CollisionMesh) -> Self {
        Self {
            lanes: mesh.lanes().clone(),
            features: mesh.features().clone(),
            mesh,
        }
    }
}

impl MeshArena {
    /// Adds a mesh and returns its slot.
    pub fn add(&mut self, mesh: CollisionMesh) -> u32 {
        let free = self.slots.iter().position(Option::is_none);
        let slot = free.unwrap_or(self.slots.len());
        if free.is_none() {
            self.slots.push(None);
        }
        self.replace(slot as u32, mesh);
        slot as u32
    }

    /// Replaces the mesh in a slot.
    pub fn replace(&mut self, slot: u32, mesh: CollisionMesh) {
        self.slots[slot as usize] = Some(MeshSlot::new(mesh));
    }

    /// The content of a slot.
    pub fn get(&self, slot: u32) -> Option<&MeshSlot> {
        self.slots.get(slot as usize)?.as_ref()
    }

    /// Number of slots, in use or free.
    pub fn len(&self) -> usize {
        self.slots.len()
    }

    /// Whether there are no slots.
    pub fn is_empty(&self) -> bool {
        self.slots.is_empty()
    }

    /// Frees a slot. No body may refer to it any more.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::shapes;

    /// Derived data of a mesh is shared, not computed again.
    #[test]
    fn a_slot_shares_what_its_mesh_has() {
        let mesh = CollisionMesh::new(&shapes::cube(1.0));
        let mut arena = MeshArena::default();
        let slots = [(); 2].map(|()| arena.add(mesh.clone()));
        for slot in slots {
            assert!(Arc::ptr_eq(&arena[slot].lanes, mesh.lanes()));
            assert!(Arc::ptr_eq(&arena[slot].features, mesh.features()));
        }
    }
}
