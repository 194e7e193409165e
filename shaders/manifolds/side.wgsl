#define_import_path faceoff::sides

// One body of a pair, in the axes of the pair's first body, relative to the centre of mass of the smaller one.
// Coordinates are made relative to that centre in each body's own axes before they are rotated. So no precision is lost
// far from the world's origin, nor between bodies of very different size.

#import faceoff::arena::{meshes, words, vector}
#import faceoff::constants::manifolds::ARC_SLACK
#import faceoff::constants::shared::{ANY_NORMAL, MESH_HEADER, MESH_RECORD, MESH_ROUND}
#import faceoff::math::direction
#import faceoff::types as t

struct Side {
    rotation: mat3x3<f32>,
    scale: vec3<f32>,
    offset: vec3<f32>,
    // The centre of mass.
    center: vec3<f32>,
    other_center: vec3<f32>,
    // -1 if the scale mirrors, so that outward faces are clockwise; else 1.
    mirror: f32,
    mesh: u32,
    triangles: u32,
    triangle_count: u32,
    // Index of its features among the words.
    features: u32,
    // Some triangles have no inside and outside.
    some_two_sided: bool,
    // The mesh is a segment or a point.
    is_thin: bool,
    // Radius of the rounding; 0 without. All else is that of the core.
    rounded: f32,
    // `OF_SECOND` or 0.
    mark: u32,
}

struct Triangle {
    number: u32,
    // 1 if the corners are counter-clockwise about the normal, else -1.
    winding_sign: f32,
    // Unit vector, outward. Normals of two-sided triangles point to the other body.
    normal: vec3<f32>,
}

fn first(setup: t::PairSetup) -> Side {
    let identity = mat3x3(vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), vec3(0.0, 0.0, 1.0));
    var side = side_of(setup.mesh_a, setup.scale_a, setup.offset_a, identity);
    side.other_center = -(b_to_a(setup) * setup.offset_b);
    side.rounded = setup.rounded_a;
    side.mark = 0u;
    return side;
}

fn second(setup: t::PairSetup) -> Side {
    var side = side_of(setup.mesh_b, setup.scale_b, setup.offset_b, b_to_a(setup));
    side.other_center = -setup.offset_a;
    side.rounded = setup.rounded_b;
    side.mark = t::OF_SECOND;
    return side;
}

// Rotation from b's axes to a's.
fn b_to_a(setup: t::PairSetup) -> mat3x3<f32> {
    return mat3x3(setup.x, setup.y, setup.z);
}

fn side_of(mesh: u32, scale: vec3<f32>, offset: vec3<f32>, rotation: mat3x3<f32>) -> Side {
    let mirrored = (scale.x < 0.0) != ((scale.y < 0.0) != (scale.z < 0.0));
    var side: Side;
    side.rotation = rotation;
    side.scale = scale;
    side.offset = offset;
    side.center = -(rotation * offset);
    side.mirror = select(1.0, -1.0, mirrored);
    side.mesh = mesh;
    side.triangles = meshes[mesh].corners;
    side.triangle_count = meshes[mesh].triangle_count;
    side.features = meshes[mesh].features;
    side.some_two_sided = (meshes[mesh].flags & t::SOME_TWO_SIDED) != 0u;
    side.is_thin = (meshes[mesh].flags & t::THIN) != 0u;
    return side;
}

// How far apart cores are whose rounded surfaces touch; 0 without rounding.
fn rounding(a: Side, b: Side) -> f32 {
    return a.rounded + b.rounded;
}

// Places a point of the mesh, given relative to its centre of mass.
fn place(side: Side, p: vec3<f32>) -> vec3<f32> {
    return side.rotation * (side.scale * p - side.offset);
}

// Transforms a placed point back to the body's own axes, relative to its centre of mass and scaled.
fn to_own(side: Side, p: vec3<f32>) -> vec3<f32> {
    return p * side.rotation + side.offset;
}

fn record(side: Side, number: u32) -> u32 {
    return side.features + MESH_HEADER + MESH_RECORD * number;
}

fn vertex_count(side: Side) -> u32 {
    return words[side.features];
}

fn vertex(side: Side, number: u32) -> vec3<f32> {
    return place(side, vector(side.features + words[side.features + 1u] + 3u * number));
}

// Index of the words of a vertex's smooth normal and roundness, for a mesh whose features start at `features`.
fn smooth_vertex(features: u32, number: u32) -> u32 {
    return features + words[features + 6u] + MESH_ROUND * number;
}

// Range of the vertex's neighbours among the words.
fn neighbors(side: Side, number: u32) -> vec2<u32> {
    let at = side.features + words[side.features + 2u] + number;
    return side.features + words[side.features + 3u] + vec2(words[at], words[at + 1u]);
}

// The connected component of a vertex.
fn component(side: Side, number: u32) -> u32 {
    return words[side.features + words[side.features + 4u] + number];
}

// The vertex of a component that is farthest from its first vertex.
fn far_end(side: Side, number: u32) -> vec3<f32> {
    return place(side, vector(side.features + words[side.features + 5u] + 3u * number));
}

// The vertices of a triangle, in the order of its corners.
fn vertices(side: Side, number: u32) -> vec3<u32> {
    let at = record(side, number);
    return vec3(words[at], words[at + 1u], words[at + 2u]);
}

fn edge_number(side: Side, number: u32, k: u32) -> u32 {
    return words[record(side, number) + 3u + k];
}

// The triangle across an edge that this triangle owns; `NOTHING` at a boundary edge.
fn across(side: Side, number: u32, k: u32) -> u32 {
    return words[record(side, number) + 6u + k];
}

fn owned(side: Side, number: u32) -> u32 {
    return words[record(side, number) + 12u] & 63u;
}

// Whether a triangle pushes only to the side of its normal.
fn is_one_sided(side: Side, number: u32) -> bool {
    return !side.some_two_sided || (words[record(side, number) + 12u] & t::ONE_SIDED) != 0u;
}

// Largest angle between a triangle's normal and a contact normal at an edge that it owns, radians. `ANY_NORMAL` permits
// every normal.
fn edge_normal_rotation(side: Side, number: u32) -> f32 {
    return rotation_in(side, (words[record(side, number) + 12u] >> 8u) & 255u);
}

// Largest angle between a triangle's normal and the way to a point to which it is nearest at a vertex or edge that it
// owns, radians. `ANY_NORMAL` permits every way.
fn nearest_rotation(side: Side, number: u32) -> f32 {
    return rotation_in(side, (words[record(side, number) + 12u] >> 16u) & 255u);
}

// A rotation as it is stored, radians.
fn rotation_in(side: Side, stored: u32) -> f32 {
    let scale = abs(side.scale);
    let longest = max(scale.x, max(scale.y, scale.z));
    let shortest = min(scale.x, min(scale.y, scale.z));
    let rotation = f32(stored) * (ANY_NORMAL / 255.0) + ARC_SLACK;
    // Non-uniform scales change angles.
    return select(ANY_NORMAL, min(rotation, ANY_NORMAL), longest <= shortest * (1.0 + 1.0e-6));
}

fn curvature_radius(side: Side, number: u32) -> f32 {
    return bitcast<f32>(words[record(side, number) + 13u]);
}

// Upper bound of the surface's radius of curvature in all directions at a triangle; `FLAT_RADIUS` or more if it is not
// convex in all directions.
fn max_curvature_radius(side: Side, number: u32) -> f32 {
    let curvature = bitcast<f32>(words[record(side, number) + 15u]);
    if !(curvature > 0.0) {
        return t::FLAT_RADIUS;
    }
    let scale = abs(side.scale);
    let longest = max(scale.x, max(scale.y, scale.z));
    let shortest = min(scale.x, min(scale.y, scale.z));
    // The flattest point of a sphere scaled to an ellipsoid has the radius of curvature `longest^2 / shortest`.
    return longest * (longest / shortest) / curvature;
}

// `max_curvature_radius` of the core at a feature of this origin; 0 at the end of a segment.
fn max_curvature_radius_at(side: Side, number: u32, origin: u32) -> f32 {
    let kind = origin & t::ORIGIN_MASK;
    let is_own = ((origin & t::VERTEX_OF_SECOND) != 0u) == (side.mark != 0u);
    let is_vertex = kind == t::OF_VERTICES || ((kind == t::OF_VERTEX || kind == t::OF_VERTEX_EDGE) && is_own);
    if side.is_thin && is_vertex {
        return 0.0;
    }
    return max_curvature_radius(side, number);
}

fn face(side: Side, number: u32) -> u32 {
    return words[record(side, number) + 14u];
}

// The placed k-th corner of a triangle. It is placed again at each use: stored corners of two triangles would take too
// many registers.
fn corner(side: Side, number: u32, k: u32) -> vec3<f32> {
    return place(side, vector(side.triangles + 9u * number + 3u * k));
}

// A placed triangle. Its normal is computed from the placed corners, so corners in its plane have a height of nearly
// zero.
fn triangle(side: Side, number: u32) -> Triangle {
    var result: Triangle;
    result.number = number;
    let start = corner(side, number, 0u);
    let along = direction(corner(side, number, 1u) - start);
    let normal = cross(along, direction(corner(side, number, 2u) - start)) * side.mirror;
    let square = dot(normal, normal);
    // A triangle too thin for that has the transformed normal of its mesh.
    if square > 1.0e-12 {
        result.normal = normal / sqrt(square);
    } else {
        result.normal = baked_normal(side, number);
    }
    result.winding_sign = side.mirror;
    if faces_away(side, number, result.normal, start) {
        result.normal = -result.normal;
        result.winding_sign = -side.mirror;
    }
    return result;
}

// The transformed normal of the mesh.
fn baked_normal(side: Side, number: u32) -> vec3<f32> {
    return side.rotation * direction(vector(record(side, number) + 9u) / side.scale);
}

// `baked_normal`, but towards the other body for two-sided triangles.
fn normal_of(side: Side, number: u32) -> vec3<f32> {
    let normal = baked_normal(side, number);
    if !side.some_two_sided {
        return normal;
    }
    return select(normal, -normal, faces_away(side, number, normal, corner(side, number, 0u)));
}

fn faces_away(side: Side, number: u32, normal: vec3<f32>, corner: vec3<f32>) -> bool {
    return !is_one_sided(side, number) && dot(normal, side.other_center - corner) < 0.0;
}

// Heights of a triangle's corners over the plane of another one, of the other side.
fn heights(side: Side, number: u32, other: Side, over: Triangle) -> vec3<f32> {
    let start = corner(other, over.number, 0u);
    return vec3(
        dot(over.normal, corner(side, number, 0u) - start),
        dot(over.normal, corner(side, number, 1u) - start),
        dot(over.normal, corner(side, number, 2u) - start),
    );
}
