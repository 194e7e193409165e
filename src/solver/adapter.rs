//! Conversion between the bodies of a step and those of the solver.

use super::bodies::{SolverBodies, SolverBody, SolverMotion};
use crate::state::mesh_arena::MeshArena;
use crate::state::{Bodies, Plane};
use crate::types::body::RigidBody;
use glam::DMat3;

/// Key of the first plane; the keys of planes descend from here.
pub(crate) const PLANE_KEY: u64 = u64::MAX;

impl SolverBodies {
    /// Replaces all bodies by those of a step, followed by its planes as static bodies: plane `i` has the number
    /// `bodies.len() + i` and the key `u64::MAX - i`. All are awake.
    ///
    /// # Panics
    /// If there are fewer `keys` than bodies.
    pub fn read(&mut self, bodies: &Bodies, planes: &[Plane], keys: &[u64]) {
        self.clear();
        for (i, &key) in keys[..bodies.len()].iter().enumerate() {
            let frame = &bodies.frame[i];
            let params = &bodies.params[i];
            let body = SolverBody {
                kind: bodies.kind[i],
                inverse_mass: bodies.inverse_mass[i],
                inverse_inertia: bodies.local_inverse_inertia[i],
                radius: bodies.unpadded_radius[i],
                thickness: bodies.thickness[i],
                restitution: bodies.restitution[i],
                restitution_combine: params.restitution_combine,
                friction: params.friction.coefficient,
                friction_combine: params.friction.combine,
                gravity_scale: bodies.gravity_scale[i],
                linear_damping: params.linear_damping,
                angular_damping: params.angular_damping,
                max_linear_speed: params.max_linear_speed,
                max_angular_speed: params.max_angular_speed,
                locked_axes: params.locked_axes,
                solid: !bodies.sensor[i],
                continuous: params.continuous,
            };
            let motion = SolverMotion {
                center: frame.center,
                rotation: bodies.rotation[i].as_dquat().normalize(),
                linear_velocity: bodies.linear_velocity[i],
                angular_velocity: bodies.angular_velocity[i],
            };
            let number = self.push(key, body, motion);
            self.forces[number as usize] = params.forces;
        }
        for (i, plane) in planes.iter().enumerate() {
            let body = SolverBody {
                restitution: plane.restitution,
                restitution_combine: plane.restitution_combine,
                friction: plane.friction.coefficient,
                friction_combine: plane.friction.combine,
                ..SolverBody::immovable(RigidBody::Static, f32::INFINITY)
            };
            let center = plane.normal.as_dvec3() * plane.distance as f64;
            self.push(PLANE_KEY - i as u64, body, SolverMotion::at(center));
        }
    }

    /// Writes poses, frames and velocities to the bodies that these were read from. World inertia tensors, which are
    /// derived from poses, are stale afterwards.
    pub fn write(&self, bodies: &mut Bodies, meshes: &MeshArena) {
        for i in 0..bodies.len() {
            let motion = &self.motions[i];
            bodies.linear_velocity[i] = motion.linear_velocity;
            bodies.angular_velocity[i] = motion.angular_velocity;
            let before = &bodies.frame[i];
            let rotated = motion.rotation != bodies.rotation[i].as_dquat().normalize();
            if bodies.kind[i] == RigidBody::Static || (motion.center == before.center && !rotated) {
                continue;
            }
            let frame = &mut bodies.frame[i];
            let local_center = frame.scale * meshes[bodies.mesh[i]].mesh.mass.center.as_dvec3();
            frame.center = motion.center;
            frame.rotation = DMat3::from_quat(motion.rotation);
            frame.position = motion.center - frame.rotation * local_center;
            bodies.center[i] = motion.center.as_vec3();
            bodies.position[i] = frame.position.as_vec3();
            if rotated {
                bodies.rotation[i] = motion.rotation.as_quat();
            }
        }
    }
}
