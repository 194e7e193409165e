#define_import_path faceoff::points

// The points of a pair at the present poses of its bodies. The twin of `update_points` and `begin_substep` in
// `src/solver/solve.rs`.

#import faceoff::constants::solver::ACTIVATION_DISTANCE
#import faceoff::contact as c
#import faceoff::contact::{body_states, collision_substep, point_constants, point_states, solver_pairs}
#import faceoff::math::{rotation_by, tangent}
#import faceoff::solver_math::rotation_displacement
#import faceoff::solver_types as s

// The change of a body's pose `time` seconds after the start of the collision substep. A body that impulses do not move
// may belong to several islands, so none of them integrates its pose.
fn pose_change_of(body: u32, time: f32) -> s::PoseChange {
    let flags = body_states[body].mass.flags;
    if (flags & s::HAS_MASS) != 0u {
        return body_states[body].pose_change;
    }
    if (flags & s::MOVES) == 0u {
        return s::PoseChange(vec3(0.0), 0.0, vec4(0.0, 0.0, 0.0, 1.0));
    }
    let velocity = body_states[body].velocity;
    return s::PoseChange(velocity.linear * time, 0.0, rotation_by(velocity.angular * time));
}

// Updates separations, normals, anchors and effective masses. `time` is the time of the poses.
fn update_points(pair: s::SolverPair, time: f32) {
    let a = pose_change_of(pair.a, time);
    let b = pose_change_of(pair.b, time);
    let translation = b.translation - a.translation;
    let mass_a = body_states[pair.a].mass;
    let mass_b = body_states[pair.b].mass;
    for (var k = pair.first; k < c::end_of_points(pair); k += 1u) {
        if (point_states[k].flags & s::POINT_VALID) == 0u {
            continue;
        }
        let constants = point_constants[k];
        var normal = point_states[k].normal;
        var anchor_a = vec3(0.0);
        var anchor_b = vec3(0.0);
        if (pair.flags & s::DEPENETRATING) != 0u {
            point_states[k].separation = constants.initial_separation + dot(normal, translation);
        } else {
            let displacement_a = rotation_displacement(a.rotation, constants.curvature_center_a);
            let displacement_b = rotation_displacement(b.rotation, constants.curvature_center_b);
            let displacement = translation + displacement_b - displacement_a;
            // The normal of curved surfaces that have not touched yet rotates as for two balls that pass each other:
            // the impulse acts along the normal at the moment of contact.
            if constants.normal_rotation > 0.0 && (point_states[k].flags & s::TOUCHED) == 0u {
                let rotated = constants.initial_normal + constants.normal_rotation * displacement;
                let square = dot(rotated, rotated);
                if square > 0.0 {
                    normal = rotated / sqrt(square);
                    point_states[k].normal = normal;
                }
            }
            var separation = constants.initial_separation + dot(normal, displacement);
            if constants.normal_rotation > 0.0 {
                // The distance between the centres of curvature is shorter along the rotated normal.
                let change_of_normal = normal - constants.initial_normal;
                separation -= 0.5 * dot(change_of_normal, change_of_normal) / constants.normal_rotation;
            }
            point_states[k].separation = separation;
            // Both impulses act at one position. Otherwise they would exert a moment on the pair.
            let offset = constants.anchor_offset + displacement;
            anchor_a = constants.anchor_a + displacement_a + constants.contact_fraction * offset;
            anchor_b = constants.anchor_b + displacement_b - (1.0 - constants.contact_fraction) * offset;
        }
        set_rows(k, mass_a, mass_b, anchor_a, anchor_b);
    }
}

// Sets the rows of a point whose impulses act at these places, from each centre of mass.
fn set_rows(k: u32, mass_a: s::Mass, mass_b: s::Mass, anchor_a: vec3<f32>, anchor_b: vec3<f32>) {
    let normal = point_states[k].normal;
    let offset = point_states[k].friction_offset;
    let first_tangent = tangent(normal);
    // One row after the other: all three at once would take more registers than some cards have.
    point_states[k].normal_row = c::row(mass_a, mass_b, anchor_a, anchor_b, normal);
    let first = c::row(mass_a, mass_b, anchor_a + offset, anchor_b + offset, first_tangent);
    point_states[k].first_tangent_row = first;
    let second = c::row(mass_a, mass_b, anchor_a + offset, anchor_b + offset, cross(normal, first_tangent));
    point_states[k].second_tangent_row = second;
    // Both tangents use the same value. Otherwise friction would not point against the sliding direction.
    let along_tangent = max(first.inverse_effective_mass, second.inverse_effective_mass);
    point_states[k].first_tangent_row.inverse_effective_mass = along_tangent;
    point_states[k].second_tangent_row.inverse_effective_mass = along_tangent;
}

// Decides which of a pair's points are active in a substep of `h` seconds. They are up to date with the poses.
fn begin_substep(i: u32, h: f32) {
    let pair = solver_pairs[i];
    var any_active = false;
    var pair_velocities = c::velocities_of(pair.a, pair.b);
    let spin_a = pair_velocities.a.angular;
    let spin_b = pair_velocities.b.angular;
    for (var k = pair.first; k < c::end_of_points(pair); k += 1u) {
        var flags = point_states[k].flags;
        if (flags & s::POINT_VALID) == 0u {
            continue;
        }
        let drift_a = cross(spin_a, cross(spin_a, point_constants[k].anchor_a));
        let drift_b = cross(spin_b, cross(spin_b, point_constants[k].anchor_b));
        // In passes with bias velocity a point is at rest in the mean of the substep.
        let drift = 0.5 * h * (drift_b - drift_a);
        point_states[k].first_tangent_row.bias = dot(drift, point_states[k].first_tangent_row.direction);
        point_states[k].second_tangent_row.bias = dot(drift, point_states[k].second_tangent_row.direction);
        // All points are judged by the velocities before the warm start.
        let normal_velocity = c::velocity_along(&pair_velocities, point_states[k].normal_row);
        let impulse = point_states[k].normal_impulse;
        point_states[k].total_normal_impulse += impulse;
        flags &= ~(s::MAY_IMPACT | s::HAS_IMPACT | s::REBOUNDS | s::POINT_ACTIVE);
        flags |= select(s::TOUCHED, s::MAY_IMPACT, impulse == 0.0);
        let next_separation = point_states[k].separation + normal_velocity * h;
        if impulse > 0.0 || next_separation < ACTIVATION_DISTANCE * pair.rest_offset {
            flags |= s::POINT_ACTIVE;
            any_active = true;
        } else {
            point_states[k].friction_impulse = vec2(0.0);
        }
        point_states[k].flags = flags;
    }
    solver_pairs[i].flags = (pair.flags & ~s::ACTIVE) | select(0u, s::ACTIVE, any_active);
}
