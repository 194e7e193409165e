#define_import_path faceoff::contact_slots

// Every pair of bodies has a slot, and every body one for each half-space, ascending by both numbers. Kernels fill the
// slots in any order; the final list holds the slots with points.

// The slot of pair `i` of the list, whose first body is `a`.
fn slot_of_pair(i: u32, a: u32, bodies: u32, planes: u32) -> u32 {
    return i + planes * min(a, bodies);
}

// The slot of a body and a half-space. `before` is the number of pairs whose first body is this one or an earlier one.
fn slot_of_plane(body: u32, plane: u32, before: u32, planes: u32) -> u32 {
    return before + planes * body + plane;
}
