//! Conversion between the bodies of a step and the bodies of the solver.

use super::bodies::SolverPart;
use super::bodies::{SleepState, SolverBodies, SolverBody, SolverMotion, Statics};
use crate::state::bodies::MAX_ACCELERATION;
use crate::state::fault::MAX_SPEED;
use crate::state::mesh_arena::MeshArena;
use crate::state::{Bodies, Compound, Plane};
use crate::types::body::{ExternalForces, RigidBody};
use glam::{DMat3, Mat3};

/// Key of the first plane; the keys of planes descend from here.
pub(crate) const PLANE_KEY: u64 = u64::MAX;

impl SolverBodies {
    /// Replaces all bodies by the bodies of a step, followed by its planes as static bodies: plane `i` has the number
    /// `bodies.len() + i` and the key `u64::MAX - i`. All are awake.
    ///
    /// # Panics
    /// If there are fewer `keys` than bodies.
    pub fn read(&mut self, bodies: &Bodies, planes: &[Plane], keys: &[u64]) {
        let changed = bodies.static_changes_since(self.revision);
        let same = bodies.same_since(self.revision, self.layout).min(self.colliders);
        if changed.is_some() {
            self.truncate(same);
            self.parts.clear();
        } else {
            self.clear();
        }
        let mut is_new = changed.is_none();
        for i in changed.unwrap_or_default().iter().map(|&i| i as usize) {
            let before = self.bodies[i];
            self.set(i, bodies);
            let now = &self.bodies[i];
            let was_thinnest = before.thickness <= self.statics.thinnest;
            is_new |= was_thinnest && now.thickness > before.thickness || before.solid != now.solid;
            self.statics.include(now);
        }
        let again = bodies.movers().take_while(|&i| i < same);
        again.for_each(|i| self.set(i, bodies));
        for (i, &key) in keys.iter().enumerate().take(bodies.len()).skip(self.len()) {
            let number = self.push(key, collider_of(bodies, i), collider_motion(bodies, i));
            self.forces[number as usize] = bodies.params[i].forces;
        }
        self.read_compounds(bodies);
        for i in bodies.movers() {
            let (forces, body) = (&mut self.forces[i], &self.bodies[i]);
            if !forces.is_zero() {
                *forces = forces.bounded(body.inverse_mass, &body.inverse_inertia, MAX_ACCELERATION);
            }
        }
        if bodies.revision.is_known() {
            if is_new {
                let mut statics = Statics::default();
                let all = &self.bodies[..bodies.static_count];
                all.iter().for_each(|body| statics.include(body));
                self.statics = statics;
            }
            self.moving.clear();
            self.moving.extend_from_slice(&bodies.moving);
            self.colliders = self.len();
            self.revision = bodies.revision;
            self.base = bodies.static_changes.base;
            self.layout = bodies.layout;
            if !self.dormant_name.is(bodies.dormant.name) {
                self.count_dormant(bodies);
            }
        }
        for (i, plane) in planes.iter().enumerate() {
            let body = SolverBody {
                restitution: plane.restitution,
                restitution_combine: plane.restitution_combine,
                friction: plane.friction.coefficient,
                friction_combine: plane.friction.combine,
                solid: !plane.sensor,
                ..SolverBody::immovable(RigidBody::Static, f32::INFINITY)
            };
            let center = plane.normal.as_dvec3() * plane.distance as f64;
            self.push(PLANE_KEY - i as u64, body, SolverMotion::at(center));
        }
    }

    /// Replaces body `i` by the body of a step, which is awake.
    fn set(&mut self, i: usize, bodies: &Bodies) {
        self.bodies[i] = collider_of(bodies, i);
        self.motions[i] = collider_motion(bodies, i);
        self.forces[i] = bodies.params[i].forces;
        self.sleep[i] = SleepState::default();
    }

    /// Takes the present list of movers, some of which were dormant.
    pub(crate) fn take_movers(&mut self, bodies: &Bodies) {
        self.moving.clear();
        self.moving.extend_from_slice(&bodies.moving);
        self.count_dormant(bodies);
    }

    fn count_dormant(&mut self, bodies: &Bodies) {
        self.dormant_name = bodies.dormant.name;
        self.dormant = Statics::default();
        for (body, _) in self.bodies.iter().zip(&bodies.dormant.flags).filter(|(_, flag)| **flag) {
            self.dormant.include(body);
        }
    }

    /// Moves the mass of compounds to their first colliders. Other colliders keep their own motions, which bound their
    /// speeds.
    fn read_compounds(&mut self, bodies: &Bodies) {
        self.part_index.clone_from(&bodies.part_index);
        for part in &bodies.parts {
            let compound = &bodies.compounds[part.compound as usize];
            self.parts.push(SolverPart {
                collider: part.collider,
                body: compound.number,
                offset: part.offset,
            });
            if part.collider != compound.number {
                let i = part.collider as usize;
                (self.bodies[i].inverse_mass, self.bodies[i].inverse_inertia) = (0.0, Mat3::ZERO);
                self.forces[i] = ExternalForces::default();
            }
        }
        for compound in &bodies.compounds {
            let i = compound.number as usize;
            (self.bodies[i], self.motions[i]) = (properties_of(bodies, i), motion_of(bodies, i));
        }
    }

    /// Writes poses, frames and velocities to the bodies that these were read from. World inertia tensors, which are
    /// derived from poses, are stale afterwards.
    pub fn write(&self, bodies: &mut Bodies, meshes: &MeshArena) {
        for compound in &mut bodies.compounds {
            let motion = &self.motions[compound.number as usize];
            compound.set(
                motion.center,
                motion.rotation,
                motion.linear_velocity,
                motion.angular_velocity,
            );
        }
        bodies.place_parts(0..bodies.parts.len());
        let mut parts = self.parts.iter().peekable();
        bodies.for_each_mover(|bodies, i| {
            while parts.next_if(|part| part.collider < i as u32).is_some() {}
            if parts.peek().is_some_and(|part| part.collider == i as u32) {
                return;
            }
            let motion = &self.motions[i];
            bodies.linear_velocity[i] = motion.linear_velocity;
            bodies.angular_velocity[i] = motion.angular_velocity;
            let before = &bodies.frame[i];
            let rotated = motion.rotation != bodies.rotation[i].as_dquat().normalize();
            if motion.center == before.center && !rotated {
                return;
            }
            let frame = &mut bodies.frame[i];
            let local_center = frame.scale * meshes[bodies.mesh[i]].mesh.mass.center.as_dvec3();
            (frame.center, frame.body_center) = (motion.center, motion.center);
            frame.rotation = DMat3::from_quat(motion.rotation);
            frame.position = motion.center - frame.rotation * local_center;
            bodies.center[i] = motion.center.as_vec3();
            bodies.position[i] = frame.position.as_vec3();
            if rotated {
                bodies.rotation[i] = motion.rotation.as_quat();
            }
        });
    }

    /// Removes all from this number on.
    fn truncate(&mut self, count: usize) {
        self.keys.truncate(count);
        self.bodies.truncate(count);
        self.motions.truncate(count);
        self.forces.truncate(count);
        self.sleep.truncate(count);
    }
}

/// Properties of the body with the number `i`.
pub(super) fn properties_of(bodies: &Bodies, i: usize) -> SolverBody {
    let own = collider_of(bodies, i);
    match compound_of(bodies, i) {
        None => own,
        Some(compound) => SolverBody {
            inverse_inertia: compound.local_inverse_inertia,
            extent: compound.radius,
            ..own
        },
    }
}

/// Motion of the body with the number `i`.
pub(super) fn motion_of(bodies: &Bodies, i: usize) -> SolverMotion {
    match compound_of(bodies, i) {
        None => collider_motion(bodies, i),
        Some(compound) => SolverMotion {
            center: compound.center,
            rotation: compound.rotation,
            linear_velocity: compound.motion.linear_velocity,
            angular_velocity: compound.motion.angular_velocity,
        },
    }
}

fn compound_of(bodies: &Bodies, i: usize) -> Option<&Compound> {
    let part = bodies.part(i as u32)?;
    Some(&bodies.compounds[part.compound as usize])
}

/// Properties of collider `i`, as if it were a body of its own.
fn collider_of(bodies: &Bodies, i: usize) -> SolverBody {
    let params = &bodies.params[i];
    SolverBody {
        kind: bodies.kind[i],
        inverse_mass: bodies.inverse_mass[i],
        own_inverse_mass: bodies.own_inverse_mass[i],
        inverse_inertia: bodies.local_inverse_inertia[i],
        radius: bodies.unpadded_radius[i],
        extent: bodies.unpadded_radius[i],
        thickness: bodies.thickness[i],
        restitution: bodies.restitution[i],
        restitution_combine: params.restitution_combine,
        friction: params.friction.coefficient,
        friction_combine: params.friction.combine,
        gravity_scale: bodies.gravity_scale[i],
        linear_damping: params.linear_damping,
        angular_damping: params.angular_damping,
        // Gravity, forces and impulses may accelerate a body without end.
        max_linear_speed: params.max_linear_speed.min(MAX_SPEED),
        max_angular_speed: params.max_angular_speed.min(MAX_SPEED),
        locked_axes: params.locked_axes,
        solid: !bodies.sensor[i],
        // The flag of others is for the sensors on their way.
        continuous: params.continuous && bodies.kind[i] == RigidBody::Dynamic,
    }
}

fn collider_motion(bodies: &Bodies, i: usize) -> SolverMotion {
    SolverMotion {
        center: bodies.frame[i].center,
        rotation: bodies.rotation[i].as_dquat().normalize(),
        linear_velocity: bodies.linear_velocity[i],
        angular_velocity: bodies.angular_velocity[i],
    }
}
