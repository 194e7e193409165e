//! A mesh with its pose.

use super::bodies::{Bodies, Frame};
use super::mesh_arena::MeshArena;
use crate::asset::CollisionMesh;
use glam::Vec3;

/// A mesh placed in the world.
pub struct PlacedMesh<'a> {
    pub mesh: &'a CollisionMesh,
    pub frame: &'a Frame,
    pub scale: Vec3,
    /// Radius of the bounding sphere about the centre of mass, rounded up.
    pub radius: f32,
    /// Radius of the rounding, metres; see [`BakeSettings::rounding`](crate::projection::BakeSettings::rounding).
    pub rounding: f32,
}

impl<'a> PlacedMesh<'a> {
    /// Collider `i` of `bodies`.
    pub fn of(bodies: &'a Bodies, meshes: &'a MeshArena, i: u32) -> Self {
        let i = i as usize;
        Self {
            mesh: &meshes[bodies.mesh[i]].mesh,
            frame: &bodies.frame[i],
            scale: bodies.scale[i],
            radius: bodies.radius[i],
            rounding: bodies.rounding[i],
        }
    }
}
