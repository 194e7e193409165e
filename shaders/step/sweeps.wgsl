// Begin of a step that may need several collision substeps: the sphere that each collider sweeps over in the whole
// step. The broad phase then finds the pairs that can meet. At first every body is a group of its own. One thread per
// collider.
#import faceoff::arena::meshes
#import faceoff::constants::shared::SAFETY
#import faceoff::dispatch::group_index
#import faceoff::grid::center_of
#import faceoff::margins::sway
#import faceoff::solver_types as s
#import faceoff::types as t
#import faceoff::union_find::islands

@group(0) @binding(2) var<uniform> step: t::Step;
@group(0) @binding(3) var<storage, read_write> counters: array<u32>;
@group(0) @binding(4) var<storage, read_write> bodies: array<t::Body>;
@group(0) @binding(5) var<storage, read_write> sweeps: array<t::Sweep>;
@group(0) @binding(6) var<storage, read_write> meetings: array<t::Meeting>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i == 0u {
        counters[t::NEEDED_SUBSTEPS] = 1u;
    }
    if i >= step.bodies {
        return;
    }
    let body = bodies[i];
    var travel = vec3(0.0);
    var margin = step.contact_margin * body.radius;
    var speed = 0.0;
    if (body.flags & t::KIND_MASK) != t::STATIC {
        let time = SAFETY * step.dt;
        travel = time * body.linear_velocity;
        margin += time * sway(step, body, step.dt);
        speed = length(body.linear_velocity - step.drift) * time;
    }
    let center = center_of(body, meshes[body.mesh].center);
    sweeps[i] = t::Sweep(center, body.radius + margin, travel, body.flags, 0.0, 0u, 0u, 0u);
    bodies[i].speculative_radius = body.radius + margin + speed;
    atomicStore(&islands[i].parent, body.body);
    for (var axis = 0u; axis < 3u; axis += 1u) {
        atomicStore(&meetings[i].highest[axis], 0u);
        atomicStore(&meetings[i].highest_negated[axis], 0u);
    }
    atomicStore(&meetings[i].substeps, 1u);
    atomicStore(&meetings[i].exists, 0u);
    atomicStore(&meetings[i].spin, 0u);
    atomicStore(&meetings[i].thinnest, bitcast<u32>(s::INFINITE_LENGTH));
}
