// TriangleTest: one workgroup per pair traverses both bounding-volume trees. It tests eight children of one node
// against eight of another at a time, one thread each, and finally eight triangles against eight. Candidates wait in a
// queue until there is work for all threads. The order of the results is that of the trees, whatever the order of
// threads.
#import faceoff::agree::agree
#import faceoff::arena::{meshes, words, vector}
#import faceoff::constants::triangle_test::SIGNIFICANT
#import faceoff::containment::{contains, unfinished}
#import faceoff::dispatch::group_index
#import faceoff::math::{absolute, norm1, rotate}
#import faceoff::tree
#import faceoff::triangles as tri
#import faceoff::types as t

@group(0) @binding(2) var<uniform> step: t::Step;
@group(0) @binding(3) var<storage, read_write> counters: array<atomic<u32>>;
@group(0) @binding(4) var<storage, read> bodies: array<t::Body>;
@group(0) @binding(5) var<storage, read> near_pairs: array<t::NearPair>;
@group(0) @binding(6) var<storage, read_write> results: array<t::PairResult>;
@group(0) @binding(7) var<storage, read_write> touching: array<t::Touching>;
@group(0) @binding(8) var<storage, read_write> hits: array<t::Hit>;

// Pairs of nodes. Of at most 8 levels, no more than 63 pairs wait while the 64th is opened.
var<workgroup> stack: array<vec2<u32>, 512>;
// Pairs of triangles. Fewer than 64 wait when up to 64 are added.
var<workgroup> queue: array<vec2<u32>, 128>;
// Bit sets of the threads, in triplicate: one is in use, the next is cleared meanwhile, and threads that have not
// passed the barrier may still read the last.
var<workgroup> found: array<atomic<u32>, 6>;
var<workgroup> tested: atomic<u32>;
var<workgroup> hit_base: u32;
var<workgroup> origin: vec3<f32>;
// Numbers of waiting pairs of nodes and of triangles.
var<workgroup> lengths: vec2<u32>;

// Sums over the contour per thread: midpoints weighted by length, with the length; area; offset from each start to its
// end.
var<workgroup> sum_middle: array<vec4<f32>, 64>;
var<workgroup> sum_area: array<vec4<f32>, 64>;
var<workgroup> sum_closing: array<vec4<f32>, 64>;

// The data of the pair that all threads use.
struct Pair {
    near: t::NearPair,
    rotation: mat3x3<f32>,
    spread: mat3x3<f32>,
    scale_a: vec3<f32>,
    scale_b: vec3<f32>,
    mesh_a: t::Mesh,
    mesh_b: t::Mesh,
    radius_a: f32,
    radius_b: f32,
    pad: f32,
}

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let index = group_index(group);
    if index >= agree(thread, atomicLoad(&counters[t::PAIRS])) {
        return;
    }
    let near = near_pairs[index];
    if near.near != t::OVERLAPPING {
        if thread == 0u {
            results[index].touching = 0u;
        }
        return;
    }
    let a = bodies[near.a];
    let b = bodies[near.b];
    var pair: Pair;
    pair.near = near;
    pair.rotation = mat3x3(near.x, near.y, near.z);
    pair.spread = absolute(pair.rotation);
    pair.scale_a = near.unit * a.scale;
    pair.scale_b = near.unit * b.scale;
    pair.mesh_a = meshes[a.mesh];
    pair.mesh_b = meshes[b.mesh];
    pair.radius_a = near.unit * a.radius;
    pair.radius_b = near.unit * b.radius;
    pair.pad = 2.0 * near.error;
    if thread < 6u {
        atomicStore(&found[thread], 0u);
    }
    if thread < 2u {
        tree::survey(thread, select(a.mesh, b.mesh, thread == 1u));
    }
    if thread == 0u {
        atomicStore(&tested, 0u);
        stack[0] = vec2(tree::node(pair.mesh_a.levels - 1u, 0u), tree::node(pair.mesh_b.levels - 1u, 0u));
    }
    workgroupBarrier();

    var depth = 1u;
    var waiting = 0u;
    var hit_count = 0u;
    var middle = vec4(0.0);
    var area = vec4(0.0);
    var closure = vec4(0.0);
    // Which of the three bit sets is in use.
    var mask_set = 0u;
    loop {
        let testing = waiting >= 64u || (depth == 0u && waiting > 0u);
        if !testing && depth == 0u {
            break;
        }
        let next_set = (mask_set + 2u) % 6u;
        if thread < 2u {
            atomicStore(&found[next_set + thread], 0u);
        }
        let bit = 1u << (thread % 32u);
        let word = mask_set + thread / 32u;
        var next_lengths = vec2(depth, waiting);
        if testing {
            // Up to 64 pairs of triangles, one thread each.
            let taken = min(waiting, 64u);
            let first = waiting - taken;
            next_lengths.y = first;
            var verdict: tri::Verdict;
            var triangles = vec2(0u);
            if thread < taken {
                triangles = queue[first + thread];
                let ca = corners_a(pair, triangles.x);
                let cb = corners_b(pair, triangles.y);
                let reach = tri::reach(ca) + tri::reach(cb);
                verdict = tri::decide(
                    tri::triangle(ca, near.error, reach), tri::triangle(cb, near.error, reach), near.error
                );
            }
            let hit = thread < taken && verdict.hit;
            if hit {
                atomicOr(&found[word], bit);
            }
            workgroupBarrier();
            let mask = vec2(atomicLoad(&found[mask_set]), atomicLoad(&found[mask_set + 1u]));
            let hits_now = countOneBits(mask.x) + countOneBits(mask.y);
            let rank = tree::rank_of(mask, thread);
            if thread == 0u && hits_now > 0u {
                hit_base = atomicAdd(&counters[t::HITS], hits_now);
            }
            if hit && hit_count == 0u && rank == 0u {
                // Sums are relative to the first point, for precision.
                origin = verdict.start;
            }
            workgroupBarrier();
            if hit {
                let at = hit_base + rank;
                if at < step.hit_capacity {
                    let start = to_world(a, pair, verdict.start);
                    let end = to_world(a, pair, verdict.end);
                    hits[at] = t::Hit(
                        index, hit_count + rank, triangles.x, triangles.y,
                        start.x, start.y, start.z, end.x, end.y, end.z
                    );
                }
                let anchor = verdict.start - origin;
                let along = verdict.end - verdict.start;
                let length = sqrt(dot(along, along));
                middle += vec4((anchor + 0.5 * along) * length, length);
                if verdict.directed {
                    area += vec4(0.5 * cross(anchor, along), 0.0);
                    closure += vec4(along, 0.0);
                }
            }
            hit_count += hits_now;
        } else {
            let last = depth - 1u;
            let nodes = stack[last];
            let opened = tree::open(nodes, thread);
            let candidate = opened.pair;
            let leaves = opened.leaves;
            var meets = false;
            if leaves {
                // Each thread places its own two triangles, which costs less than waiting for other threads.
                meets = may_intersect(pair, candidate);
            } else {
                meets = opened.wanted && boxes_meet(pair, candidate.x, candidate.y);
            }
            if meets {
                atomicOr(&found[word], bit);
            }
            workgroupBarrier();
            let mask = vec2(atomicLoad(&found[mask_set]), atomicLoad(&found[mask_set + 1u]));
            let number = countOneBits(mask.x) + countOneBits(mask.y);
            if leaves {
                if meets {
                    queue[waiting + tree::rank_of(mask, thread)] = candidate;
                }
                next_lengths = vec2(last, waiting + number);
            } else {
                if meets {
                    stack[last + tree::rank_of(mask, thread)] = candidate;
                }
                next_lengths.x = last + number;
            }
        }
        mask_set = next_set;
        if thread == 0u {
            lengths = next_lengths;
        }
        let agreed = workgroupUniformLoad(&lengths);
        depth = agreed.x;
        waiting = agreed.y;
    }

    // Some devices abort long loops: Mesa's llvmpipe does after some ten thousand iterations, separately for each group
    // of threads. The lists are then incomplete.
    if depth != 0u || waiting != 0u {
        atomicOr(&counters[t::CUT_SHORT], 1u);
    }

    var contained = false;
    if agree(thread, hit_count) == 0u {
        contained = any_inside(pair, true, thread);
        if !contained {
            contained = any_inside(pair, false, thread);
        }
    }
    if unfinished {
        atomicOr(&counters[t::CUT_SHORT], 1u);
    }
    sum_middle[thread] = middle;
    sum_area[thread] = area;
    sum_closing[thread] = closure;
    workgroupBarrier();
    for (var half = 32u; half > 0u; half /= 2u) {
        if thread < half {
            sum_middle[thread] += sum_middle[thread + half];
            sum_area[thread] += sum_area[thread + half];
            sum_closing[thread] += sum_closing[thread + half];
        }
        workgroupBarrier();
    }
    if thread == 0u {
        atomicAdd(&counters[t::TRIANGLE_TESTS], atomicLoad(&tested));
        let touches = hit_count > 0u || contained;
        var result: t::PairResult;
        result.touching = u32(touches);
        result.a = near.a;
        result.b = near.b;
        if touches {
            let local = contact(pair, a, b, hit_count);
            result.point = rotate(a.rotation, local.point / near.unit);
            result.normal = rotate(a.rotation, local.normal);
            let at = atomicAdd(&counters[t::TOUCHING], 1u);
            touching[at] = t::Touching(
                to_world(a, pair, local.point), near.a, result.normal, near.b, index, hit_count, u32(contained), 0u
            );
        }
        results[index] = result;
    }
}

// From a's axes and the pair's unit to the world.
fn to_world(a: t::Body, pair: Pair, p: vec3<f32>) -> vec3<f32> {
    return a.position + rotate(a.rotation, a.scale * pair.mesh_a.center + p / pair.near.unit);
}

fn placed_a(pair: Pair, at: u32) -> vec3<f32> {
    return pair.scale_a * vector(at);
}

fn placed_b(pair: Pair, at: u32) -> vec3<f32> {
    return pair.rotation * (pair.scale_b * vector(at)) + pair.near.translation;
}

fn corners_a(pair: Pair, number: u32) -> tri::Corners {
    let at = pair.mesh_a.triangles + 9u * number;
    return tri::Corners(placed_a(pair, at), placed_a(pair, at + 3u), placed_a(pair, at + 6u));
}

fn corners_b(pair: Pair, number: u32) -> tri::Corners {
    let at = pair.mesh_b.triangles + 9u * number;
    return tri::Corners(placed_b(pair, at), placed_b(pair, at + 3u), placed_b(pair, at + 6u));
}

// Whether both triangles exist, are visible and within the support axis' bounds, their boxes overlap, and neither is
// certainly on one side of the other's plane.
fn may_intersect(pair: Pair, triangles: vec2<u32>) -> bool {
    if triangles.x >= pair.mesh_a.triangle_count || triangles.y >= pair.mesh_b.triangle_count {
        return false;
    }
    let axis = pair.near.axis;
    let a = corners_a(pair, triangles.x);
    if max(dot(a.p, axis), max(dot(a.q, axis), dot(a.r, axis))) < pair.near.b_above - pair.pad {
        return false;
    }
    let b = corners_b(pair, triangles.y);
    if min(dot(b.p, axis), min(dot(b.q, axis), dot(b.r, axis))) > pair.near.a_below + pair.pad {
        return false;
    }
    let low_a = tri::low(a);
    let low_b = tri::low(b);
    let high_a = tri::high(a);
    let high_b = tri::high(b);
    if any(low_a > high_b + pair.pad) || any(low_b > high_a + pair.pad) {
        return false;
    }
    let reach = norm1(high_a - low_a) + norm1(high_b - low_b);
    let ta = tri::triangle(a, pair.near.error, reach);
    let tb = tri::triangle(b, pair.near.error, reach);
    if !in_view(pair, true, pair.near.view_a, triangles.x, ta.normal)
        || !in_view(pair, false, pair.near.view_b, triangles.y, tb.normal) {
        return false;
    }
    atomicAdd(&tested, 1u);
    return !tri::beside(ta, tb) && !tri::beside(tb, ta);
}

// Front faces are determined by the winding of the corners in a's axes.
fn in_view(pair: Pair, of_a: bool, view: u32, number: u32, normal: vec3<f32>) -> bool {
    if view == t::VIEW_ALL {
        return true;
    }
    if view == t::VIEW_ALONG {
        return dot(normal, pair.near.translation) > 0.0;
    }
    if view == t::VIEW_AGAINST {
        return dot(normal, pair.near.translation) < 0.0;
    }
    let groups = select(pair.mesh_b.groups, pair.mesh_a.groups, of_a);
    let group_words = select(pair.mesh_b.group_words, pair.mesh_a.group_words, of_a);
    let word = words[groups + (view - t::VIEW_GROUP) * group_words + number / 32u];
    return ((word >> (number % 32u)) & 1u) == 1u;
}

// Whether both nodes exist, reach beyond the other body's bound along the support axis and into its sphere, and their
// boxes overlap along the axes of both.
fn boxes_meet(pair: Pair, node_a: u32, node_b: u32) -> bool {
    let at_a = tree::box_of(0u, node_a);
    let at_b = tree::box_of(1u, node_b);
    if at_a == 0u || at_b == 0u {
        return false;
    }
    let center_a = pair.scale_a * vector(at_a);
    let half_a = abs(pair.scale_a) * vector(at_a + 3u);
    let own_b = pair.scale_b * vector(at_b);
    let half_b = abs(pair.scale_b) * vector(at_b + 3u);
    let rotated_b = pair.rotation * own_b;
    let center_b = rotated_b + pair.near.translation;
    let around_b = pair.spread * half_b;
    if any(abs(center_b - center_a) > half_a + around_b + pair.pad) {
        return false;
    }
    let axis = pair.near.axis;
    if dot(center_a, axis) + dot(half_a, abs(axis)) < pair.near.b_above - pair.pad {
        return false;
    }
    if dot(center_b, axis) - dot(around_b, abs(axis)) > pair.near.a_below + pair.pad {
        return false;
    }
    let past_a = max(abs(center_a - pair.near.translation) - half_a, vec3(0.0));
    let past_b = max(abs(center_b) - around_b, vec3(0.0));
    let reach_a = pair.radius_a + pair.pad;
    let reach_b = pair.radius_b + pair.pad;
    if dot(past_a, past_a) > reach_b * reach_b || dot(past_b, past_b) > reach_a * reach_a {
        return false;
    }
    let apart = (center_a - center_b) * pair.rotation;
    return all(abs(apart) <= half_b + half_a * pair.spread + pair.pad);
}

struct Contact {
    point: vec3<f32>,
    normal: vec3<f32>,
}

// The contact in a's axes and the pair's unit: the contour's centroid, and its area vector as the normal. The twin of
// `src/triangle_test/cpu/contact.rs`.
fn contact(pair: Pair, a: t::Body, b: t::Body, hit_count: u32) -> Contact {
    let translation = pair.near.translation;
    let apart = sqrt(dot(translation, translation));
    var centers = vec3(0.0, 1.0, 0.0);
    if apart > 0.0 {
        centers = translation / apart;
    }
    if hit_count == 0u {
        // Containment: the centre of the smaller body, along the line of centres.
        return Contact(select(translation, vec3(0.0), a.radius < b.radius), centers);
    }
    let length = sum_middle[0].w;
    var middle = sum_middle[0].xyz / length;
    if !(length > 0.0) {
        middle = vec3(0.0);
    }
    let area = sum_area[0].xyz - 0.5 * cross(middle, sum_closing[0].xyz);
    let sign = sign_of(a, pair.mesh_a) * sign_of(b, pair.mesh_b);
    let size = sqrt(dot(area, area));
    var normal = centers;
    if size > SIGNIFICANT * length * length * 0.07957747 && sign != 0.0 {
        normal = area * (sign / size);
    }
    return Contact(middle + origin, normal);
}

// The orientation of a body's faces: 1 as in its mesh, -1 if the scale mirrors, 0 if it is inconsistent.
fn sign_of(body: t::Body, mesh: t::Mesh) -> f32 {
    let mirrored = (body.scale.x < 0.0) != ((body.scale.y < 0.0) != (body.scale.z < 0.0));
    let orientation = mesh.flags & t::ORIENTATION_MASK;
    if orientation == t::MIXED {
        return 0.0;
    }
    return select(1.0, -1.0, mirrored);
}

// Whether one body is solid and contains a component of the other. `of_a`: a component of a inside b.
fn any_inside(pair: Pair, of_a: bool, thread: u32) -> bool {
    var inner = pair.mesh_b;
    var outer = pair.mesh_a;
    if of_a {
        inner = pair.mesh_a;
        outer = pair.mesh_b;
    }
    if (outer.flags & t::SOLID) == 0u {
        return false;
    }
    for (var k = 0u; k < inner.component_count; k += 1u) {
        let vertex = inner.components + 3u * k;
        var p: vec3<f32>;
        if of_a {
            p = ((placed_a(pair, vertex) - pair.near.translation) * pair.rotation) / pair.scale_b;
        } else {
            p = placed_b(pair, vertex) / pair.scale_a;
        }
        if any(abs(p - outer.box_center) > outer.box_half * 1.00001 + outer.radius * 1.0e-5) {
            continue;
        }
        if contains(outer, select(0u, 1u, of_a), p, thread) {
            return true;
        }
    }
    return false;
}
