// Begin of a step that may need several collision substeps: what each solid body adds to its group, except its
// rotation, and whether it can meet a half-space. One thread per collider.
#import faceoff::dispatch::group_index
#import faceoff::meeting::{add_spin, add_thickness, add_velocity, set_exists}
#import faceoff::solver_types as s
#import faceoff::sweep::{is_solid, moves}
#import faceoff::types as t
#import faceoff::union_find::root_of

@group(0) @binding(0) var<uniform> step: t::Step;
@group(0) @binding(1) var<storage, read> bodies: array<t::Body>;
@group(0) @binding(2) var<storage, read> solver_bodies: array<s::SolverBody>;
@group(0) @binding(3) var<storage, read> motion_states: array<s::MotionState>;
@group(0) @binding(4) var<storage, read> planes: array<t::Plane>;
@group(0) @binding(5) var<storage, read_write> sweeps: array<t::Sweep>;
@group(0) @binding(6) var<storage, read> forces: array<s::BodyForces>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= step.bodies {
        return;
    }
    let sweep = sweeps[i];
    if !moves(sweep) || !is_solid(sweep) {
        return;
    }
    let root = root_of(i);
    add_thickness(root, bodies[i].thickness);
    var spin = 0.0;
    // Continuous collision needs no collision substeps.
    if (sweep.flags & t::FAST) == 0u {
        let number = bodies[i].body;
        let state = motion_states[number];
        if state.asleep != 0u && state.asleep != s::CHANGED {
            add_velocity(root, vec3(0.0));
        } else {
            let body = solver_bodies[number];
            let push = forces[number].force * body.inverse_mass;
            spin = length(state.angular_velocity) * body.extent + bodies[i].torque_acceleration * step.dt;
            add_velocity(root, state.linear_velocity);
            add_velocity(root, state.linear_velocity + push * step.dt);
        }
    }
    sweeps[i].spin = spin;
    for (var k = 0u; k < step.planes; k += 1u) {
        let height = dot(planes[k].normal, sweep.center) - planes[k].distance;
        if planes[k].sensor == 0u && height + min(dot(planes[k].normal, sweep.travel), 0.0) < sweep.radius {
            set_exists(root);
            add_velocity(root, vec3(0.0));
            add_spin(root, spin);
        }
    }
}
