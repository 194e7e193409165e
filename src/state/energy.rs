//! Measures the mechanical energy of bodies.

use super::bodies::{Bodies, invert_inertia};
use crate::types::body::RigidBody;
use crate::types::energy::Energy;
use glam::{DVec3, Mat3, Vec3};

impl Bodies {
    /// The energy of all dynamic bodies in this field of gravity, m/s², asleep or not.
    pub fn energy(&self, gravity: Vec3) -> Energy {
        let mut energy = Energy::default();
        let is_dynamic = |&i: &usize| self.kind[i] == RigidBody::Dynamic && self.inverse_mass[i] > 0.0;
        // Not only the movers: dormant bodies are none.
        for i in (0..self.len()).filter(is_dynamic).filter(|&i| self.is_body(i)) {
            let (motion, center, inverse_inertia) = match self.compound_of(i as u32) {
                None => (self.motion(i), self.current_center(i), &self.local_inverse_inertia[i]),
                Some(compound) => (compound.motion, compound.center, &compound.local_inverse_inertia),
            };
            let mass = 1.0 / f64::from(self.inverse_mass[i]);
            energy.kinetic += 0.5 * mass * motion.linear_velocity.as_dvec3().length_squared();
            let local_spin = motion.rotation.as_dquat().inverse() * motion.angular_velocity.as_dvec3();
            energy.kinetic += rotational(inverse_inertia, local_spin);
            let weight = gravity.as_dvec3() * f64::from(self.gravity_scale[i]) * mass;
            energy.potential -= weight.dot(center);
        }
        energy
    }

    /// The centre of mass of a body of one collider. After a step on a device its frame is that of the step before.
    fn current_center(&self, i: usize) -> DVec3 {
        let frame = &self.frame[i];
        let arm = frame.rotation.transpose() * (frame.center - frame.position);
        self.position[i].as_dvec3() + self.rotation[i].as_dquat() * arm
    }
}

/// The energy of a rotation. Both are in the body's axes. A body that nothing rotates has none.
fn rotational(inverse_inertia: &Mat3, spin: DVec3) -> f64 {
    0.5 * spin.dot(invert_inertia(inverse_inertia.as_dmat3()) * spin)
}
