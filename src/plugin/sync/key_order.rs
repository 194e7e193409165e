//! Contacts in the order of keys, in which users see them. A step has what is static first.

use super::order::Numbers;
use crate::state::Contacts;

/// Puts the pairs of `contacts` in the order of keys: in each pair the smaller collider first, and the pairs ascending.
pub(super) fn put_in_key_order(contacts: &mut Contacts, colliders: &Numbers) {
    let key = |i: u32| colliders.keyed(i as usize);
    let Contacts {
        pairs,
        faces,
        planes,
        points,
        lists_faces,
        ..
    } = contacts;
    for pair in pairs.iter_mut() {
        let [a, b] = pair.bodies;
        if key(a) <= key(b) {
            continue;
        }
        pair.bodies = [b, a];
        pair.contact.normal = -pair.contact.normal;
        let own = &mut points[pair.first_point as usize..][..pair.point_count as usize];
        own.iter_mut().for_each(|point| point.normal = -point.normal);
        if *lists_faces {
            let own = &mut faces[pair.first_face as usize..][..pair.face_count as usize];
            own.iter_mut().for_each(|face| (face.a, face.b) = (face.b, face.a));
            own.sort_by_key(|face| (face.a, face.b));
        }
    }
    let of_pair = |bodies: [u32; 2]| bodies.map(key);
    if !pairs.is_sorted_by_key(|pair| of_pair(pair.bodies)) {
        pairs.sort_by_cached_key(|pair| of_pair(pair.bodies));
    }
    if !planes.is_sorted_by_key(|contact| (key(contact.body), contact.plane)) {
        planes.sort_by_cached_key(|contact| (key(contact.body), contact.plane));
    }
}
