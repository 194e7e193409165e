// BroadPhase: each body searches the cells around it, on its own level and all coarser ones. So each pair is found
// once: by the smaller body or, on the same level, by the one of smaller number. The first run counts the pairs; the
// second, with EMIT, writes them to the positions from the scan of the counts. One thread per body.
//
// The search of a body ends after MAX_PARTNERS others. Its count is then more than any list holds, so that the step is
// not done here: in a crowd each body would be compared with each other one.
//
// With SWEPT the spheres hold the ways of the whole step, and only pairs that can meet within it count.
#import faceoff::constants::broad_phase::{MAX_PARTNERS, SPHERE_SLACK}
#import faceoff::dispatch::group_index
#import faceoff::grid::{bucket_of, cell_of}
#import faceoff::math::layers_interact
#import faceoff::sweep::meet
#import faceoff::types::{Body, GridEntry, Step, Sweep, LEVELS, KIND_MASK, DYNAMIC, KINEMATIC, OVERFLOW, SENSOR}

@group(0) @binding(0) var<uniform> step: Step;
@group(0) @binding(1) var<storage, read> counters: array<u32>;
@group(0) @binding(2) var<storage, read> bodies: array<Body>;
@group(0) @binding(3) var<storage, read> entries: array<GridEntry>;
@group(0) @binding(4) var<storage, read> buckets: array<vec2<u32>>;
@group(0) @binding(7) var<storage, read> status: array<u32>;
#ifdef SWEPT
@group(0) @binding(8) var<storage, read> sweeps: array<Sweep>;
#endif
#ifdef EMIT
@group(0) @binding(5) var<storage, read> pair_counts: array<u32>;
@group(0) @binding(6) var<storage, read_write> sphere_pairs: array<vec2<u32>>;
#else
@group(0) @binding(5) var<storage, read_write> pair_counts: array<u32>;
#endif

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= step.bodies {
        return;
    }
    var found = 0u;
#ifdef EMIT
    found = pair_counts[i];
#endif
    let own = entries[i];
    // After an overflow nothing has moved, and poses may be missing: with all bodies at one place, pairs would have no
    // end.
    let is_void = status[OVERFLOW] != 0u || step.is_over != 0u;
    var level = own.level;
    var is_crowded = false;
    while !is_void && !is_crowded && own.radius > 0.0 && level < 64 {
        if ((counters[LEVELS + u32(level) / 32u] >> (u32(level) % 32u)) & 1u) == 0u {
            level += 1;
            continue;
        }
        let middle = cell_of(own.center, level);
        for (var k = 0; k < 27 && !is_crowded; k += 1) {
            let cell = middle + vec3(k % 3, (k / 3) % 3, k / 9) - 1;
            let bucket = buckets[bucket_of(cell, level, step.bucket_mask)];
            for (var j = bucket.x; j < bucket.y && !is_crowded; j += 1u) {
                let other = entries[j];
                if other.level != level || (level == own.level && other.body <= own.body) || !(other.radius > 0.0) {
                    continue;
                }
                // Several cells may share the bucket.
                if any(cell_of(other.center, level) != cell) || !overlap(own, other) || !may_collide(own, other) {
                    continue;
                }
#ifdef EMIT
                if found < step.pair_capacity {
                    sphere_pairs[found] = vec2(min(own.body, other.body), max(own.body, other.body));
                }
#endif
                found += 1u;
#ifndef EMIT
                is_crowded = found >= MAX_PARTNERS;
#endif
            }
        }
        level += 1;
    }
#ifndef EMIT
    pair_counts[i] = select(found, 0x80000000u, is_crowded);
#endif
}

fn overlap(a: GridEntry, b: GridEntry) -> bool {
    // In units of the larger sphere: squares of tiny or huge lengths would leave the range of f32.
    let reach = a.radius + b.radius;
    let d = (b.center - a.center) / reach;
    if !(dot(d, d) <= SPHERE_SLACK) {
        return false;
    }
#ifdef SWEPT
    return meet(sweeps[a.body], sweeps[b.body]);
#else
    return true;
#endif
}

fn may_collide(a: GridEntry, b: GridEntry) -> bool {
    let kind_a = a.flags & KIND_MASK;
    let kind_b = b.flags & KIND_MASK;
    let sensor = ((a.flags | b.flags) & SENSOR) != 0u;
    let moved = kind_a == DYNAMIC || kind_b == DYNAMIC || (sensor && (kind_a == KINEMATIC || kind_b == KINEMATIC));
    if !moved {
        return false;
    }
    let of_a = bodies[a.body];
    let of_b = bodies[b.body];
    // Colliders of one body do not collide.
    if of_a.body == of_b.body {
        return false;
    }
    return layers_interact(vec2(of_a.memberships, of_a.filters), vec2(of_b.memberships, of_b.filters));
}
