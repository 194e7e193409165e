#define_import_path faceoff::patch

// Flat patches: where friction acts between two flat surfaces. The twin of `src/solver/patch.rs`.

#import faceoff::constants::solver::{FLATNESS, INSIDE, MAX_PATCH_POINTS, SAME_NORMAL}
#import faceoff::math::tangent
#import faceoff::solver_math::finite
#import faceoff::solver_types as s

@group(0) @binding(7) var<storage, read_write> point_constants: array<s::PointConstants>;
@group(0) @binding(8) var<storage, read_write> point_states: array<s::PointState>;

// While a patch is examined, the friction offset of each of its points holds its position in the patch's plane and, for
// the corners of the outline, the number of the next corner. So no thread needs memory of its own for 64 points.

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
        for (var k = first; k < end; k += 1u) {
            if is_flat(k) && in_plane(first, k, FLATNESS * pair.diameter) {
                members |= bit(k - pair.first);
                point_states[k].friction_offset = vec3(position_of(first, k), 0.0);
            }
        }
        done |= members;
        let outline = find_outline(pair.first, members);
        let circle = friction_circle(pair.first, outline);
        let normal = point_states[first].normal;
        let first_tangent = tangent(normal);
        let second_tangent = cross(normal, first_tangent);
        if circle.scale >= 0.0 {
            for (var rest = members; any(rest != vec2(0u)); rest = without_lowest(rest)) {
                let k = pair.first + lowest(rest);
                if is_inside(pair.first, outline, planar(k), INSIDE * pair.diameter) {
                    point_states[k].flags &= ~s::POINT_VALID;
                }
            }
        }
        for (var rest = members; any(rest != vec2(0u)); rest = without_lowest(rest)) {
            let k = pair.first + lowest(rest);
            let offset = (max(circle.scale, 0.0) - 1.0) * (planar(k) - circle.center);
            let spread = offset.x * first_tangent + offset.y * second_tangent;
            point_states[k].friction_offset = select(vec3(0.0), spread, circle.scale >= 0.0);
        }
    }
}

// The position of a point in the plane of the patch.
fn planar(k: u32) -> vec2<f32> {
    return point_states[k].friction_offset.xy;
}

fn bit(number: u32) -> vec2<u32> {
    let one = 1u << (number % 32u);
    return select(vec2(one, 0u), vec2(0u, one), number >= 32u);
}

fn has_bit(bits: vec2<u32>, number: u32) -> bool {
    return any((bits & bit(number)) != vec2(0u));
}

// The number of the lowest bit of a set that is not empty.
fn lowest(bits: vec2<u32>) -> u32 {
    return select(32u + countTrailingZeros(bits.y), countTrailingZeros(bits.x), bits.x != 0u);
}

fn without_lowest(bits: vec2<u32>) -> vec2<u32> {
    return bits & ~bit(lowest(bits));
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

// The outline of a patch, counter-clockwise: its first corner, a number within the pair, and its number of corners.
struct Outline {
    start: u32,
    corners: u32,
}

// Links the corners of the convex hull of the points in a set (gift wrapping). `base` is the pair's first point.
fn find_outline(base: u32, members: vec2<u32>) -> Outline {
    var start = lowest(members);
    for (var rest = without_lowest(members); any(rest != vec2(0u)); rest = without_lowest(rest)) {
        let p = planar(base + lowest(rest));
        let q = planar(base + start);
        if p.x < q.x || (p.x == q.x && p.y < q.y) {
            start = lowest(rest);
        }
    }
    let size = countOneBits(members.x) + countOneBits(members.y);
    var corner = start;
    for (var corners = 0u; corners < size; corners += 1u) {
        let at = planar(base + corner);
        var next = corner;
        var q = vec2(0.0);
        for (var rest = members; any(rest != vec2(0u)); rest = without_lowest(rest)) {
            let p = planar(base + lowest(rest)) - at;
            let side = cross_product(q, p);
            if all(q == vec2(0.0)) || side < 0.0 || (side == 0.0 && dot(p, p) > dot(q, q)) {
                next = lowest(rest);
                q = p;
            }
        }
        point_states[base + corner].friction_offset.z = f32(next);
        if all(planar(base + next) == planar(base + start)) {
            point_states[base + corner].friction_offset.z = f32(start);
            return Outline(start, corners + 1u);
        }
        corner = next;
    }
    return Outline(start, size);
}

// The corner after another one.
fn corner_after(base: u32, corner: u32) -> u32 {
    return u32(point_states[base + corner].friction_offset.z);
}

struct FrictionCircle {
    center: vec2<f32>,
    // Distance at which friction acts from the centre, over that of the corners; negative if there is no patch.
    scale: f32,
}

fn friction_circle(base: u32, outline: Outline) -> FrictionCircle {
    let corners = outline.corners;
    if corners < 2u {
        return FrictionCircle(vec2(0.0), -1.0);
    }
    var mean = vec2(0.0);
    var corner = outline.start;
    for (var i = 0u; i < corners; i += 1u) {
        mean += planar(base + corner) / f32(corners);
        corner = corner_after(base, corner);
    }
    var area = 0.0;
    var moment = vec2(0.0);
    corner = outline.start;
    for (var i = 0u; i < corners; i += 1u) {
        let a = planar(base + corner);
        corner = corner_after(base, corner);
        let b = planar(base + corner);
        let double_area = cross_product(a - mean, b - mean);
        area += double_area;
        moment += double_area * (a + b + mean) / 3.0;
    }
    if corners == 2u || !(area > 0.0) {
        // The load of a line: half of its points are nearer than a quarter of its length.
        return FrictionCircle(mean, 0.5);
    }
    let center = moment / area;
    // The mean distance from a corner within a triangle is two thirds of the mean distance to the opposite side, which
    // is found by Simpson's rule.
    var corner_distance = 0.0;
    var distance = 0.0;
    corner = outline.start;
    for (var i = 0u; i < corners; i += 1u) {
        let a = planar(base + corner) - center;
        corner = corner_after(base, corner);
        let b = planar(base + corner) - center;
        corner_distance += length(a) / f32(corners);
        let side = (length(a) + 4.0 * length(0.5 * (a + b)) + length(b)) / 6.0;
        distance += cross_product(a, b) * side * 2.0 / 3.0;
    }
    let scale = distance / (area * corner_distance);
    return FrictionCircle(center, select(-1.0, clamp(scale, 0.0, 1.0), finite(scale)));
}

// Whether a point is farther inside the outline than `distance`.
fn is_inside(base: u32, outline: Outline, position: vec2<f32>, distance: f32) -> bool {
    if outline.corners <= 2u {
        return false;
    }
    var corner = outline.start;
    for (var i = 0u; i < outline.corners; i += 1u) {
        let start = planar(base + corner);
        corner = corner_after(base, corner);
        let side = planar(base + corner) - start;
        if !(cross_product(side, position - start) > distance * length(side)) {
            return false;
        }
    }
    return true;
}
