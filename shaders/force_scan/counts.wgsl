// ForceScan: counts the contacts that apply an impulse to each collider. Contacts that separate do not count, so they
// take no part of the body's mass. One thread per collider.
#import faceoff::dispatch::group_index
#import faceoff::response::plane_pushes
#import faceoff::types as t

@group(0) @binding(0) var<uniform> step: t::Step;
@group(0) @binding(1) var<storage, read> bodies: array<t::Body>;
@group(0) @binding(2) var<storage, read> planes: array<t::Plane>;
@group(0) @binding(3) var<storage, read> plane_contacts: array<t::PlaneContact>;
@group(0) @binding(4) var<storage, read_write> body_contacts: array<t::BodyContacts>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= step.bodies {
        return;
    }
    let body = bodies[i];
    let contacts = body_contacts[i];
    var active_contacts = contacts.last_entry - contacts.first_entry;
    for (var k = contacts.first_plane; k < contacts.first_plane + contacts.planes; k += 1u) {
        if k < step.plane_contact_capacity {
            let contact = plane_contacts[k];
            active_contacts += u32(plane_pushes(step, body, planes[contact.plane], contact));
        }
    }
    body_contacts[i].active_contacts = active_contacts;
}
