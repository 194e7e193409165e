#define_import_path faceoff::sides

// The two bodies of a pair whose contact points are wanted, in the axes of the first about the centre of mass of the
// smaller one: coordinates are taken relative to that centre in each body's own axes before they are turned, so that
// digits are lost neither far from the world's origin nor between a small body and a large one.

#import faceoff::arena::{meshes, words, vector}
#import faceoff::constants::manifolds::ARC_SLACK
#import faceoff::constants::shared::{ANY_NORMAL, MESH_HEADER, MESH_RECORD}
#import faceoff::math::direction
#import faceoff::types as t

struct Side {
    rotation: mat3x3<f32>,
    scale: vec3<f32>,
    offset: vec3<f32>,
    // Of mass.
    center: vec3<f32>,
    other_center: vec3<f32>,
    // Minus one if the scale mirrors, so that corners run clockwise seen from outside.
    mirror: f32,
    mesh: u32,
    triangles: u32,
    triangle_count: u32,
    // Where features lie among the words.
    features: u32,
    // Whether the faces of a closed mesh agree about where it is solid; if not, triangles have two sides.
    sided: bool,
    // `OF_SECOND` or 0.
    mark: u32,
}

struct Triangle {
    number: u32,
    // 1 if the corners run counter-clockwise about the normal, else -1.
    winding_sign: f32,
    corners: array<vec3<f32>, 3>,
    // Unit vector, outward; of triangles with two sides towards the other body.
    normal: vec3<f32>,
}

fn first(setup: t::PairSetup) -> Side {
    let identity = mat3x3(vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), vec3(0.0, 0.0, 1.0));
    var side = side_of(setup.mesh_a, setup.scale_a, setup.offset_a, identity);
    side.other_center = -(b_to_a(setup) * setup.offset_b);
    side.mark = 0u;
    return side;
}

fn second(setup: t::PairSetup) -> Side {
    var side = side_of(setup.mesh_b, setup.scale_b, setup.offset_b, b_to_a(setup));
    side.other_center = -setup.offset_a;
    side.mark = t::OF_SECOND;
    return side;
}

// Turns b's axes into a's.
fn b_to_a(setup: t::PairSetup) -> mat3x3<f32> {
    return mat3x3(setup.x, setup.y, setup.z);
}

fn side_of(mesh: u32, scale: vec3<f32>, offset: vec3<f32>, rotation: mat3x3<f32>) -> Side {
    let orientation = meshes[mesh].flags & t::ORIENTATION_MASK;
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
    side.sided = orientation == t::OUTWARD || orientation == t::INWARD;
    return side;
}

// A point of the mesh, relative to its centre of mass.
fn place(side: Side, p: vec3<f32>) -> vec3<f32> {
    return side.rotation * (side.scale * p - side.offset);
}

// Back to the body's own axes about its centre of mass, scaled.
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

// The normal of the smooth surface at a vertex; zero if it has none.
fn smooth_normal(side: Side, number: u32) -> vec3<f32> {
    return side.rotation * direction(vector(smooth_vertex(side.features, number)) / side.scale);
}

// Where normal and roundness of a vertex lie among the words of a mesh whose features start there.
fn smooth_vertex(features: u32, number: u32) -> u32 {
    return features + words[features + 6u] + 4u * number;
}

// Where the vertices' neighbours start among the words, and where they end.
fn neighbors(side: Side, number: u32) -> vec2<u32> {
    let at = side.features + words[side.features + 2u] + number;
    return side.features + words[side.features + 3u] + vec2(words[at], words[at + 1u]);
}

// The number of the connected component to which a vertex belongs.
fn component(side: Side, number: u32) -> u32 {
    return words[side.features + words[side.features + 4u] + number];
}

// The vertex of a component that is farthest from its first one.
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

// The triangle across an edge that this triangle owns; `NOTHING` at a rim.
fn across(side: Side, number: u32, k: u32) -> u32 {
    return words[record(side, number) + 6u + k];
}

fn owned(side: Side, number: u32) -> u32 {
    return words[record(side, number) + 12u] & 63u;
}

// How far a contact's normal at an edge that the triangle owns may turn from the triangle's, radians; of `ANY_NORMAL` any normal
// is within.
fn edge_normal_rotation(side: Side, number: u32) -> f32 {
    let scale = abs(side.scale);
    let longest = max(scale.x, max(scale.y, scale.z));
    let shortest = min(scale.x, min(scale.y, scale.z));
    let rotation = f32(words[record(side, number) + 12u] >> 8u) * (ANY_NORMAL / 255.0) + ARC_SLACK;
    // Unequal scales change angles.
    return select(ANY_NORMAL, min(rotation, ANY_NORMAL), longest <= shortest * (1.0 + 1.0e-6));
}

fn curvature_radius(side: Side, number: u32) -> f32 {
    return bitcast<f32>(words[record(side, number) + 13u]);
}

// The largest radius of curvature that the surface has in any direction at a triangle; `FLAT_RADIUS` or more if it is not
// round all ways.
fn max_curvature_radius(side: Side, number: u32) -> f32 {
    let curvature = bitcast<f32>(words[record(side, number) + 15u]);
    if !(curvature > 0.0) {
        return t::FLAT_RADIUS;
    }
    let scale = abs(side.scale);
    let longest = max(scale.x, max(scale.y, scale.z));
    let shortest = min(scale.x, min(scale.y, scale.z));
    // Of a ball squeezed to an ellipsoid the flattest place has the radius `longest^2 / shortest`.
    return longest * (longest / shortest) / curvature;
}

fn face(side: Side, number: u32) -> u32 {
    return words[record(side, number) + 14u];
}

// Its normal is that of the placed corners, so that corners in its plane have a height of nearly zero.
fn triangle(side: Side, number: u32) -> Triangle {
    let at = side.triangles + 9u * number;
    var result: Triangle;
    result.number = number;
    result.corners[0] = place(side, vector(at));
    result.corners[1] = place(side, vector(at + 3u));
    result.corners[2] = place(side, vector(at + 6u));
    let along = direction(result.corners[1] - result.corners[0]);
    let normal = cross(along, direction(result.corners[2] - result.corners[0])) * side.mirror;
    let square = dot(normal, normal);
    // What is too thin to have a normal by its corners has that of its mesh.
    if square > 1.0e-12 {
        result.normal = normal / sqrt(square);
    } else {
        result.normal = baked_normal(side, number);
    }
    result.winding_sign = side.mirror;
    if faces_away(side, result.normal, result.corners[0]) {
        result.normal = -result.normal;
        result.winding_sign = -side.mirror;
    }
    return result;
}

// The normal that a triangle has in its mesh, turned and scaled.
fn baked_normal(side: Side, number: u32) -> vec3<f32> {
    return side.rotation * direction(vector(record(side, number) + 9u) / side.scale);
}

// The same; of triangles with two sides towards the other body.
fn normal_of(side: Side, number: u32) -> vec3<f32> {
    let normal = baked_normal(side, number);
    if side.sided {
        return normal;
    }
    return select(normal, -normal, faces_away(side, normal, place(side, vector(side.triangles + 9u * number))));
}

fn faces_away(side: Side, normal: vec3<f32>, corner: vec3<f32>) -> bool {
    return !side.sided && dot(normal, side.other_center - corner) < 0.0;
}

// Heights of a triangle's corners over another's plane.
fn heights(of_triangle: Triangle, over: Triangle) -> vec3<f32> {
    return vec3(
        dot(over.normal, of_triangle.corners[0] - over.corners[0]),
        dot(over.normal, of_triangle.corners[1] - over.corners[0]),
        dot(over.normal, of_triangle.corners[2] - over.corners[0]),
    );
}
