// Solver: every body takes the sum of the impulses at its ends, in the order of pairs, and moves or speeds up if that is
// next.
#import faceoff::dispatch::group_index
#import faceoff::motion as m
#import faceoff::solver_types as s
#import faceoff::types as t

@group(0) @binding(0) var<uniform> interval: s::Interval;
// Whether the pairs that push each body are counted first; what follows.
@group(0) @binding(1) var<uniform> constants: vec4<u32>;
@group(0) @binding(2) var<storage, read> movers: array<s::Mover>;
@group(0) @binding(3) var<storage, read_write> velocities: array<s::Velocity>;
@group(0) @binding(4) var<storage, read_write> masses: array<s::Mass>;
@group(0) @binding(5) var<storage, read_write> shifts: array<s::Shift>;
@group(0) @binding(6) var<storage, read> links: array<vec4<u32>>;
@group(0) @binding(7) var<storage, read> ends: array<u32>;
@group(0) @binding(8) var<storage, read> end_impulses: array<t::Impulse>;
@group(0) @binding(9) var<storage, read> solver_pairs: array<s::SolverPair>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= interval.bodies {
        return;
    }
    let link = links[i];
    let taken = link.x < link.y;
    if !taken && constants.y == 0u {
        return;
    }
    let mover = movers[i];
    var mass = masses[i];
    var velocity = velocities[i];
    if taken {
        var linear = vec3(0.0);
        var angular = vec3(0.0);
        var pushing = 0u;
        for (var k = link.x; k < link.y; k += 1u) {
            let end = ends[k];
            linear += end_impulses[end].linear;
            angular += end_impulses[end].angular;
            if constants.x != 0u {
                pushing += u32((solver_pairs[end / 2u].flags & s::ACTIVE) != 0u);
            }
        }
        velocity = m::pushed(velocity, mass, linear, angular);
        if constants.x != 0u {
            mass.share = f32(max(pushing, 1u));
        }
    }
    if (constants.y & s::THEN_ADVANCE) != 0u {
        var shift = shifts[i];
        m::advance(mover, &velocity, &mass, &shift, interval.h);
        shifts[i] = shift;
    }
    if (constants.y & s::THEN_ACCELERATE) != 0u {
        velocity = m::accelerated(velocity, mass, mover, interval.h);
    }
    velocities[i] = velocity;
    masses[i] = mass;
}
