#define_import_path faceoff::arm

// How far from the axis of a body's rotation another body may touch it. The twin of `src/state/arm.rs`.

#import faceoff::arena::{meshes, support}
#import faceoff::math::{conjugate, rotate}
#import faceoff::types as t

// Upper bound of the distance from the axis of rotation of collider `own`, through its centre of mass, at which `other` may
// touch it, metres; no more than its bounding radius. `motion` bounds how far points of `other` move relative to that centre.
fn arm(own: t::Body, other: t::Body, motion: f32) -> f32 {
    let w = own.angular_velocity;
    let turn = sqrt(dot(w, w));
    if !(turn > 0.0) {
        return own.radius;
    }
    // Two directions across the axis (Duff et al. 2017, Building an Orthonormal Basis, Revisited).
    let axis = w / turn;
    let sign = select(1.0, -1.0, axis.z < 0.0);
    let a = -1.0 / (sign + axis.z);
    let b = axis.x * axis.y * a;
    let u = vec3(1.0 + sign * axis.x * axis.x * a, sign * b, -sign * axis.x);
    let v = vec3(b, sign + axis.y * axis.y * a, -axis.y);

    // The difference of two positions is rounded once, however far they are from the origin.
    let offset_own = rotate(own.rotation, own.scale * meshes[own.mesh].center);
    let offset_other = rotate(other.rotation, other.scale * meshes[other.mesh].center);
    let center = (other.position - own.position) + (offset_other - offset_own);
    let across = vec2(dot(center, u), dot(center, v));
    if sqrt(dot(across, across)) + motion >= own.radius {
        return own.radius;
    }
    let heights = meshes[other.mesh].heights;
    let back = conjugate(other.rotation);
    let p = (u + v) * 0.70710678;
    let q = (v - u) * 0.70710678;
    var square = 0.0;
    let first = height(heights, other, back, center, u);
    var one = first;
    for (var k = 1u; k <= 8u; k += 1u) {
        let even = select(u, v, (k & 2u) != 0u);
        let odd = select(p, q, (k & 2u) != 0u);
        let direction = select(even, odd, (k & 1u) != 0u);
        var next = first;
        if k < 8u {
            next = height(heights, other, back, center, select(direction, -direction, (k & 4u) != 0u));
        }
        square = max(square, 2.0 * (one * one + next * next - 1.41421356 * one * next));
        one = next;
    }
    return min(own.radius, sqrt(square) + motion);
}

// Upper bound of the height of a body along a direction.
fn height(heights: u32, body: t::Body, back: vec4<f32>, center: vec3<f32>, direction: vec3<f32>) -> f32 {
    let local = body.scale * rotate(back, direction);
    return dot(center, direction) + dot(local, support(heights, local));
}
