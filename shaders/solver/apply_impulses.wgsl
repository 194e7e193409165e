// Solver: applies to each body the sum of the impulses of its sides, in the order of pairs. Then integrates its pose or
// velocity, if that is next. One thread per body.
#import faceoff::dispatch::group_index
#import faceoff::motion as m
#import faceoff::solver_types as s
#import faceoff::types as t

@group(0) @binding(0) var<uniform> collision_substep: s::CollisionSubstep;
// x: split the mass of each body among its active pairs. y: what follows, by the bits `THEN_...`.
@group(0) @binding(1) var<uniform> constants: vec4<u32>;
@group(0) @binding(2) var<storage, read> body_constants: array<s::BodyConstants>;
@group(0) @binding(3) var<storage, read_write> velocities: array<s::Velocity>;
@group(0) @binding(4) var<storage, read_write> masses: array<s::Mass>;
@group(0) @binding(5) var<storage, read_write> pose_changes: array<s::PoseChange>;
@group(0) @binding(6) var<storage, read> body_adjacency: array<s::BodyAdjacency>;
@group(0) @binding(7) var<storage, read> sides: array<u32>;
@group(0) @binding(8) var<storage, read> side_impulses: array<t::Impulse>;
@group(0) @binding(9) var<storage, read> solver_pairs: array<s::SolverPair>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= collision_substep.bodies {
        return;
    }
    let adjacency = body_adjacency[i];
    let has_pairs = adjacency.first_side < adjacency.sides_end;
    if !has_pairs && constants.y == 0u {
        return;
    }
    let body = body_constants[i];
    var mass = masses[i];
    var velocity = velocities[i];
    if has_pairs {
        var linear = vec3(0.0);
        var angular = vec3(0.0);
        var active_pairs = 0u;
        for (var k = adjacency.first_side; k < adjacency.sides_end; k += 1u) {
            let side = sides[k];
            linear += side_impulses[side].linear;
            angular += side_impulses[side].angular;
            if constants.x != 0u {
                active_pairs += u32((solver_pairs[side / 2u].flags & s::ACTIVE) != 0u);
            }
        }
        velocity = m::with_impulse(velocity, mass, linear, angular);
        if constants.x != 0u {
            mass.split_count = f32(max(active_pairs, 1u));
        }
    }
    if (constants.y & s::THEN_INTEGRATE_POSES) != 0u {
        var pose_change = pose_changes[i];
        m::integrate_pose(body, &velocity, &mass, &pose_change, collision_substep.h);
        pose_changes[i] = pose_change;
    }
    if (constants.y & s::THEN_INTEGRATE_VELOCITIES) != 0u {
        velocity = m::with_integrated_velocity(velocity, mass, body, collision_substep.h);
    }
    velocities[i] = velocity;
    masses[i] = mass;
}
