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

    /// The ends of the core if that is a segment or a point, relative to the centre of mass, scaled, along the mesh's
    /// axes.
    #[inline]
    pub fn thin_ends(&self) -> Option<[Vec3; 2]> {
        if self.rounding == 0.0 || !self.mesh.mesh.is_thin() {
            return None;
        }
        let [start, _, end] = self.mesh.mesh.corners(0);
        Some([start, end].map(|end| self.scale * (end - self.mesh.mass.center)))
    }

    /// A point of the core that is at least as far along `u`, a vector along the mesh's axes, as all of the core,
    /// relative to the centre of mass, scaled.
    #[inline]
    pub fn core_support(&self, u: Vec3) -> Vec3 {
        match self.thin_ends() {
            Some([start, end]) => {
                if start.dot(u) > end.dot(u) {
                    start
                } else {
                    end
                }
            }
            None => self.scale * self.mesh.heights.support(self.scale * u),
        }
    }
}
