#define_import_path faceoff::solver_math

#import faceoff::constants::solver::COARSE_DIGIT
#import faceoff::math::{compose, rotation_by}

// WGSL may take for granted that there are neither NaN nor infinities: only the bits tell.
const EXPONENT: u32 = 0x7f800000u;

fn finite(x: f32) -> bool {
    return (bitcast<u32>(x) & EXPONENT) != EXPONENT;
}

fn finite_vector(v: vec3<f32>) -> bool {
    return all((bitcast<vec3<u32>>(v) & vec3(EXPONENT)) != vec3(EXPONENT));
}

fn finite_rotation(q: vec4<f32>) -> bool {
    return all((bitcast<vec4<u32>>(q) & vec4(EXPONENT)) != vec4(EXPONENT));
}

// A unit vector across the unit vector n, always the same (Duff et al., "Building an Orthonormal Basis, Revisited", 2017).
fn tangent(n: vec3<f32>) -> vec3<f32> {
    let side = select(1.0, -1.0, n.z < 0.0);
    let a = -1.0 / (side + n.z);
    return vec3(1.0 + side * n.x * n.x * a, side * n.x * n.y * a, -side * n.x);
}

// q turns v: by how much it changes, without the rounding of either.
fn rotation_displacement(q: vec4<f32>, v: vec3<f32>) -> vec3<f32> {
    let t = 2.0 * cross(q.xyz, v);
    return q.w * t + cross(q.xyz, t);
}

// q, turned on by the angle vector w in world axes.
fn rotated(w: vec3<f32>, q: vec4<f32>) -> vec4<f32> {
    let rotation_change = compose(rotation_by(w), q);
    let unit = rotation_change / sqrt(dot(rotation_change, rotation_change));
    if finite_rotation(unit) {
        return unit;
    }
    return q;
}

// v, or a vector along it of length `limit` if it is longer.
fn limited(v: vec3<f32>, limit: f32) -> vec3<f32> {
    let square = dot(v, v);
    if square > limit * limit {
        return v * (limit / sqrt(square));
    }
    return v;
}

// exp(-x) for an x that is not negative; 1 for others. WGSL's own is too coarse to be taken once a substep.
fn decay(x: f32) -> f32 {
    if !(x > 0.0) {
        return 1.0;
    }
    var part = x;
    var halvings = 0u;
    while part > 0.5 && halvings < 8u {
        part *= 0.5;
        halvings += 1u;
    }
    if part > 0.5 {
        return 0.0;
    }
    var result = 1.0;
    for (var k = 8.0; k > 0.0; k -= 1.0) {
        result = 1.0 - result * part / k;
    }
    for (var k = 0u; k < halvings; k += 1u) {
        result *= result;
    }
    return result;
}

// Numbers in two parts. The coarse one has so few digits that what is carried to it arrives unrounded, but for once in a
// doubling of its size; no compiler can take that for zero, as it may with the usual sums of what rounding has lost.

// The digit of a coarse part of this size; below a metre always the same.
fn coarse_digit(coarse: vec3<f32>) -> vec3<f32> {
    let power = bitcast<vec3<f32>>(bitcast<vec3<u32>>(coarse) & vec3(EXPONENT));
    return max(power * COARSE_DIGIT, vec3(COARSE_DIGIT));
}

// What a fine part of this size should hand over.
fn coarse_part(fine: vec3<f32>, digit: vec3<f32>) -> vec3<f32> {
    return round(fine / digit) * digit;
}

fn coarse_rotation(fine: vec4<f32>) -> vec4<f32> {
    return round(fine / COARSE_DIGIT) * COARSE_DIGIT;
}
