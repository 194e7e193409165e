// Solver: moves bodies that are in no island, and writes poses and velocities back at the end of a collision substep.
// One thread per body.
#import faceoff::dispatch::group_index
#import faceoff::math::compose
#import faceoff::motion as m
#import faceoff::paces::pace_of
#import faceoff::solver_math::{coarse_part, coarse_rotation, finite_rotation, coarse_digit}
#import faceoff::solver_types as s

@group(0) @binding(0) var<uniform> collision_substep: s::CollisionSubstep;
@group(0) @binding(1) var<storage, read> body_constants: array<s::BodyConstants>;
@group(0) @binding(2) var<storage, read_write> body_states: array<s::BodyState>;
@group(0) @binding(3) var<storage, read_write> motion_states: array<s::MotionState>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= collision_substep.bodies || (body_constants[i].flags & s::MOVES) == 0u {
        return;
    }
    if (body_states[i].mass.flags & s::SOLVED) == 0u {
        move_freely(i);
    }
    var state = motion_states[i];
    let velocity = m::limited_velocity(body_states[i].velocity, body_constants[i]);
    state.linear_velocity = velocity.linear;
    state.angular_velocity = velocity.angular;

    let fine = state.center_low + body_states[i].pose_change.translation;
    let carry = coarse_part(fine, coarse_digit(state.center));
    state.center += carry;
    state.center_low = fine - carry;

    rotate_state(&state, body_states[i].pose_change.rotation);
    motion_states[i] = state;
}

fn move_freely(i: u32) {
    let constants = body_constants[i];
    let pace = pace_of(constants.flags);
    var state = body_states[i];
    for (var number = 0u; number < pace.substeps; number += 1u) {
        state.velocity = m::with_integrated_velocity(state.velocity, state.mass, constants, pace.h);
        m::integrate_pose(constants, &state, pace.h);
    }
    body_states[i] = state;
}

fn rotate_state(state: ptr<function, s::MotionState>, rotation_change: vec4<f32>) {
    let high = (*state).rotation;
    let low = (*state).rotation_low;
    // `rotation_change * rotation - rotation`, where the first factor is close to the identity: computing 1 - w from
    // the small parts avoids cancellation.
    let small = dot(rotation_change.xyz, rotation_change.xyz);
    let one_minus_w = select(1.0 - rotation_change.w, small / (1.0 + rotation_change.w), rotation_change.w > 0.0);
    let by = vec4(rotation_change.xyz, -one_minus_w);
    let whole = high + low;
    // The squared length minus 1, computed from the small parts to avoid cancellation.
    let excess = (dot(high, high) - 1.0) + 2.0 * dot(high, low);
    let step = compose(by, whole);
    let fine = low + step - (0.5 * excess) * (whole + step);
    let carry = coarse_rotation(fine);
    let next = high + carry;
    if finite_rotation(next) && finite_rotation(fine) && abs(excess) < 0.01 {
        (*state).rotation = next;
        (*state).rotation_low = fine - carry;
        return;
    }
    let rotation = compose(rotation_change, whole);
    let unit = rotation / sqrt(dot(rotation, rotation));
    (*state).rotation = select(vec4(0.0, 0.0, 0.0, 1.0), coarse_rotation(unit), finite_rotation(unit));
    (*state).rotation_low = select(vec4(0.0), unit - coarse_rotation(unit), finite_rotation(unit));
}
