#define_import_path faceoff::islands

// Sleep: islands of bodies at rest, by union-find over touching pairs. The twin of `src/sleep/cpu.rs`. All kernels run
// twice in a collision substep: before it they wake bodies, after it they put them to sleep.

#import faceoff::constants::sleep::{OVERLAP, TOUCH}
#import faceoff::solver_math::{finite, finite_vector}
#import faceoff::solver_types as s
#import faceoff::types as t
#import faceoff::union_find::{islands, root_of}

@group(0) @binding(0) var<uniform> collision_substep: s::CollisionSubstep;
// x: `WAKE` or `FALL_ASLEEP`.
@group(0) @binding(1) var<uniform> constants: vec4<u32>;
@group(0) @binding(2) var<storage, read> solver_counters: array<u32>;
@group(0) @binding(3) var<storage, read> contact_pairs: array<t::ContactPair>;
@group(0) @binding(4) var<storage, read> contact_points: array<t::ContactPoint>;
@group(0) @binding(5) var<storage, read> solver_bodies: array<s::SolverBody>;
@group(0) @binding(6) var<storage, read_write> motion_states: array<s::MotionState>;
@group(0) @binding(7) var<storage, read> forces: array<s::BodyForces>;
@group(0) @binding(9) var<storage, read> body_paces: array<u32>;

fn disturb(body: u32) {
    atomicStore(&islands[root_of(body)].disturbed, 1u);
}

// Whether impulses change its velocity.
fn has_mass(body: s::SolverBody) -> bool {
    return (body.flags & t::KIND_MASK) == t::DYNAMIC
        && body.inverse_mass > 0.0
        && finite(body.inverse_mass)
        && finite_vector(body.inverse_inertia)
        && finite_vector(body.inverse_inertia_off_diagonal);
}

// Upper bound of the speed of any point of the body, m/s.
fn speed_of(i: u32) -> f32 {
    let v = motion_states[i].linear_velocity;
    let w = motion_states[i].angular_velocity;
    return sqrt(dot(v, v)) + sqrt(dot(w, w)) * solver_bodies[i].extent;
}

// Whether the pair names solid colliders of two bodies and its points are in the list.
fn is_pair(pair: t::ContactPair) -> bool {
    let points = solver_counters[s::POINTS];
    if pair.a >= collision_substep.bodies || pair.b >= collision_substep.bodies {
        return false;
    }
    return solver_bodies[pair.a].body != solver_bodies[pair.b].body
        && ((solver_bodies[pair.a].flags | solver_bodies[pair.b].flags) & t::SENSOR) == 0u
        && pair.first_point <= points
        && pair.point_count <= points - pair.first_point;
}

// Bodies touch up to this separation.
fn touch_distance(pair: t::ContactPair) -> f32 {
    return TOUCH * rest_offset(pair);
}

// The numbers of the bodies.
fn bodies_of(pair: t::ContactPair) -> vec2<u32> {
    return vec2(solver_bodies[pair.a].body, solver_bodies[pair.b].body);
}

// The separation that a pair keeps at rest.
fn rest_offset(pair: t::ContactPair) -> f32 {
    return collision_substep.rest_offset * 2.0 * min(solver_bodies[pair.a].radius, solver_bodies[pair.b].radius);
}

// Whether some point is deeper than resting contacts get.
fn overlaps(pair: t::ContactPair) -> bool {
    let limit = -OVERLAP * rest_offset(pair);
    for (var k = pair.first_point; k < pair.first_point + pair.point_count; k += 1u) {
        if contact_points[k].separation - contact_points[k].bulge < limit {
            return true;
        }
    }
    return false;
}

// Whether some point touches.
fn touches(pair: t::ContactPair) -> bool {
    let near = touch_distance(pair);
    for (var k = pair.first_point; k < pair.first_point + pair.point_count; k += 1u) {
        if contact_points[k].separation - contact_points[k].bulge <= near {
            return true;
        }
    }
    return false;
}
