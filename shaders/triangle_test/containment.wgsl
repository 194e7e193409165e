#define_import_path faceoff::containment

// Whether a closed mesh has a point inside, asked by all 64 threads of a workgroup together.

#import faceoff::arena::vector
#import faceoff::tree
#import faceoff::types as t

var<workgroup> inside: atomic<i32>;
var<workgroup> crossings: atomic<u32>;
// Nodes to look into. Of each level at most 64 wait, for only nodes of the lowest one that waits are opened.
var<workgroup> waiting: array<u32, 512>;
var<workgroup> depth: atomic<u32>;
// Whether the device left a loop before its end.
var<private> unfinished: bool = false;

// By the winding number along the ray from p along +z; by its parity if neighbouring faces disagree about the outside.
// `end` is the mesh's place in the pair. Eight nodes are opened at a time, a thread each child.
fn contains(mesh: t::Mesh, end: u32, p: vec3<f32>, thread: u32) -> bool {
    if thread == 0u {
        atomicStore(&inside, 0);
        atomicStore(&crossings, 0u);
        waiting[0] = tree::node(mesh.levels - 1u, 0u);
        atomicStore(&depth, 1u);
    }
    workgroupBarrier();
    loop {
        let last = atomicLoad(&depth);
        if last == 0u {
            break;
        }
        let level = tree::level_of(waiting[last - 1u]);
        var taken = 1u;
        while taken < min(last, 8u) && tree::level_of(waiting[last - 1u - taken]) == level {
            taken += 1u;
        }
        let mine = thread / 8u;
        let number = waiting[last - 1u - min(mine, taken - 1u)] & tree::NUMBER;
        workgroupBarrier();
        if thread == 0u {
            atomicStore(&depth, last - taken);
        }
        workgroupBarrier();
        if mine < taken {
            let child = 8u * number + thread % 8u;
            if level == 0u {
                count_crossing(mesh, child, p);
            } else if meets(mesh, end, tree::node(level - 1u, child), p) {
                waiting[atomicAdd(&depth, 1u)] = tree::node(level - 1u, child);
            }
        }
        workgroupBarrier();
    }
    unfinished = unfinished || atomicLoad(&depth) != 0u;
    workgroupBarrier();
    let winding = atomicLoad(&inside);
    let parity = atomicLoad(&crossings) % 2u;
    // All have read them before they are cleared for the next component.
    workgroupBarrier();
    if (mesh.flags & t::ORIENTATION_MASK) == t::MIXED {
        return parity == 1u;
    }
    return winding != 0;
}

// Whether there is such a node, and the ray meets its box.
fn meets(mesh: t::Mesh, end: u32, node: u32, p: vec3<f32>) -> bool {
    let at = tree::box_of(end, node);
    if at == 0u {
        return false;
    }
    let offset = vector(at) - p;
    // Rounding moves a box by less than a millionth of the mesh.
    let half = vector(at + 3u) + 1.0e-5 * mesh.radius;
    return abs(offset.x) <= half.x && abs(offset.y) <= half.y && offset.z >= -half.z;
}

fn count_crossing(mesh: t::Mesh, number: u32, p: vec3<f32>) {
    if number >= mesh.triangle_count {
        return;
    }
    let at = mesh.corners + 9u * number;
    // Divided by the mesh's size: products of five lengths occur.
    let side = crossing(
        (vector(at) - p) / mesh.radius, (vector(at + 3u) - p) / mesh.radius, (vector(at + 6u) - p) / mesh.radius
    );
    if side != 0 {
        atomicAdd(&inside, side);
        atomicAdd(&crossings, 1u);
    }
}

// Whether the ray from the origin along +z crosses the triangle, and from which side. A ray through an edge or corner
// is moved aside by an infinitely small step, the same for all triangles.
fn crossing(p: vec3<f32>, q: vec3<f32>, r: vec3<f32>) -> i32 {
    let pq = left(p.xy, q.xy);
    if left(q.xy, r.xy) != pq || left(r.xy, p.xy) != pq {
        return 0;
    }
    let normal = cross(q - p, r - p);
    if dot(normal, p) * normal.z > 0.0 {
        return select(-1, 1, pq);
    }
    return 0;
}

// Whether the origin lies to the left of the way from p to q. Both triangles at an edge must agree, so it is always
// computed in the same direction, however the products are rounded.
fn left(p: vec2<f32>, q: vec2<f32>) -> bool {
    let swapped = q.x < p.x || (q.x == p.x && q.y < p.y);
    let u = select(p, q, swapped);
    let v = select(q, p, swapped);
    let side = u.x * v.y - u.y * v.x;
    // On the line: as if the origin lay a little aside.
    return (side >= 0.0) != swapped;
}
