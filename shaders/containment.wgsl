#define_import_path faceoff::containment

// Whether a closed mesh has a point inside, asked by all 64 threads of a workgroup together.

#import faceoff::arena::vector
#import faceoff::types as t

var<workgroup> inside: atomic<i32>;
var<workgroup> crossings: atomic<u32>;
// Whether the device left a loop before its end.
var<private> unfinished: bool = false;

// By the winding number along the ray from p along +z; by its parity if neighbouring faces disagree about the outside.
fn contains(mesh: t::Mesh, p: vec3<f32>, thread: u32) -> bool {
    if thread == 0u {
        atomicStore(&inside, 0);
        atomicStore(&crossings, 0u);
    }
    workgroupBarrier();
    var n = thread;
    for (; n < mesh.triangle_count; n += 64u) {
        let at = mesh.triangles + 9u * n;
        // Divided by the mesh's size: products of five lengths occur.
        let side = crossing(
            (vector(at) - p) / mesh.radius, (vector(at + 3u) - p) / mesh.radius, (vector(at + 6u) - p) / mesh.radius
        );
        if side != 0 {
            atomicAdd(&inside, side);
            atomicAdd(&crossings, 1u);
        }
    }
    unfinished = unfinished || n < mesh.triangle_count;
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
