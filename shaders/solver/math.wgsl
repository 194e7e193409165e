#define_import_path faceoff::solver_math

#import faceoff::constants::solver::COARSE_DIGIT
#import faceoff::math::{compose, rotation_by}

// WGSL compilers may assume that NaN and infinity do not occur, so these functions test the bits.
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

// The displacement of v by the rotation q, without cancellation.
fn rotation_displacement(q: vec4<f32>, v: vec3<f32>) -> vec3<f32> {
    let t = 2.0 * cross(q.xyz, v);
    return q.w * t + cross(q.xyz, t);
}

// q, followed by the rotation vector w in world axes.
fn rotated(w: vec3<f32>, q: vec4<f32>) -> vec4<f32> {
    let rotation_change = compose(rotation_by(w), q);
    let unit = rotation_change / sqrt(dot(rotation_change, rotation_change));
    if finite_rotation(unit) {
        return unit;
    }
    return q;
}

// v, shortened to the length `limit` if it is longer.
fn limited(v: vec3<f32>, limit: f32) -> vec3<f32> {
    let square = dot(v, v);
    if square > limit * limit {
        return v * (limit / sqrt(square));
    }
    return v;
}

// exp(-x); 1 if x is negative. The built-in function is too coarse for a factor that is applied in every substep.
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

// Numbers in two parts, a coarse one and a fine one. The coarse part is a multiple of a digit so large that additions
// to it are exact, except when its magnitude doubles. Compilers cannot optimise this away, as they may the usual
// compensated sums.

// The digit of a coarse part of this magnitude; below one metre always the same.
fn coarse_digit(coarse: vec3<f32>) -> vec3<f32> {
    let power = bitcast<vec3<f32>>(bitcast<vec3<u32>>(coarse) & vec3(EXPONENT));
    return max(power * COARSE_DIGIT, vec3(COARSE_DIGIT));
}

// The multiple of the digit that moves from a fine part to the coarse one.
fn coarse_part(fine: vec3<f32>, digit: vec3<f32>) -> vec3<f32> {
    return round(fine / digit) * digit;
}

fn coarse_rotation(fine: vec4<f32>) -> vec4<f32> {
    return round(fine / COARSE_DIGIT) * COARSE_DIGIT;
}
