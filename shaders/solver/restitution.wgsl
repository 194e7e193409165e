#define_import_path faceoff::restitution

// Restitution: impacts reverse the normal velocity (Newton's law of restitution). The twin of
// `src/solver/restitution.rs`.

#import faceoff::contact as c
#import faceoff::contact::{collision_substep, point_states}
#import faceoff::solver_types as s

// Marks the points of a pair that have an impact in this substep, and returns the speed of the fastest one that needs
// restitution, m/s; 0 if there is none.
fn find_impacts(pair: s::SolverPair) -> f32 {
    if (pair.flags & s::ACTIVE) == 0u || (pair.flags & s::DEPENETRATING) != 0u || !(pair.restitution > 0.0) {
        return 0.0;
    }
    var pair_velocities = c::initial_velocities_of(pair.a, pair.b);
    var fastest = 0.0;
    for (var k = pair.first; k < pair.first + pair.count; k += 1u) {
        var flags = point_states[k].flags;
        if (flags & s::POINT_ACTIVE) == 0u {
            continue;
        }
        let velocity = c::velocity_along(&pair_velocities, point_states[k].normal_row);
        point_states[k].impact_velocity = velocity;
        let pushes = (flags & s::MAY_IMPACT) != 0u && point_states[k].normal_impulse > 0.0;
        let has_impact = pushes && velocity < -collision_substep.restitution_threshold;
        // With a point that separates, an impact elsewhere may reverse its velocity too. If its velocity only fell to
        // zero, the impulse would add energy.
        flags &= ~(s::HAS_IMPACT | s::REBOUNDS);
        flags |= select(0u, s::HAS_IMPACT, has_impact) | select(0u, s::REBOUNDS, has_impact || velocity > 0.0);
        point_states[k].flags = flags;
        if has_impact {
            fastest = max(fastest, -velocity);
        }
    }
    return fastest;
}

// Ends the impacts of a pair: the bodies separate, so the impulses must not be applied again.
fn end_impacts(pair: s::SolverPair) {
    if (pair.flags & s::ACTIVE) == 0u {
        return;
    }
    for (var k = pair.first; k < c::end_of_points(pair); k += 1u) {
        if (point_states[k].flags & s::HAS_IMPACT) == 0u {
            continue;
        }
        point_states[k].total_normal_impulse += point_states[k].normal_impulse;
        point_states[k].normal_impulse = 0.0;
        point_states[k].friction_impulse = vec2(0.0);
        point_states[k].flags |= s::BOUNCED;
    }
}
