//! Distances of moving meshes, by brute force in double precision. It shares no code with the product.

use glam::{DMat3, DVec3};

pub type Triangle = [DVec3; 3];

/// A moving mesh. Corners are relative to the centre of mass at the start, already scaled and rotated.
#[derive(Clone)]
pub struct MovingMesh {
    pub triangles: Vec<Triangle>,
    pub center: DVec3,
    pub travel: DVec3,
    pub turn: DVec3,
}

impl MovingMesh {
    /// Its triangles at time `t`, relative to `origin`.
    pub fn at(&self, t: f64, origin: DVec3) -> Vec<Triangle> {
        let turn = rotation(self.turn * t);
        let center = (self.center - origin) + self.travel * t;
        self.triangles
            .iter()
            .map(|triangle| triangle.map(|p| center + turn * p))
            .collect()
    }
}

/// The matrix of a rotation vector, by Rodrigues' formula.
fn rotation(turn: DVec3) -> DMat3 {
    let angle = turn.length();
    if angle == 0.0 {
        return DMat3::IDENTITY;
    }
    let [x, y, z] = (turn / angle).to_array();
    let k = DMat3::from_cols(DVec3::new(0.0, z, -y), DVec3::new(-z, 0.0, x), DVec3::new(y, -x, 0.0));
    DMat3::IDENTITY + k * angle.sin() + k * k * (1.0 - angle.cos())
}

/// The distance of two moving_meshes at time `t`, at most `most`.
pub fn distance(moving_meshes: &[MovingMesh; 2], t: f64, most: f64) -> f64 {
    let origin = moving_meshes[0].center;
    let [a, b] = [0, 1].map(|i| moving_meshes[i].at(t, origin));
    let round = |triangle: &Triangle| {
        let center = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
        let radius = triangle.iter().map(|p| p.distance(center)).fold(0.0, f64::max);
        (center, radius)
    };
    // Triangles that do not reach this sphere around the first body are farther away than `most`.
    let center = moving_meshes[0].travel * t;
    let radius = a.iter().flatten().map(|p| p.distance(center)).fold(0.0, f64::max);
    let b: Vec<(Triangle, (DVec3, f64))> = b
        .iter()
        .map(|triangle| (*triangle, round(triangle)))
        .filter(|(_, (middle, reach))| middle.distance(center) < radius + reach + most)
        .collect();
    let mut least = most;
    for triangle in &a {
        if b.is_empty() {
            break;
        }
        let (center, radius) = round(triangle);
        for (other, (middle, reach)) in &b {
            if center.distance(*middle) - radius - reach < least {
                least = least.min(triangles(triangle, other));
            }
        }
    }
    least
}

/// The first of `samples` times, evenly from 0 to `end`, at which the moving_meshes are nearer than `target_distance`.
pub fn first_near(moving_meshes: &[MovingMesh; 2], target_distance: f64, samples: usize, end: f64) -> Option<f64> {
    (0..=samples)
        .map(|i| end * i as f64 / samples as f64)
        .find(|&t| distance(moving_meshes, t, target_distance) < target_distance)
}

/// The distance of two triangles.
fn triangles(a: &Triangle, b: &Triangle) -> f64 {
    if pierced(a, b) || pierced(b, a) {
        return 0.0;
    }
    let corners = a
        .iter()
        .map(|p| to_triangle(*p, b))
        .chain(b.iter().map(|p| to_triangle(*p, a)));
    let edges = sides(a).into_iter().flat_map(|u| sides(b).map(|v| segments(u, v)));
    corners.chain(edges).fold(f64::INFINITY, f64::min)
}

fn sides(t: &Triangle) -> [[DVec3; 2]; 3] {
    [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]]
}

/// Whether a side of `other` passes through `t`, by the signs of volumes.
fn pierced(t: &Triangle, other: &Triangle) -> bool {
    let volume = |p: DVec3, q: DVec3, r: DVec3, s: DVec3| (q - p).cross(r - p).dot(s - p);
    sides(other).iter().any(|[from, to]| {
        let ends = [volume(t[0], t[1], t[2], *from), volume(t[0], t[1], t[2], *to)];
        let around = sides(t).map(|[p, q]| volume(*from, *to, p, q));
        ends[0] * ends[1] < 0.0 && (around.iter().all(|v| *v > 0.0) || around.iter().all(|v| *v < 0.0))
    })
}

fn to_triangle(p: DVec3, t: &Triangle) -> f64 {
    let (u, v, w) = (t[1] - t[0], t[2] - t[0], p - t[0]);
    let (uu, uv, vv, wu, wv) = (u.dot(u), u.dot(v), v.dot(v), w.dot(u), w.dot(v));
    let det = uu * vv - uv * uv;
    let (s, r) = ((vv * wu - uv * wv) / det, (uu * wv - uv * wu) / det);
    if s >= 0.0 && r >= 0.0 && s + r <= 1.0 {
        return (w - u * s - v * r).length();
    }
    let to_sides = sides(t).map(|side| to_segment(p, side));
    to_sides.into_iter().fold(f64::INFINITY, f64::min)
}

fn to_segment(p: DVec3, [from, to]: [DVec3; 2]) -> f64 {
    let way = to - from;
    let part = ((p - from).dot(way) / way.dot(way)).clamp(0.0, 1.0);
    p.distance(from + way * part)
}

/// The distance of two segments: that of their lines if the nearest points are within both, otherwise that of an end
/// point.
fn segments(a: [DVec3; 2], b: [DVec3; 2]) -> f64 {
    let ends = [
        to_segment(a[0], b),
        to_segment(a[1], b),
        to_segment(b[0], a),
        to_segment(b[1], a),
    ];
    let least = ends.into_iter().fold(f64::INFINITY, f64::min);
    let (u, v, w) = (a[1] - a[0], b[1] - b[0], b[0] - a[0]);
    let across = u.cross(v);
    let squared = across.length_squared();
    let (s, t) = (w.cross(v).dot(across) / squared, w.cross(u).dot(across) / squared);
    if (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
        least.min((w.dot(across) / squared.sqrt()).abs())
    } else {
        least
    }
}
