//! Measures the mechanical energy of bodies.

use super::bodies::{Bodies, invert_inertia};
use crate::types::body::RigidBody;
use crate::types::energy::Energy;
use glam::{DMat3, DVec3, Mat3, Vec3};

impl Bodies {
    /// The energy of all dynamic bodies in this field of gravity, m/s², asleep or not.
    pub fn energy(&self, gravity: Vec3) -> Energy {
        let mut energy = Energy::default();
        for i in (0..self.len()).filter(|&i| self.is_dynamic(i)) {
            let mass = 1.0 / f64::from(self.inverse_mass[i]);
            // A body with several colliders is counted with its first one.
            let (velocity, spin, inverse_inertia) = match self.part(i as u32) {
                None => {
                    let local_spin = self.frame[i].rotation.transpose() * self.angular_velocity[i].as_dvec3();
                    (self.linear_velocity[i], local_spin, &self.local_inverse_inertia[i])
                }
                Some(part) => {
                    let compound = &self.compounds[part.compound as usize];
                    let motion = &compound.motion;
                    let local_spin = compound.rotation.inverse() * motion.angular_velocity.as_dvec3();
                    (motion.linear_velocity, local_spin, &compound.local_inverse_inertia)
                }
            };
            let speed_squared = velocity.as_dvec3().length_squared();
            energy.kinetic += 0.5 * (mass * speed_squared + rotational(inverse_inertia, spin));
            let weight = gravity.as_dvec3() * f64::from(self.gravity_scale[i]) * mass;
            energy.potential -= weight.dot(self.frame[i].body_center);
        }
        energy
    }

    /// Whether this is the first collider of a dynamic body.
    fn is_dynamic(&self, i: usize) -> bool {
        self.kind[i] == RigidBody::Dynamic && self.body[i] as usize == i && self.inverse_mass[i] > 0.0
    }
}

/// Twice the energy of a rotation. Both are in the body's axes.
fn rotational(inverse_inertia: &Mat3, spin: DVec3) -> f64 {
    // Zero for a body that nothing rotates.
    let inertia: DMat3 = invert_inertia(inverse_inertia.as_dmat3());
    spin.dot(inertia * spin)
}
