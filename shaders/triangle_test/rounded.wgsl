// TriangleTest: pairs whose cores do not touch, but are no farther apart than both roundings. One workgroup per pair
// traverses both bounding-volume trees, 64 pairs of nodes or of triangles at a time. Only for steps with a rounded
// mesh. The twin of `src/triangle_test/cpu/rounded.rs`.
#import faceoff::agree::agree
#import faceoff::arena::{meshes, vector}
#import faceoff::closest::of_triangles
#import faceoff::dispatch::group_index
#import faceoff::math::{absolute, rotate}
#import faceoff::pair_contact::{counters, results, touching}
#import faceoff::placed_pair::{
    Pair, bodies, has_contact_points, near_pairs, placed, placed_a, placed_b, rounding_of, slack_of, to_world
}
#import faceoff::tree
#import faceoff::types as t

@group(0) @binding(2) var<uniform> step: t::Step;
@group(0) @binding(8) var<storage, read_write> hits: array<t::Hit>;

// Pairs of nodes. On each of at most 8 levels, no more than 63 pairs wait while the 64th is opened.
var<workgroup> stack: array<vec2<u32>, 512>;
// Bit sets of the threads, in triplicate: one is in use, the next is cleared meanwhile, and threads that have not
// passed the barrier may still read the last.
var<workgroup> found: array<atomic<u32>, 6>;
var<workgroup> hit_base: u32;
// The least distance that each thread has found, and the number of that hit within the pair.
var<workgroup> distances: array<f32, 64>;
var<workgroup> numbers: array<u32, 64>;

// Two triangles whose roundings touch, in a's axes and the pair's unit.
struct RoundedTouch {
    // Distance of the cores.
    distance: f32,
    // Midway between both surfaces.
    point: vec3<f32>,
    // Unit vector from a to b.
    normal: vec3<f32>,
    exists: bool,
}

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let index = group_index(group);
    if index >= agree(thread, atomicLoad(&counters[t::PAIRS])) {
        return;
    }
    if near_pairs[index].near != t::OVERLAPPING {
        return;
    }
    let pair = placed(index);
    if agree(thread, u32(rounding_of(pair) == 0.0 || has_contact_points(step, pair))) == 1u {
        return;
    }
    if agree(thread, results[index].touching) != 0u {
        return;
    }
    if thread < 6u {
        atomicStore(&found[thread], 0u);
    }
    if thread < 2u {
        tree::survey(thread, select(pair.mesh_a, pair.mesh_b, thread == 1u));
    }
    if thread == 0u {
        let levels = vec2(meshes[pair.mesh_a].levels, meshes[pair.mesh_b].levels);
        stack[0] = vec2(tree::node(levels.x - 1u, 0u), tree::node(levels.y - 1u, 0u));
    }
    workgroupBarrier();
    var depth = 1u;
    var hit_count = 0u;
    // Which of the three bit sets is in use.
    var mask_set = 0u;
    var deepest: RoundedTouch;
    deepest.distance = 3.0e38;
    var own_number = t::NOTHING;
    loop {
        if depth == 0u {
            break;
        }
        let next_set = (mask_set + 2u) % 6u;
        if thread < 2u {
            atomicStore(&found[next_set + thread], 0u);
        }
        var next_depth = depth - 1u;
        let opened = tree::open(stack[next_depth], thread);
        var meets = false;
        var touch: RoundedTouch;
        if opened.leaves {
            touch = touch_of(pair, opened.pair);
            meets = touch.exists;
        } else {
            meets = opened.wanted && boxes_near(pair, opened.pair);
        }
        if meets {
            atomicOr(&found[mask_set + thread / 32u], 1u << (thread % 32u));
        }
        workgroupBarrier();
        let mask = vec2(atomicLoad(&found[mask_set]), atomicLoad(&found[mask_set + 1u]));
        let number = countOneBits(mask.x) + countOneBits(mask.y);
        let rank = tree::rank_of(mask, thread);
        if opened.leaves && thread == 0u && number > 0u {
            hit_base = atomicAdd(&counters[t::HITS], number);
        }
        workgroupBarrier();
        if opened.leaves {
            if meets {
                list(index, pair, hit_base + rank, hit_count + rank, opened.pair, touch.point);
                if touch.distance < deepest.distance {
                    deepest = touch;
                    own_number = hit_count + rank;
                }
            }
            hit_count += number;
        } else {
            if meets {
                stack[next_depth + rank] = opened.pair;
            }
            next_depth += number;
        }
        mask_set = next_set;
        depth = agree(thread, next_depth);
    }
    // Some devices abort long loops.
    if depth != 0u {
        atomicOr(&counters[t::CUT_SHORT], 1u);
    }
    if least(deepest.distance, own_number, thread) == own_number && own_number != t::NOTHING {
        report(index, pair, hit_count, deepest);
    }
}

// Writes a hit to the list of all pairs.
fn list(index: u32, pair: Pair, at: u32, number: u32, triangles: vec2<u32>, point: vec3<f32>) {
    if at < step.hit_capacity {
        let p = to_world(pair, point);
        hits[at] = t::Hit(index, number, triangles.x, triangles.y, p.x, p.y, p.z, p.x, p.y, p.z);
    }
}

// The number of the hit with the least distance; of equal ones the first.
fn least(distance: f32, number: u32, thread: u32) -> u32 {
    distances[thread] = distance;
    numbers[thread] = number;
    workgroupBarrier();
    for (var half = 32u; half > 0u; half /= 2u) {
        if thread < half {
            let other = distances[thread + half];
            let other_number = numbers[thread + half];
            if other < distances[thread] || (other == distances[thread] && other_number < numbers[thread]) {
                distances[thread] = other;
                numbers[thread] = other_number;
            }
        }
        workgroupBarrier();
    }
    return numbers[0];
}

// Writes the result of a pair that touches.
fn report(index: u32, pair: Pair, hit_count: u32, touch: RoundedTouch) {
    let rotation = bodies[pair.a].rotation;
    let normal = rotate(rotation, touch.normal);
    results[index].touching = 1u;
    results[index].point = rotate(rotation, touch.point / pair.unit);
    results[index].normal = normal;
    results[index].a = pair.a;
    results[index].b = pair.b;
    let at = atomicAdd(&counters[t::TOUCHING], 1u);
    touching[at] = t::Touching(to_world(pair, touch.point), pair.a, normal, pair.b, index, hit_count, 0u, 0u);
}

// Whether both nodes exist, and their boxes are no farther apart than the roundings, along the axes of both.
fn boxes_near(pair: Pair, nodes: vec2<u32>) -> bool {
    let at_a = tree::box_of(0u, nodes.x);
    let at_b = tree::box_of(1u, nodes.y);
    if at_a == 0u || at_b == 0u {
        return false;
    }
    let reach = rounding_of(pair) + slack_of(pair);
    let spread = absolute(pair.rotation);
    let half_a = abs(pair.scale_a) * vector(at_a + 3u);
    let half_b = abs(pair.scale_b) * vector(at_b + 3u);
    let apart = placed_a(pair, at_a) - placed_b(pair, at_b);
    return all(abs(apart) <= half_a + spread * half_b + reach)
        && all(abs(apart * pair.rotation) <= half_b + half_a * spread + reach);
}

// The touch of two triangles. Triangles that cross have none, because they have no direction.
fn touch_of(pair: Pair, triangles: vec2<u32>) -> RoundedTouch {
    var touch: RoundedTouch;
    if triangles.x >= meshes[pair.mesh_a].triangle_count || triangles.y >= meshes[pair.mesh_b].triangle_count {
        return touch;
    }
    let at_a = meshes[pair.mesh_a].triangles + 9u * triangles.x;
    let at_b = meshes[pair.mesh_b].triangles + 9u * triangles.y;
    let a = mat3x3(placed_a(pair, at_a), placed_a(pair, at_a + 3u), placed_a(pair, at_a + 6u));
    let b = mat3x3(placed_b(pair, at_b), placed_b(pair, at_b + 3u), placed_b(pair, at_b + 6u));
    let reach = rounding_of(pair);
    let low = max(min(a[0], min(a[1], a[2])), min(b[0], min(b[1], b[2])));
    let high = min(max(a[0], max(a[1], a[2])), max(b[0], max(b[1], b[2])));
    if any(low > high + reach + slack_of(pair)) {
        return touch;
    }
    let nearest = of_triangles(a, b);
    touch.distance = sqrt(nearest.square);
    touch.exists = touch.distance <= reach && touch.distance > 0.0;
    touch.normal = (nearest.q - nearest.p) / touch.distance;
    let own = pair.unit * bodies[pair.a].rounding;
    touch.point = nearest.p + touch.normal * (own + 0.5 * (touch.distance - reach));
    return touch;
}
