#define_import_path faceoff::rims

// Overlaps at the rims of open meshes: contours that end there. The twin of `src/manifolds/cpu/rim.rs`.

#import faceoff::agree::agree
#import faceoff::constants::manifolds::{MAX_DEPTH, MIN_MEAN}
#import faceoff::contours::{contour_links, first, is_loose, ordered, place, segments}
#import faceoff::contour_sums::{maximum, minimum_number, total}
#import faceoff::math::direction
#import faceoff::sides
#import faceoff::types as t

// The part of a rim that is in the other body.
struct Rim {
    // Owner of the rim: 0: no rim; 1: the first body; 2: the second.
    owner: u32,
    // Middle of the rim.
    middle: vec3<f32>,
    // From there to one end.
    half: vec3<f32>,
    depth: f32,
    // From the first body to the second.
    normal: vec3<f32>,
}

// The edge of a rim at the end of a segment.
struct RimEdge {
    is_rim: bool,
    of_second: bool,
    triangle: u32,
    // Position in the triangle.
    k: u32,
}

fn rim_edge(a: sides::Side, b: sides::Side, end: u32) -> RimEdge {
    var result: RimEdge;
    let segment = segments[first + end / 2u];
    let edge = select(segment.start_edge, segment.end_edge, end % 2u == 1u);
    result.of_second = (edge & t::OF_SECOND) != 0u;
    result.triangle = select(segment.a, segment.b, result.of_second);
    var side = a;
    if result.of_second {
        side = b;
    }
    if !is_loose(end) || sides::is_one_sided(side, result.triangle) {
        return result;
    }
    for (var k = 0u; k < 3u; k += 1u) {
        if sides::edge_number(side, result.triangle, k) == (edge & ~t::OF_SECOND) {
            result.is_rim = sides::across(side, result.triangle, k) == t::NOTHING;
            result.k = k;
        }
    }
    return result;
}

// Whether a segment ends at a rim.
fn ends_at_rim(a: sides::Side, b: sides::Side, segment: u32) -> bool {
    return rim_edge(a, b, 2u * segment).is_rim || rim_edge(a, b, 2u * segment + 1u).is_rim;
}

// The rim of a contour, whose segments have this range in the order of contours, and this centre and length.
fn rim_of(
    setup: t::PairSetup, a: sides::Side, b: sides::Side, range: vec2<u32>, center: vec3<f32>, length: f32, thread: u32
) -> Rim {
    var rim: Rim;
    rim.owner = 0u;
    // The sum and the number of the ends on each body's rim, and the first of all ends.
    var ends_a = vec4(0.0);
    var ends_b = vec4(0.0);
    var first_end = t::NOTHING;
    for (var i = range.x + thread; i < range.y; i += 64u) {
        let segment = atomicLoad(&contour_links[ordered(i)]);
        for (var end = 2u * segment; end < 2u * segment + 2u; end += 1u) {
            let edge = rim_edge(a, b, end);
            let at = select(vec4(0.0), vec4(place(end), 1.0), edge.is_rim);
            ends_a += select(at, vec4(0.0), edge.of_second);
            ends_b += select(vec4(0.0), at, edge.of_second);
            first_end = select(first_end, min(first_end, end), edge.is_rim);
        }
    }
    ends_a = total(ends_a, thread);
    ends_b = total(ends_b, thread);
    let rims = agree(thread, u32(ends_a.w > 0.0) + 2u * u32(ends_b.w > 0.0));
    if rims == 0u {
        return rim;
    }
    if rims == 3u {
        // Two rims that have crossed part along the contour.
        rim.middle = ends_a.xyz / ends_a.w;
        let way = rim.middle - ends_b.xyz / ends_b.w;
        rim.depth = sqrt(dot(way, way));
        rim.normal = direction(way);
        rim.owner = select(0u, 1u, rim.depth > 0.0);
        return rim;
    }
    let is_second = rims == 2u;
    var own = a;
    var other = b;
    if is_second {
        own = b;
        other = a;
    }
    let ends = select(ends_a, ends_b, is_second);
    rim.middle = ends.xyz / ends.w;
    rim.half = place(minimum_number(first_end, thread)) - rim.middle;
    let out = way_out(other, range, is_second, center, length, rim.middle, thread);
    // How far the contour leads out, and how far corners of the rim lie below its ends. A rim that has passed a flat
    // face ends there with its corners.
    var reach = 0.0;
    var below = 0.0;
    for (var i = range.x + thread; i < range.y; i += 64u) {
        let segment = atomicLoad(&contour_links[ordered(i)]);
        for (var end = 2u * segment; end < 2u * segment + 2u; end += 1u) {
            let at = place(end);
            reach = max(reach, dot(out, at - rim.middle));
            let edge = rim_edge(a, b, end);
            if edge.is_rim {
                let start = sides::corner(own, edge.triangle, edge.k);
                let last = sides::corner(own, edge.triangle, (edge.k + 1u) % 3u);
                below = max(below, max(dot(out, at - start), dot(out, at - last)));
            }
        }
    }
    rim.depth = max(maximum(reach, thread), min(maximum(below, thread), MAX_DEPTH * setup.size));
    rim.normal = select(-out, out, is_second);
    rim.owner = select(0u, rims, any(out != vec3(0.0)));
    return rim;
}

// The direction in which a rim within a body leaves it: the mean of the body's normals along the contour, or from the
// rim's `middle` to the contour's centre.
fn way_out(
    other: sides::Side, range: vec2<u32>, other_is_first: bool, center: vec3<f32>, length: f32, middle: vec3<f32>, thread: u32
) -> vec3<f32> {
    var sum = vec3(0.0);
    for (var i = range.x + thread; i < range.y; i += 64u) {
        let segment = segments[first + atomicLoad(&contour_links[ordered(i)])];
        let along = segment.end - segment.start;
        let triangle = select(segment.b, segment.a, other_is_first);
        sum += sides::normal_of(other, triangle) * sqrt(dot(along, along));
    }
    sum = total(vec4(sum, 0.0), thread).xyz;
    if dot(sum, sum) > MIN_MEAN * MIN_MEAN * length * length {
        return direction(sum);
    }
    return direction(center - middle);
}
