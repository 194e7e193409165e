#define_import_path faceoff::closest

// Nearest points of triangles.

// The point of a triangle nearest to p (Ericson 2005, Real-Time Collision Detection, 5.1.5).
fn closest(p: vec3<f32>, a: vec3<f32>, b: vec3<f32>, c: vec3<f32>) -> vec3<f32> {
    let ab = b - a;
    let ac = c - a;
    let ab_at_a = dot(ab, p - a);
    let ac_at_a = dot(ac, p - a);
    if ab_at_a <= 0.0 && ac_at_a <= 0.0 {
        return a;
    }
    let ab_at_b = dot(ab, p - b);
    let ac_at_b = dot(ac, p - b);
    if ab_at_b >= 0.0 && ac_at_b <= ab_at_b {
        return b;
    }
    let ab_at_c = dot(ab, p - c);
    let ac_at_c = dot(ac, p - c);
    if ac_at_c >= 0.0 && ab_at_c <= ac_at_c {
        return c;
    }
    let va = ab_at_b * ac_at_c - ab_at_c * ac_at_b;
    let vb = ab_at_c * ac_at_a - ab_at_a * ac_at_c;
    let vc = ab_at_a * ac_at_b - ab_at_b * ac_at_a;
    // A segment has no area but what rounding gives it.
    if all(b == c) || (vc <= 0.0 && ab_at_a >= 0.0 && ab_at_b <= 0.0) {
        // Welded corners leave an edge of zero length.
        return a + ab * (ab_at_a / max(ab_at_a - ab_at_b, 1.0e-30));
    }
    if vb <= 0.0 && ac_at_a >= 0.0 && ac_at_c <= 0.0 {
        return a + ac * (ac_at_a / (ac_at_a - ac_at_c));
    }
    let to_c = ac_at_b - ab_at_b;
    let to_b = ab_at_c - ac_at_c;
    if va <= 0.0 && to_c >= 0.0 && to_b >= 0.0 {
        return b + (c - b) * (to_c / (to_c + to_b));
    }
    return a + (ab * vb + ac * vc) / (va + vb + vc);
}

// Two points, one of each of two triangles.
struct Nearest {
    p: vec3<f32>,
    q: vec3<f32>,
    // The square of their distance.
    square: f32,
}

// The nearest points of two triangles, given by their corners, that do not cross.
fn of_triangles(first: mat3x3<f32>, second: mat3x3<f32>) -> Nearest {
    var a = first;
    var b = second;
    var best = Nearest(a[0], b[0], 3.0e38);
    for (var k = 0u; k < 3u; k += 1u) {
        best = nearer(best, a[k], closest(a[k], b[0], b[1], b[2]));
        best = nearer(best, closest(b[k], a[0], a[1], a[2]), b[k]);
        for (var l = 0u; l < 3u; l += 1u) {
            best = of_segments(best, a[k], a[(k + 1u) % 3u], b[l], b[(l + 1u) % 3u]);
        }
    }
    return best;
}

fn nearer(best: Nearest, p: vec3<f32>, q: vec3<f32>) -> Nearest {
    let way = q - p;
    let square = dot(way, way);
    if square < best.square {
        return Nearest(p, q, square);
    }
    return best;
}

// Two points of two segments, if they are nearer (Ericson 2005, 5.1.9).
fn of_segments(best: Nearest, p: vec3<f32>, p_end: vec3<f32>, q: vec3<f32>, q_end: vec3<f32>) -> Nearest {
    let u = p_end - p;
    let v = q_end - q;
    let way = p - q;
    let a = dot(u, u);
    let e = dot(v, v);
    let b = dot(u, v);
    let c = dot(u, way);
    let f = dot(v, way);
    let s = part(b * f - c * e, a * e - b * b);
    let t = part(b * s + f, e);
    // The nearest point of the first segment to the one found on the second.
    return nearer(best, p + u * part(b * t - c, a), q + v * t);
}

// A part of a whole, from 0 to 1.
fn part(x: f32, of_whole: f32) -> f32 {
    if of_whole > 0.0 {
        return clamp(x / of_whole, 0.0, 1.0);
    }
    return 0.0;
}
