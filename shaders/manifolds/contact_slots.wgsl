#define_import_path faceoff::contact_slots

// Every pair of bodies has a slot, and every body one for each half-space, ascending by both numbers: what a slot holds is
// found by the kernels in any order, and the list of pairs is what slots hold that hold anything.

// The slot of the pair that is the i-th of the list, with the first body `a`.
fn slot_of_pair(i: u32, a: u32, bodies: u32, planes: u32) -> u32 {
    return i + planes * min(a, bodies);
}

// The slot of a body and a half-space; `before` is how many pairs have this body or one before as their first.
fn slot_of_plane(body: u32, plane: u32, before: u32, planes: u32) -> u32 {
    return before + planes * body + plane;
}
