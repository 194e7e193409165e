#define_import_path faceoff::smooth

// Contact on the smooth surface that a fine mesh approximates. The twin of `src/manifolds/cpu/smooth.rs`.

#import faceoff::arena::{words, vector}
#import faceoff::constants::manifolds::{MIN_ROLL, MIN_TURN, SMOOTH, SMOOTH_PAIR}
#import faceoff::math::direction
#import faceoff::sides
#import faceoff::types as t

// The role of a vertex in a contact with a certain normal: a corner, which touches itself and rotates with the body; a
// vertex of a smooth surface that touches nearer to other vertices; or a vertex around which the surface touches.
const SHARP: u32 = 0u;
const ELSEWHERE: u32 = 1u;
const ROUND: u32 = 2u;

// The contact of the smooth surfaces at a feature.
struct Smoothed {
    // Unit vector from the first body to the second.
    normal: vec3<f32>,
    // Rotation of the normal per distance that the surfaces slide along each other.
    normal_rotation: f32,
    // Offset of each body's point, perpendicular to the normal, to where its smooth surface touches.
    slide_a: vec3<f32>,
    // How far each smooth surface lies beyond the body's point there, along its outward normal.
    bulge_a: f32,
    slide_b: vec3<f32>,
    bulge_b: f32,
    // Radii of curvature, along the direction in which the bodies roll where they are smooth.
    radius_a: f32,
    radius_b: f32,
    // The vertex from which the feature was derived stands for a smooth surface that touches elsewhere.
    elsewhere: bool,
}

// Where the smooth surface around a vertex touches.
struct VertexContact {
    // Offset from the vertex, perpendicular to the contact normal.
    slide: vec3<f32>,
    // How far it lies beyond the vertex, along the contact normal.
    bulge: f32,
    // Radius of curvature in the direction in which the body rolls.
    radius: f32,
    state: u32,
}

// The sphere that a surface approximates near a feature.
struct Sphere {
    center: vec3<f32>,
    // Negative if the facets are too coarse to stand for their sphere.
    radius: f32,
    // The outward normal of the smooth surface at the point of the feature.
    normal: vec3<f32>,
}

// The contact at a feature, for the radii of curvature of the faces there. The second body rotates with `spin` relative
// to the first.
fn smoothed(a: sides::Side, b: sides::Side, feature: t::Feature, face_radii: vec2<f32>, spin: vec3<f32>) -> Smoothed {
    var result: Smoothed;
    result.normal = feature.normal;
    result.radius_a = face_radii.x;
    result.radius_b = face_radii.y;
    let radius_a = sides::max_curvature_radius_at(a, feature.a, feature.origin);
    let radius_b = sides::max_curvature_radius_at(b, feature.b, feature.origin);
    if radius_a < t::FLAT_RADIUS && radius_b < t::FLAT_RADIUS {
        // Surfaces that are convex in all directions touch on the line between their centres of curvature.
        let sphere_a = sphere_at(a, feature.a, feature.point_a, feature.normal, radius_a);
        let sphere_b = sphere_at(b, feature.b, feature.point_b, -feature.normal, radius_b);
        // The smooth normals at two points differ by at most the angle of two facets.
        let least = 1.0 - 2.0 * SMOOTH_PAIR * SMOOTH_PAIR;
        let way = sphere_b.center - sphere_a.center;
        if dot(sphere_a.normal, feature.normal) >= least && -dot(sphere_b.normal, feature.normal) >= least
            && dot(way, way) > 0.0 {
            let normal = direction(way);
            result.normal = normal;
            result.normal_rotation = 1.0 / length(way);
            let from_a = feature.point_a - sphere_a.center;
            let from_b = feature.point_b - sphere_b.center;
            let height_a = dot(from_a, normal);
            let height_b = -dot(from_b, normal);
            result.slide_a = normal * height_a - from_a;
            result.slide_b = -normal * height_b - from_b;
            if sphere_a.radius >= 0.0 {
                result.radius_a = sphere_a.radius;
                result.bulge_a = sphere_a.radius - height_a;
            }
            if sphere_b.radius >= 0.0 {
                result.radius_b = sphere_b.radius;
                result.bulge_b = sphere_b.radius - height_b;
            }
            return result;
        }
    }
    // Overlapping features have other things in the word of the origin.
    let is_of_vertices = (feature.origin & t::ORIGIN_MASK) == t::OF_VERTICES && feature.separation >= 0.0;
    let apart = distance(feature.point_a, feature.point_b);
    if is_of_vertices && sides::rounding(a, b) > 0.0 && apart > 0.0 {
        // Rounded vertices are balls.
        result.normal_rotation = 1.0 / apart;
    }
    if feature.vertex == t::NOTHING {
        return result;
    }
    let number = feature.vertex & ~t::OF_SECOND;
    let is_first = (feature.vertex & t::OF_SECOND) == 0u;
    var contact: VertexContact;
    if is_first {
        contact = vertex_contact(sides::smooth_vertex(a.features, number), a.rotation, a.scale, feature.normal, spin);
    } else {
        contact = vertex_contact(sides::smooth_vertex(b.features, number), b.rotation, b.scale, -feature.normal, spin);
    }
    result.elsewhere = contact.state == ELSEWHERE;
    // Both points move along the other body's face.
    result.slide_a = contact.slide;
    result.slide_b = contact.slide;
    if is_first {
        result.bulge_a = contact.bulge;
        result.radius_a = contact.radius;
    } else {
        result.bulge_b = contact.bulge;
        result.radius_b = contact.radius;
    }
    return result;
}

// The contact of the smooth surface around a vertex with the outward normal `out`. The words of its roundness begin at
// `at`; `rotation` and `scale` place it. The body rotates with `spin` relative to the other.
fn vertex_contact(
    at: u32,
    rotation: mat3x3<f32>,
    scale: vec3<f32>,
    out: vec3<f32>,
    spin: vec3<f32>,
) -> VertexContact {
    var result: VertexContact;
    result.state = SHARP;
    let own_reach = bitcast<f32>(words[at + 9u]);
    if own_reach == 0.0 {
        return result;
    }
    let reach = abs(own_reach) * (abs(scale.x) + abs(scale.y) + abs(scale.z)) / 3.0;
    var normal = vec3(0.0);
    var radii: mat3x3<f32>;
    if own_reach > 0.0 {
        normal = surface_normal(at, rotation, scale);
        radii = surface_radii(at, rotation, scale);
    } else {
        let along = rotation * (scale * vector(at + 3u));
        let square = dot(along, along);
        let tangent = along / sqrt(square);
        let bend = rotation * (scale * vector(at + 6u)) / square;
        normal = direction(out - tangent * dot(out, tangent));
        // The curvature is perpendicular to the rim, as the normal is.
        let towards = -dot(bend, normal);
        // Seen from there, the rim is no rounder than a straight edge.
        if !(towards * reach > MIN_TURN) {
            return result;
        }
        let along_rim = tangent / towards;
        radii = mat3x3(along_rim * tangent.x, along_rim * tangent.y, along_rim * tangent.z);
    }
    let cosine = dot(normal, out);
    // The surface has the normal `out` this way along it, and falls by its curvature meanwhile.
    let turn = out - normal * cosine;
    let way = radii * turn;
    let along = dot(way, turn);
    if cosine <= 0.0 || dot(turn, turn) > SMOOTH * SMOOTH || dot(way, way) > reach * reach {
        // Where it is flat in the direction in which it leans, it does not roll on to other vertices.
        if cosine > 0.0 && along > 0.5 * length(way) * length(turn) {
            result.state = ELSEWHERE;
        }
        return result;
    }
    result.state = ROUND;
    result.bulge = along / (1.0 + cosine);
    result.slide = way - normal * result.bulge - out * result.bulge;
    let across = cross(spin, out);
    let square = dot(across, across);
    var rolling = orthogonal(out);
    if square > MIN_ROLL * dot(spin, spin) && square > 0.0 {
        rolling = direction(across);
    }
    // Along the surface at the vertex, which leans.
    rolling -= normal * dot(rolling, normal);
    result.radius = dot(rolling, radii * rolling) / dot(rolling, rolling);
    return result;
}

// The normal of a surface at a vertex, a unit vector.
fn surface_normal(at: u32, rotation: mat3x3<f32>, scale: vec3<f32>) -> vec3<f32> {
    return rotation * direction(vector(at) / scale);
}

// The radii of curvature of a surface at a vertex, as a matrix.
fn surface_radii(at: u32, rotation: mat3x3<f32>, scale: vec3<f32>) -> mat3x3<f32> {
    let first = vector(at + 3u);
    let last = vector(at + 6u);
    // The curvature is a quadratic form on tangents, over the length of the transformed normal.
    let stretch = length(vector(at) / scale);
    let x = vec3(first.x, first.y, first.z) * scale * (scale.x * stretch);
    let y = vec3(first.y, last.x, last.y) * scale * (scale.y * stretch);
    let z = vec3(first.z, last.y, last.z) * scale * (scale.z * stretch);
    return rotation * mat3x3(x, y, z) * transpose(rotation);
}

// A unit vector perpendicular to one.
fn orthogonal(v: vec3<f32>) -> vec3<f32> {
    // Duff et al., "Building an Orthonormal Basis, Revisited", 2017.
    let sign = select(1.0, -1.0, v.z < 0.0);
    let a = -1.0 / (sign + v.z);
    return vec3(v.x * v.y * a, sign + v.y * v.y * a, -v.y);
}

// The sphere of a surface at a point of a triangle. A coarse surface has the sphere of this radius through the point;
// a point of radius 0 has the outward normal `out`.
fn sphere_at(side: sides::Side, triangle: u32, at: vec3<f32>, out: vec3<f32>, radius: f32) -> Sphere {
    if radius == 0.0 {
        return Sphere(at, 0.0, out);
    }
    let numbers = sides::vertices(side, triangle);
    let corners = mat3x3(
        sides::vertex(side, numbers.x) - at,
        sides::vertex(side, numbers.y) - at,
        sides::vertex(side, numbers.z) - at,
    );
    // The barycentric coordinates of the point, or of what is nearest to it.
    let whole = direction(cross(corners[1] - corners[0], corners[2] - corners[0]));
    var weights = max(
        vec3(
            dot(cross(corners[1], corners[2]), whole),
            dot(cross(corners[2], corners[0]), whole),
            dot(cross(corners[0], corners[1]), whole),
        ),
        vec3(0.0),
    );
    let sum = weights.x + weights.y + weights.z;
    weights = select(vec3(1.0 / 3.0), weights / sum, sum > 0.0);
    var result: Sphere;
    var normals = vec3(0.0);
    var centers = vec3(0.0);
    for (var k = 0u; k < 3u; k += 1u) {
        let place = sides::smooth_vertex(side.features, numbers[k]);
        let normal = surface_normal(place, side.rotation, side.scale);
        normals += normal * weights[k];
        if bitcast<f32>(words[place + 9u]) > 0.0 {
            let radii = surface_radii(place, side.rotation, side.scale);
            let own = 0.5 * (radii[0].x + radii[1].y + radii[2].z);
            centers += weights[k] * (corners[k] - normal * own);
            result.radius += weights[k] * own;
        } else {
            result.radius = -t::FLAT_RADIUS;
        }
    }
    result.normal = direction(normals);
    result.center = at + select(-result.normal * radius, centers, result.radius >= 0.0);
    return result;
}
