//! [`CollisionMesh`]: everything the five stages need to know about a mesh.

use crate::geometry::cluster::cluster_order;
use crate::geometry::{MassProperties, TriMesh};
use crate::projection::{BakeSettings, Cancelled, FaceTable, Progress, SupportHeights};
use bevy::prelude::*;
use std::ops::Deref;
use std::sync::Arc;

/// A baked mesh. Cloning is cheap: the data is shared and never changes.
#[derive(Asset, TypePath, Clone, Debug)]
pub struct CollisionMesh(Arc<BakedMesh>);

/// What a bake produces.
#[derive(Debug)]
pub struct BakedMesh {
    /// The validated mesh, its triangles in cluster order.
    pub mesh: TriMesh,
    /// Volume, centre of mass, inertia, thickness.
    pub mass: MassProperties,
    /// Radius of the bounding sphere about the centre of mass.
    pub radius: f32,
    /// Upper bounds of the reach in every direction, measured from the centre of mass.
    pub heights: SupportHeights,
    /// Faces of collision, if the settings asked for them; indices are triangles of `mesh`.
    pub faces: Option<FaceTable>,
    /// What was asked for.
    pub settings: BakeSettings,
}

impl Deref for CollisionMesh {
    type Target = BakedMesh;
    fn deref(&self) -> &BakedMesh {
        &self.0
    }
}

impl CollisionMesh {
    /// Bakes `mesh` on `pool`.
    pub fn bake(
        mesh: &TriMesh,
        settings: BakeSettings,
        pool: &rayon::ThreadPool,
        progress: &Progress,
    ) -> Result<Self, Cancelled> {
        let _ = (
            mesh,
            settings,
            pool,
            progress,
            cluster_order as fn(&TriMesh) -> Vec<u32>,
        );
        todo!()
    }

    /// Whether both are the same bake, not merely equal.
    pub fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }

    /// Heights and clusters only, which takes milliseconds and no pool.
    pub fn new(mesh: &TriMesh) -> Self {
        let _ = mesh;
        todo!()
    }
}
