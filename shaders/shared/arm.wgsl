#define_import_path faceoff::arm

// How far from the axis of a body's rotation another body may touch it. The twin of `src/state/arm.rs`.

#import faceoff::arena::{meshes, support}
#import faceoff::constants::shared::SAFETY
#import faceoff::margins::{sway, sway_at}
#import faceoff::math::{conjugate, rotate, tangent}
#import faceoff::types as t

// The arm of `own` within this time from now, at velocities that forces may change. The twin of `arm_within` in
// `src/state/margins.rs`.
fn arm_within(step: t::Step, own: t::Body, other: t::Body, time: f32) -> f32 {
    let speed = relative_speed(own, other) + sway(step, other, time) + sway_at(step, own, time, 0.0);
    return arm(own, other, SAFETY * speed * time);
}

// The speed of the bodies' centres relative to each other, m/s.
fn relative_speed(a: t::Body, b: t::Body) -> f32 {
    let v = velocity(b) - velocity(a);
    return sqrt(dot(v, v));
}

fn velocity(body: t::Body) -> vec3<f32> {
    return select(body.linear_velocity, vec3(0.0), (body.flags & t::KIND_MASK) == t::STATIC);
}

// Upper bound of the distance from the axis of rotation of collider `own`, through its centre of mass, at which `other`
// may touch it, metres; no more than its bounding radius. `motion` bounds how far points of `other` move relative to
// the centre of mass of `own`.
fn arm(own: t::Body, other: t::Body, motion: f32) -> f32 {
    let w = own.angular_velocity;
    let turn = sqrt(dot(w, w));
    if !(turn > 0.0) {
        return own.radius;
    }
    let axis = w / turn;
    let u = tangent(axis);
    let v = cross(axis, u);

    // The difference of two positions is rounded once, however far they are from the origin.
    let offset_own = rotate(own.rotation, own.scale * meshes[own.mesh].center);
    let offset_other = rotate(other.rotation, other.scale * meshes[other.mesh].center);
    let center = (other.position - own.position) + (offset_other - offset_own);
    let most = own.radius - motion;
    let heights = meshes[other.mesh].heights;
    let back = conjugate(other.rotation);
    // The side towards the centre of the other is probably the farthest: beyond the radius nothing else matters.
    let first = octant(dot(center, u), dot(center, v));
    var one = height(heights, other, back, center, side(u, v, first));
    var square = 0.0;
    for (var k = first + 1u; k <= first + 8u; k += 1u) {
        let next = height(heights, other, back, center, side(u, v, k));
        let corner = 2.0 * (one * one + next * next - 1.41421356 * one * next);
        if !(sqrt(corner) < most) {
            return own.radius;
        }
        square = max(square, corner);
        one = next;
    }
    return sqrt(square) + motion;
}

// Number of the eighth of a turn, from the x axis to the y axis, in which a vector points.
fn octant(x: f32, y: f32) -> u32 {
    let flat = u32(abs(x) < abs(y));
    if y < 0.0 {
        return select(7u - flat, 4u + flat, x < 0.0);
    }
    return select(flat, 3u - flat, x < 0.0);
}

// The direction at `k` eighths of a turn from u to v.
fn side(u: vec3<f32>, v: vec3<f32>, k: u32) -> vec3<f32> {
    let quarter = (k & 2u) != 0u;
    let even = select(u, v, quarter);
    let odd = select(u + v, v - u, quarter) * 0.70710678;
    let direction = select(even, odd, (k & 1u) != 0u);
    return select(direction, -direction, (k & 4u) != 0u);
}

// Upper bound of the height of a body along a direction.
fn height(heights: u32, body: t::Body, back: vec4<f32>, center: vec3<f32>, direction: vec3<f32>) -> f32 {
    let local = body.scale * rotate(back, direction);
    return dot(center, direction) + dot(local, support(heights, local)) + body.rounding;
}
