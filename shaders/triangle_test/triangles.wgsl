#define_import_path faceoff::triangles

// Triangle-triangle test in single precision with error bounds: Moeller's interval test (1997), where the bounds
// permit. Undecided pairs count as touching unless a separating plane is found. Lengths are in the pair's unit, so that
// products of five of them stay in the range of f32.

#import faceoff::constants::triangle_test::MIN_LINE
#import faceoff::math::{max_component, norm1}

struct Triangle {
    p: vec3<f32>,
    q: vec3<f32>,
    r: vec3<f32>,
    normal: vec3<f32>,
    // Error bound of a height over the plane, times the normal's length, for points of a triangle whose box overlaps
    // this one's.
    tolerance: f32,
}

struct Corners {
    p: vec3<f32>,
    q: vec3<f32>,
    r: vec3<f32>,
}

fn low(c: Corners) -> vec3<f32> {
    return min(c.p, min(c.q, c.r));
}

fn high(c: Corners) -> vec3<f32> {
    return max(c.p, max(c.q, c.r));
}

// Upper bound of the distance between two points of the triangle.
fn reach(c: Corners) -> f32 {
    return norm1(high(c) - low(c));
}

// `error` is the error of a coordinate; `reach` is the sum of both triangles' reaches.
fn triangle(c: Corners, error: f32, reach: f32) -> Triangle {
    let u = c.q - c.p;
    let v = c.r - c.p;
    let normal = cross(u, v);
    return Triangle(c.p, c.q, c.r, normal, 3.0 * error * (norm1(normal) + (norm1(u) + norm1(v)) * reach));
}

// Heights of the corners of `t` over the plane, times the normal's length.
fn heights(plane: Triangle, t: Triangle) -> vec3<f32> {
    return vec3(
        dot(t.p - plane.p, plane.normal),
        dot(t.q - plane.p, plane.normal),
        dot(t.r - plane.p, plane.normal),
    );
}

// Whether `t` is certainly on one side of the plane.
fn beside(plane: Triangle, t: Triangle) -> bool {
    let h = heights(plane, t);
    return all(h > vec3(plane.tolerance)) || all(h < vec3(-plane.tolerance));
}

// The segment in which a triangle crosses the other's plane: two points in order along the common line.
struct Chord {
    low: vec3<f32>,
    low_at: f32,
    high: vec3<f32>,
    high_at: f32,
    // Error bound of the points, besides the error bound of the coordinates.
    error: f32,
}

// The chord of a triangle with corners on both sides of the plane.
fn chord(t: Triangle, h: vec3<f32>, tolerance: f32, line: vec3<f32>) -> Chord {
    let above = h > vec3(0.0);
    // The corner that is alone on its side comes first.
    var p = t.p;
    var q = t.q;
    var r = t.r;
    var hs = h;
    if above.x == above.y {
        p = t.r;
        q = t.p;
        r = t.q;
        hs = h.zxy;
    } else if above.x == above.z {
        p = t.q;
        q = t.p;
        r = t.r;
        hs = h.yxz;
    }
    let to_q = 1.0 / (hs.x - hs.y);
    let to_r = 1.0 / (hs.x - hs.z);
    let x = p + (q - p) * (hs.x * to_q);
    let y = p + (r - p) * (hs.x * to_r);
    let error = 2.0 * tolerance * max(norm1(q - p) * abs(to_q), norm1(r - p) * abs(to_r));
    let at_x = dot(x, line);
    let at_y = dot(y, line);
    if at_x <= at_y {
        return Chord(x, at_x, y, at_y, error);
    }
    return Chord(y, at_y, x, at_x, error);
}

struct Verdict {
    hit: bool,
    // The segment runs along the cross product of both normals. It does not if the triangles are coplanar.
    directed: bool,
    start: vec3<f32>,
    end: vec3<f32>,
}

fn decide(a: Triangle, b: Triangle, error: f32) -> Verdict {
    var miss: Verdict;
    miss.hit = false;
    if beside(a, b) || beside(b, a) {
        return miss;
    }
    let over_b = heights(b, a);
    let over_a = heights(a, b);
    let line = cross(a.normal, b.normal);
    let clear = all(abs(over_b) > vec3(b.tolerance)) && all(abs(over_a) > vec3(a.tolerance));
    let crossing = crosses(over_a) && crosses(over_b) && norm1(line) > MIN_LINE;
    var estimate = miss;
    if crossing {
        let of_a = chord(a, over_b, b.tolerance, line);
        let of_b = chord(b, over_a, a.tolerance, line);
        let overlap = min(of_a.high_at, of_b.high_at) - max(of_a.low_at, of_b.low_at);
        let bound = norm1(line) * (of_a.error + of_b.error + 4.0 * error);
        if clear && overlap < -bound {
            return miss;
        }
        let start = select(of_b.low, of_a.low, of_a.low_at >= of_b.low_at);
        let end = select(of_b.high, of_a.high, of_a.high_at <= of_b.high_at);
        estimate = Verdict(overlap > 0.0, true, start, end);
        if clear && overlap > bound {
            return estimate;
        }
    }
    let verdict = unsure(a, b, error);
    if verdict.hit && estimate.hit {
        return estimate;
    }
    return verdict;
}

// Whether the plane separates the corners.
fn crosses(h: vec3<f32>) -> bool {
    return any(h > vec3(0.0)) && any(h <= vec3(0.0));
}

// Two triangles that are close to touching or to coplanar. If they touch, the segment is one between them.
fn unsure(a: Triangle, b: Triangle, error: f32) -> Verdict {
    var verdict: Verdict;
    verdict.hit = false;
    verdict.directed = false;
    let nearest = nearest_points(a, b);
    verdict.start = nearest.a;
    verdict.end = nearest.b;
    // Any separating direction will do. The normals are tried again: `beside` allows for the error of the plane's
    // normal, but any axis is valid here, whatever its error.
    if apart(a, b, nearest.b - nearest.a, error) || apart(a, b, a.normal, error) || apart(a, b, b.normal, error) {
        return verdict;
    }
    // One loop over all axes: unrolled, each would hold registers for the threads that it has left.
    var axis = 0u;
    while axis < 15u && !apart(a, b, edge_axis(a, b, axis / 5u, axis % 5u), error) {
        axis += 1u;
    }
    verdict.hit = axis == 15u;
    return verdict;
}

// The i-th edge times one of five vectors: the normal of its triangle, an edge of the other one, or the same for the
// second triangle.
fn edge_axis(a: Triangle, b: Triangle, i: u32, k: u32) -> vec3<f32> {
    let of_a = edge(a, i);
    if k == 0u {
        return cross(a.normal, of_a);
    }
    let of_b = edge(b, select(k - 2u, i, k == 1u));
    return cross(select(of_a, b.normal, k == 1u), of_b);
}

fn edge(t: Triangle, i: u32) -> vec3<f32> {
    return select(select(t.p - t.r, t.r - t.q, i == 1u), t.q - t.p, i == 0u);
}

// Whether the axis, of any length, certainly separates the triangles.
fn apart(a: Triangle, b: Triangle, axis: vec3<f32>, error: f32) -> bool {
    let size = max_component(abs(axis));
    if !(size > MIN_LINE) {
        return false;
    }
    let u = axis / size;
    // Relative to a corner of a, for precision.
    let of_a = vec2(dot(a.q - a.p, u), dot(a.r - a.p, u));
    let of_b = vec3(dot(b.p - a.p, u), dot(b.q - a.p, u), dot(b.r - a.p, u));
    let high = max(0.0, max(of_a.x, of_a.y));
    let low = min(0.0, min(of_a.x, of_a.y));
    let gap = max(min(of_b.x, min(of_b.y, of_b.z)) - high, low - max(of_b.x, max(of_b.y, of_b.z)));
    return gap > 2.0 * error * norm1(u);
}

struct Points {
    a: vec3<f32>,
    b: vec3<f32>,
    square: f32,
}

fn closer(best: Points, a: vec3<f32>, b: vec3<f32>) -> Points {
    let d = b - a;
    let square = dot(d, d);
    if square < best.square {
        return Points(a, b, square);
    }
    return best;
}

// Approximately the nearest points of two triangles: good enough for a separating direction.
fn nearest_points(a: Triangle, b: Triangle) -> Points {
    var best = Points(a.p, b.p, 3.0e38);
    var ca = array(a.p, a.q, a.r);
    var cb = array(b.p, b.q, b.r);
    for (var i = 0; i < 3; i += 1) {
        best = closer(best, ca[i], on_triangle(ca[i], b));
        best = closer(best, on_triangle(cb[i], a), cb[i]);
        let pa = ca[i];
        let da = ca[(i + 1) % 3] - pa;
        for (var j = 0; j < 3; j += 1) {
            let pb = cb[j];
            let db = cb[(j + 1) % 3] - pb;
            // Ericson, Real-Time Collision Detection, 5.1.9; from both starts, for nearly parallel edges.
            let w = pa - pb;
            let aa = dot(da, da);
            let bb = dot(db, db);
            let ab = dot(da, db);
            let determinant = aa * bb - ab * ab;
            var s = 0.0;
            if determinant > 0.0 {
                s = clamp((ab * dot(db, w) - bb * dot(da, w)) / determinant, 0.0, 1.0);
            }
            let t = along(pa + da * s - pb, db, bb);
            s = along(pb + db * t - pa, da, aa);
            best = closer(best, pa + da * s, pb + db * t);
        }
    }
    return best;
}

// The parameter on an edge that is nearest to the point at `w` from its start.
fn along(w: vec3<f32>, edge: vec3<f32>, square: f32) -> f32 {
    if square > 0.0 {
        return clamp(dot(w, edge) / square, 0.0, 1.0);
    }
    return 0.0;
}

// The projection of `p` onto the triangle if it is inside; else one of the corners. Edges are handled elsewhere.
fn on_triangle(p: vec3<f32>, t: Triangle) -> vec3<f32> {
    let square = dot(t.normal, t.normal);
    if !(square > 0.0) {
        return t.p;
    }
    let w = p - t.p;
    let u = t.q - t.p;
    let v = t.r - t.p;
    let y = dot(cross(u, w), t.normal) / square;
    let x = dot(cross(w, v), t.normal) / square;
    if x < 0.0 || y < 0.0 || x + y > 1.0 {
        return t.p;
    }
    return t.p + u * x + v * y;
}
