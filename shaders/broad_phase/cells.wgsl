// BroadPhase: the bucket of each body, and which levels have bodies. One thread per body.
#import faceoff::dispatch::group_index
#import faceoff::grid::{bucket_of, cell_of, center_of, level_of}
#import faceoff::types::{Body, Mesh, Step, LEVELS}

@group(0) @binding(0) var<uniform> step: Step;
@group(0) @binding(1) var<storage, read> bodies: array<Body>;
@group(0) @binding(2) var<storage, read> meshes: array<Mesh>;
@group(0) @binding(3) var<storage, read_write> counters: array<atomic<u32>>;
@group(0) @binding(4) var<storage, read_write> keys: array<u32>;
@group(0) @binding(5) var<storage, read_write> values: array<u32>;

var<workgroup> levels: array<atomic<u32>, 2>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    if thread < 2u {
        atomicStore(&levels[thread], 0u);
    }
    workgroupBarrier();
    let i = group_index(group) * 64u + thread;
    if i < step.bodies {
        let body = bodies[i];
        let level = level_of(body.speculative_radius);
        let cell = cell_of(center_of(body, meshes[body.mesh].center), level);
        keys[i] = bucket_of(cell, level, step.bucket_mask);
        values[i] = i;
        if body.speculative_radius > 0.0 {
            atomicOr(&levels[u32(level) / 32u], 1u << (u32(level) % 32u));
        }
    }
    workgroupBarrier();
    if thread < 2u {
        let found = atomicLoad(&levels[thread]);
        if found != 0u {
            atomicOr(&counters[LEVELS + thread], found);
        }
    }
}
