// Integrate between collision substeps: moves the colliders of compounds to where the solver has put these. One thread
// per compound.
#import faceoff::compound::{CompoundMotion, offset_of, placed_part}
#import faceoff::dispatch::group_index
#import faceoff::paces::NO_PACE
#import faceoff::placed::rotation_of
#import faceoff::scheduled::{after_substep, has_completed}
#import faceoff::solver_types as s
#import faceoff::types as t

@group(0) @binding(0) var<uniform> step: t::Step;
@group(0) @binding(1) var<storage, read> motion_states: array<s::MotionState>;
@group(0) @binding(2) var<storage, read> compounds: array<t::Compound>;
@group(0) @binding(3) var<storage, read> parts: array<t::CompoundPart>;
@group(0) @binding(4) var<storage, read_write> bodies: array<t::Body>;
@group(0) @binding(5) var<storage, read_write> body_contacts: array<t::BodyContacts>;
@group(0) @binding(6) var<storage, read> tally: array<u32>;
@group(0) @binding(7) var<storage, read_write> body_paces: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let number = group_index(group) * 64u + thread;
    if number >= step.compounds {
        return;
    }
    let compound = compounds[number];
    let state = motion_states[compound.collider];
    let completed = has_completed(body_paces[compound.collider], tally[t::COLLISION_SUBSTEPS]);
    let motion = CompoundMotion(
        state.center, state.center_low, rotation_of(state), state.linear_velocity, state.angular_velocity
    );
    for (var k = compound.first_part; k < compound.first_part + compound.part_count; k += 1u) {
        let part = parts[k];
        let i = part.collider;
        var body = placed_part(bodies[i], part, motion);
        body.source = i;
        bodies[i] = after_substep(step, body, state.asleep != 0u, completed);
        if completed {
            body_paces[i] = NO_PACE;
        }
        let offset = offset_of(part, motion);
        body_contacts[i].offset_x = offset.x;
        body_contacts[i].offset_y = offset.y;
        body_contacts[i].offset_z = offset.z;
    }
}
