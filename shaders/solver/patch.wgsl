#define_import_path faceoff::patch

// Flat patches: where friction acts between two flat surfaces. The twin of `src/solver/patch.rs`.

#import faceoff::constants::solver::{FLATNESS, INSIDE, MAX_PATCH_POINTS, SAME_NORMAL}
#import faceoff::solver_math::{finite, tangent}
#import faceoff::solver_types as s

@group(0) @binding(7) var<storage, read_write> point_constants: array<s::PointConstants>;
@group(0) @binding(8) var<storage, read_write> point_states: array<s::PointState>;

// Positions of the points of a patch in its plane, and its outline, counter-clockwise.
var<private> positions: array<vec2<f32>, MAX_PATCH_POINTS>;
var<private> outline: array<vec2<f32>, MAX_PATCH_POINTS>;

// Spreads the friction of the flat patches of a pair over their areas. Removes the points inside a patch: the corners
// hold the same load, and how the solver shares it out is arbitrary.
fn spread_friction(pair: s::SolverPair) {
    let end = pair.first + min(pair.count, MAX_PATCH_POINTS);
    // One bit for each point that belongs to a patch.
    var done = vec2(0u);
    for (var first = pair.first; first < end; first += 1u) {
        if has_bit(done, first - pair.first) || !is_flat(first) {
            continue;
        }
        var members = vec2(0u);
        var size = 0u;
        for (var k = first; k < end; k += 1u) {
            if is_flat(k) && in_plane(first, k, FLATNESS * pair.diameter) {
                members |= bit(k - pair.first);
                positions[size] = position_of(first, k);
                size += 1u;
            }
        }
        done |= members;
        let corners = find_outline(size);
        let circle = friction_circle(corners);
        if circle.scale < 0.0 {
            continue;
        }
        let normal = point_states[first].normal;
        let first_tangent = tangent(normal);
        let second_tangent = cross(normal, first_tangent);
        for (var k = first; k < end; k += 1u) {
            if !has_bit(members, k - pair.first) {
                continue;
            }
            let position = position_of(first, k);
            if is_inside(corners, position, INSIDE * pair.diameter) {
                point_states[k].flags &= ~s::POINT_VALID;
            }
            let offset = (circle.scale - 1.0) * (position - circle.center);
            point_states[k].friction_offset = offset.x * first_tangent + offset.y * second_tangent;
        }
    }
}

fn bit(number: u32) -> vec2<u32> {
    let one = 1u << (number % 32u);
    return select(vec2(one, 0u), vec2(0u, one), number >= 32u);
}

fn has_bit(bits: vec2<u32>, number: u32) -> bool {
    return any((bits & bit(number)) != vec2(0u));
}

// Whether both surfaces are flat.
fn is_flat(k: u32) -> bool {
    return (point_states[k].flags & s::POINT_VALID) != 0u
        && point_constants[k].normal_rotation == 0.0
        && all(point_constants[k].anchor_a == point_constants[k].curvature_center_a)
        && all(point_constants[k].anchor_b == point_constants[k].curvature_center_b);
}

// Whether two points and their normals belong to one patch.
fn in_plane(a: u32, b: u32, tolerance: f32) -> bool {
    let normal = point_states[a].normal;
    let height_a = dot(point_constants[b].anchor_a - point_constants[a].anchor_a, normal);
    let height_b = dot(point_constants[b].anchor_b - point_constants[a].anchor_b, normal);
    return dot(normal, point_states[b].normal) > SAME_NORMAL && abs(height_a) < tolerance && abs(height_b) < tolerance;
}

// The position of a point in the plane of another one.
fn position_of(origin: u32, k: u32) -> vec2<f32> {
    let offset = point_constants[k].anchor_a - point_constants[origin].anchor_a;
    let normal = point_states[origin].normal;
    let first_tangent = tangent(normal);
    return vec2(dot(offset, first_tangent), dot(offset, cross(normal, first_tangent)));
}

fn cross_product(a: vec2<f32>, b: vec2<f32>) -> f32 {
    return a.x * b.y - a.y * b.x;
}

// Writes the convex hull of the first `size` positions to `outline`, and returns its number of corners (gift wrapping).
fn find_outline(size: u32) -> u32 {
    var start = positions[0];
    for (var i = 1u; i < size; i += 1u) {
        let p = positions[i];
        if p.x < start.x || (p.x == start.x && p.y < start.y) {
            start = p;
        }
    }
    var corner = start;
    for (var corners = 0u; corners < size; corners += 1u) {
        outline[corners] = corner;
        var next = corner;
        for (var i = 0u; i < size; i += 1u) {
            let p = positions[i] - corner;
            let q = next - corner;
            let side = cross_product(q, p);
            if all(q == vec2(0.0)) || side < 0.0 || (side == 0.0 && dot(p, p) > dot(q, q)) {
                next = positions[i];
            }
        }
        if all(next == start) {
            return corners + 1u;
        }
        corner = next;
    }
    return size;
}

struct FrictionCircle {
    center: vec2<f32>,
    // By which factor friction is nearer to the centre than the corners; negative if there is no patch.
    scale: f32,
}

fn friction_circle(corners: u32) -> FrictionCircle {
    if corners < 2u {
        return FrictionCircle(vec2(0.0), -1.0);
    }
    var mean = vec2(0.0);
    for (var i = 0u; i < corners; i += 1u) {
        mean += outline[i] / f32(corners);
    }
    var area = 0.0;
    var moment = vec2(0.0);
    for (var i = 0u; i < corners; i += 1u) {
        let a = outline[i];
        let b = outline[(i + 1u) % corners];
        let double_area = cross_product(a - mean, b - mean);
        area += double_area;
        moment += double_area * (a + b + mean) / 3.0;
    }
    if corners == 2u || !(area > 0.0) {
        // The load of a line: half of its points are nearer than a quarter of its length.
        return FrictionCircle(mean, 0.5);
    }
    let center = moment / area;
    // The mean distance in a triangle from one corner is two thirds of that of the opposite side, which is found by
    // Simpson's rule.
    var corner_distance = 0.0;
    var distance = 0.0;
    for (var i = 0u; i < corners; i += 1u) {
        let a = outline[i] - center;
        let b = outline[(i + 1u) % corners] - center;
        corner_distance += length(a) / f32(corners);
        let side = (length(a) + 4.0 * length(0.5 * (a + b)) + length(b)) / 6.0;
        distance += cross_product(a, b) * side * 2.0 / 3.0;
    }
    let scale = distance / (area * corner_distance);
    return FrictionCircle(center, select(-1.0, clamp(scale, 0.0, 1.0), finite(scale)));
}

// Whether a point is farther inside the outline than `distance`.
fn is_inside(corners: u32, position: vec2<f32>, distance: f32) -> bool {
    if corners <= 2u {
        return false;
    }
    for (var i = 0u; i < corners; i += 1u) {
        let side = outline[(i + 1u) % corners] - outline[i];
        if !(cross_product(side, position - outline[i]) > distance * length(side)) {
            return false;
        }
    }
    return true;
}
