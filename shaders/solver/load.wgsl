#define_import_path faceoff::load

// How many substeps an island needs so that its contact springs hold their loads. The twin of `src/solver/load.rs`.

#import faceoff::constants::solver::{MAX_COMPRESSION, MAX_FACTOR, MAX_STRESS, POINT_BUDGET, SQUEEZED}
#import faceoff::contact::{body_states, collision_substep, point_states}
#import faceoff::math::max_component
#import faceoff::solver_types as s

// How far the springs of a pair give way under their loads, over how far they may. The points have the impulses of the
// last collision substep, which count up to a multiple of what the pair transmits.
fn compression(pair: s::SolverPair, pace: s::Pace) -> f32 {
    if (pair.flags & s::DEPENETRATING) != 0u || !(pair.diameter > 0.0) {
        return 0.0;
    }
    let most_impulse = MAX_STRESS * length(transmitted_impulse(pair));
    let inverse_mass_a = max_component(body_states[pair.a].mass.inverse_mass);
    let inverse_mass_b = max_component(body_states[pair.b].mass.inverse_mass);
    let is_held = inverse_mass_a == 0.0 || inverse_mass_b == 0.0;
    var most = 0.0;
    for (var k = pair.first; k < pair.first + pair.count; k += 1u) {
        if (point_states[k].flags & s::POINT_VALID) == 0u {
            continue;
        }
        if is_held && point_states[k].separation < -SQUEEZED * pair.diameter {
            return 0.0;
        }
        // Acceleration of the bodies by the load.
        var load = 0.0;
        let impulse = min(point_states[k].normal_impulse, most_impulse);
        if impulse > 0.0 {
            load = impulse * point_states[k].normal_row.inverse_effective_mass / pace.h;
        } else if pair.saved_pair == s::NOT_SAVED && point_states[k].separation <= pair.rest_offset {
            // The load is not known yet. The upper body rests on the lower one with at least its own weight.
            let down = -dot(point_states[k].normal, collision_substep.gravity);
            let upper = select(inverse_mass_a, inverse_mass_b, down > 0.0);
            if upper > 0.0 {
                load = abs(down) / upper * (inverse_mass_a + inverse_mass_b);
            }
        }
        most = max(most, load * pair.softness / (pace.stiffness * MAX_COMPRESSION * pair.diameter));
    }
    return most;
}

// The sum of the impulses of a pair.
fn transmitted_impulse(pair: s::SolverPair) -> vec3<f32> {
    var sum = vec3(0.0);
    for (var k = pair.first; k < pair.first + pair.count; k += 1u) {
        if (point_states[k].flags & s::POINT_VALID) != 0u {
            let friction = point_states[k].friction_impulse;
            sum += point_states[k].normal_row.direction * point_states[k].normal_impulse
                + point_states[k].first_tangent_row.direction * friction.x
                + point_states[k].second_tangent_row.direction * friction.y;
        }
    }
    return sum;
}

// Factor on the number of substeps of an island with this compression and number of points.
fn substep_factor(compression: f32, points: u32) -> u32 {
    let most = clamp(POINT_BUDGET / f32(max(points, 1u)), 1.0, MAX_FACTOR);
    return u32(ceil(clamp(sqrt(compression), 1.0, most)));
}
