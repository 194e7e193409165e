// Solver: every body takes over pose and velocity and the impulses from outside, and speeds up for the first substep.
#import faceoff::dispatch::group_index
#import faceoff::math::largest
#import faceoff::motion as m
#import faceoff::solver_math::{decay, finite, finite_rotation, finite_vector}
#import faceoff::solver_types as s
#import faceoff::tensor::{inverse_tensor, is_zero, Tensor}
#import faceoff::types as t

@group(0) @binding(0) var<uniform> interval: s::Interval;
@group(0) @binding(1) var<storage, read> solver_bodies: array<s::SolverBody>;
@group(0) @binding(2) var<storage, read> states: array<s::BodyState>;
@group(0) @binding(3) var<storage, read_write> forces: array<s::BodyForces>;
@group(0) @binding(4) var<storage, read_write> movers: array<s::Mover>;
@group(0) @binding(5) var<storage, read_write> velocities: array<s::Velocity>;
@group(0) @binding(6) var<storage, read_write> masses: array<s::Mass>;
@group(0) @binding(7) var<storage, read_write> shifts: array<s::Shift>;
// Of each body: where its ends begin and end among those sorted by body, and its number in the interval before.
@group(0) @binding(8) var<storage, read_write> links: array<vec4<u32>>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= interval.bodies {
        return;
    }
    let body = solver_bodies[i];
    let state = states[i];
    let mover = mover_of(body, state, forces[i]);
    var mass: s::Mass;
    mass.share = 1.0;
    mass.flags = mover.flags;
    var velocity: s::Velocity;
    if (mover.flags & s::MOVES) != 0u {
        velocity.linear = state.linear_velocity;
        velocity.angular = state.angular_velocity;
    }
    if (mover.flags & s::HAS_MASS) != 0u {
        let inertia = m::world_inverse_inertia(mover, mover.rotation);
        mass.inverse_mass = body.inverse_mass * m::free_translation(mover.flags);
        mass.inverse_inertia = inertia.diagonal;
        mass.inverse_inertia_mixed = inertia.mixed;
        if all(mass.inverse_mass == vec3(0.0)) && is_zero(inertia) {
            // All axes are locked.
            mass.flags &= ~s::HAS_MASS;
        }
        velocity = m::pushed(velocity, mass, forces[i].impulse, forces[i].angular_impulse);
        velocity.linear *= m::free_translation(mover.flags);
        velocity.angular *= m::free_rotation(mover.flags);
    }
    if state.asleep == 0u {
        forces[i].impulse = vec3(0.0);
        forces[i].angular_impulse = vec3(0.0);
    }
    var kept = mover;
    kept.flags = mass.flags;
    movers[i] = kept;
    masses[i] = mass;
    velocities[i] = m::accelerated(velocity, mass, kept, interval.h);
    shifts[i] = s::Shift(vec3(0.0), 0.0, vec4(0.0, 0.0, 0.0, 1.0));
    links[i] = vec4(0u, 0u, s::NOT_KEPT, 0u);
}

fn mover_of(body: s::SolverBody, state: s::BodyState, acting: s::BodyForces) -> s::Mover {
    let sound = finite_vector(state.center)
        && finite_rotation(state.rotation)
        && finite_vector(state.linear_velocity)
        && finite_vector(state.angular_velocity);
    let kind = body.flags & t::KIND_MASK;
    let moves = sound && kind != t::STATIC && state.asleep == 0u;
    let massive = moves
        && kind == t::DYNAMIC
        && body.inverse_mass > 0.0
        && finite(body.inverse_mass)
        && finite_vector(body.inverse_inertia)
        && finite_vector(body.inverse_inertia_mixed);
    var mover: s::Mover;
    mover.rotation = vec4(0.0, 0.0, 0.0, 1.0);
    let rotation = state.rotation + state.rotation_low;
    let length = sqrt(dot(rotation, rotation));
    if sound && length > 1.0e-6 && finite(length) {
        mover.rotation = rotation / length;
    }
    mover.linear_decay = decay(body.linear_damping * interval.h);
    mover.angular_decay = decay(body.angular_damping * interval.h);
    mover.max_linear_speed = body.max_linear_speed;
    mover.max_angular_speed = body.max_angular_speed;
    mover.flags = select(0u, s::SOUND, sound) | select(0u, s::MOVES, moves);
    if !massive {
        mover.flags |= s::ISOTROPIC;
        return mover;
    }
    mover.flags |= s::HAS_MASS | ((body.flags >> s::LOCKED_AXES) & 63u) << s::LOCKED;
    mover.inverse_inertia = body.inverse_inertia;
    mover.inverse_inertia_mixed = body.inverse_inertia_mixed;
    let inertia = inverse_tensor(Tensor(body.inverse_inertia, body.inverse_inertia_mixed));
    // A body that cannot be turned about some axis has no inertia to speak of: it turns as if it were a ball.
    let regular = !is_zero(inertia) && finite_vector(inertia.diagonal) && finite_vector(inertia.mixed);
    if regular {
        mover.inertia = inertia.diagonal;
        mover.inertia_mixed = inertia.mixed;
    }
    let size = body.inverse_inertia.x;
    let uneven = max(largest(abs(body.inverse_inertia - size)), largest(abs(body.inverse_inertia_mixed)));
    if !regular || uneven <= 1.0e-5 * size {
        mover.flags |= s::ISOTROPIC;
    }
    mover.acceleration = interval.gravity * body.gravity_scale * m::free_translation(mover.flags);
    mover.force = acting.force;
    mover.torque = acting.torque;
    return mover;
}
