// BroadPhase: the same for compounds, whose colliders follow. One thread per compound.
#import faceoff::carried::carry_over_compound
#import faceoff::compound::{CompoundMotion, offset_of, placed_part}
#import faceoff::dispatch::group_index
#import faceoff::margins::{with_rounded_center, with_speculative_radius}
#import faceoff::math::rotate
#import faceoff::types as t

@group(0) @binding(0) var<uniform> step: t::Step;
@group(0) @binding(1) var<storage, read> moved: array<t::Moved>;
@group(0) @binding(2) var<storage, read_write> compounds: array<t::Compound>;
@group(0) @binding(3) var<storage, read> parts: array<t::CompoundPart>;
@group(0) @binding(4) var<storage, read_write> bodies: array<t::Body>;
@group(0) @binding(5) var<storage, read_write> body_contacts: array<t::BodyContacts>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let number = group_index(group) * 64u + thread;
    if number >= step.compounds {
        return;
    }
    let compound = carry_over_compound(compounds[number], moved[compounds[number].source]);
    compounds[number] = compound;
    let motion = CompoundMotion(
        compound.position,
        rotate(compound.rotation, compound.center),
        compound.rotation,
        compound.linear_velocity,
        compound.angular_velocity,
    );
    for (var k = compound.first_part; k < compound.first_part + compound.part_count; k += 1u) {
        let part = parts[k];
        let i = part.collider;
        let body = placed_part(bodies[i], part, motion);
        bodies[i] = with_speculative_radius(step, with_rounded_center(body));
        let offset = offset_of(part, motion);
        body_contacts[i].offset_x = offset.x;
        body_contacts[i].offset_y = offset.y;
        body_contacts[i].offset_z = offset.z;
    }
}
