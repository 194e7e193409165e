// Solver: which number each body had in the interval before.
#import faceoff::dispatch::group_index
#import faceoff::solver_types as s

@group(0) @binding(0) var<uniform> interval: s::Interval;
// New numbers by old ones; the largest word for bodies that are gone.
@group(0) @binding(1) var<storage, read> renumbered: array<u32>;
@group(0) @binding(2) var<storage, read_write> links: array<vec4<u32>>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let old = group_index(group) * 64u + thread;
    if old >= min(interval.old_bodies, arrayLength(&renumbered)) {
        return;
    }
    let body = renumbered[old];
    if body < interval.bodies {
        links[body].z = old;
    }
}
