//! Bodies whose colliders are placed in them: several colliders, or one that is not at the body's origin.

use super::bodies::{Bodies, Frame, bounding_radius, invert_inertia};
use super::body::{Body, Motion};
use super::checks::check_body;
use super::fault::BodyFault;
use super::mesh_arena::MeshArena;
use crate::types::body::RigidBody;
use glam::{DMat3, DQuat, DVec3, Mat3, Quat, Vec3};
use std::ops::Range;

/// A moving body whose colliders are placed in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compound {
    /// The number of its first collider, which is also its own.
    pub number: u32,
    /// Pose in the world, and velocities; the linear velocity is that of the centre of mass.
    pub motion: Motion,
    /// The centre of mass in the body's axes, from its origin, metres.
    pub local_center: DVec3,
    /// The centre of mass in the world.
    pub center: DVec3,
    /// From the body's axes to the world's, of unit length: the rotation of `motion` in double precision.
    pub rotation: DQuat,
    /// Inverse inertia tensor about the centre of mass in the body's axes; zero if contacts cannot rotate it.
    pub local_inverse_inertia: Mat3,
    /// Distance of the farthest point from the centre of mass, metres.
    pub radius: f32,
}

/// A collider of a [`Compound`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompoundPart {
    /// Number of the collider.
    pub collider: u32,
    /// Pose of the collider in the body.
    pub pose: LocalPose,
    /// Index of its body in [`Bodies::compounds`].
    pub compound: u32,
    /// From the body's centre of mass to the collider's, in the body's axes, metres.
    pub offset: DVec3,
}

/// Pose of a collider in its body. The scale is not included.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct LocalPose {
    /// Position of the mesh's origin, in the body's axes, metres.
    pub translation: DVec3,
    /// From the mesh's axes to the body's; of unit length.
    pub rotation: DQuat,
}

impl Compound {
    /// Sets velocity and pose. `center` is the centre of mass; `rotation` has unit length. The colliders follow with
    /// [`Bodies::place_parts`]. A pose that does not change keeps its bits.
    pub(crate) fn set(&mut self, center: DVec3, rotation: DQuat, linear_velocity: Vec3, angular_velocity: Vec3) {
        let rotated = rotation != self.rotation;
        let motion = &mut self.motion;
        (motion.linear_velocity, motion.angular_velocity) = (linear_velocity, angular_velocity);
        if rotated {
            motion.rotation = rotation.as_quat();
        }
        if rotated || center != self.center {
            motion.position = (center - rotation * self.local_center).as_vec3();
        }
        (self.center, self.rotation) = (center, rotation);
    }
}

/// A collider for [`Bodies::join`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewCompoundPart {
    /// Number of the collider.
    pub collider: u32,
    /// Pose of the collider in the body.
    pub pose: LocalPose,
    /// Kilograms per cubic metre.
    pub density: f32,
}

/// Mass, centre of mass and inertia of several colliders.
struct Total {
    mass: f64,
    center: DVec3,
    inertia: DMat3,
}

impl LocalPose {
    /// At the body's origin, along its axes.
    pub const IDENTITY: Self = Self {
        translation: DVec3::ZERO,
        rotation: DQuat::IDENTITY,
    };
}

impl Bodies {
    /// Makes one body of colliders that were pushed with their own poses and parameters. `body` describes it; its mesh,
    /// scale and density are not used. `center` overrides the centre of mass, in the body's axes from its origin. The
    /// `parts` are ascending, and there is at least one.
    ///
    /// Sensors have no mass, unless all colliders are sensors.
    ///
    /// # Errors
    /// If a number of `body` is invalid. Then nothing changes.
    ///
    /// # Panics
    /// If a collider was not pushed.
    pub fn join(
        &mut self,
        body: &Body,
        center: Option<Vec3>,
        parts: &[NewCompoundPart],
        meshes: &MeshArena,
    ) -> Result<(), BodyFault> {
        check_body(body)?;
        let number = parts[0].collider;
        let total = self.total(body, center, parts, meshes);
        let rotation = super::bodies::unit(body.rotation);
        let dynamic = body.kind == RigidBody::Dynamic;
        let inverse_mass = if dynamic { (1.0 / total.mass) as f32 } else { 0.0 };
        let own_inverse_mass = match body.kind {
            RigidBody::Static => 0.0,
            _ => (1.0 / total.mass) as f32,
        };
        let local_inverse_inertia = match body.inertia {
            _ if !dynamic => DMat3::ZERO,
            Some(inertia) => inertia.as_dmat3().inverse(),
            None => invert_inertia(total.inertia),
        };
        let compound = self.compounds.len() as u32;
        let mut radius = 0.0f64;
        for &NewCompoundPart { collider, pose, .. } in parts {
            let i = collider as usize;
            let mesh_center = meshes[self.mesh[i]].mesh.mass.center.as_dvec3();
            let offset = pose.translation + pose.rotation * (self.frame[i].scale * mesh_center) - total.center;
            radius = radius.max(offset.length() + f64::from(self.unpadded_radius[i]));
            self.body[i] = number;
            self.inverse_mass[i] = inverse_mass;
            self.own_inverse_mass[i] = own_inverse_mass;
            self.parts.push(CompoundPart {
                collider,
                pose,
                compound,
                offset,
            });
        }
        let turn = rotation.as_dquat().normalize();
        self.compounds.push(Compound {
            number,
            motion: Motion {
                rotation,
                ..body.motion()
            },
            local_center: total.center,
            center: body.position.as_dvec3() + turn * total.center,
            rotation: turn,
            local_inverse_inertia: local_inverse_inertia.as_mat3(),
            radius: radius as f32,
        });
        let first = self.parts.len() - parts.len();
        self.place_parts(first..self.parts.len());
        Ok(())
    }

    /// Completes the bodies: call it when all of them are joined.
    pub fn end_joins(&mut self) {
        self.parts.sort_unstable_by_key(|part| part.collider);
        self.part_index.set(self.parts.iter().map(|part| part.collider));
    }

    /// The part that a collider is of a [`Compound`].
    pub(crate) fn part(&self, collider: u32) -> Option<&CompoundPart> {
        self.part_index.get(collider).map(|at| &self.parts[at])
    }

    /// The compound to which a collider belongs.
    pub(crate) fn compound_of(&self, collider: u32) -> Option<&Compound> {
        self.part(collider).map(|part| &self.compounds[part.compound as usize])
    }

    /// The number of the body of a collider.
    pub(crate) fn body_of(&self, collider: u32) -> u32 {
        if self.parts.is_empty() {
            collider
        } else {
            self.body[collider as usize]
        }
    }

    /// Whether a body has this number.
    pub fn is_body(&self, i: usize) -> bool {
        self.body_of(i as u32) == i as u32
    }

    /// The row of the body of collider `i` in lists of motions: first motions of colliders, then of compounds.
    #[cfg(feature = "gpu")]
    pub(crate) fn motion_row(&self, i: usize) -> usize {
        self.part(i as u32)
            .map_or(i, |part| self.len() + part.compound as usize)
    }

    /// Sets the linear and the angular velocity of the body with the number `i`.
    pub(crate) fn set_velocity(&mut self, i: usize, [linear, angular]: [Vec3; 2]) {
        match self.part(i as u32).map(|part| part.compound as usize) {
            Some(compound) => {
                let compound = &mut self.compounds[compound];
                compound.set(compound.center, compound.rotation, linear, angular);
                self.place_parts(0..self.parts.len());
            }
            None => (self.linear_velocity[i], self.angular_velocity[i]) = (linear, angular),
        }
    }

    /// Pose and velocities of the body with the number `i`.
    pub fn body_motion(&self, i: usize) -> Motion {
        match self.compound_of(i as u32) {
            Some(compound) => compound.motion,
            None => self.motion(i),
        }
    }

    /// Places colliders by the poses of their bodies. `parts` are indices of [`Bodies::parts`].
    pub(crate) fn place_parts(&mut self, parts: Range<usize>) {
        let mut last: Option<(u32, Mat3)> = None;
        for part in &self.parts[parts] {
            let i = part.collider as usize;
            let compound = &self.compounds[part.compound as usize];
            let motion = &compound.motion;
            let turn = compound.rotation;
            let inverse_inertia = match last {
                Some((known, tensor)) if known == part.compound => tensor,
                _ => {
                    let axes = DMat3::from_quat(turn).as_mat3();
                    axes * compound.local_inverse_inertia * axes.transpose()
                }
            };
            last = Some((part.compound, inverse_inertia));
            let offset = turn * part.offset;
            let rotation = (turn * part.pose.rotation).normalize();
            let axes = DMat3::from_quat(rotation);
            let position = compound.center + turn * (part.pose.translation - compound.local_center);
            let velocity = motion.linear_velocity.as_dvec3() + motion.angular_velocity.as_dvec3().cross(offset);
            self.frame[i] = Frame {
                position,
                rotation: axes,
                scale: self.frame[i].scale,
                center: compound.center + offset,
                body_center: compound.center,
            };
            self.position[i] = position.as_vec3();
            self.rotation[i] = rotation.as_quat();
            self.center[i] = self.frame[i].center.as_vec3();
            self.radius[i] = bounding_radius(self.unpadded_radius[i], self.center[i]);
            self.linear_velocity[i] = velocity.as_vec3();
            self.angular_velocity[i] = motion.angular_velocity;
            self.inverse_inertia[i] = inverse_inertia;
        }
    }

    /// Sets poses and velocities of all colliders, which are followed by those of compounds. Values derived from the
    /// poses of bodies of one collider are not updated.
    pub fn set_motions(&mut self, motions: &[Motion]) {
        let (colliders, compounds) = motions.split_at(self.len().min(motions.len()));
        for (i, motion) in colliders.iter().enumerate() {
            if self.part(i as u32).is_none() {
                self.set_motion(i, motion);
            }
        }
        for (compound, motion) in self.compounds.iter_mut().zip(compounds) {
            compound.motion = *motion;
            compound.rotation = motion.rotation.as_dquat().normalize();
            compound.center = motion.position.as_dvec3() + compound.rotation * compound.local_center;
        }
        self.place_parts(0..self.parts.len());
    }

    /// Mass of a collider, its axes, and its centre of mass in the body's axes.
    #[inline]
    fn weigh(&self, part: &NewCompoundPart, meshes: &MeshArena) -> (f64, DMat3, DVec3) {
        let i = part.collider as usize;
        let (mesh, scale) = (&meshes[self.mesh[i]].mesh, self.frame[i].scale);
        let mass = f64::from(part.density) * mesh.volume(scale);
        let axes = DMat3::from_quat(part.pose.rotation);
        let center = part.pose.translation + axes * (scale * mesh.mass.center.as_dvec3());
        (mass, axes, center)
    }

    /// Adds up the masses of colliders.
    fn total(&self, body: &Body, center: Option<Vec3>, parts: &[NewCompoundPart], meshes: &MeshArena) -> Total {
        let all_sensors = parts.iter().all(|part| self.sensor[part.collider as usize]);
        let weighs = |part: &&NewCompoundPart| all_sensors || !self.sensor[part.collider as usize];
        let (mut mass, mut moment) = (0.0, DVec3::ZERO);
        for part in parts.iter().filter(weighs) {
            let (own, _, at) = self.weigh(part, meshes);
            mass += own;
            moment += own * at;
        }
        let center = center.map_or(moment / mass, |center| center.as_dvec3());
        let mut inertia = DMat3::ZERO;
        for part in parts.iter().filter(weighs) {
            let (own, axes, at) = self.weigh(part, meshes);
            let i = part.collider as usize;
            let tensor = meshes[self.mesh[i]].mesh.inertia(self.frame[i].scale, own);
            // Steiner's theorem.
            let d = at - center;
            let shift =
                DMat3::from_diagonal(DVec3::splat(d.length_squared())) - DMat3::from_cols(d * d.x, d * d.y, d * d.z);
            inertia += axes * tensor * axes.transpose() + own * shift;
        }
        let wanted = body.mass.map_or(mass, f64::from);
        Total {
            mass: wanted,
            center,
            inertia: inertia * (wanted / mass),
        }
    }
}

impl Body {
    /// A collider at `pose` in this body: the same parameters, with the pose in the world. Mass, inertia and velocities
    /// are those of the body, so the collider has none.
    pub fn collider(&self, mesh: u32, pose: &LocalPose, scale: Vec3) -> Self {
        let turn = self.rotation.as_dquat().normalize();
        Self {
            mesh,
            position: (self.position.as_dvec3() + turn * pose.translation).as_vec3(),
            rotation: (turn * pose.rotation).as_quat(),
            scale,
            mass: None,
            inertia: None,
            ..*self
        }
    }
}

impl From<(Vec3, Quat)> for LocalPose {
    fn from((translation, rotation): (Vec3, Quat)) -> Self {
        Self {
            translation: translation.as_dvec3(),
            rotation: rotation.as_dquat().normalize(),
        }
    }
}
