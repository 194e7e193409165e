//! From the host's arrays to the device's.

use super::buffers::{Buffers, Sizes};
use super::device::Gpu;
use super::layout::{self, BODIES, COUNTERS, CULLING_FACES, CULLING_FRONT, DYNAMIC, KINEMATIC, SENSOR, STATIC};
use crate::components::RigidBody;
use crate::settings::{Culling, Response};
use crate::stages::state::{Bodies, Plane, StepState};
use bytemuck::{Pod, cast_slice};

/// Writes all input of a step.
pub fn write(gpu: &Gpu, buffers: &Buffers, state: &StepState) {
    let StepState {
        config, bodies, planes, ..
    } = state;
    let sizes = &buffers.sizes;
    let held = Sizes {
        bodies: bodies.len() as u32,
        ..*sizes
    };
    let step = layout::Step {
        gravity: config.gravity.to_array(),
        dt: config.dt,
        bodies: bodies.len() as u32,
        planes: planes.len() as u32,
        // By the bodies there are and not by the room for them: the order of pairs, and so of sums, follows the buckets.
        bucket_mask: held.buckets() - 1,
        response: u32::from(config.response != Response::None),
        pair_capacity: sizes.pairs,
        hit_capacity: sizes.hits,
        plane_contact_capacity: sizes.plane_contacts,
        padding: 0,
    };
    gpu.queue.write_buffer(&buffers.step, 0, bytemuck::bytes_of(&step));
    let mut counters = [0u32; COUNTERS as usize];
    counters[BODIES as usize] = step.bodies;
    gpu.queue.write_buffer(&buffers.counters, 0, cast_slice(&counters));
    gpu.queue.write_buffer(&buffers.status, 0, cast_slice(&[0u32; 4]));
    fill(gpu, &buffers.bodies, bodies.len(), |i| body(bodies, state, i));
    fill(gpu, &buffers.planes, planes.len(), |i| plane(&planes[i]));
}

/// Writes the first elements of an array.
fn fill<T: Pod>(gpu: &Gpu, buffer: &wgpu::Buffer, count: usize, of: impl Fn(usize) -> T) {
    let all: Vec<T> = (0..count).map(of).collect();
    gpu.queue.write_buffer(buffer, 0, cast_slice(&all));
}

fn body(bodies: &Bodies, state: &StepState, i: usize) -> layout::Body {
    let inertia = bodies.own_inverse_inertia[i];
    let scale = bodies.scale[i];
    // The device places the centre of mass in single precision: the sphere grows by what that can cost.
    let arm = scale * state.meshes[bodies.mesh[i]].mesh.mass.center;
    layout::Body {
        position: bodies.position[i].to_array(),
        mesh: bodies.mesh[i],
        rotation: bodies.rotation[i].to_array(),
        scale: scale.to_array(),
        radius: bodies.radius[i] + 1.0e-6 * arm.length(),
        linear_velocity: bodies.linear_velocity[i].to_array(),
        inverse_mass: bodies.inverse_mass[i],
        angular_velocity: bodies.angular_velocity[i].to_array(),
        restitution: bodies.restitution[i],
        inverse_inertia: [inertia.x_axis.x, inertia.y_axis.y, inertia.z_axis.z],
        gravity_scale: bodies.gravity_scale[i],
        inverse_inertia_mixed: [inertia.y_axis.x, inertia.z_axis.x, inertia.z_axis.y],
        flags: flags(bodies, i),
        memberships: bodies.layers[i].memberships,
        filters: bodies.layers[i].filters,
        padding: [0; 2],
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
        ..Default::default()
    }
}
