// TriangleTest: the vertices of each body that lie inside half-spaces. One workgroup per body.
#import faceoff::agree::agree
#import faceoff::arena::{meshes, words, vector}
#import faceoff::dispatch::group_index
#import faceoff::math::{conjugate, layers_interact, rotate}
#import faceoff::types as t

@group(0) @binding(2) var<uniform> step: t::Step;
@group(0) @binding(3) var<storage, read_write> counters: array<atomic<u32>>;
@group(0) @binding(4) var<storage, read> bodies: array<t::Body>;
@group(0) @binding(5) var<storage, read> planes: array<t::Plane>;
@group(0) @binding(6) var<storage, read_write> plane_contacts: array<t::PlaneContact>;
@group(0) @binding(7) var<storage, read_write> body_contacts: array<t::BodyContacts>;

var<workgroup> base: u32;
// Sum of points weighted by depth, with the sum of depths; the largest depth.
var<workgroup> sums: array<vec4<f32>, 64>;
var<workgroup> deepest: array<f32, 64>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let index = group_index(group);
    if index >= step.bodies || agree(thread, atomicLoad(&counters[t::SKIPPED])) != 0u {
        return;
    }
    let body = bodies[index];
    if (body.flags & t::KIND_MASK) == t::STATIC || !(body.radius > 0.0) {
        return;
    }
    let mesh = meshes[body.mesh];
    let center = body.position + rotate(body.rotation, body.scale * mesh.center);
    var near = 0u;
    for (var k = 0u; k < step.planes; k += 1u) {
        near += u32(meets(body, planes[k]) && height(planes[k], center) < body.radius);
    }
    if near == 0u {
        return;
    }
    if thread == 0u {
        base = atomicAdd(&counters[t::PLANE_CONTACTS], near);
        body_contacts[index].first_plane = base;
        body_contacts[index].planes = near;
    }
    var at = workgroupUniformLoad(&base);
    if at + near > step.plane_contact_capacity {
        return;
    }
    for (var k = 0u; k < step.planes; k += 1u) {
        let plane = planes[k];
        let above = height(plane, center);
        if !(meets(body, plane) && above < body.radius) {
            continue;
        }
        // Height of the rounded surface, if the core's vertices are at the centre.
        let lowered = above - body.rounding;
        let direction = body.scale * rotate(conjugate(body.rotation), plane.normal);
        // Vertices inside, weighted by depth.
        var sum = vec4(0.0);
        var max_depth = 0.0;
        for (var n = thread; n < mesh.vertex_count; n += 64u) {
            let p = vector(mesh.vertices + 3u * n);
            let depth = -(dot(p, direction) + lowered);
            if depth > 0.0 {
                sum += vec4(p * depth, depth);
                max_depth = max(max_depth, depth);
            }
        }
        sums[thread] = sum;
        deepest[thread] = max_depth;
        workgroupBarrier();
        for (var half = 32u; half > 0u; half /= 2u) {
            if thread < half {
                sums[thread] += sums[thread + half];
                deepest[thread] = max(deepest[thread], deepest[thread + half]);
            }
            workgroupBarrier();
        }
        if thread == 0u {
            var anchor = vec3(0.0);
            if deepest[0] > 0.0 {
                anchor = rotate(body.rotation, body.scale * (sums[0].xyz / sums[0].w)) - plane.normal * body.rounding;
            }
            plane_contacts[at] = t::PlaneContact(anchor, deepest[0], center + anchor, index, k, 0u, 0u, 0u);
        }
        at += 1u;
        workgroupBarrier();
    }
}

// A sensor detects all that move, a solid half-space dynamic bodies.
fn meets(body: t::Body, plane: t::Plane) -> bool {
    if plane.sensor == 0u && (body.flags & t::KIND_MASK) != t::DYNAMIC {
        return false;
    }
    return layers_interact(vec2(body.memberships, body.filters), vec2(plane.memberships, plane.filters));
}

fn height(plane: t::Plane, center: vec3<f32>) -> f32 {
    return dot(plane.normal, center) - plane.distance;
}
