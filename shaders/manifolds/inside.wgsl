// Contact generation: containment without intersecting faces, and the shortest way out; and the way out for a segment
// that pierces faces. One workgroup per pair. The twin of `src/manifolds/cpu/inside.rs` and of `thin.rs` there.
#import faceoff::agree::agree
#import faceoff::arena::{meshes, words, vector}
#import faceoff::closest::closest
#import faceoff::containment::{contains, unfinished}
#import faceoff::dispatch::group_index
#import faceoff::math::direction
#import faceoff::near_ranges::{range_count, range_of}
#import faceoff::sides
#import faceoff::tree
#import faceoff::types as t

@group(0) @binding(2) var<uniform> limits: t::ContactLimits;
@group(0) @binding(3) var<storage, read_write> contact_counters: array<atomic<u32>>;
@group(0) @binding(4) var<storage, read_write> pair_setups: array<t::PairSetup>;
@group(0) @binding(5) var<storage, read_write> features: array<t::Feature>;
@group(0) @binding(6) var<storage, read> near_triangles: array<vec4<u32>>;

// Most components of a mesh that are tested.
const MAX_COMPONENTS: u32 = 1024u;

// Bit set of the components of the inner body that are inside.
var<workgroup> held: array<u32, 32>;
// The best candidate of each thread: a position with its rank, and a number.
var<workgroup> best: array<vec4<f32>, 64>;
var<workgroup> best_number: array<u32, 64>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let index = group_index(group);
    if index >= agree(thread, atomicLoad(&contact_counters[t::BATCH_PAIRS])) {
        return;
    }
    let setup = pair_setups[index];
    if agree(thread, u32(setup.valid == 0u || setup.segment_count > 0u)) == 1u {
        return;
    }
    let a = sides::first(setup);
    let b = sides::second(setup);
    if thread < 2u {
        tree::survey(thread, select(a.mesh, b.mesh, thread == 1u));
    }
    workgroupBarrier();
    var done = false;
    if agree(thread, u32(a.is_thin != b.is_thin)) == 1u {
        if agree(thread, u32(a.is_thin)) == 1u {
            done = push_segment_out(index, setup, a, b, thread);
        } else {
            done = push_segment_out(index, setup, b, a, thread);
        }
        if done {
            return;
        }
    }
    done = try_side(index, a, b, 0u, thread);
    if !done {
        done = try_side(index, b, a, 1u, thread);
    }
    if unfinished {
        atomicOr(&contact_counters[t::CONTACTS_CUT_SHORT], 1u);
    }
}

// Whether the segment of `own` pierces faces. If so, its end that is least deep behind one of them is pushed out.
fn push_segment_out(index: u32, setup: t::PairSetup, own: sides::Side, other: sides::Side, thread: u32) -> bool {
    var depth = t::DROPPED;
    // Twice the number of the face, plus that of the end.
    var number = t::NOTHING;
    let ranges = range_count(setup, atomicLoad(&contact_counters[t::NEAR_PIECES]), limits.pieces);
    for (var i = 0u; i < ranges; i += 1u) {
        let range = range_of(setup, i);
        for (var k = thread; k < range.y; k += 64u) {
            let triangles = near_triangles[range.x + k].xy;
            let face = select(triangles.x, triangles.y, own.mark == 0u);
            let heights = heights_if_pierced(own, other, face, setup.rounding);
            for (var end = 0u; end < 2u; end += 1u) {
                let place = 2u * face + end;
                let is_less = -heights[end] < depth || (-heights[end] == depth && place < number);
                if heights[end] < 0.0 && is_less {
                    depth = -heights[end];
                    number = place;
                }
            }
        }
    }
    least(vec4(0.0, 0.0, 0.0, depth), number, thread);
    let found = agree(thread, best_number[0]);
    if found == t::NOTHING {
        return false;
    }
    if thread == 0u {
        let of_second = own.mark != 0u;
        let over = sides::triangle(other, found / 2u);
        let end = sides::corner(own, 0u, found % 2u);
        let height = dot(over.normal, end - sides::corner(other, over.number, 0u));
        let foot = end - over.normal * height;
        var feature: t::Feature;
        feature.point_a = select(end, foot, of_second);
        feature.point_b = select(foot, end, of_second);
        feature.normal = select(-over.normal, over.normal, of_second);
        feature.separation = height;
        feature.vertex = (found % 2u) | own.mark;
        feature.origin = t::OF_VERTEX | select(0u, t::VERTEX_OF_SECOND, of_second);
        feature.a = select(0u, over.number, of_second);
        feature.b = select(over.number, 0u, of_second);
        pair_setups[index].meeting_count = 0u;
        add(index, feature);
    }
    return true;
}

// Heights of the ends of a segment over a face that it pierces; 0 if it does not.
fn heights_if_pierced(own: sides::Side, other: sides::Side, number: u32, rounding: f32) -> vec2<f32> {
    let face = sides::triangle(other, number);
    let start = sides::corner(other, number, 0u);
    let end_a = sides::corner(own, 0u, 0u);
    let end_b = sides::corner(own, 0u, 1u);
    let heights = vec2(dot(face.normal, end_a - start), dot(face.normal, end_b - start));
    if (heights.x < 0.0) == (heights.y < 0.0) {
        return vec2(0.0);
    }
    let at = end_a + (end_b - end_a) * (heights.x / (heights.x - heights.y));
    for (var k = 0u; k < 3u; k += 1u) {
        let p = sides::corner(other, number, k);
        let along = sides::corner(other, number, (k + 1u) % 3u) - p;
        if dot(cross(along, at - p), face.normal) * face.winding_sign < -rounding * length(along) {
            return vec2(0.0);
        }
    }
    return heights;
}

// Whether a component of `inner` is inside `outer`, whose position in the pair is `end`. If so, the contact replaces
// all other features of the pair.
fn try_side(index: u32, outer: sides::Side, inner: sides::Side, end: u32, thread: u32) -> bool {
    let mesh = meshes[outer.mesh];
    // No component can be inside a mesh that is not solid.
    let candidates = select(0u, meshes[inner.mesh].component_count, (mesh.flags & t::SOLID) != 0u);
    let components = agree(thread, candidates);
    if components == 0u {
        return false;
    }
    let several = components > 1u;
    var start = vec3(0.0);
    var any_inside = false;
    if thread < 32u {
        held[thread] = 0u;
    }
    workgroupBarrier();
    for (var k = 0u; k < min(components, MAX_COMPONENTS); k += 1u) {
        let p = sides::place(inner, vector(meshes[inner.mesh].components + 3u * k));
        // Rounding decides whether points on the surface are inside, so two vertices must be.
        if is_inside(mesh, outer, end, p, thread) && is_inside(mesh, outer, end, sides::far_end(inner, k), thread) {
            if !any_inside {
                start = p;
            }
            any_inside = true;
            if thread == 0u {
                held[k / 32u] |= 1u << (k % 32u);
            }
        }
    }
    if !any_inside {
        return false;
    }
    if is_inside(mesh, outer, end, inner.center, thread) {
        start = inner.center;
    }
    workgroupBarrier();
    push_out(index, outer, inner, start, several, thread);
    return true;
}

fn is_inside(mesh: t::Mesh, outer: sides::Side, end: u32, p: vec3<f32>, thread: u32) -> bool {
    let own = sides::to_own(outer, p) / outer.scale;
    // Optimisation only: points outside the slightly enlarged box are outside the body.
    let outside = any(abs(own - mesh.box_center) > mesh.box_half * 1.00001 + mesh.radius * 1.0e-5);
    if agree(thread, u32(outside)) == 1u {
        return false;
    }
    return contains(mesh, end, own, thread);
}

// The contact from the nearest point of the outer surface to the far end of the contained part, on the line through its
// middle.
fn push_out(index: u32, outer: sides::Side, inner: sides::Side, start: vec3<f32>, several: bool, thread: u32) {
    var nearest = vec4(vec3(0.0), t::DROPPED);
    var number = t::NOTHING;
    for (var i = thread; i < outer.triangle_count; i += 64u) {
        let at = outer.triangles + 9u * i;
        let q = closest(
            start, sides::place(outer, vector(at)), sides::place(outer, vector(at + 3u)),
            sides::place(outer, vector(at + 6u))
        );
        let square = dot(q - start, q - start);
        if square < nearest.w {
            nearest = vec4(q, square);
            number = i;
        }
    }
    least(nearest, number, thread);
    let surface = best[0].xyz;
    let triangle = best_number[0];
    workgroupBarrier();
    var direction_out = direction(surface - start);
    if dot(direction_out, direction_out) == 0.0 {
        direction_out = sides::normal_of(outer, triangle);
    }
    // Only components inside count for the far end.
    var far = vec4(0.0);
    var vertex = t::NOTHING;
    for (var v = thread; v < sides::vertex_count(inner); v += 64u) {
        let along = dot(direction_out, sides::vertex(inner, v) - start);
        if along < far.w {
            let component = min(sides::component(inner, v), MAX_COMPONENTS - 1u);
            if !several || ((held[component / 32u] >> (component % 32u)) & 1u) == 1u {
                far.w = along;
                vertex = v;
            }
        }
    }
    least(far, vertex, thread);
    let depth = best[0].w;
    // Without a far end, the first vertex.
    let last = select(best_number[0], 0u, best_number[0] == t::NOTHING);
    workgroupBarrier();
    var owner = t::NOTHING;
    for (var i = thread; i < inner.triangle_count; i += 64u) {
        if any(sides::vertices(inner, i) == vec3(last)) {
            owner = i;
            break;
        }
    }
    least(vec4(0.0), owner, thread);
    if thread != 0u {
        return;
    }
    let inner_triangle = best_number[0];
    let farthest = start + direction_out * depth;
    let outer_is_second = outer.mark != 0u;
    var feature: t::Feature;
    feature.point_a = select(surface, farthest, outer_is_second);
    feature.point_b = select(farthest, surface, outer_is_second);
    feature.normal = select(direction_out, -direction_out, outer_is_second);
    feature.separation = dot(direction_out, farthest - surface);
    feature.vertex = t::NOTHING;
    feature.a = select(triangle, inner_triangle, outer_is_second);
    feature.b = select(inner_triangle, triangle, outer_is_second);
    pair_setups[index].feature_count = 0u;
    pair_setups[index].nearest_count = 0u;
    pair_setups[index].meeting_count = 0u;
    add(index, feature);
}

// Adds a feature to those of a pair.
fn add(index: u32, feature: t::Feature) {
    let at = atomicAdd(&contact_counters[t::FEATURES], 1u);
    if at < limits.features {
        features[at] = feature;
        pair_setups[index].first_probe = at;
        pair_setups[index].probe_count = 1u;
    }
}

// Reduction to the smallest value of all threads; of equal ones, that with the smallest number.
fn least(own: vec4<f32>, number: u32, thread: u32) {
    best[thread] = own;
    best_number[thread] = number;
    workgroupBarrier();
    for (var half = 32u; half > 0u; half /= 2u) {
        if thread < half {
            let other = best[thread + half];
            let other_number = best_number[thread + half];
            if other.w < best[thread].w || (other.w == best[thread].w && other_number < best_number[thread]) {
                best[thread] = other;
                best_number[thread] = other_number;
            }
        }
        workgroupBarrier();
    }
}
