//! The input of a step, packed for the device.

use super::contact_programs::ContactPrograms;
use super::readback_lengths::ReadbackLengths;
use super::solver_input::SolverInput;
use crate::asset::CollisionMesh;
use crate::gpu::arena::has_large_meshes;
use crate::gpu::buffer_contents::BufferContents;
use crate::gpu::buffers::{Buffers, Capacity};
use crate::gpu::commands::Commands;
use crate::gpu::layout::{
    self, BODIES, CARRIED_ANGULAR, CARRIED_LINEAR, CARRIED_POSITION, CARRIED_ROTATION, CARRIED_SLEEP, CONTINUES,
    COUNTERS, CULLING_FACES, CULLING_FRONT, DYNAMIC, FAST, KIND_MASK, KINEMATIC, NEEDED_SUBSTEPS, PART, SENSOR, STATIC,
};
use crate::gpu::program::Population;
use crate::state::bodies::MAX_ACCELERATION;
use crate::state::margins::SAFETY;
use crate::state::{Bodies, Compound, CompoundPart, Motion, Plane, StepInput};
use crate::types::body::RigidBody;
use crate::types::settings::{Culling, Response};
use bytemuck::cast_slice;
use glam::{BVec3, DMat3, Quat, Vec3};

/// A body that continues from the last step, whose results the host may not know yet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carried {
    /// The body's row in the motions after the last step: first motions of colliders, then of compounds.
    pub source: u32,
    /// What carries over of its position.
    pub position: CarriedVector,
    /// Whether its rotation carries over. Otherwise [`Bodies`] has it.
    pub rotation: bool,
    /// What carries over of its linear velocity.
    pub linear: CarriedVector,
    /// What carries over of its angular velocity.
    pub angular: CarriedVector,
}

/// What carries over of a vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CarriedVector {
    /// The axes along which it carries over. Along the others [`Bodies`] has it.
    pub axes: BVec3,
    /// Added along these axes.
    pub added: Vec3,
}

impl Carried {
    /// Everything of body `source` carries over unchanged.
    pub fn all(source: u32) -> Self {
        Self {
            source,
            position: CarriedVector::ALL,
            rotation: true,
            linear: CarriedVector::ALL,
            angular: CarriedVector::ALL,
        }
    }

    /// The bits of `Body::carried`.
    fn bits(&self) -> u32 {
        // Powers of two, each larger than the sum of the ones before.
        u32::from(self.rotation) * CARRIED_ROTATION
            + self.position.axes.bitmask() * CARRIED_POSITION
            + self.linear.axes.bitmask() * CARRIED_LINEAR
            + self.angular.axes.bitmask() * CARRIED_ANGULAR
    }

    /// The motion for the device, from the host's. What carries over does not depend on the host's, so that it is not
    /// written again.
    fn sent(&self, own: Motion) -> Motion {
        Motion {
            position: self.position.sent(own.position),
            rotation: if self.rotation { Quat::IDENTITY } else { own.rotation },
            linear_velocity: self.linear.sent(own.linear_velocity),
            angular_velocity: self.angular.sent(own.angular_velocity),
        }
    }

    /// The motion of the body, from its last motion and the host's.
    pub fn apply(&self, last: &Motion, own: &Motion) -> Motion {
        Motion {
            position: self.position.apply(last.position, own.position),
            rotation: if self.rotation { last.rotation } else { own.rotation },
            linear_velocity: self.linear.apply(last.linear_velocity, own.linear_velocity),
            angular_velocity: self.angular.apply(last.angular_velocity, own.angular_velocity),
        }
    }
}

impl CarriedVector {
    /// The whole vector carries over unchanged. Adding minus zero preserves the bits of every number; plus zero would
    /// change minus zero.
    pub const ALL: Self = Self {
        axes: BVec3::TRUE,
        added: Vec3::splat(-0.0),
    };

    /// Adds a change to what carries over.
    pub fn add(&mut self, change: Vec3) {
        self.added = Vec3::select(self.axes, self.added + change, self.added);
    }

    /// The value for the device.
    pub fn sent(&self, own: Vec3) -> Vec3 {
        Vec3::select(self.axes, self.added, own)
    }

    fn apply(&self, last: Vec3, own: Vec3) -> Vec3 {
        Vec3::select(self.axes, last + self.added, own)
    }
}

/// The input of a step. It is kept until the results are read, because a step whose lists overflowed is repeated.
pub struct Input {
    step: layout::Step,
    bodies: Vec<layout::Body>,
    compounds: Vec<layout::Compound>,
    parts: Vec<layout::CompoundPart>,
    planes: Vec<layout::Plane>,
    meshes: Vec<Option<CollisionMesh>>,
    /// Whether intersecting faces are listed.
    pub(super) face_lists: bool,
    /// Whether pairs may be split into pieces.
    large_meshes: bool,
    /// What happens to bodies that touch.
    pub(super) response: Response,
    /// With [`Response::Contacts`].
    pub(super) solver: Option<SolverInput>,
}

impl Input {
    /// Packs the bodies, planes and settings of `state`. `carried` has an entry for each collider and then
    /// for each compound, or is empty.
    pub fn new(state: &StepInput, carried: &[Option<Carried>]) -> Self {
        let StepInput {
            config, bodies, planes, ..
        } = state;
        let count = bodies.len();
        let carried = |row: usize| carried.get(row).copied().flatten();
        let mut parts: Vec<_> = bodies.parts.iter().collect();
        parts.sort_by_key(|part| part.compound);
        let compounds = (bodies.compounds.iter().enumerate())
            .map(|(i, own)| compound(i as u32, own, &parts, carried(count + i)))
            .collect();
        Self {
            step: layout::Step {
                gravity: config.gravity.to_array(),
                dt: config.dt,
                bodies: count as u32,
                planes: planes.len() as u32,
                compounds: bodies.compounds.len() as u32,
                response: u32::from(config.response != Response::None),
                contact_margin: match config.response {
                    Response::Impulse => 0.0,
                    Response::None | Response::Contacts => config.solver.margin(),
                },
                rest_offset: config.solver.rest_offset,
                ..Default::default()
            },
            bodies: (0..count).map(|i| body(bodies, state, i, carried(i))).collect(),
            parts: parts.into_iter().map(|own| part(bodies, own)).collect(),
            compounds,
            planes: planes.iter().map(plane).collect(),
            meshes: (0..state.meshes.len() as u32)
                .map(|slot| state.meshes.get(slot).map(|slot| slot.mesh.clone()))
                .collect(),
            face_lists: config.face_lists,
            large_meshes: has_large_meshes(&state.meshes),
            response: config.response,
            solver: None,
        }
    }

    /// Adds the solver's input, with [`Response::Contacts`]. Continuous collision needs some pairs more if it
    /// `has_fast_bodies`.
    pub(super) fn with_solver(mut self, solver: SolverInput, has_fast_bodies: bool) -> Self {
        self.step.has_fast_bodies = has_fast_bodies.into();
        for body in &mut self.bodies {
            if solver.fast().binary_search(&body.body).is_ok() {
                body.flags |= FAST;
            }
        }
        self.step.travel_scale = SAFETY;
        self.step.drift = solver.drift.to_array();
        self.step.substeps = solver.substeps();
        self.step.planes_changed = solver.planes_changed().into();
        self.step.same_numbers = solver.same_numbers().into();
        for (i, body) in self.bodies.iter_mut().enumerate() {
            let (source, carried) = solver.source(i);
            (body.source, body.carried) = both((body.source, body.carried), (source, carried));
        }
        for (compound, remap) in self.compounds.iter_mut().zip(solver.compound_sources()) {
            let (source, carried) = (compound.source, compound.carried);
            (compound.source, compound.carried) = both((source, carried), (remap.row, remap.carried));
            compound.last_collider = remap.collider;
        }
        self.solver = Some(solver);
        self
    }

    /// The number of collision substeps for which there are commands.
    pub(super) fn recorded_substeps(&self) -> u32 {
        self.solver.as_ref().map_or(1, |solver| solver.recorded_substeps)
    }

    /// Asks for commands for at least `needed` collision substeps, if the device counts them.
    pub(super) fn record_substeps(&mut self, needed: u32) {
        if let Some(solver) = self.solver.as_mut().filter(|solver| solver.counts_substeps()) {
            solver.recorded_substeps = solver.recorded_substeps.max(needed);
        }
    }

    /// Whether some body has continuous collision, with [`Response::Contacts`].
    pub(super) fn has_fast_bodies(&self) -> bool {
        self.step.has_fast_bodies != 0
    }

    /// Number of bodies and planes in the last step.
    pub(super) fn old_bodies(&self) -> u32 {
        self.solver.as_ref().map_or(0, SolverInput::old_bodies)
    }

    /// Number of colliders.
    pub fn len(&self) -> u32 {
        self.step.bodies
    }

    /// Number of colliders of compounds.
    pub fn part_count(&self) -> u32 {
        self.parts.len() as u32
    }

    /// The numbers on which calls depend.
    pub fn population(&self) -> Population {
        Population {
            bodies: self.step.bodies,
            compounds: self.step.compounds,
            planes: self.step.planes,
            large_meshes: self.large_meshes,
            rounded_meshes: self.bodies.iter().any(|body| body.rounding > 0.0),
        }
    }

    /// How many of `hits` intersecting face pairs are listed.
    pub(super) fn listed_hits(&self, hits: u32) -> u32 {
        if self.face_lists { hits } else { 0 }
    }

    /// Whether there are no colliders.
    pub fn is_empty(&self) -> bool {
        self.step.bodies == 0
    }

    /// Parameters of the step, without the lengths of lists.
    pub(crate) fn step(&self) -> &layout::Step {
        &self.step
    }

    /// All bodies.
    pub(crate) fn bodies(&self) -> &[layout::Body] {
        &self.bodies
    }

    /// All planes.
    pub(crate) fn planes(&self) -> &[layout::Plane] {
        &self.planes
    }

    /// The mesh of a body.
    pub(super) fn mesh_of(&self, body: u32) -> Option<&CollisionMesh> {
        self.meshes[self.bodies[body as usize].mesh as usize].as_ref()
    }

    /// The centre of mass of the body of a collider before a step without response, from the motions after it: of
    /// colliders, then of compounds.
    pub(super) fn center_before(&self, collider: u32, after: &[Motion]) -> Vec3 {
        let packed = &self.bodies[collider as usize];
        let (after, center) = if packed.flags & PART == 0 {
            let center = self.mesh_of(collider).map_or(Vec3::ZERO, |mesh| mesh.mass.center);
            (after[collider as usize], Vec3::from_array(packed.scale) * center)
        } else {
            let mut compounds = self.compounds.iter().zip(&after[self.bodies.len()..]);
            let found = compounds.find(|(compound, _)| compound.collider == packed.body);
            let (compound, after) = found.expect("each part belongs to a compound");
            (*after, Vec3::from_array(compound.center))
        };
        let now = after.position + after.rotation * center;
        if packed.flags & KIND_MASK == STATIC {
            return now;
        }
        now - self.step.dt * after.linear_velocity
    }

    /// Resets the counters.
    pub(super) fn write_counters(&self, commands: &mut Commands, buffers: &Buffers) {
        let mut counters = [0u32; COUNTERS as usize];
        counters[BODIES as usize] = self.step.bodies;
        // If more may be needed, the device counts them.
        counters[NEEDED_SUBSTEPS as usize] = 1;
        commands.write(&buffers.counters, cast_slice(&counters));
    }

    /// Writes what has changed in all other buffers. Lists have these `lengths`.
    pub(super) fn write(
        &self,
        commands: &mut Commands,
        contents: &mut BufferContents,
        buffers: &Buffers,
        contacts: Option<&ContactPrograms>,
        lengths: &ReadbackLengths,
    ) {
        let held = Capacity {
            bodies: self.step.bodies,
            ..buffers.capacity
        };
        let step = layout::Step {
            // By the number of bodies, not by the capacity: the order of pairs, and so of sums, depends on the buckets.
            bucket_mask: held.buckets() - 1,
            pair_capacity: lengths.pairs,
            hit_capacity: self.listed_hits(lengths.hits),
            hit_limit: if self.face_lists { lengths.hits } else { u32::MAX },
            plane_contact_capacity: lengths.plane_contacts,
            piece_capacity: buffers.capacity.pieces,
            touch_capacity: lengths.touches,
            ..self.step
        };
        commands.write_changes(contents, &buffers.sent_step, bytemuck::bytes_of(&step));
        commands.copy(&buffers.sent_step, &buffers.step);
        commands.write_changes(contents, &buffers.parts, cast_slice(&self.parts));
        commands.write_changes(contents, &buffers.planes, cast_slice(&self.planes));
        for (sent, used, bytes) in [
            (&buffers.sent_bodies, &buffers.bodies, cast_slice(&self.bodies)),
            (&buffers.sent_compounds, &buffers.compounds, cast_slice(&self.compounds)),
        ] {
            commands.write_changes(contents, sent, bytes);
            commands.copy_start(sent, used, bytes.len() as u64);
        }
        if let Some(contacts) = contacts {
            contacts.write_limits(commands, contents, step.bodies, step.planes, lengths);
            if let Some(solver) = &self.solver {
                solver.write(commands, contents, &contacts.step, &contacts.solver);
            }
        }
    }
}

/// Source and `carried` of a body, from the host's and from those of its colliders. The colliders may have belonged to
/// another body, whose state the body does not continue.
fn both((source, carried): (u32, u32), (of_colliders, also): (u32, u32)) -> (u32, u32) {
    if carried == 0 {
        (of_colliders, also)
    } else if source == of_colliders {
        (source, carried | also)
    } else {
        (source, carried | (also & !(CONTINUES | CARRIED_SLEEP)))
    }
}

fn body(bodies: &Bodies, state: &StepInput, i: usize, carried: Option<Carried>) -> layout::Body {
    let part = bodies.part(i as u32);
    let inertia = part.map_or(bodies.local_inverse_inertia[i], |part| {
        // In the axes of the collider.
        let axes = DMat3::from_quat(part.pose.rotation).as_mat3();
        axes.transpose() * bodies.compounds[part.compound as usize].local_inverse_inertia * axes
    });
    let scale = bodies.scale[i];
    let mesh = &state.meshes[bodies.mesh[i]].mesh;
    // The device places the centre of mass in single precision, so the sphere grows by the rounding error. The device
    // adds the part that depends on the distance from the origin.
    let anchor = scale * mesh.mass.center;
    let radius = mesh.radius * scale.abs().max_element();
    let sent = carried.map_or_else(|| bodies.motion(i), |carried| carried.sent(bodies.motion(i)));
    let [force_acceleration, torque_acceleration] = bodies.surface_accelerations(i);
    // An angular impulse acts when the device knows the rotation, after margins are chosen. Margins count it as a
    // torque over the whole step.
    let [_, by_impulse] = bodies.surface_speeds_of_impulses(i);
    let torque_acceleration = (torque_acceleration + by_impulse / state.config.dt).min(MAX_ACCELERATION);
    layout::Body {
        position: sent.position.to_array(),
        mesh: bodies.mesh[i],
        rotation: sent.rotation.to_array(),
        scale: scale.to_array(),
        radius: radius * (1.0 + 1.0e-6) + 1.5e-6 * anchor.length(),
        linear_velocity: sent.linear_velocity.to_array(),
        inverse_mass: bodies.inverse_mass[i],
        angular_velocity: sent.angular_velocity.to_array(),
        restitution: bodies.restitution[i],
        inverse_inertia: [inertia.x_axis.x, inertia.y_axis.y, inertia.z_axis.z],
        gravity_scale: bodies.gravity_scale[i],
        inverse_inertia_off_diagonal: [inertia.y_axis.x, inertia.z_axis.x, inertia.z_axis.y],
        flags: flags(bodies, i) | if part.is_some() { PART } else { 0 },
        memberships: bodies.layers[i].memberships,
        filters: bodies.layers[i].filters,
        thickness: bodies.thickness[i],
        travel_time: state.config.dt,
        center_offset: part.map_or(0.0, |part| part.offset.length() as f32),
        force_acceleration,
        torque_acceleration,
        acceleration: bodies.acceleration(i, state.config.gravity).to_array(),
        rounding: bodies.rounding[i],
        source: carried.map_or(0, |carried| carried.source),
        carried: carried.map_or(0, |carried| carried.bits()),
        body: bodies.body_of(i as u32),
        ..Default::default()
    }
}

/// Compound `number`. `parts` are ascending by compound.
fn compound(number: u32, own: &Compound, parts: &[&CompoundPart], carried: Option<Carried>) -> layout::Compound {
    let sent = carried.map_or(own.motion, |carried| carried.sent(own.motion));
    let first = parts.partition_point(|part| part.compound < number);
    let end = parts.partition_point(|part| part.compound <= number);
    layout::Compound {
        position: sent.position.to_array(),
        collider: own.number,
        rotation: sent.rotation.to_array(),
        center: own.local_center.as_vec3().to_array(),
        radius: own.radius,
        linear_velocity: sent.linear_velocity.to_array(),
        first_part: first as u32,
        angular_velocity: sent.angular_velocity.to_array(),
        part_count: (end - first) as u32,
        source: carried.map_or(0, |carried| carried.source),
        carried: carried.map_or(0, |carried| carried.bits()),
        ..Default::default()
    }
}

fn part(bodies: &Bodies, part: &CompoundPart) -> layout::CompoundPart {
    let compound = &bodies.compounds[part.compound as usize];
    layout::CompoundPart {
        translation: (part.pose.translation - compound.local_center).as_vec3().to_array(),
        collider: part.collider,
        rotation: part.pose.rotation.as_quat().to_array(),
        offset: part.offset.as_vec3().to_array(),
        ..Default::default()
    }
}

fn flags(bodies: &Bodies, i: usize) -> u32 {
    let kind = match bodies.kind[i] {
        RigidBody::Dynamic => DYNAMIC,
        RigidBody::Kinematic => KINEMATIC,
        RigidBody::Static => STATIC,
    };
    let culling = match bodies.culling[i] {
        Culling::Exact => 0,
        Culling::FacesOfCollision => CULLING_FACES,
        Culling::FrontFacing => CULLING_FRONT,
    };
    kind | culling | if bodies.sensor[i] { SENSOR } else { 0 }
}

fn plane(plane: &Plane) -> layout::Plane {
    layout::Plane {
        normal: plane.normal.to_array(),
        distance: plane.distance,
        restitution: plane.restitution,
        memberships: plane.layers.memberships,
        filters: plane.layers.filters,
        sensor: plane.sensor.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::shapes;
    use crate::state::Body;

    #[test]
    fn margins_include_an_angular_impulse_that_is_left() {
        let mut state = StepInput::default();
        let cube = state.meshes.add(CollisionMesh::new(&shapes::cube(1.0)));
        let mut cube = Body::at_rest(cube, Vec3::ZERO, Quat::IDENTITY, Vec3::ONE);
        cube.params.forces.angular_impulse = Vec3::Z * 2.0;
        state.bodies.push(&cube, &state.meshes).expect("a usable body");
        let sent = body(&state.bodies, &state, 0, Some(Carried::all(0)));
        // 12 rad/s about the centre of mass of a cube of a kilogram.
        let speed = sent.torque_acceleration * state.config.dt;
        assert!((10.0..20.0).contains(&speed), "{speed}");
    }
}
