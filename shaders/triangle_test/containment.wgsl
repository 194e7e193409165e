#define_import_path faceoff::containment

// Whether a point is inside a closed mesh. All 64 threads of a workgroup work on one point.

#import faceoff::agree::agree
#import faceoff::arena::vector
#import faceoff::tree
#import faceoff::types as t

var<workgroup> inside: atomic<i32>;
var<workgroup> crossings: atomic<u32>;
// Nodes still to be opened. At most 64 nodes of each level wait, because only nodes of the lowest waiting level are
// opened.
var<workgroup> waiting: array<u32, 512>;
var<workgroup> depth: atomic<u32>;
// The device aborted a loop.
var<private> unfinished: bool = false;

// By the winding number along the ray from p along +z or, if the winding is inconsistent, by the parity of crossings.
// The caps of a nearly closed mesh count too. `end` is the mesh's position in the pair. Eight nodes are opened at a
// time, one thread per child.
fn contains(mesh: t::Mesh, end: u32, p: vec3<f32>, thread: u32) -> bool {
    if thread == 0u {
        atomicStore(&inside, 0);
        atomicStore(&crossings, 0u);
        waiting[0] = tree::node(mesh.levels - 1u, 0u);
        atomicStore(&depth, 1u);
    }
    workgroupBarrier();
    loop {
        let last = agree(thread, atomicLoad(&depth));
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
        if thread == 0u {
            atomicStore(&depth, last - taken);
        }
        workgroupBarrier();
        if mine < taken {
            let child = 8u * number + thread % 8u;
            if level == 0u {
                if child < mesh.triangle_count {
                    count_crossing(mesh, mesh.corners + 9u * child, p);
                }
            } else if meets(mesh, end, tree::node(level - 1u, child), p) {
                waiting[atomicAdd(&depth, 1u)] = tree::node(level - 1u, child);
            }
        }
        workgroupBarrier();
    }
    unfinished = unfinished || atomicLoad(&depth) != 0u;
    for (var i = thread; i < mesh.cap_count; i += 64u) {
        count_crossing(mesh, mesh.caps + 9u * i, p);
    }
    workgroupBarrier();
    let is_odd = atomicLoad(&crossings) % 2u == 1u;
    let is_inside = select(atomicLoad(&inside) != 0, is_odd, (mesh.flags & t::ORIENTATION_MASK) == t::MIXED);
    // All threads have the result before the counters are cleared for the next component.
    return agree(thread, u32(is_inside)) == 1u;
}

// Whether the node exists and the ray meets its box.
fn meets(mesh: t::Mesh, end: u32, node: u32, p: vec3<f32>) -> bool {
    let at = tree::box_of(end, node);
    if at == 0u {
        return false;
    }
    let offset = vector(at) - p;
    // Rounding moves a box by less than a millionth of the mesh's size.
    let half = vector(at + 3u) + 1.0e-5 * mesh.radius;
    return abs(offset.x) <= half.x && abs(offset.y) <= half.y && offset.z >= -half.z;
}

// Counts the crossing of the triangle whose corners begin at this word.
fn count_crossing(mesh: t::Mesh, at: u32, p: vec3<f32>) {
    // In units of the mesh's size, because products of five lengths occur.
    let side = crossing(
        (vector(at) - p) / mesh.radius, (vector(at + 3u) - p) / mesh.radius, (vector(at + 6u) - p) / mesh.radius
    );
    if side != 0 {
        atomicAdd(&inside, side);
        atomicAdd(&crossings, 1u);
    }
}

// Whether the ray from the origin along +z crosses the triangle: 1 or -1 by the side, else 0. A ray through an edge or
// a corner counts as displaced by an infinitesimal offset, the same for all triangles.
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

// Whether the origin lies to the left of the line from p to q. It is always computed in the same direction, so that
// both triangles of an edge get the same result in spite of rounding.
fn left(p: vec2<f32>, q: vec2<f32>) -> bool {
    let swapped = q.x < p.x || (q.x == p.x && q.y < p.y);
    let u = select(p, q, swapped);
    let v = select(q, p, swapped);
    // Two products are compared and not subtracted: a compiler may fuse a product with a subtraction in one of this
    // function's copies and not in another. On the line, the origin counts as displaced to one side.
    return (u.x * v.y >= u.y * v.x) != swapped;
}
