// Integrate of a step with contacts: the same for compounds and their colliders. One thread per compound.
#import faceoff::compound::{CompoundMotion, placed_part}
#import faceoff::dispatch::group_index
#import faceoff::math::ascending
#import faceoff::placed::{position_of, rotation_of}
#import faceoff::solver_types as s
#import faceoff::types as t

@group(0) @binding(0) var<uniform> step: t::Step;
@group(0) @binding(1) var<storage, read> counters: array<u32>;
@group(0) @binding(2) var<storage, read_write> tally: array<atomic<u32>>;
@group(0) @binding(3) var<storage, read> bodies: array<t::Body>;
@group(0) @binding(4) var<storage, read> compounds: array<t::Compound>;
@group(0) @binding(5) var<storage, read> parts: array<t::CompoundPart>;
@group(0) @binding(6) var<storage, read> motion_states: array<s::MotionState>;
@group(0) @binding(7) var<storage, read_write> moved: array<t::Moved>;
@group(0) @binding(8) var<storage, read_write> last_step_states: array<s::MotionState>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let number = group_index(group) * 64u + thread;
    if number >= step.compounds || counters[t::SKIPPED] != 0u {
        return;
    }
    let compound = compounds[number];
    let state = motion_states[compound.collider];
    let asleep = state.asleep;
    // The compound has slept since the step began, so it keeps its pose to the bit.
    let rests = asleep != 0u && (bodies[compound.collider].inactive & t::RESTS) != 0u;
    let v = state.linear_velocity;
    let w = state.angular_velocity;
    let motion = CompoundMotion(state.center, state.center_low, rotation_of(state), v, w);
    for (var k = compound.first_part; k < compound.first_part + compound.part_count; k += 1u) {
        let part = parts[k];
        let i = part.collider;
        var body = bodies[i];
        if !rests {
            body = placed_part(body, part, motion);
        }
        moved[i] =
            t::Moved(body.position, asleep, body.rotation, body.linear_velocity, 0u, body.angular_velocity, 0u);
        last_step_states[i] = motion_states[i];
    }
    var position = compound.position;
    var rotation = compound.rotation;
    if !rests {
        position = position_of(state, compound.center);
        rotation = motion.rotation;
    }
    moved[step.bodies + number] = t::Moved(position, asleep, rotation, v, 0u, w, 0u);
    atomicAdd(&tally[t::ASLEEP], u32(asleep != 0u));
    if asleep == 0u {
        atomicStore(&tally[t::AWAKE], 1u);
    }
    if (bodies[compound.collider].flags & t::FAST) != 0u {
        return;
    }
    for (var axis = 0u; axis < 3u; axis += 1u) {
        atomicMax(&tally[t::MAX_VELOCITY + axis], ascending(v[axis]));
        atomicMax(&tally[t::MAX_NEGATED_VELOCITY + axis], ascending(-v[axis]));
    }
    atomicMax(&tally[t::MAX_SPIN], ascending(sqrt(dot(w, w)) * compound.radius));
}
