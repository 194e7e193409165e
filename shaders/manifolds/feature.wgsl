#define_import_path faceoff::features

// Vertex-face and edge-edge features, and the segments in which triangles cross. The twin of
// `src/manifolds/cpu/feature.rs` and `contour.rs`.

#import faceoff::arena::words
#import faceoff::constants::manifolds::{ARC, BELOW, FLAT, OUTSIDE, PARALLEL}
#import faceoff::sides
#import faceoff::types as t

// Triangles are coplanar if the squared sine of the angle between them is below this.
const SAME_PLANE: f32 = 1.0e-12;

// Two triangles, and the heights of their corners over each other's planes.
struct TrianglePair {
    a: sides::Triangle,
    b: sides::Triangle,
    heights_a: vec3<f32>,
    heights_b: vec3<f32>,
    rounding: f32,
    // Either mesh is rounded.
    is_rounded: bool,
    // Range of the separations of features.
    low: f32,
    high: f32,
}

fn none() -> t::Feature {
    var feature: t::Feature;
    feature.separation = t::DROPPED;
    return feature;
}

// Whether a point in the plane of a triangle lies within the triangle, or outside by no more than rounding. No point is
// over a degenerate triangle.
fn is_over(side: sides::Side, over: sides::Triangle, foot: vec3<f32>, rounding: f32) -> bool {
    if side.is_thin {
        return false;
    }
    var next = sides::corner(side, over.number, 0u);
    for (var i = 0u; i < 3u; i += 1u) {
        let start = next;
        next = sides::corner(side, over.number, (i + 1u) % 3u);
        let edge = next - start;
        let inside = dot(cross(edge, foot - start), over.normal) * over.winding_sign;
        let square = dot(edge, edge);
        if inside <= -(OUTSIDE * square + rounding * sqrt(square)) {
            return false;
        }
    }
    return true;
}

// The feature of corner k of the triangle `own` over the triangle `over` of the other side.
fn vertex_feature(
    side: sides::Side, own: u32, other: sides::Side, over: sides::Triangle, height: f32, k: u32, rounding: f32
) -> t::Feature {
    let p = sides::corner(side, own, k);
    let foot = p - over.normal * height;
    if !is_over(other, over, foot, rounding) {
        return none();
    }
    let vertex = sides::vertices(side, own)[k];
    let range = sides::neighbors(side, vertex);
    for (var n = range.x; n < range.y; n += 1u) {
        let edge = sides::vertex(side, words[n]) - p;
        let along = dot(edge, over.normal);
        if along < 0.0 && along * along > BELOW * BELOW * dot(edge, edge) {
            return none();
        }
    }
    var feature: t::Feature;
    let of_second = side.mark != 0u;
    feature.point_a = select(p, foot, of_second);
    feature.point_b = select(foot, p, of_second);
    feature.normal = select(-over.normal, over.normal, of_second);
    feature.separation = height;
    feature.vertex = vertex | side.mark;
    feature.origin = t::OF_VERTEX | select(0u, t::VERTEX_OF_SECOND, of_second);
    feature.a = select(own, over.number, of_second);
    feature.b = select(over.number, own, of_second);
    return feature;
}

// The feature of edge k of the first triangle and edge l of the second.
fn edge_feature(sa: sides::Side, sb: sides::Side, pair: TrianglePair, k: u32, l: u32) -> t::Feature {
    let start_a = sides::corner(sa, pair.a.number, k);
    let start_b = sides::corner(sb, pair.b.number, l);
    let along_a = sides::corner(sa, pair.a.number, (k + 1u) % 3u) - start_a;
    let along_b = sides::corner(sb, pair.b.number, (l + 1u) % 3u) - start_b;
    let normal_of_both = cross(along_a, along_b);
    let square = dot(normal_of_both, normal_of_both);
    // The distance of the lines is tested first, because it rejects most pairs.
    let offset = start_b - start_a;
    let product = dot(offset, normal_of_both);
    let max_distance = max(abs(pair.low), abs(pair.high));
    if product * product > max_distance * max_distance * square {
        return none();
    }
    if square <= PARALLEL * PARALLEL * dot(along_a, along_a) * dot(along_b, along_b) {
        return none();
    }
    let at_a = dot(cross(offset, along_b), normal_of_both) / square;
    let at_b = dot(cross(offset, along_a), normal_of_both) / square;
    if !(at_a >= 0.0 && at_a <= 1.0 && at_b >= 0.0 && at_b <= 1.0) {
        return none();
    }
    let across_a = sides::across(sa, pair.a.number, k);
    let across_b = sides::across(sb, pair.b.number, l);
    let rim_a = across_a == t::NOTHING;
    let rim_b = across_b == t::NOTHING;
    var other_a = vec3(0.0);
    var other_b = vec3(0.0);
    if !rim_a {
        other_a = sides::normal_of(sa, across_a);
    }
    if !rim_b {
        other_b = sides::normal_of(sb, across_b);
    }
    // The normal of a boundary edge may point in any direction from one side of the sheet to the other, so the
    // neighbouring faces decide.
    var towards = pair.a.normal + other_a;
    if rim_a {
        towards = select(-(pair.b.normal + other_b), sb.center - sa.center, rim_b);
    }
    var normal = normal_of_both / sqrt(square);
    if dot(normal, towards) < 0.0 {
        normal = -normal;
    }
    if !may_face(pair.a, along_a, normal, rim_a, other_a) || !may_face(pair.b, along_b, -normal, rim_b, other_b) {
        return none();
    }
    var nearest = vec4(normal, 1.0 - 0.5 * ARC * ARC);
    // Between rounded surfaces normals change without steps.
    if !pair.is_rounded {
        nearest = nearer(nearest, normal, pair.a.normal);
        if !rim_a {
            nearest = nearer(nearest, normal, other_a);
        }
        nearest = nearer(nearest, normal, -pair.b.normal);
        if !rim_b {
            nearest = nearer(nearest, normal, -other_b);
        }
    }
    var feature: t::Feature;
    feature.point_a = start_a + along_a * at_a;
    feature.point_b = start_b + along_b * at_b;
    feature.normal = nearest.xyz;
    feature.separation = dot(nearest.xyz, feature.point_b - feature.point_a);
    feature.vertex = t::NOTHING;
    feature.origin = t::OF_EDGES | (k << t::FIRST_EDGE_SHIFT) | (l << t::SECOND_EDGE_SHIFT);
    feature.a = pair.a.number;
    feature.b = pair.b.number;
    if feature.separation < pair.low || feature.separation > pair.high {
        return none();
    }
    return feature;
}

// The face's normal, if it is closer to the edge's normal than the known one.
fn nearer(known: vec4<f32>, normal: vec3<f32>, face: vec3<f32>) -> vec4<f32> {
    let cosine = dot(face, normal);
    if cosine > known.w {
        return vec4(face, cosine);
    }
    return known;
}

// Whether the edge is convex or a boundary, and `normal` lies between the normals of its owner and of the other face.
fn may_face(own: sides::Triangle, along: vec3<f32>, normal: vec3<f32>, rim: bool, other: vec3<f32>) -> bool {
    let length = sqrt(dot(along, along));
    let least = -ARC * length;
    if own.winding_sign * dot(cross(own.normal, normal), along) < least {
        return false;
    }
    return rim || (own.winding_sign * dot(cross(own.normal, other), along) > FLAT * length
        && own.winding_sign * dot(cross(normal, other), along) >= least);
}

// The point at which an edge pierces a plane.
struct Crossing {
    point: vec3<f32>,
    at: f32,
    edge: u32,
}

// The crossings of a triangle's edges with the other's plane, in order along the common line.
struct Chord {
    start: Crossing,
    end: Crossing,
}

// Whether the triangles cross and are not coplanar. Heights up to the rounding are ties. Ties are broken as if the
// first body were slightly smaller: its corners lie below the second's planes, and the second's above its own.
fn crosses(pair: TrianglePair) -> bool {
    let above_a = above(pair.heights_a, pair.rounding, false);
    let above_b = above(pair.heights_b, -pair.rounding, true);
    let line = cross(pair.a.normal, pair.b.normal);
    return above_a != 0u && above_a != 7u && above_b != 0u && above_b != 7u && dot(line, line) >= SAME_PLANE;
}

// One bit per corner whose height is above the limit, or at it.
fn above(heights: vec3<f32>, limit: f32, at_it: bool) -> u32 {
    var bits = 0u;
    for (var k = 0u; k < 3u; k += 1u) {
        if heights[k] > limit || (at_it && heights[k] == limit) {
            bits |= 1u << k;
        }
    }
    return bits;
}

// The segment in which two triangles cross. Its start edge is `NOTHING` if they miss each other.
fn segment(sa: sides::Side, sb: sides::Side, pair: TrianglePair) -> t::Segment {
    let line = cross(pair.a.normal, pair.b.normal);
    let of_a = chord(sa, pair.a, pair.heights_a, above(pair.heights_a, pair.rounding, false), line);
    let of_b = chord(sb, pair.b, pair.heights_b, above(pair.heights_b, -pair.rounding, true), line);
    // At ties the first body, which counts as smaller, ends first.
    let slack = pair.rounding * sqrt(dot(line, line));
    var start = of_b.start;
    if of_a.start.at >= of_b.start.at - slack {
        start = of_a.start;
    }
    var end = of_b.end;
    if of_a.end.at <= of_b.end.at + slack {
        end = of_a.end;
    }
    var result: t::Segment;
    result.start = start.point;
    result.end = end.point;
    result.start_edge = select(t::NOTHING, start.edge, start.at < end.at);
    result.end_edge = end.edge;
    result.a = pair.a.number;
    result.b = pair.b.number;
    return result;
}

fn chord(side: sides::Side, own: sides::Triangle, heights: vec3<f32>, bits: u32, line: vec3<f32>) -> Chord {
    let vertices = sides::vertices(side, own.number);
    var result: Chord;
    var count = 0u;
    for (var k = 0u; k < 3u; k += 1u) {
        var i = k;
        var j = (k + 1u) % 3u;
        if ((bits >> i) & 1u) == ((bits >> j) & 1u) {
            continue;
        }
        // Both triangles of an edge compute the point from the same end, so they get the same bits.
        if vertices[i] > vertices[j] {
            i = j;
            j = k;
        }
        // If both heights are zero, any point of the edge will do.
        let fall = heights[i] - heights[j];
        var at = 0.5;
        if fall != 0.0 {
            at = clamp(heights[i] / fall, 0.0, 1.0);
        }
        let start = sides::corner(side, own.number, i);
        let point = start + (sides::corner(side, own.number, j) - start) * at;
        let crossing = Crossing(point, dot(line, point), sides::edge_number(side, own.number, k) | side.mark);
        if count == 0u {
            result.start = crossing;
        } else {
            result.end = crossing;
        }
        count += 1u;
    }
    if result.start.at > result.end.at {
        let swapped = result.start;
        result.start = result.end;
        result.end = swapped;
    }
    return result;
}
