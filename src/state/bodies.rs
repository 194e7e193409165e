//! The colliders of a step, and the bodies that they form, as a structure of arrays. [`Bodies::push`] validates a
//! collider and derives what follows from its pose and mesh; [`Bodies::join`](super::compound) makes one body of
//! several.
//!
//! Most bodies have one collider, and both have the same number. A body with several colliders has the number of the
//! first. Stages that look at surfaces work on colliders: the broad phase up to contact generation, and continuous
//! collision. Stages that move bodies work on bodies: the solver, sleep and integration.

use super::body::{Body, BodyParams, Motion};
use super::checks::{check_body, check_collider, check_pose};
use super::columns::Row;
use super::compound::{Compound, CompoundPart};
use super::dormant_set::DormantSet;
use super::fault::{BodyFault, MAX_SPEED};
use super::mesh_arena::MeshArena;
use super::part_index::PartIndex;
use super::revision::Revision;
use super::static_changes::StaticChanges;
use crate::asset::CollisionMesh;
use crate::geometry::mesh::MAX_COORDINATE;
use crate::types::body::{CollisionLayers, ExternalForces, RigidBody};
use crate::types::settings::Culling;
use glam::{DMat3, DQuat, DVec3, Mat3, Quat, Vec3};
use std::borrow::Cow;

/// One entry per collider in every array up to `params`.
#[derive(Clone, Debug, Default)]
pub struct Bodies {
    /// Number of the body, which is the number of its first collider.
    pub body: Vec<u32>,
    /// Slot in the [`MeshArena`].
    pub mesh: Vec<u32>,
    /// Kind of the body: dynamic, kinematic or static.
    pub kind: Vec<RigidBody>,
    /// Position of the mesh's origin, metres.
    pub position: Vec<Vec3>,
    /// Unit quaternion.
    pub rotation: Vec<Quat>,
    /// Scale along the mesh's own axes; no component is zero.
    pub scale: Vec<Vec3>,
    /// Velocity of the collider's centre of mass, m/s.
    pub linear_velocity: Vec<Vec3>,
    /// Angular velocity in world axes, rad/s.
    pub angular_velocity: Vec<Vec3>,
    /// The pose in double precision.
    pub frame: Vec<Frame>,
    /// Centre of the bounding sphere: the collider's centre of mass in the world.
    pub center: Vec<Vec3>,
    /// Radius of the bounding sphere, rounded up.
    pub radius: Vec<f32>,
    /// Radius of the rounding, metres; 0 for most meshes.
    pub rounding: Vec<f32>,
    /// Radius of the bounding sphere without the allowance for a rounded centre. It does not depend on the position.
    pub unpadded_radius: Vec<f32>,
    /// Thickness of the thinnest part, metres.
    pub thickness: Vec<f32>,
    /// Radius that the broad phase uses: the bounding radius plus the body's speculative margin, metres.
    pub speculative_radius: Vec<f32>,
    /// Time until the next collision substep, seconds; 0 once the body has completed its step, and for what is static.
    pub travel_time: Vec<f32>,
    /// Inverse mass of the body, 1/kg; 0 for bodies that contacts cannot move.
    pub inverse_mass: Vec<f32>,
    /// Inverse mass that the body would have if contacts moved it, 1/kg; 0 for static bodies.
    pub own_inverse_mass: Vec<f32>,
    /// Inverse inertia tensor in the body's own axes; zero for bodies that contacts cannot rotate. A body with several
    /// colliders has its tensor in its [`Compound`].
    pub local_inverse_inertia: Vec<Mat3>,
    /// Inverse inertia tensor of the body in world axes.
    pub inverse_inertia: Vec<Mat3>,
    /// Coefficient of restitution, 0 to 1.
    pub restitution: Vec<f32>,
    /// Factor on gravity.
    pub gravity_scale: Vec<f32>,
    /// Collision filter.
    pub layers: Vec<CollisionLayers>,
    /// Whether the collider only reports contacts and exchanges no impulses.
    pub sensor: Vec<bool>,
    /// Which of its triangles are tested.
    pub culling: Vec<Culling>,
    /// Solver parameters: friction and restitution of the collider, the others of the body.
    pub params: Vec<BodyParams>,
    /// Moving bodies whose colliders are placed in them. Other bodies have one collider.
    pub compounds: Vec<Compound>,
    /// Colliders of compounds, ascending.
    pub parts: Vec<CompoundPart>,
    /// Finds a collider among `parts`.
    pub(crate) part_index: PartIndex,
    /// The colliders that are not static, ascending, if they have been listed.
    pub(crate) moving: Vec<u32>,
    /// Number of static colliders, which come first, where `revision` is known.
    pub(crate) static_count: usize,
    pub(crate) is_listed: bool,
    /// Properties that at least one static collider has, if they have been listed.
    pub(crate) of_static: Flags,
    /// The state of the static colliders; see [`Bodies::keep_static`].
    pub(crate) revision: Revision,
    pub(crate) static_changes: StaticChanges,
    /// The contact margin with which speculative radii of static colliders were set; see
    /// [`SpeculativeMargins`](super::margins::SpeculativeMargins).
    pub(crate) static_margin: Option<f32>,
    /// Names which collider has which number, where that is known.
    pub(crate) layout: Revision,
    /// The layout before, and how many of the first colliders have kept their numbers since.
    pub(crate) layout_before: (Revision, usize),
    /// The colliders that are dormant.
    pub(crate) dormant: DormantSet,
}

/// Properties that at least one collider has.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Flags {
    /// Continuous collision detection.
    pub continuous: bool,
    /// A hook that filters pairs.
    pub filters: bool,
    /// A hook that modifies contacts.
    pub modifies: bool,
}

impl Flags {
    pub fn of<'a>(all: impl Iterator<Item = &'a BodyParams>) -> Self {
        let flags = |params: &BodyParams| Self {
            continuous: params.continuous,
            filters: params.hooks.filter_pairs,
            modifies: params.hooks.modify_contacts,
        };
        all.map(flags).fold(Self::default(), Self::or)
    }

    #[cfg(feature = "bevy")]
    fn any(self) -> bool {
        self.continuous || self.filters || self.modifies
    }

    fn or(self, other: Self) -> Self {
        Self {
            continuous: self.continuous | other.continuous,
            filters: self.filters | other.filters,
            modifies: self.modifies | other.modifies,
        }
    }
}

/// A collider's pose in double precision: world point = `position + rotation * (scale * mesh point)`.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// Position of the mesh's origin, metres.
    pub position: DVec3,
    /// Orthonormal.
    pub rotation: DMat3,
    /// Scale along the mesh's own axes.
    pub scale: DVec3,
    /// The collider's centre of mass in the world.
    pub center: DVec3,
    /// The body's centre of mass in the world.
    pub body_center: DVec3,
}

/// With this acceleration a body reaches the largest speed in a thousandth of a second, m/s².
pub(crate) const MAX_ACCELERATION: f32 = 1000.0 * MAX_SPEED;

impl Bodies {
    /// Number of colliders.
    pub fn len(&self) -> usize {
        self.mesh.len()
    }

    /// Whether there are no colliders.
    pub fn is_empty(&self) -> bool {
        self.mesh.is_empty()
    }

    /// Removes all bodies and keeps the memory.
    pub fn clear(&mut self) {
        self.truncate_rows(0);
        self.separate();
        self.end_dormancy();
        self.layout = Revision::UNKNOWN;
        self.layout_before = Default::default();
        self.moving.clear();
        self.static_count = 0;
        self.is_listed = false;
        self.of_static = Flags::default();
        self.revision = Revision::UNKNOWN;
        self.static_margin = None;
    }

    fn separate(&mut self) {
        self.compounds.clear();
        self.parts.clear();
        self.part_index.clear();
    }

    /// Begins to rewrite the colliders that are neither static nor dormant. They are all among the first `count`, which
    /// keep their numbers. Compounds are joined anew.
    #[cfg(feature = "bevy")]
    pub(crate) fn begin_rewriting(&mut self, count: usize) {
        self.separate();
        if count < self.len() {
            self.truncate_rows(count);
            self.dormant.flags.truncate(count);
            self.moving.retain(|&i| (i as usize) < count);
        }
    }

    /// The static colliders that have changed since the state `known`, if none has come or gone; else `None`.
    pub(crate) fn static_changes_since(&self, known: Revision) -> Option<&[u32]> {
        self.static_changes.since(known, self.revision)
    }

    /// Replaces static colliders, and names their new state.
    ///
    /// # Errors
    /// The first that is not valid. Then the state is not known.
    #[cfg(feature = "bevy")]
    pub(crate) fn rewrite_static(&mut self, changed: &[(u32, Body)], meshes: &MeshArena) -> Result<(), BodyFault> {
        let before = std::mem::replace(&mut self.revision, Revision::UNKNOWN);
        for (i, body) in changed {
            let at = *i as usize;
            self.rewrite(at, body, meshes, false)?;
            let margin = self.static_margin.unwrap_or_default();
            self.speculative_radius[at] = self.radius[at] + margin * self.radius[at];
        }
        let statics = self.params[..self.static_count].iter();
        self.of_static = match self.of_static.any() {
            true => Flags::of(statics),
            false => Flags::of(changed.iter().map(|(_, body)| &body.params)),
        };
        let numbers: Vec<u32> = changed.iter().map(|&(i, _)| i).collect();
        self.revision = Revision::new();
        self.static_changes.add(&numbers, before, self.revision);
        Ok(())
    }

    /// How many of the first colliders have kept their numbers since the static colliders were in the state `revision`
    /// and all colliders in the `layout`.
    pub(crate) fn same_since(&self, revision: Revision, layout: Revision) -> usize {
        let (before, same) = self.layout_before;
        if self.static_changes_since(revision).is_none() {
            0
        } else if layout.is(self.layout) {
            self.len()
        } else if layout.is(before) {
            same.max(self.static_count)
        } else {
            self.static_count
        }
    }

    /// No collider is dormant any more.
    pub(crate) fn end_dormancy(&mut self) {
        self.dormant.flags.clear();
        self.dormant.count = 0;
        self.dormant.name = Revision::UNKNOWN;
        self.dormant.filled = Revision::UNKNOWN;
        self.dormant.has = Flags::default();
    }

    /// What has been pushed so far is static, and what follows is not.
    #[cfg(feature = "bevy")]
    pub(crate) fn end_static(&mut self) {
        self.static_count = self.len();
    }

    /// Names the present state of the static colliders, which come first. Until [`Bodies::clear`] they must not change,
    /// so that steps do nothing for them.
    #[cfg(feature = "bevy")]
    pub(crate) fn keep_static(&mut self) {
        self.revision = Revision::UNKNOWN;
        self.list_movers();
        self.revision = Revision::new();
        self.static_changes.begin(self.revision);
        self.keep_layout(0);
    }

    /// Names the present numbers of all colliders, of which the first `same` are those of the layout before. Until the
    /// next call colliders may only be [written again](Bodies::rewrite).
    #[cfg(feature = "bevy")]
    pub(crate) fn keep_layout(&mut self, same: usize) {
        self.layout_before = (self.layout, same);
        self.layout = Revision::new();
    }

    /// Lists the colliders that are not static, at the beginning of a step, unless they are known to be those of the
    /// last one.
    pub(crate) fn list_movers(&mut self) {
        if !self.revision.is_known() {
            let moves = |&i: &u32| self.kind[i as usize] != RigidBody::Static;
            self.moving.clear();
            self.moving.extend((0..self.kind.len() as u32).filter(moves));
            self.is_listed = true;
            self.static_margin = None;
            let statics = self.params.iter().zip(&self.kind);
            let statics = statics.filter(|(_, kind)| **kind == RigidBody::Static);
            self.of_static = Flags::of(statics.map(|(params, _)| params));
        } else {
            let awake = |&i: &u32| !self.dormant.has(i as usize);
            self.moving.clear();
            self.moving
                .extend((self.static_count as u32..self.kind.len() as u32).filter(awake));
        }
    }

    /// The colliders that are neither static nor dormant, ascending.
    pub(crate) fn movers(&self) -> impl Iterator<Item = usize> + Clone + '_ {
        let (listed, all) = match self.is_listed {
            true => (&self.moving[..], 0..0),
            false => (&[][..], 0..self.kind.len()),
        };
        let moves = |&i: &usize| self.kind[i] != RigidBody::Static;
        listed.iter().map(|&i| i as usize).chain(all.filter(moves))
    }

    /// Number of [`Bodies::movers`], or of all colliders if they have not been listed.
    pub(crate) fn mover_count(&self) -> usize {
        if self.is_listed { self.moving.len() } else { self.len() }
    }

    /// Number of colliders that move, but were not listed among [`Bodies::movers`], because they are dormant.
    #[cfg(feature = "bevy")]
    pub(crate) fn left_out(&self) -> usize {
        match self.revision.is_known() {
            true => self.len() - self.static_count - self.moving.len(),
            false => 0,
        }
    }

    /// What some collider has.
    pub(crate) fn flags(&self) -> Flags {
        if !self.is_listed {
            return Flags::of(self.params.iter());
        }
        // A search without a step may have spheres only.
        let moving = Flags::of(self.moving.iter().filter_map(|&i| self.params.get(i as usize)));
        moving.or(self.of_static).or(self.dormant.has)
    }

    /// [`Bodies::movers`] as a list.
    pub(crate) fn list_of_movers(&self) -> Cow<'_, [u32]> {
        match self.is_listed {
            true => Cow::Borrowed(&self.moving),
            false => Cow::Owned(self.movers().map(|i| i as u32).collect()),
        }
    }

    /// Calls `f` with each of [`Bodies::movers`].
    pub(crate) fn for_each_mover(&mut self, mut f: impl FnMut(&mut Self, usize)) {
        let list = match self.is_listed {
            true => std::mem::take(&mut self.moving),
            false => self.list_of_movers().into_owned(),
        };
        list.iter().for_each(|&i| f(self, i as usize));
        if self.is_listed {
            self.moving = list;
        }
    }

    /// [`Bodies::travel_time`] of a collider; 0 for planes, which are numbered after the colliders.
    pub(crate) fn travel_time_of(&self, i: usize) -> f32 {
        self.travel_time.get(i).copied().unwrap_or(0.0)
    }

    /// Upper bounds of the accelerations of a collider's surface by the external force and by the external torque on
    /// its body, m/s².
    pub(crate) fn surface_accelerations(&self, i: usize) -> [f32; 2] {
        self.surface_response(i, self.forces_on(i))
    }

    /// Upper bounds of the speeds that the pending external impulse and angular impulse give to a collider's surface.
    #[cfg(feature = "gpu")]
    pub(crate) fn surface_speeds_of_impulses(&self, i: usize) -> [f32; 2] {
        self.surface_response(i, &self.forces_on(i).in_a_second())
    }

    /// The acceleration of a collider by gravity and by the external force on its body, m/s².
    pub(crate) fn acceleration(&self, i: usize, gravity: Vec3) -> Vec3 {
        if self.kind[i] != RigidBody::Dynamic {
            return Vec3::ZERO;
        }
        let body = self.body_of(i as u32) as usize;
        let push = self.params[body].forces.force * self.inverse_mass[i];
        let push = push.clamp_length_max(MAX_ACCELERATION);
        (gravity * self.gravity_scale[i] + push) * self.params[body].locked_axes.free_translation()
    }

    fn forces_on(&self, i: usize) -> &ExternalForces {
        &self.params[self.body_of(i as u32) as usize].forces
    }

    fn surface_response(&self, i: usize, forces: &ExternalForces) -> [f32; 2] {
        let (inverse_inertia, reach) = match self.part(i as u32) {
            None => (&self.local_inverse_inertia[i], self.radius[i]),
            Some(part) => (
                &self.compounds[part.compound as usize].local_inverse_inertia,
                part.offset.length() as f32 + self.radius[i],
            ),
        };
        let (linear, angular) = forces.accelerations(self.inverse_mass[i], inverse_inertia);
        [linear.length(), angular * reach].map(|acceleration| acceleration.min(MAX_ACCELERATION))
    }

    /// Whether either collider of a pair is rounded.
    pub(crate) fn are_rounded(&self, pair: [u32; 2]) -> bool {
        pair.iter().any(|&i| self.rounding[i as usize] > 0.0)
    }

    /// Whether contacts between two colliders can move one of their bodies.
    pub(crate) fn push_each_other(&self, [a, b]: [u32; 2]) -> bool {
        let (a, b) = (a as usize, b as usize);
        (self.inverse_mass[a] > 0.0 || self.inverse_mass[b] > 0.0) && !self.sensor[a] && !self.sensor[b]
    }

    /// Pose and velocities of collider `i`.
    pub fn motion(&self, i: usize) -> Motion {
        Motion {
            position: self.position[i],
            rotation: self.rotation[i],
            linear_velocity: self.linear_velocity[i],
            angular_velocity: self.angular_velocity[i],
        }
    }

    /// Sets pose and velocities of collider `i`, which must be a body by itself. Values derived from the pose are not
    /// updated.
    pub fn set_motion(&mut self, i: usize, motion: &Motion) {
        self.position[i] = motion.position;
        self.rotation[i] = motion.rotation;
        self.linear_velocity[i] = motion.linear_velocity;
        self.angular_velocity[i] = motion.angular_velocity;
    }

    /// Validates `body`, derives what follows from its pose and mesh, and appends it: a collider that is a body by
    /// itself, until [`Bodies::join`](super::compound) joins it with others.
    pub fn push(&mut self, body: &Body, meshes: &MeshArena) -> Result<(), BodyFault> {
        let row = self.row(self.len(), body, meshes, true)?;
        self.push_row(row);
        Ok(())
    }

    /// Like [`Bodies::push`], for a collider that will be joined with others before the bodies are used. What it has
    /// from its body must be valid.
    pub fn push_part(&mut self, body: &Body, meshes: &MeshArena) -> Result<(), BodyFault> {
        let row = self.row(self.len(), body, meshes, false)?;
        self.push_row(row);
        Ok(())
    }

    /// Replaces collider `i` by what [`Bodies::push`] would append, or [`Bodies::push_part`] if it `is_part` of a body.
    #[cfg(feature = "bevy")]
    pub(crate) fn rewrite(
        &mut self,
        i: usize,
        body: &Body,
        meshes: &MeshArena,
        is_part: bool,
    ) -> Result<(), BodyFault> {
        let row = self.row(i, body, meshes, !is_part)?;
        self.set_row(i, row);
        Ok(())
    }

    /// The row of collider `i` in the arrays. The collider is a body by itself (`is_body`) or a part of one.
    fn row(&self, i: usize, body: &Body, meshes: &MeshArena, is_body: bool) -> Result<Row, BodyFault> {
        if is_body {
            check_body(body)?;
        } else {
            check_collider(body)?;
        }
        let slot = &meshes[body.mesh];
        let (rotation, scale, unpadded_radius) = check_pose(&slot.mesh, body.rotation.as_dquat(), body.scale)?;

        let frame = Frame::new(
            body.position.as_dvec3(),
            rotation,
            scale.as_dvec3(),
            slot.mesh.mass.center,
        );
        let center = frame.center.as_vec3();
        let extent = center.abs().max(body.position.abs()).max_element() + unpadded_radius;
        if extent.is_nan() || extent > MAX_COORDINATE {
            return Err(BodyFault::TooFar);
        }
        let radius = bounding_radius(unpadded_radius, center);
        let mass = mass_of(body, &frame, &slot.mesh);
        let inverse_mass = (1.0 / mass) as f32;
        if !inverse_mass.is_finite() {
            return Err(BodyFault::Mass(body.mass.unwrap_or(0.0)));
        }
        let (own_inertia, inverse_inertia) = if is_body && mass.is_finite() {
            let own = inverse_inertia_of(body, &frame, &slot.mesh, mass);
            (own, frame.rotation * own * frame.rotation.transpose())
        } else {
            (DMat3::ZERO, DMat3::ZERO)
        };
        Ok(Row {
            body: i as u32,
            mesh: body.mesh,
            kind: body.kind,
            position: body.position,
            rotation: unit(body.rotation),
            scale,
            linear_velocity: body.linear_velocity,
            angular_velocity: body.angular_velocity,
            frame,
            center,
            radius,
            rounding: rounding(&slot.mesh, scale),
            unpadded_radius,
            thickness: slot.mesh.mass.thickness * scale.abs().min_element(),
            speculative_radius: radius,
            travel_time: 0.0,
            inverse_mass,
            own_inverse_mass: own_inverse_mass(body, &frame, &slot.mesh),
            local_inverse_inertia: own_inertia.as_mat3(),
            inverse_inertia: inverse_inertia.as_mat3(),
            restitution: body.restitution.clamp(0.0, 1.0),
            gravity_scale: body.gravity_scale,
            layers: body.layers,
            sensor: body.sensor,
            culling: body.culling,
            params: body.params,
        })
    }
}

/// The normalised quaternion. A quaternion of unit length up to rounding is returned unchanged, so a rotation that a
/// step wrote keeps its bits.
pub(super) fn unit(rotation: Quat) -> Quat {
    if (rotation.as_dquat().length_squared() - 1.0).abs() < 1.0e-6 {
        rotation
    } else {
        rotation.normalize()
    }
}

/// Radius of the rounding of a mesh with this scale, metres.
pub(crate) fn rounding(mesh: &CollisionMesh, scale: Vec3) -> f32 {
    mesh.settings.rounding * scale.abs().min_element()
}

/// Radius of a body's bounding sphere, enlarged by the rounding error of its centre.
pub(crate) fn bounding_radius(unpadded_radius: f32, center: Vec3) -> f32 {
    unpadded_radius * (1.0 + 1.0e-6) + 4.0 * f32::EPSILON * center.abs().max_element()
}

impl Frame {
    /// `rotation` has unit length; `mesh_center` is the centre of mass in the mesh.
    pub(crate) fn new(position: DVec3, rotation: DQuat, scale: DVec3, mesh_center: Vec3) -> Self {
        Self::from_arm(position, rotation, scale, scale * mesh_center.as_dvec3())
    }

    /// `arm` is the centre of mass in the collider's axes, from its origin.
    pub(super) fn from_arm(position: DVec3, rotation: DQuat, scale: DVec3, arm: DVec3) -> Self {
        let rotation = DMat3::from_quat(rotation);
        let center = position + rotation * arm;
        Self {
            position,
            rotation,
            scale,
            center,
            body_center: center,
        }
    }

    /// From the body's centre of mass to the collider's, in world axes, metres.
    pub(crate) fn offset(&self) -> DVec3 {
        self.center - self.body_center
    }
}

/// The mass in kilograms; infinite for a body that contacts cannot move.
fn mass_of(body: &Body, frame: &Frame, mesh: &CollisionMesh) -> f64 {
    if body.kind != RigidBody::Dynamic {
        return f64::INFINITY;
    }
    own_mass_of(body, frame, mesh)
}

/// The mass if contacts moved it, kg.
fn own_mass_of(body: &Body, frame: &Frame, mesh: &CollisionMesh) -> f64 {
    let weigh = || f64::from(body.density) * mesh.volume(frame.scale);
    body.mass.map_or_else(weigh, f64::from)
}

/// The inverse mass if contacts moved it, 1/kg; 0 for a static body, and where it is not finite.
fn own_inverse_mass(body: &Body, frame: &Frame, mesh: &CollisionMesh) -> f32 {
    if body.kind == RigidBody::Static {
        return 0.0;
    }
    let inverse = (1.0 / own_mass_of(body, frame, mesh)) as f32;
    if inverse.is_finite() { inverse } else { 0.0 }
}

/// The inverse inertia of a dynamic body in its own axes.
fn inverse_inertia_of(body: &Body, frame: &Frame, mesh: &CollisionMesh, mass: f64) -> DMat3 {
    match body.inertia {
        Some(inertia) => inertia.as_dmat3().inverse(),
        None => invert_inertia(mesh.inertia(frame.scale, mass)),
    }
}

/// The inverse of an inertia tensor or of an inverse one; zero if the result is not finite. Determinants for bodies of
/// a millimetre and of hundreds of metres need double precision.
pub(crate) fn invert_inertia(tensor: DMat3) -> DMat3 {
    // `DMat3::inverse`, with a determinant of 0 allowed.
    let DMat3 { x_axis, y_axis, z_axis } = tensor;
    let [x, y, z] = [y_axis.cross(z_axis), z_axis.cross(x_axis), x_axis.cross(y_axis)];
    let factor = z_axis.dot(z).recip();
    let inverse = DMat3::from_cols(x * factor, y * factor, z * factor).transpose();
    match inverse.as_mat3().is_finite() {
        true => inverse,
        false => DMat3::ZERO,
    }
}
