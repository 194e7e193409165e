#define_import_path faceoff::math

// Functions that WGSL lacks, or whose built-in versions are too inaccurate: its sin, cos and atan2 may have errors of
// 2^-11.

#import faceoff::constants::shared::MAX_SPEED

// A velocity no larger than bodies may have.
fn limited(v: vec3<f32>) -> vec3<f32> {
    return clamp(v, vec3(-MAX_SPEED), vec3(MAX_SPEED));
}

// A velocity after a change, no larger than bodies may have. A change that is no number has no effect.
fn pushed(velocity: vec3<f32>, change: vec3<f32>) -> vec3<f32> {
    let after = velocity + change;
    // Compilers may take it for granted that comparisons find no NaN.
    let is_nan = (bitcast<vec3<u32>>(after) & vec3(0x7fffffffu)) > vec3(0x7f800000u);
    return select(limited(after), velocity, any(is_nan));
}

// Rotates v by the unit quaternion q.
fn rotate(q: vec4<f32>, v: vec3<f32>) -> vec3<f32> {
    let t = 2.0 * cross(q.xyz, v);
    return v + q.w * t + cross(q.xyz, t);
}

fn conjugate(q: vec4<f32>) -> vec4<f32> {
    return vec4(-q.xyz, q.w);
}

// The rotation by q, followed by the rotation by p.
fn compose(p: vec4<f32>, q: vec4<f32>) -> vec4<f32> {
    return vec4(p.w * q.xyz + q.w * p.xyz + cross(p.xyz, q.xyz), p.w * q.w - dot(p.xyz, q.xyz));
}

// The rotation matrix of the unit quaternion q.
fn matrix(q: vec4<f32>) -> mat3x3<f32> {
    let d = q.xyz + q.xyz;
    let xx = q.x * d.x;
    let yy = q.y * d.y;
    let zz = q.z * d.z;
    let xy = q.x * d.y;
    let xz = q.x * d.z;
    let yz = q.y * d.z;
    let wx = q.w * d.x;
    let wy = q.w * d.y;
    let wz = q.w * d.z;
    return mat3x3(
        vec3(1.0 - (yy + zz), xy + wz, xz - wy),
        vec3(xy - wz, 1.0 - (xx + zz), yz + wx),
        vec3(xz + wy, yz - wx, 1.0 - (xx + yy)),
    );
}

fn absolute(m: mat3x3<f32>) -> mat3x3<f32> {
    return mat3x3(abs(m[0]), abs(m[1]), abs(m[2]));
}

fn max_component(v: vec3<f32>) -> f32 {
    return max(v.x, max(v.y, v.z));
}

fn norm1(v: vec3<f32>) -> f32 {
    return abs(v.x) + abs(v.y) + abs(v.z);
}

// v normalised; zero stays zero. It is scaled first, because squares of tiny or huge lengths would leave the range of
// f32.
fn direction(v: vec3<f32>) -> vec3<f32> {
    let size = max_component(abs(v));
    if !(size > 0.0) {
        return vec3(0.0);
    }
    let w = v / size;
    return w / sqrt(dot(w, w));
}

// (sin x, cos x) by Taylor series after reduction to a quarter turn. The error is below 1e-7 while |x| is below some
// thousands.
fn sin_cos(x: f32) -> vec2<f32> {
    let turns = round(x * 0.63661977);
    // pi/2 in three parts.
    let r = ((x - turns * 1.5703125) - turns * 4.837513e-4) - turns * 7.54979e-8;
    let q = r * r;
    let s = r + r * q * (-0.16666667 + q * (0.008333333 + q * (-1.9841270e-4 + q * 2.7557319e-6)));
    let c = 1.0 + q * (-0.5 + q * (0.041666668 + q * (-0.0013888889 + q * (2.4801587e-5 - q * 2.7557319e-7))));
    let quarter = i32(turns) & 3;
    if quarter == 0 {
        return vec2(s, c);
    } else if quarter == 1 {
        return vec2(c, -s);
    } else if quarter == 2 {
        return vec2(-s, -c);
    }
    return vec2(-c, s);
}

// The rotation by the rotation vector w, whose length is the angle in radians.
fn rotation_by(w: vec3<f32>) -> vec4<f32> {
    let size = max_component(abs(w));
    if !(size > 0.0) {
        return vec4(0.0, 0.0, 0.0, 1.0);
    }
    let n = w / size;
    let length = sqrt(dot(n, n));
    let half = sin_cos(0.5 * size * length);
    return vec4(n * (half.x / length), half.y);
}

// The angle of (x, y), with an error below 3e-7. The angle of (0, 0) is 0.
fn angle_of(y: f32, x: f32) -> f32 {
    let ax = abs(x);
    let ay = abs(y);
    let high = max(ax, ay);
    if !(high > 0.0) {
        return 0.0;
    }
    // At most 1; after the reduction at most tan(pi/12), where five terms of the series suffice.
    var t = min(ax, ay) / high;
    var base = 0.0;
    if t > 0.26794919 {
        t = (1.7320508 * t - 1.0) / (1.7320508 + t);
        base = 0.52359878;
    }
    let q = t * t;
    var a = base + t * (1.0 + q * (-0.33333333 + q * (0.2 + q * (-0.14285714 + q * (0.11111111 - q * 0.09090909)))));
    if ay > ax {
        a = 1.5707963 - a;
    }
    if x < 0.0 {
        a = 3.1415927 - a;
    }
    return select(a, -a, y < 0.0);
}

// Whether two colliders may collide, by the memberships and filters of their collision layers.
fn layers_interact(a: vec2<u32>, b: vec2<u32>) -> bool {
    return (a.x & b.y) != 0u && (b.x & a.y) != 0u;
}

// Maps floats to integers in the same order; never 0.
fn ascending(x: f32) -> u32 {
    let bits = bitcast<u32>(x);
    return select(bits | 0x80000000u, ~bits, (bits >> 31u) != 0u);
}

// The inverse of `ascending`.
fn descending(x: u32) -> f32 {
    return bitcast<f32>(select(~x, x ^ 0x80000000u, (x >> 31u) != 0u));
}

// A unit vector perpendicular to the unit vector n, continuous in n (Duff et al., "Building an Orthonormal Basis,
// Revisited", 2017).
fn tangent(n: vec3<f32>) -> vec3<f32> {
    let side = select(1.0, -1.0, n.z < 0.0);
    let a = -1.0 / (side + n.z);
    return vec3(1.0 + side * n.x * n.x * a, side * n.x * n.y * a, -side * n.x);
}

// The power of two that scales a size to between 1 and 2.
fn unit_of(size: f32) -> f32 {
    let exponent = clamp((bitcast<u32>(size) >> 23u) & 255u, 1u, 253u);
    return bitcast<f32>((254u - exponent) << 23u);
}
