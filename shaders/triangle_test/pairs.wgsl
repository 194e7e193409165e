// TriangleTest: one workgroup per pair traverses both bounding-volume trees. It tests eight children of one node
// against eight of another at a time, one thread each, and finally eight triangles against eight. Candidates wait in a
// queue until there is work for all threads. The order of the results follows the trees, whatever the order of threads.
//
// A pair of large meshes may be split (`split.wgsl`). With `PIECES` there is one workgroup per piece of such a pair,
// whose results `join.wgsl` puts together.
#import faceoff::agree::agree
#import faceoff::arena::{meshes, words}
#import faceoff::dispatch::group_index
#import faceoff::math::norm1
#import faceoff::pair_contact::{Sums, counters}
#ifdef PIECES
#import faceoff::pair_contact::total
#else
#import faceoff::pair_contact::{report, results}
#import faceoff::split::is_large
#endif
#ifndef PIECES
#import faceoff::placed_pair::{has_contact_points, rounding_of}
#endif
#import faceoff::placed_pair::{Pair, boxes_meet, near_pairs, slack_of, placed, placed_a, placed_b, to_world}
#import faceoff::tree
#import faceoff::triangles as tri
#import faceoff::types as t

@group(0) @binding(2) var<uniform> step: t::Step;
@group(0) @binding(8) var<storage, read_write> hits: array<t::Hit>;
#ifdef PIECES
@group(0) @binding(9) var<storage, read_write> pieces: array<t::Piece>;
#endif

// Pairs of nodes. On each of at most 8 levels, no more than 63 pairs wait while the 64th is opened.
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

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let number = group_index(group);
#ifdef PIECES
    let count = agree(thread, atomicLoad(&counters[t::PIECES]));
    if number >= count || count > step.piece_capacity {
        return;
    }
    let index = agree(thread, pieces[number].pair);
    // The pair and the number within it follow when all pieces are counted.
    let owner = t::OF_PIECE | number;
#else
    if number >= agree(thread, atomicLoad(&counters[t::PAIRS])) {
        return;
    }
    let index = number;
    let owner = index;
    if near_pairs[index].near != t::OVERLAPPING {
        if thread == 0u {
            results[index].touching = 0u;
        }
        return;
    }
#endif
    let pair = placed(index);
#ifndef PIECES
    if has_contact_points(step, pair) {
        if thread == 0u {
            results[index].touching = 0u;
        }
        return;
    }
    if is_large(pair.mesh_a, pair.mesh_b) && rounding_of(pair) == 0.0 {
        if agree(thread, results[index].pieces) > 0u {
            return;
        }
    }
#endif
    if thread < 6u {
        atomicStore(&found[thread], 0u);
    }
    if thread < 2u {
        tree::survey(thread, select(pair.mesh_a, pair.mesh_b, thread == 1u));
    }
    if thread == 0u {
        atomicStore(&tested, 0u);
#ifdef PIECES
        stack[0] = vec2(pieces[number].node_a, pieces[number].node_b);
#else
        stack[0] = vec2(tree::node(meshes[pair.mesh_a].levels - 1u, 0u), tree::node(meshes[pair.mesh_b].levels - 1u, 0u));
#endif
    }
    workgroupBarrier();

    var depth = 1u;
    var waiting = 0u;
    var hit_count = 0u;
    var own: Sums;
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
                    tri::triangle(ca, pair.error, reach), tri::triangle(cb, pair.error, reach), pair.error
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
                    let start = to_world(pair, verdict.start);
                    let end = to_world(pair, verdict.end);
                    hits[at] = t::Hit(
                        owner, hit_count + rank, triangles.x, triangles.y,
                        start.x, start.y, start.z, end.x, end.y, end.z
                    );
                }
                let anchor = verdict.start - origin;
                let along = verdict.end - verdict.start;
                let length = sqrt(dot(along, along));
                own.middle += vec4((anchor + 0.5 * along) * length, length);
                if verdict.directed {
                    own.area += 0.5 * cross(anchor, along);
                    own.closing += along;
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
    if thread == 0u {
        atomicAdd(&counters[t::TRIANGLE_TESTS], atomicLoad(&tested));
    }
#ifdef PIECES
    let sums = total(own, thread);
    if thread == 0u {
        pieces[number].middle = sums.middle.xyz;
        pieces[number].length = sums.middle.w;
        pieces[number].area = sums.area;
        pieces[number].closing = sums.closing;
        pieces[number].origin = origin;
        pieces[number].hits = hit_count;
    }
#else
    report(index, pair, hit_count, own, origin, thread);
#endif
}

fn corners_a(pair: Pair, number: u32) -> tri::Corners {
    let at = meshes[pair.mesh_a].triangles + 9u * number;
    return tri::Corners(placed_a(pair, at), placed_a(pair, at + 3u), placed_a(pair, at + 6u));
}

fn corners_b(pair: Pair, number: u32) -> tri::Corners {
    let at = meshes[pair.mesh_b].triangles + 9u * number;
    return tri::Corners(placed_b(pair, at), placed_b(pair, at + 3u), placed_b(pair, at + 6u));
}

// Whether both triangles exist, are visible and within the support axis' bounds, their boxes overlap, and neither is
// certainly on one side of the other's plane.
fn may_intersect(pair: Pair, triangles: vec2<u32>) -> bool {
    if triangles.x >= meshes[pair.mesh_a].triangle_count || triangles.y >= meshes[pair.mesh_b].triangle_count {
        return false;
    }
    let axis = near_pairs[pair.index].axis;
    let pad = slack_of(pair);
    let a = corners_a(pair, triangles.x);
    if max(dot(a.p, axis), max(dot(a.q, axis), dot(a.r, axis))) < near_pairs[pair.index].b_above - pad {
        return false;
    }
    let b = corners_b(pair, triangles.y);
    if min(dot(b.p, axis), min(dot(b.q, axis), dot(b.r, axis))) > near_pairs[pair.index].a_below + pad {
        return false;
    }
    let low_a = tri::low(a);
    let low_b = tri::low(b);
    let high_a = tri::high(a);
    let high_b = tri::high(b);
    if any(low_a > high_b + pad) || any(low_b > high_a + pad) {
        return false;
    }
    let reach = norm1(high_a - low_a) + norm1(high_b - low_b);
    let ta = tri::triangle(a, pair.error, reach);
    let tb = tri::triangle(b, pair.error, reach);
    if !in_view(pair, pair.mesh_a, near_pairs[pair.index].view_a, triangles.x, ta.normal)
        || !in_view(pair, pair.mesh_b, near_pairs[pair.index].view_b, triangles.y, tb.normal) {
        return false;
    }
    atomicAdd(&tested, 1u);
    return !tri::beside(ta, tb) && !tri::beside(tb, ta);
}

// Front faces are determined by the winding of the corners in a's axes.
fn in_view(pair: Pair, mesh: u32, view: u32, number: u32, normal: vec3<f32>) -> bool {
    if view == t::VIEW_ALL {
        return true;
    }
    if view == t::VIEW_ALONG {
        return dot(normal, pair.translation) > 0.0;
    }
    if view == t::VIEW_AGAINST {
        return dot(normal, pair.translation) < 0.0;
    }
    let word = words[meshes[mesh].groups + (view - t::VIEW_GROUP) * meshes[mesh].group_words + number / 32u];
    return ((word >> (number % 32u)) & 1u) == 1u;
}
