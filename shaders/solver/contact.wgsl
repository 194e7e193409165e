#define_import_path faceoff::contact

// What a pair does in a pass: from the velocities of its bodies, an impulse for each. `src/solver/pairs.rs` explains it.
// Bound here, once, is what the kernels over pairs share.

#import faceoff::solver_math::{across, change}
#import faceoff::solver_types as s
#import faceoff::tensor::{apply_tensor, Tensor}
#import faceoff::types as t

@group(0) @binding(0) var<uniform> interval: s::Interval;
@group(0) @binding(2) var<storage, read> solver_counters: array<u32>;
@group(0) @binding(3) var<storage, read_write> solver_pairs: array<s::SolverPair>;
@group(0) @binding(4) var<storage, read> shapes: array<s::PointShape>;
@group(0) @binding(5) var<storage, read_write> points: array<s::PointState>;
@group(0) @binding(6) var<storage, read> masses: array<s::Mass>;
@group(0) @binding(7) var<storage, read> shifts: array<s::Shift>;
@group(0) @binding(8) var<storage, read> velocities: array<s::Velocity>;
// What each pair does to its first body and to its second.
@group(0) @binding(9) var<storage, read_write> end_impulses: array<t::Impulse>;

// A pair by itself: its bodies, each with this pair's share of its mass.
struct Local {
    mass_a: s::Mass,
    mass_b: s::Mass,
    a: s::Velocity,
    b: s::Velocity,
    // The impulse on the second body; the first has its opposite.
    linear: vec3<f32>,
    angular_a: vec3<f32>,
    angular_b: vec3<f32>,
}

// A direction in which a point pushes, and what a unit impulse along it does to the two bodies.
struct Row {
    direction: vec3<f32>,
    // Its moment about each centre of mass.
    moment_a: vec3<f32>,
    moment_b: vec3<f32>,
    // The angular velocity that the moment causes.
    turn_a: vec3<f32>,
    turn_b: vec3<f32>,
}

fn local_of(pair: s::SolverPair) -> Local {
    var local: Local;
    local.mass_a = masses[pair.a];
    local.mass_b = masses[pair.b];
    local.a = velocities[pair.a];
    local.b = velocities[pair.b];
    return local;
}

fn turn_of(mass: s::Mass, moment: vec3<f32>) -> vec3<f32> {
    return apply_tensor(Tensor(mass.inverse_inertia, mass.inverse_inertia_mixed), moment);
}

fn row(mass_a: s::Mass, mass_b: s::Mass, point: s::PointState, direction: vec3<f32>) -> Row {
    let moment_a = cross(point.lever_a, direction);
    let moment_b = cross(point.lever_b, direction);
    return Row(direction, moment_a, moment_b, turn_of(mass_a, moment_a), turn_of(mass_b, moment_b));
}

// Change of speed per unit impulse at both bodies.
fn give_along(mass_a: s::Mass, mass_b: s::Mass, r: Row) -> vec2<f32> {
    let d = r.direction;
    return vec2(
        dot(mass_a.inverse_mass * d, d) + dot(r.moment_a, r.turn_a),
        dot(mass_b.inverse_mass * d, d) + dot(r.moment_b, r.turn_b),
    );
}

// Where a point is now, and how the bodies give way there.
fn measured(pair: s::SolverPair, k: u32) -> s::PointState {
    var point = points[k];
    let shape = shapes[k];
    if (pair.flags & s::DEPENETRATING) != 0u {
        point.separation = shape.first_separation + dot(point.normal, shifts[pair.b].moved - shifts[pair.a].moved);
        point.lever_a = vec3(0.0);
        point.lever_b = vec3(0.0);
    } else {
        let turn_a = change(shifts[pair.a].turned, shape.round_a);
        let turn_b = change(shifts[pair.b].turned, shape.round_b);
        let shifted = (shifts[pair.b].moved - shifts[pair.a].moved) + turn_b - turn_a;
        // Round surfaces that have not touched yet pass each other as balls do: they push along the normal at the moment
        // of touching.
        if shape.turn > 0.0 && point.largest == 0.0 && point.impulse == 0.0 {
            let way = shape.normal + shape.turn * shifted;
            let square = dot(way, way);
            if square > 0.0 {
                point.normal = way / sqrt(square);
            }
        }
        point.separation = shape.first_separation + dot(point.normal, shifted);
        if shape.turn > 0.0 {
            // By how much the way between the centres of curvature is shorter along the new normal.
            let change_of_normal = point.normal - shape.normal;
            point.separation -= 0.5 * dot(change_of_normal, change_of_normal) / shape.turn;
        }
        // One place for both, or the two impulses would turn the pair.
        let offset = shape.offset + shifted;
        point.lever_a = shape.arm_a + turn_a + shape.along * offset;
        point.lever_b = shape.arm_b + turn_b - (1.0 - shape.along) * offset;
    }
    let mass_a = masses[pair.a];
    let mass_b = masses[pair.b];
    let side = across(point.normal);
    let normal = give_along(mass_a, mass_b, row(mass_a, mass_b, point, point.normal));
    let one = give_along(mass_a, mass_b, row(mass_a, mass_b, point, side));
    let other = give_along(mass_a, mass_b, row(mass_a, mass_b, point, cross(point.normal, side)));
    // One number for both tangents: with two, friction would not point against the sliding.
    let most = max(one, other);
    point.give = vec4(normal.x, most.x, normal.y, most.y);
    return point;
}

// The point's give along the normal and across it, with the bodies' shares.
fn shared_give(local: ptr<function, Local>, point: s::PointState) -> vec2<f32> {
    return (*local).mass_a.share * point.give.xy + (*local).mass_b.share * point.give.zw;
}

// How fast the bodies part along a row.
fn parting(local: ptr<function, Local>, r: Row) -> f32 {
    let a = (*local).a;
    let b = (*local).b;
    return dot(r.direction, b.linear - a.linear) + dot(r.moment_b, b.angular) - dot(r.moment_a, a.angular);
}

// Adds an impulse on the second body, and its opposite on the first, to what the pair hands out.
fn note(local: ptr<function, Local>, r: Row, impulse: f32) {
    (*local).linear += r.direction * impulse;
    (*local).angular_a -= r.moment_a * impulse;
    (*local).angular_b += r.moment_b * impulse;
}

// The same, and changes the velocities.
fn push(local: ptr<function, Local>, r: Row, impulse: f32) {
    note(local, r, impulse);
    let linear = r.direction * impulse;
    let share_a = (*local).mass_a.share;
    let share_b = (*local).mass_b.share;
    (*local).a.linear -= share_a * (*local).mass_a.inverse_mass * linear;
    (*local).a.angular -= r.turn_a * (share_a * impulse);
    (*local).b.linear += share_b * (*local).mass_b.inverse_mass * linear;
    (*local).b.angular += r.turn_b * (share_b * impulse);
}

// Leaves what the pair does to its ends.
fn hand_out(i: u32, local: ptr<function, Local>) {
    end_impulses[2u * i] = t::Impulse(-(*local).linear, 0.0, (*local).angular_a, 0.0);
    end_impulses[2u * i + 1u] = t::Impulse((*local).linear, 0.0, (*local).angular_b, 0.0);
}

fn hand_out_nothing(i: u32) {
    end_impulses[2u * i] = t::Impulse(vec3(0.0), 0.0, vec3(0.0), 0.0);
    end_impulses[2u * i + 1u] = t::Impulse(vec3(0.0), 0.0, vec3(0.0), 0.0);
}
