//! The input of a step, packed for the device.

use super::contact_programs::ContactPrograms;
use super::solver_input::SolverInput;
use crate::asset::CollisionMesh;
use crate::gpu::buffers::{Buffers, Capacity};
use crate::gpu::device::Gpu;
use crate::gpu::layout::{
    self, BODIES, CARRIED_ANGULAR, CARRIED_LINEAR, CARRIED_POSITION, CARRIED_ROTATION, COUNTERS, CULLING_FACES,
    CULLING_FRONT, DYNAMIC, KIND_MASK, KINEMATIC, SENSOR, STATIC,
};
use crate::state::{Bodies, Motion, Plane, StepInput};
use crate::types::body::RigidBody;
use crate::types::settings::{Culling, Response};
use bytemuck::cast_slice;
use glam::{BVec3, Vec3};

/// A body that continues from the last step, whose results the host may not know yet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carried {
    /// Its number in the last step.
    pub source: u32,
    /// What carries over of its position.
    pub position: CarriedVector,
    /// Whether its rotation carries over. Otherwise it is that of [`Bodies`].
    pub rotation: bool,
    /// What carries over of its linear velocity.
    pub linear: CarriedVector,
    /// What carries over of its angular velocity.
    pub angular: CarriedVector,
}

/// What carries over of a vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CarriedVector {
    /// The axes along which it carries over. Along the others it is that of [`Bodies`].
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
    planes: Vec<layout::Plane>,
    meshes: Vec<Option<CollisionMesh>>,
    /// What happens to bodies that touch.
    pub(super) response: Response,
    /// With [`Response::Contacts`].
    pub(super) solver: Option<SolverInput>,
}

impl Input {
    /// Packs the bodies, half-spaces and settings of `state`. `carried` has an entry for each body, or is empty.
    pub fn new(state: &StepInput, carried: &[Option<Carried>]) -> Self {
        let StepInput {
            config, bodies, planes, ..
        } = state;
        let count = bodies.len();
        let body = |i: usize| body(bodies, state, i, carried.get(i).copied().flatten());
        Self {
            step: layout::Step {
                gravity: config.gravity.to_array(),
                dt: config.dt,
                bodies: count as u32,
                planes: planes.len() as u32,
                response: u32::from(config.response != Response::None),
                contact_margin: match config.response {
                    Response::Impulse => 0.0,
                    Response::None | Response::Contacts => config.solver.margin(),
                },
                ..Default::default()
            },
            bodies: (0..count).map(body).collect(),
            planes: planes.iter().map(plane).collect(),
            meshes: (0..state.meshes.len() as u32)
                .map(|slot| state.meshes.get(slot).map(|slot| slot.mesh.clone()))
                .collect(),
            response: config.response,
            solver: None,
        }
    }

    /// Adds the solver's input, with [`Response::Contacts`].
    pub(super) fn with_solver(mut self, solver: SolverInput) -> Self {
        self.step.dt = solver.dt();
        self.step.speculative_time = solver.speculative_time();
        self.step.drift = solver.drift.to_array();
        self.step.planes_changed = solver.planes_changed().into();
        for (i, body) in self.bodies.iter_mut().enumerate() {
            let (source, carried) = solver.source(i);
            // For bodies that carry over, both sources are equal.
            body.source = if carried == 0 { body.source } else { source };
            body.carried |= carried;
        }
        self.solver = Some(solver);
        self
    }

    /// Number of collision substeps.
    pub(super) fn collision_substeps(&self) -> u32 {
        self.solver.as_ref().map_or(1, |solver| solver.collision_substeps)
    }

    /// Number of bodies and half-spaces in the last step.
    pub(super) fn old_bodies(&self) -> u32 {
        self.solver.as_ref().map_or(0, SolverInput::old_bodies)
    }

    /// Number of bodies.
    pub fn len(&self) -> u32 {
        self.step.bodies
    }

    /// Whether there are none.
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

    /// All half-spaces.
    pub(crate) fn planes(&self) -> &[layout::Plane] {
        &self.planes
    }

    /// The mesh of a body.
    pub(super) fn mesh_of(&self, body: u32) -> Option<&CollisionMesh> {
        self.meshes[self.bodies[body as usize].mesh as usize].as_ref()
    }

    /// The centre of mass of a body before a step without response, from its motion after it.
    pub(super) fn center_before(&self, body: u32, after: &Motion) -> Vec3 {
        let packed = &self.bodies[body as usize];
        let center = self.mesh_of(body).map_or(Vec3::ZERO, |mesh| mesh.mass.center);
        let now = after.position + after.rotation * (Vec3::from_array(packed.scale) * center);
        if packed.flags & KIND_MASK == STATIC {
            return now;
        }
        now - self.step.dt * after.linear_velocity
    }

    /// Writes all buffers.
    pub(super) fn write(&self, gpu: &Gpu, buffers: &Buffers, contacts: Option<&ContactPrograms>) {
        let capacity = &buffers.capacity;
        let held = Capacity {
            bodies: self.step.bodies,
            ..*capacity
        };
        let step = layout::Step {
            // By the number of bodies, not by the capacity: the order of pairs, and so of sums, depends on the buckets.
            bucket_mask: held.buckets() - 1,
            pair_capacity: capacity.pairs,
            hit_capacity: capacity.hits,
            plane_contact_capacity: capacity.plane_contacts,
            touch_capacity: contacts.map_or(0, |contacts| contacts.capacity().touches),
            ..self.step
        };
        let mut counters = [0u32; COUNTERS as usize];
        counters[BODIES as usize] = step.bodies;
        gpu.queue.write_buffer(&buffers.step, 0, bytemuck::bytes_of(&step));
        gpu.queue.write_buffer(&buffers.counters, 0, cast_slice(&counters));
        gpu.queue.write_buffer(&buffers.bodies, 0, cast_slice(&self.bodies));
        gpu.queue.write_buffer(&buffers.planes, 0, cast_slice(&self.planes));
        if let Some(contacts) = contacts {
            contacts.write_limits(gpu, step.bodies, step.planes);
            if let Some(solver) = &self.solver {
                solver.write(gpu, &contacts.step, contacts.solver.capacity);
            }
        }
    }
}

fn body(bodies: &Bodies, state: &StepInput, i: usize, carried: Option<Carried>) -> layout::Body {
    let inertia = bodies.local_inverse_inertia[i];
    let scale = bodies.scale[i];
    let mesh = &state.meshes[bodies.mesh[i]].mesh;
    // The device places the centre of mass in single precision, so the sphere grows by the rounding error. The device
    // adds the part that depends on the distance from the origin.
    let anchor = scale * mesh.mass.center;
    let radius = mesh.radius * scale.abs().max_element();
    let mut sent = bodies.motion(i);
    if let Some(carried) = carried {
        sent.position = carried.position.sent(sent.position);
        sent.linear_velocity = carried.linear.sent(sent.linear_velocity);
        sent.angular_velocity = carried.angular.sent(sent.angular_velocity);
    }
    layout::Body {
        position: sent.position.to_array(),
        mesh: bodies.mesh[i],
        rotation: bodies.rotation[i].to_array(),
        scale: scale.to_array(),
        radius: radius * (1.0 + 1.0e-6) + 1.5e-6 * anchor.length(),
        linear_velocity: sent.linear_velocity.to_array(),
        inverse_mass: bodies.inverse_mass[i],
        angular_velocity: sent.angular_velocity.to_array(),
        restitution: bodies.restitution[i],
        inverse_inertia: [inertia.x_axis.x, inertia.y_axis.y, inertia.z_axis.z],
        gravity_scale: bodies.gravity_scale[i],
        inverse_inertia_off_diagonal: [inertia.y_axis.x, inertia.z_axis.x, inertia.z_axis.y],
        flags: flags(bodies, i),
        memberships: bodies.layers[i].memberships,
        filters: bodies.layers[i].filters,
        thickness: bodies.thickness[i],
        source: carried.map_or(0, |carried| carried.source),
        carried: carried.map_or(0, |carried| carried.bits()),
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
        ..Default::default()
    }
}
