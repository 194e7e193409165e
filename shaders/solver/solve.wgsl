#define_import_path faceoff::solve

// One pass over one pair: impulses that change the velocities of its two bodies. The twin of `src/solver/solve.rs`.

#import faceoff::constants::solver::MAX_STEP_ERROR
#import faceoff::contact as c
#import faceoff::contact::{collision_substep, point_states}
#import faceoff::friction::friction_impulse
#import faceoff::solver_types as s

// What a pass is for: overlapping bodies get a bias velocity that pushes them apart; the velocity that it added is
// removed; points with an impact separate as Newton's law of restitution tells.
const BIAS: u32 = 0u;
const RELAX: u32 = 1u;
const RESTITUTION: u32 = 2u;

// Parameters of a pass, the same for all pairs of an island.
struct Pass {
    // Length of the substep, seconds.
    h: f32,
    // Bias velocity per metre of overlap, 1/s.
    bias_rate: f32,
    // The softness of the contact spring.
    mass_scale: f32,
    impulse_scale: f32,
    purpose: u32,
    // m/s.
    convergence_speed: f32,
}

// How far a pass changed the impulses of the pairs of a thread.
struct Residual {
    // The largest change of a normal velocity, over that below which its pair has converged.
    velocity: f32,
    // The sum of the squared changes of impulses, each over its effective mass, joules.
    energy: f32,
}

// What passes need to know of a pair.
struct PassPair {
    // Numbers of the bodies.
    a: u32,
    b: u32,
    // Where the velocities of both bodies are in workgroup memory; see `IslandPair`.
    places: u32,
    flags: u32,
    // The points that may be solved.
    first: u32,
    end: u32,
    friction: f32,
    // The change of a normal velocity below which the pair has converged, m/s.
    convergence_speed: f32,
}

fn pass_pair(pair: s::SolverPair, places: u32, parameters: Pass) -> PassPair {
    // A light body passes on only a small part of what a heavy one needs, so it must be more exact.
    let convergence_speed = min(parameters.convergence_speed, MAX_STEP_ERROR * pair.diameter / parameters.h) / pair.mass_ratio;
    return PassPair(
        pair.a, pair.b, places, pair.flags, pair.first, c::end_of_points(pair), pair.friction, convergence_speed
    );
}

// The bias velocity of a point, and the softness of its constraint.
struct Bias {
    speed: f32,
    mass_scale: f32,
    impulse_scale: f32,
}

fn bias_of(pair: s::SolverPair, k: u32, parameters: Pass) -> Bias {
    let separation = point_states[k].separation;
    if parameters.purpose == RESTITUTION && (point_states[k].flags & s::REBOUNDS) != 0u {
        return Bias(pair.restitution * point_states[k].impact_velocity, 1.0, 0.0);
    }
    let spring = spring_of(parameters, pair.softness);
    var rigid = Bias(0.0, 1.0, 0.0);
    if (pair.flags & s::DRIVEN) != 0u && parameters.purpose != RESTITUTION {
        // Where a kinematic body moves, no constraint is rigid. A body that it squeezes against another one has no
        // velocity that satisfies both contacts, and rigid constraints would push from both sides, with impulses that
        // grow in each pass.
        rigid = spring_of(parameters, 1.0);
    }
    if separation > 0.0 {
        // Speculative contact: the gap may close by the end of the substep, and no sooner.
        rigid.speed = separation / parameters.h;
        return rigid;
    }
    if parameters.purpose != BIAS {
        return rigid;
    }
    let spring_speed = parameters.bias_rate * separation;
    if (pair.flags & s::DEPENETRATING) != 0u {
        // Near the surface the bias falls from the maximum to the bias of an ordinary contact spring.
        rigid.speed = max(spring_speed, -collision_substep.deep_depenetration_speed);
        return rigid;
    }
    let fastest = -collision_substep.max_depenetration_speed;
    if spring_speed < fastest {
        // The force goes on growing with the depth. So a body that is squeezed between two others overlaps both
        // equally.
        let fraction = fastest / spring_speed;
        var deep = spring_of(parameters, (1.0 + (pair.softness - 1.0) * fraction) * fraction);
        deep.speed = fastest;
        return deep;
    }
    return Bias(spring_speed, spring.mass_scale, spring.impulse_scale);
}

// The contact spring that is softer by the factor `softness`.
fn spring_of(parameters: Pass, softness: f32) -> Bias {
    if softness == 1.0 {
        return Bias(0.0, parameters.mass_scale, parameters.impulse_scale);
    }
    let softer = softness * parameters.impulse_scale;
    let sum = parameters.mass_scale + softer;
    return Bias(0.0, parameters.mass_scale / sum, softer / sum);
}

// Sets what passes over a pair aim at, after separations and effective masses have changed. `begin_substep` has set the
// bias of tangents in passes with bias velocity.
fn aim(pair: s::SolverPair, parameters: Pass) {
    if (pair.flags & s::ACTIVE) == 0u {
        return;
    }
    for (var k = pair.first; k < c::end_of_points(pair); k += 1u) {
        let is_active = (point_states[k].flags & s::POINT_ACTIVE) != 0u;
        let bias = bias_of(pair, k, parameters);
        let along_normal = point_states[k].normal_row.inverse_effective_mass;
        let along_tangent = point_states[k].first_tangent_row.inverse_effective_mass;
        var response = 0.0;
        if is_active && along_normal > 0.0 {
            response = bias.mass_scale / along_normal;
        }
        var friction_response = 0.0;
        if is_active && along_tangent > 0.0 {
            friction_response = 1.0 / along_tangent;
        }
        point_states[k].normal_row.response = response;
        point_states[k].normal_row.bias = bias.speed;
        point_states[k].normal_row.impulse_scale = bias.impulse_scale;
        point_states[k].first_tangent_row.response = friction_response;
        if parameters.purpose != BIAS {
            point_states[k].first_tangent_row.bias = 0.0;
            point_states[k].second_tangent_row.bias = 0.0;
        }
        point_states[k].change = vec3(0.0);
    }
}

// One pass over a pair's active points: first the normals, then friction. Adds to the residual.
fn solve(pair: PassPair, pair_velocities: ptr<function, c::PairVelocities>, residual: ptr<function, Residual>) {
    var largest_change = 0.0;
    for (var k = pair.first; k < pair.end; k += 1u) {
        let row = point_states[k].normal_row;
        if row.response == 0.0 {
            continue;
        }
        let before = point_states[k].normal_impulse;
        let velocity_error = c::velocity_along(pair_velocities, row) + row.bias;
        let impulse = max(before - row.response * velocity_error - row.impulse_scale * before, 0.0);
        let change = impulse - before;
        c::apply_impulse(pair_velocities, row, change);
        let velocity_change = change * row.inverse_effective_mass;
        largest_change = max(largest_change, abs(velocity_change));
        (*residual).energy += change * velocity_change;
        point_states[k].change.x = change;
        point_states[k].normal_impulse = impulse;
        if impulse > 0.0 {
            point_states[k].flags |= s::TOUCHED;
        }
    }
    if (pair.flags & s::DEPENETRATING) == 0u {
        for (var k = pair.first; k < pair.end; k += 1u) {
            solve_friction(pair, k, pair_velocities, residual);
        }
    }
    (*residual).velocity = max((*residual).velocity, largest_change / pair.convergence_speed);
}

// Solves the tangents of a point, after its normal.
fn solve_friction(
    pair: PassPair,
    k: u32,
    pair_velocities: ptr<function, c::PairVelocities>,
    residual: ptr<function, Residual>,
) {
    let limit = pair.friction * point_states[k].normal_impulse;
    let before = point_states[k].friction_impulse;
    if limit == 0.0 && all(before == vec2(0.0)) {
        point_states[k].change.y = 0.0;
        point_states[k].change.z = 0.0;
        return;
    }
    let first = point_states[k].first_tangent_row;
    if first.response == 0.0 {
        return;
    }
    let second = point_states[k].second_tangent_row;
    let impulse = friction_impulse(pair_velocities, before, first, second, limit);
    let change = impulse - before;
    c::apply_impulse(pair_velocities, first, change.x);
    c::apply_impulse(pair_velocities, second, change.y);
    (*residual).energy += dot(change, change) * first.inverse_effective_mass;
    point_states[k].change.y = change.x;
    point_states[k].change.z = change.y;
    point_states[k].friction_impulse = impulse;
}

// Moves the impulses on along the search direction. `keep` is the part of the last direction that the new one keeps.
fn extrapolate(pair: PassPair, pair_velocities: ptr<function, c::PairVelocities>, keep: f32) {
    for (var k = pair.first; k < pair.end; k += 1u) {
        if (point_states[k].flags & s::POINT_ACTIVE) == 0u {
            continue;
        }
        let step = keep * point_states[k].search;
        let before = point_states[k].normal_impulse;
        let impulse = max(before + step.x, 0.0);
        c::apply_impulse(pair_velocities, point_states[k].normal_row, impulse - before);
        if any(step.yz != vec2(0.0)) {
            c::apply_impulse(pair_velocities, point_states[k].first_tangent_row, step.y);
            c::apply_impulse(pair_velocities, point_states[k].second_tangent_row, step.z);
            point_states[k].friction_impulse += step.yz;
        }
        point_states[k].normal_impulse = impulse;
        point_states[k].search = step + point_states[k].change;
    }
}

// The search direction starts as the last change.
fn start_search(pair: PassPair) {
    for (var k = pair.first; k < pair.end; k += 1u) {
        point_states[k].search = point_states[k].change;
    }
}
