#define_import_path faceoff::nearest

// Features between nearest points of two triangles: two corners, a corner and an edge, edges of any angle, and a corner
// over the back of a two-sided face. The twin of `src/manifolds/cpu/nearest.rs`. All conditions are wider by the
// rounding, so that adjacent features leave no gap: both are found there.

#import faceoff::arena::words
#import faceoff::constants::manifolds::{ALONG, OUTSIDE}
#import faceoff::constants::shared::DEFAULT_DIRECTION
#import faceoff::features::{TrianglePair, is_over, none}
#import faceoff::math::direction
#import faceoff::sides
#import faceoff::types as t

// Numbers of candidates. Nine pairs of corners; nine pairs of a corner of the first triangle and an edge of the second,
// and nine the other way round; nine pairs of edges; three corners of the first over the back of the second, and three
// the other way round. The number of a pair is three times the first triangle's number plus the second's.
const CORNER_EDGES: u32 = 9u;
const EDGE_CORNERS: u32 = 18u;
const EDGE_EDGES: u32 = 27u;
const OVER_SECOND: u32 = 36u;
const OVER_FIRST: u32 = 39u;

// The sine of the angle between two edges below which single precision does not know their nearest points.
const PARALLEL_SINGLE: f32 = 1.0e-5;
// Allowance for the distance of the lines of such edges, as a factor on its square.
const PARALLEL_ERROR: f32 = 1.2;

// An edge that a triangle owns.
struct Edge {
    start: vec3<f32>,
    along: vec3<f32>,
    square: f32,
    // In each of its faces, the unit vector perpendicular to the edge, away from it; zero without a second face.
    inward: vec3<f32>,
    other_inward: vec3<f32>,
}

// The bits of the candidates of two triangles, by what they own. The first word has the first 32.
fn candidates(owned_a: u32, owned_b: u32, over_a: bool, over_b: bool) -> vec2<u32> {
    let corners_a = owned_a & 7u;
    let corners_b = owned_b & 7u;
    let edges_a = owned_a >> 3u;
    let edges_b = owned_b >> 3u;
    var pairs = vec4(0u);
    for (var k = 0u; k < 3u; k += 1u) {
        let has_corner = 0u - ((corners_a >> k) & 1u);
        let has_edge = 0u - ((edges_a >> k) & 1u);
        let own = vec4(has_corner & corners_b, has_corner & edges_b, has_edge & corners_b, has_edge & edges_b);
        pairs |= own << vec4(3u * k);
    }
    let low = pairs.x | (pairs.y << CORNER_EDGES) | (pairs.z << EDGE_CORNERS) | (pairs.w << EDGE_EDGES);
    var high = pairs.w >> (32u - EDGE_EDGES);
    high |= select(0u, corners_a << (OVER_SECOND - 32u), over_b);
    high |= select(0u, corners_b << (OVER_FIRST - 32u), over_a);
    return vec2(low, high);
}

// The feature of this candidate, if its points are no farther apart than `most`.
fn feature_of(a: sides::Side, b: sides::Side, pair: TrianglePair, number: u32, most: f32) -> t::Feature {
    if number < CORNER_EDGES {
        return of_corners(a, b, pair, number / 3u, number % 3u, most);
    }
    if number < EDGE_CORNERS {
        let n = number - CORNER_EDGES;
        return of_corner_and_edge(a, b, pair, n / 3u, n % 3u, most);
    }
    if number < EDGE_EDGES {
        let n = number - EDGE_CORNERS;
        return of_corner_and_edge(b, a, pair, n % 3u, n / 3u, most);
    }
    if number < OVER_SECOND {
        let n = number - EDGE_EDGES;
        return of_edges(a, b, pair, n / 3u, n % 3u, most);
    }
    if number < OVER_FIRST {
        let k = number - OVER_SECOND;
        return over_back(a, b, pair, pair.b, pair.heights_a[k], k, most);
    }
    let k = number - OVER_FIRST;
    return over_back(b, a, pair, pair.a, pair.heights_b[k], k, most);
}

// The number of the triangle of this side.
fn own_of(side: sides::Side, pair: TrianglePair) -> u32 {
    return select(pair.a.number, pair.b.number, side.mark != 0u);
}

// How far beside an edge, or beyond the end of an edge of this `length`, points still count as over the face, or beside
// the edge.
fn outside(way: f32, length: f32) -> f32 {
    return min(OUTSIDE * length, ALONG * way);
}

// Whether none of a vertex's edges leads nearer to the end of this way from it.
fn corner_faces(side: sides::Side, vertex: u32, p: vec3<f32>, way: vec3<f32>, rounding: f32) -> bool {
    let distance = length(way);
    let range = sides::neighbors(side, vertex);
    for (var n = range.x; n < range.y; n += 1u) {
        let edge = sides::vertex(side, words[n]) - p;
        let of_edge = length(edge);
        if dot(edge, way) > of_edge * (rounding + outside(distance, of_edge)) {
            return false;
        }
    }
    return true;
}

// Unit vector away from a vertex's edges.
fn corner_outward(side: sides::Side, vertex: u32, p: vec3<f32>) -> vec3<f32> {
    var sum = vec3(0.0);
    let range = sides::neighbors(side, vertex);
    for (var n = range.x; n < range.y; n += 1u) {
        sum += direction(p - sides::vertex(side, words[n]));
    }
    return direction(sum);
}

fn edge_of(side: sides::Side, number: u32, k: u32) -> Edge {
    var edge: Edge;
    edge.start = sides::corner(side, number, k);
    edge.along = sides::corner(side, number, (k + 1u) % 3u) - edge.start;
    edge.square = dot(edge.along, edge.along);
    if side.is_thin {
        return edge;
    }
    edge.inward = inward(edge, sides::corner(side, number, (k + 2u) % 3u));
    let other = sides::across(side, number, k);
    if other != t::NOTHING {
        let own = sides::vertices(side, number);
        let corners = sides::vertices(side, other);
        for (var i = 0u; i < 3u; i += 1u) {
            if corners[i] != own[k] && corners[i] != own[(k + 1u) % 3u] {
                edge.other_inward = inward(edge, sides::corner(side, other, i));
            }
        }
    }
    return edge;
}

fn inward(edge: Edge, corner: vec3<f32>) -> vec3<f32> {
    let way = corner - edge.start;
    return direction(way - edge.along * (dot(way, edge.along) / edge.square));
}

// Whether none of an edge's faces leads nearer to the end of this way from it than by `most` of the way.
fn edge_faces(edge: Edge, way: vec3<f32>, most: f32) -> bool {
    return dot(edge.inward, way) <= most && dot(edge.other_inward, way) <= most;
}

fn edge_outward(edge: Edge) -> vec3<f32> {
    return -direction(edge.inward + edge.other_inward);
}

// The feature of a point of the first body and one of the second. If they touch, the way between them is rounding only,
// and these directions lead outward from the features.
fn between(
    pair: TrianglePair, p: vec3<f32>, q: vec3<f32>, outward_a: vec3<f32>, outward_b: vec3<f32>, vertex: u32, origin: u32
) -> t::Feature {
    let way = q - p;
    let distance = length(way);
    var normal = direction(outward_a - outward_b);
    if distance > pair.rounding {
        normal = way / distance;
    } else if pair.is_rounded && all(normal == vec3(0.0)) {
        // The centres of two balls coincide.
        normal = DEFAULT_DIRECTION;
    }
    if all(normal == vec3(0.0)) {
        return none();
    }
    var feature: t::Feature;
    feature.point_a = p;
    feature.point_b = q;
    feature.normal = normal;
    feature.separation = distance;
    feature.vertex = vertex;
    feature.origin = origin;
    feature.a = pair.a.number;
    feature.b = pair.b.number;
    return feature;
}

// The feature of a vertex of `side` and a point of the other side.
fn between_sides(
    side: sides::Side, pair: TrianglePair, own: vec3<f32>, other: vec3<f32>, outward: vec3<f32>, other_outward: vec3<f32>,
    vertex: u32, origin: u32
) -> t::Feature {
    if side.mark != 0u {
        return between(pair, other, own, other_outward, outward, vertex, origin | t::VERTEX_OF_SECOND);
    }
    return between(pair, own, other, outward, other_outward, vertex, origin);
}

fn of_corners(a: sides::Side, b: sides::Side, pair: TrianglePair, k: u32, l: u32, most: f32) -> t::Feature {
    let p = sides::corner(a, pair.a.number, k);
    let q = sides::corner(b, pair.b.number, l);
    let way = q - p;
    let square = dot(way, way);
    if !(square <= most * most) {
        return none();
    }
    let v = sides::vertices(a, pair.a.number)[k];
    let w = sides::vertices(b, pair.b.number)[l];
    if !corner_faces(a, v, p, way, pair.rounding) || !corner_faces(b, w, q, -way, pair.rounding) {
        return none();
    }
    var outward_a = vec3(0.0);
    var outward_b = vec3(0.0);
    if square <= pair.rounding * pair.rounding {
        outward_a = corner_outward(a, v, p);
        outward_b = corner_outward(b, w, q);
    }
    return between(pair, p, q, outward_a, outward_b, t::NOTHING, t::OF_VERTICES);
}

// Corner k of this side and edge l of the other.
fn of_corner_and_edge(
    side: sides::Side, other: sides::Side, pair: TrianglePair, k: u32, l: u32, most: f32
) -> t::Feature {
    let number = own_of(side, pair);
    let p = sides::corner(side, number, k);
    let start = sides::corner(other, own_of(other, pair), l);
    let along = sides::corner(other, own_of(other, pair), (l + 1u) % 3u) - start;
    let edge_square = dot(along, along);
    let at = dot(p - start, along) / edge_square;
    let foot = start + along * at;
    let way = p - foot;
    let square = dot(way, way);
    // Also for edges without length.
    if !(square <= most * most) {
        return none();
    }
    let edge_length = sqrt(edge_square);
    let beyond = outside(sqrt(square), edge_length);
    let within = (beyond - pair.rounding) / edge_length;
    if !(at >= within && at <= 1.0 - within) {
        return none();
    }
    let edge = edge_of(other, own_of(other, pair), l);
    if !edge_faces(edge, way, max(pair.rounding - beyond, 0.0)) {
        return none();
    }
    let vertex = sides::vertices(side, number)[k];
    if !corner_faces(side, vertex, p, -way, pair.rounding) {
        return none();
    }
    var outward = vec3(0.0);
    var other_outward = vec3(0.0);
    if square <= pair.rounding * pair.rounding {
        outward = corner_outward(side, vertex, p);
        other_outward = edge_outward(edge);
    }
    return between_sides(side, pair, p, foot, outward, other_outward, t::NOTHING, t::OF_VERTEX_EDGE);
}

fn of_edges(sa: sides::Side, sb: sides::Side, pair: TrianglePair, k: u32, l: u32, most: f32) -> t::Feature {
    let start_a = sides::corner(sa, pair.a.number, k);
    let start_b = sides::corner(sb, pair.b.number, l);
    let along_a = sides::corner(sa, pair.a.number, (k + 1u) % 3u) - start_a;
    let along_b = sides::corner(sb, pair.b.number, (l + 1u) % 3u) - start_b;
    let normal = cross(along_a, along_b);
    let square = dot(normal, normal);
    let offset = start_b - start_a;
    let product = dot(offset, normal);
    // The distance of the lines rejects most pairs.
    if product * product > PARALLEL_ERROR * most * most * square {
        return none();
    }
    let square_b = dot(along_b, along_b);
    if square <= PARALLEL_SINGLE * PARALLEL_SINGLE * dot(along_a, along_a) * square_b {
        return none();
    }
    let at_a = dot(cross(offset, along_b), normal) / square;
    if !(at_a >= 0.0 && at_a <= 1.0) {
        return none();
    }
    // The nearest point of the second edge to the first edge's point: for nearly parallel edges, the places on both
    // have errors, which this makes equal.
    let p = start_a + along_a * at_a;
    let at_b = dot(p - start_b, along_b) / square_b;
    let q = start_b + along_b * at_b;
    let way = q - p;
    let distance = length(way);
    // Edges that cross and touch have a feature without this.
    if !(at_b >= 0.0 && at_b <= 1.0 && distance > pair.rounding && distance <= most) {
        return none();
    }
    if !edge_faces(edge_of(sa, pair.a.number, k), way, pair.rounding)
        || !edge_faces(edge_of(sb, pair.b.number, l), -way, pair.rounding) {
        return none();
    }
    let origin = t::OF_EDGES | (k << t::FIRST_EDGE_SHIFT) | (l << t::SECOND_EDGE_SHIFT);
    return between(pair, p, q, vec3(0.0), vec3(0.0), t::NOTHING, origin);
}

// Corner k of this side over the back of the other side's face.
fn over_back(
    side: sides::Side, other: sides::Side, pair: TrianglePair, over: sides::Triangle, height: f32, k: u32, most: f32
) -> t::Feature {
    if !(height < 0.0 && -height <= most) {
        return none();
    }
    let number = own_of(side, pair);
    let p = sides::corner(side, number, k);
    let foot = p - over.normal * height;
    if !is_over(other, over, foot, pair.rounding) {
        return none();
    }
    let vertex = sides::vertices(side, number)[k];
    if !corner_faces(side, vertex, p, foot - p, pair.rounding) {
        return none();
    }
    return between_sides(side, pair, p, foot, vec3(0.0), vec3(0.0), vertex | side.mark, t::OF_VERTEX);
}
