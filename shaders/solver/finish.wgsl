// Solver: where the bodies are after the interval.
#import faceoff::dispatch::group_index
#import faceoff::math::compose
#import faceoff::motion::limited_velocity
#import faceoff::solver_math::{carried, carried_rotation, finite_rotation, grid}
#import faceoff::solver_types as s

@group(0) @binding(0) var<uniform> interval: s::Interval;
@group(0) @binding(1) var<storage, read> movers: array<s::Mover>;
@group(0) @binding(2) var<storage, read> velocities: array<s::Velocity>;
@group(0) @binding(3) var<storage, read> shifts: array<s::Shift>;
@group(0) @binding(4) var<storage, read_write> states: array<s::BodyState>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= interval.bodies || (movers[i].flags & s::MOVES) == 0u {
        return;
    }
    var state = states[i];
    let velocity = limited_velocity(velocities[i], movers[i]);
    state.linear_velocity = velocity.linear;
    state.angular_velocity = velocity.angular;

    let fine = state.center_low + shifts[i].moved;
    let carry = carried(fine, grid(state.center));
    state.center += carry;
    state.center_low = fine - carry;

    turn_state(&state, shifts[i].turned);
    states[i] = state;
}

fn turn_state(state: ptr<function, s::BodyState>, turned: vec4<f32>) {
    let high = (*state).rotation;
    let low = (*state).rotation_low;
    // turned * rotation - rotation, of which the first factor is nearly the identity: 1 - w follows from the small parts.
    let small = dot(turned.xyz, turned.xyz);
    let lacking = select(1.0 - turned.w, small / (1.0 + turned.w), turned.w > 0.0);
    let by = vec4(turned.xyz, -lacking);
    let whole = high + low;
    // Too long by this part, without the rounding of a sum near 1.
    let excess = (dot(high, high) - 1.0) + 2.0 * dot(high, low);
    let step = compose(by, whole);
    let fine = low + step - (0.5 * excess) * (whole + step);
    let carry = carried_rotation(fine);
    let next = high + carry;
    if finite_rotation(next) && finite_rotation(fine) && abs(excess) < 0.01 {
        (*state).rotation = next;
        (*state).rotation_low = fine - carry;
        return;
    }
    let rotation = compose(turned, whole);
    let unit = rotation / sqrt(dot(rotation, rotation));
    (*state).rotation = select(vec4(0.0, 0.0, 0.0, 1.0), carried_rotation(unit), finite_rotation(unit));
    (*state).rotation_low = select(vec4(0.0), unit - carried_rotation(unit), finite_rotation(unit));
}
