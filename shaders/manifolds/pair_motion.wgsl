#define_import_path faceoff::pair_motion

// The free motion of a pair's colliders as far as the contact solver looks ahead: to the end of the collision substep
// and one solver substep beyond. The twin of `src/state/travel.rs`.

#import faceoff::dispatch::divide_up
#import faceoff::math::{conjugate, rotate, rotation_by}
#import faceoff::sides
#import faceoff::types as t

@group(0) @binding(8) var<storage, read> bodies: array<t::Body>;
@group(0) @binding(9) var<uniform> step: t::Step;

// In the axes and the unit of the pair.
struct PairMotion {
    // Displacement of the second centre of mass relative to the first.
    travel: vec3<f32>,
    // What gravity and external forces add to it, unless something supports the bodies.
    fall: vec3<f32>,
    // Rotation vectors, radians.
    turn_a: vec3<f32>,
    turn_b: vec3<f32>,
    // The gap that contacts keep.
    rest_offset: f32,
}

// How long a body moves, and the factor of its acceleration in its displacement; zero if it does not move.
fn times_of(body: t::Body) -> vec2<f32> {
    if (body.flags & t::KIND_MASK) == t::STATIC || body.travel_time <= 0.0 {
        return vec2(0.0);
    }
    let count = u32(round(step.dt / body.travel_time));
    let substeps = max(divide_up(step.substeps, max(count, 1u)), 1u);
    let h = body.travel_time / f32(substeps);
    let steps = f32(substeps + 1u);
    // Each substep changes the velocity before it moves the body.
    return vec2(steps * h, 0.5 * h * h * steps * (steps + 1.0));
}

fn motion_of(setup: t::PairSetup) -> PairMotion {
    let a = bodies[setup.a];
    let b = bodies[setup.b];
    let times_a = times_of(a);
    let times_b = times_of(b);
    let back = conjugate(setup.rotation);
    var motion: PairMotion;
    motion.travel = rotate(back, b.linear_velocity * times_b.x - a.linear_velocity * times_a.x) * setup.unit;
    motion.fall = rotate(back, b.acceleration * times_b.y - a.acceleration * times_a.y) * setup.unit;
    motion.turn_a = rotate(back, a.angular_velocity * times_a.x);
    motion.turn_b = rotate(back, b.angular_velocity * times_b.x);
    motion.rest_offset = step.rest_offset * 2.0 * min(a.radius, b.radius) * setup.unit;
    return motion;
}

// Displacement of the second body's material at a point relative to the first body's.
fn way_at(a: sides::Side, b: sides::Side, motion: PairMotion, p: vec3<f32>) -> vec3<f32> {
    return motion.travel + cross(motion.turn_b, p - b.center) - cross(motion.turn_a, p - a.center);
}

// The rotations of both bodies after this part of the motion.
struct Turned {
    a: vec4<f32>,
    b: vec4<f32>,
}

fn turned(motion: PairMotion, time: f32) -> Turned {
    return Turned(rotation_by(motion.turn_a * time), rotation_by(motion.turn_b * time));
}
