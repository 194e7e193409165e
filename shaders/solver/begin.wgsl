// Solver: loads pose and velocity of each body, and applies external impulses. Each body is an island of its own at
// first. One thread per collider.
#import faceoff::dispatch::group_index
#import faceoff::math::max_component
#import faceoff::motion as m
#import faceoff::paces::NO_PACE
#import faceoff::solver_math::{finite, finite_rotation, finite_vector}
#import faceoff::solver_types as s
#import faceoff::tensor::{inverse_tensor, is_zero, Tensor}
#import faceoff::types as t
#import faceoff::union_find::islands

@group(0) @binding(0) var<uniform> collision_substep: s::CollisionSubstep;
@group(0) @binding(1) var<storage, read> solver_bodies: array<s::SolverBody>;
@group(0) @binding(2) var<storage, read> motion_states: array<s::MotionState>;
@group(0) @binding(3) var<storage, read_write> forces: array<s::BodyForces>;
@group(0) @binding(4) var<storage, read_write> body_constants: array<s::BodyConstants>;
@group(0) @binding(5) var<storage, read_write> body_states: array<s::BodyState>;
@group(0) @binding(6) var<storage, read_write> old_numbers: array<u32>;
@group(0) @binding(7) var<storage, read> body_paces: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= collision_substep.bodies {
        return;
    }
    let body = solver_bodies[i];
    let state = motion_states[i];
    let pace = body_paces[i];
    var constants = body_constants_of(i, body, state, forces[i], pace);
    if pace == NO_PACE && (body.flags & t::KIND_MASK) != t::STATIC {
        // The body's contacts keep their points, whose anchors are in its axes of that time.
        constants.initial_rotation = body_constants[i].initial_rotation;
    }
    var mass: s::Mass;
    mass.flags = constants.flags;
    var velocity: s::Velocity;
    if (constants.flags & s::MOVES) != 0u {
        velocity.linear = state.linear_velocity;
        velocity.angular = state.angular_velocity;
    }
    if (constants.flags & s::HAS_MASS) != 0u {
        let inertia = m::world_inverse_inertia(constants, constants.initial_rotation);
        mass.inverse_mass = body.inverse_mass * m::free_translation(constants.flags);
        mass.inverse_inertia = inertia.diagonal;
        mass.inverse_inertia_off_diagonal = inertia.off_diagonal;
        if all(mass.inverse_mass == vec3(0.0)) && is_zero(inertia) {
            // All axes are locked.
            mass.flags &= ~s::HAS_MASS;
        }
        velocity = m::with_impulse(velocity, mass, forces[i].impulse, forces[i].angular_impulse);
        velocity.linear *= m::free_translation(constants.flags);
        velocity.angular *= m::free_rotation(constants.flags);
    }
    if state.asleep == 0u {
        forces[i].impulse = vec3(0.0);
        forces[i].angular_impulse = vec3(0.0);
    }
    if (mass.flags & s::HAS_MASS) == 0u {
        // The body's velocity is the same in all substeps.
        velocity = m::limited_velocity(velocity, constants);
    }
    constants.flags = mass.flags;
    body_constants[i] = constants;
    body_states[i] =
        s::BodyState(velocity, velocity, mass, s::PoseChange(vec3(0.0), 0.0, vec4(0.0, 0.0, 0.0, 1.0)));
    old_numbers[i] = s::NOT_SAVED;
    atomicStore(&islands[i].parent, i);
}

// Only the first collider of a body moves.
fn body_constants_of(
    number: u32,
    body: s::SolverBody,
    state: s::MotionState,
    external_forces: s::BodyForces,
    pace: u32,
) -> s::BodyConstants {
    let valid = finite_vector(state.center)
        && finite_rotation(state.rotation)
        && finite_vector(state.linear_velocity)
        && finite_vector(state.angular_velocity);
    let kind = body.flags & t::KIND_MASK;
    let moves = valid
        && kind != t::STATIC
        && state.asleep == 0u
        && body.body == number
        && pace != NO_PACE;
    let has_mass = moves
        && kind == t::DYNAMIC
        && body.inverse_mass > 0.0
        && finite(body.inverse_mass)
        && finite_vector(body.inverse_inertia)
        && finite_vector(body.inverse_inertia_off_diagonal);
    var constants: s::BodyConstants;
    constants.initial_rotation = vec4(0.0, 0.0, 0.0, 1.0);
    let rotation = state.rotation + state.rotation_low;
    let length = sqrt(dot(rotation, rotation));
    if valid && length > 1.0e-6 && finite(length) {
        constants.initial_rotation = rotation / length;
    }
    constants.linear_damping = body.linear_damping;
    constants.angular_damping = body.angular_damping;
    constants.max_linear_speed = body.max_linear_speed;
    constants.max_angular_speed = body.max_angular_speed;
    constants.flags = select(0u, s::FINITE, valid) | select(0u, s::MOVES, moves);
    constants.flags |= select(s::COMPLETED, pace << s::PACE_SHIFT, pace != NO_PACE);
    if !has_mass {
        constants.flags |= s::ISOTROPIC;
        return constants;
    }
    constants.flags |= s::HAS_MASS | ((body.flags >> s::LOCKED_AXES) & 63u) << s::LOCKED;
    constants.local_inverse_inertia = body.inverse_inertia;
    constants.local_inverse_inertia_off_diagonal = body.inverse_inertia_off_diagonal;
    let inertia = inverse_tensor(Tensor(body.inverse_inertia, body.inverse_inertia_off_diagonal));
    // A singular inverse has no inertia tensor: the body cannot rotate about some axis. It rotates as if isotropic.
    let regular = !is_zero(inertia) && finite_vector(inertia.diagonal) && finite_vector(inertia.off_diagonal);
    if regular {
        constants.local_inertia = inertia.diagonal;
        constants.local_inertia_off_diagonal = inertia.off_diagonal;
    }
    let size = body.inverse_inertia.x;
    let uneven = max(
        max_component(abs(body.inverse_inertia - size)), max_component(abs(body.inverse_inertia_off_diagonal))
    );
    if !regular || uneven <= 1.0e-5 * size {
        constants.flags |= s::ISOTROPIC;
    }
    constants.acceleration = collision_substep.gravity * body.gravity_scale * m::free_translation(constants.flags);
    constants.force = external_forces.force;
    constants.torque = external_forces.torque;
    return constants;
}
