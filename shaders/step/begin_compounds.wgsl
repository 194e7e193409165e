// BroadPhase of a step with contacts: the same for compounds, whose colliders follow. One thread per compound.
#import faceoff::carried::carry_over_compound
#import faceoff::compound::{CompoundMotion, offset_of, placed_part}
#import faceoff::dispatch::group_index
#import faceoff::margins::{with_rounded_center, with_speculative_radius}
#import faceoff::placed::rotation_of
#import faceoff::solver_types as s
#import faceoff::start::{inactive_at_start, Start, state_at_start}
#import faceoff::types as t

@group(0) @binding(0) var<uniform> step: t::Step;
@group(0) @binding(1) var<storage, read> moved: array<t::Moved>;
@group(0) @binding(2) var<storage, read> last_step_states: array<s::MotionState>;
@group(0) @binding(3) var<storage, read> host_states: array<s::MotionState>;
@group(0) @binding(4) var<storage, read_write> compounds: array<t::Compound>;
@group(0) @binding(5) var<storage, read> parts: array<t::CompoundPart>;
@group(0) @binding(6) var<storage, read_write> bodies: array<t::Body>;
@group(0) @binding(7) var<storage, read_write> body_contacts: array<t::BodyContacts>;
@group(0) @binding(8) var<storage, read_write> motion_states: array<s::MotionState>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let number = group_index(group) * 64u + thread;
    if number >= step.compounds {
        return;
    }
    let last = moved[compounds[number].source];
    let known = last_step_states[compounds[number].last_collider];
    let compound = carry_over_compound(compounds[number], last);
    compounds[number] = compound;
    let v = compound.linear_velocity;
    let w = compound.angular_velocity;
    let here = t::Moved(compound.position, 0u, compound.rotation, v, 0u, w, 0u);
    let kind = bodies[compound.collider].flags & t::KIND_MASK;
    let start = Start(here, last, compound.carried, kind, compound.center, compound.radius);
    let state = state_at_start(host_states[compound.collider], known, start);
    let inactive = inactive_at_start(state, start);
    let motion = CompoundMotion(
        state.center, state.center_low, rotation_of(state), state.linear_velocity, state.angular_velocity
    );
    for (var k = compound.first_part; k < compound.first_part + compound.part_count; k += 1u) {
        let part = parts[k];
        let i = part.collider;
        var body = placed_part(bodies[i], part, motion);
        body.inactive = inactive;
        bodies[i] = with_speculative_radius(step, with_rounded_center(body));
        let offset = offset_of(part, motion);
        body_contacts[i].offset_x = offset.x;
        body_contacts[i].offset_y = offset.y;
        body_contacts[i].offset_z = offset.z;
        motion_states[i] = host_states[i];
    }
    motion_states[compound.collider] = state;
}
