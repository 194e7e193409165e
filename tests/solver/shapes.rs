//! Contact points of spheres, boxes and half-spaces.

use bevy_faceoff::manifolds::ManifoldPoint;
use bevy_faceoff::solver::SolverMotion;
use glam::{DQuat, DVec3, Mat3, Vec3};

#[derive(Clone, Copy, Debug)]
pub enum Shape {
    Sphere(f64),
    /// Half extents.
    Box(DVec3),
    /// The half-space below the xz plane of the body's own axes, through its centre.
    Plane,
}

impl Shape {
    pub fn radius(self) -> f32 {
        match self {
            Self::Sphere(r) => r as f32,
            Self::Box(half) => half.length() as f32,
            Self::Plane => f32::INFINITY,
        }
    }

    pub fn thickness(self) -> f32 {
        match self {
            Self::Sphere(r) => 2.0 * r as f32,
            Self::Box(half) => 2.0 * half.min_element() as f32,
            Self::Plane => f32::INFINITY,
        }
    }

    pub fn inertia(self, mass: f32) -> Mat3 {
        match self {
            Self::Sphere(r) => Mat3::from_diagonal(Vec3::splat(0.4 * mass * (r * r) as f32)),
            Self::Box(half) => {
                let q = (half * half).as_vec3() * (mass / 3.0);
                Mat3::from_diagonal(Vec3::new(q.y + q.z, q.x + q.z, q.x + q.y))
            }
            Self::Plane => Mat3::ZERO,
        }
    }
}

/// A contact point in world axes: the points on `a` and on `b`, and the normal from `a` to `b`.
struct Touch {
    on_a: DVec3,
    on_b: DVec3,
    normal: DVec3,
}

/// Contact points whose separation is less than `margin`.
pub fn contact(shapes: [Shape; 2], motions: [&SolverMotion; 2], margin: f64) -> Vec<ManifoldPoint> {
    let [a, b] = motions.map(|m| (m.center, m.rotation));
    let touches = match shapes {
        [Shape::Sphere(r), Shape::Sphere(s)] => sphere_sphere(a.0, r, b.0, s),
        [Shape::Sphere(r), Shape::Plane] => flip(plane_points(b, [a.0], r)),
        [Shape::Plane, Shape::Sphere(r)] => plane_points(a, [b.0], r),
        [Shape::Box(half), Shape::Plane] => flip(plane_points(b, corners(a, half), 0.0)),
        [Shape::Plane, Shape::Box(half)] => plane_points(a, corners(b, half), 0.0),
        [Shape::Box(half), Shape::Sphere(r)] => box_sphere(a, half, b.0, r),
        [Shape::Sphere(r), Shape::Box(half)] => flip(box_sphere(b, half, a.0, r)),
        [Shape::Box(half), Shape::Box(other)] => box_box(a, half, b, other, margin),
        [Shape::Plane, Shape::Plane] => Vec::new(),
    };
    touches
        .iter()
        .map(|t| ManifoldPoint {
            anchors: [(t.on_a - a.0).as_vec3(), (t.on_b - b.0).as_vec3()],
            normal: t.normal.as_vec3().normalize(),
            separation: (t.on_b - t.on_a).dot(t.normal) as f32,
            curvature_radii: round(shapes),
            bulge: 0.0,
            normal_rotation: turn(shapes, t),
            faces: [0, 0],
        })
        .filter(|p| (p.separation as f64) < margin)
        .collect()
}

/// Radii of curvature: that of the ball for balls, 0 for boxes, because their corners touch, and infinity for faces
/// under balls.
fn round(shapes: [Shape; 2]) -> [f32; 2] {
    let [a, b] = shapes;
    let of = |own, other| match (own, other) {
        (Shape::Sphere(r), _) => r as f32,
        (Shape::Plane, _) | (Shape::Box(_), Shape::Sphere(_)) => f32::INFINITY,
        (Shape::Box(_), _) => 0.0,
    };
    [of(a, b), of(b, a)]
}

/// Rotation of the normal, radians per metre: for two balls the inverse of the distance of their centres.
fn turn(shapes: [Shape; 2], touch: &Touch) -> f32 {
    match shapes {
        [Shape::Sphere(a), Shape::Sphere(b)] => (a + b + (touch.on_b - touch.on_a).dot(touch.normal)).recip() as f32,
        _ => 0.0,
    }
}

type Pose = (DVec3, DQuat);

fn flip(touches: Vec<Touch>) -> Vec<Touch> {
    let turn = |t: Touch| Touch {
        on_a: t.on_b,
        on_b: t.on_a,
        normal: -t.normal,
    };
    touches.into_iter().map(turn).collect()
}

fn sphere_sphere(a: DVec3, r: f64, b: DVec3, s: f64) -> Vec<Touch> {
    let normal = (b - a).normalize();
    vec![Touch {
        on_a: a + r * normal,
        on_b: b - s * normal,
        normal,
    }]
}

/// The plane is the first body.
fn plane_points(plane: Pose, points: impl IntoIterator<Item = DVec3>, below: f64) -> Vec<Touch> {
    let normal = plane.1 * DVec3::Y;
    let touch = |p: DVec3| Touch {
        on_a: p - normal * (p - plane.0).dot(normal),
        on_b: p - normal * below,
        normal,
    };
    points.into_iter().map(touch).collect()
}

fn corners((center, rotation): Pose, half: DVec3) -> impl Iterator<Item = DVec3> {
    (0..8).map(move |i| {
        let sign = |bit: i32| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
        center + rotation * (half * DVec3::new(sign(0), sign(1), sign(2)))
    })
}

fn box_sphere((center, rotation): Pose, half: DVec3, sphere: DVec3, r: f64) -> Vec<Touch> {
    let own = rotation.conjugate() * (sphere - center);
    let nearest = own.clamp(-half, half);
    let (nearest, normal) = if nearest == own {
        // The centre is inside: the normal is that of the nearest face.
        let room = half - own.abs();
        let axis = (0..3).min_by(|&i, &j| room[i].total_cmp(&room[j])).unwrap();
        let mut normal = DVec3::ZERO;
        normal[axis] = own[axis].signum();
        let mut on_face = own;
        on_face[axis] = half[axis] * normal[axis];
        (on_face, normal)
    } else {
        (nearest, (own - nearest).normalize())
    };
    let normal = rotation * normal;
    vec![Touch {
        on_a: center + rotation * nearest,
        on_b: sphere - r * normal,
        normal,
    }]
}

/// Separating axis test, then the incident face clipped by the sides of the reference face, or one point for two edges.
fn box_box(a: Pose, half_a: DVec3, b: Pose, half_b: DVec3, margin: f64) -> Vec<Touch> {
    let axes = |p: Pose| [DVec3::X, DVec3::Y, DVec3::Z].map(|v| p.1 * v);
    let (axes_a, axes_b) = (axes(a), axes(b));
    let between = b.0 - a.0;
    let reach = |axes: &[DVec3; 3], half: DVec3, n: DVec3| (0..3).map(|i| half[i] * axes[i].dot(n).abs()).sum::<f64>();
    let gap = |n: DVec3| between.dot(n).abs() - reach(&axes_a, half_a, n) - reach(&axes_b, half_b, n);
    let outward = |n: DVec3| if between.dot(n) < 0.0 { -n } else { n };

    let (mut face, mut face_gap) = ((0, 0), f64::NEG_INFINITY);
    for (body, axes) in [axes_a, axes_b].iter().enumerate() {
        for (i, &n) in axes.iter().enumerate() {
            // The first body's faces are preferred, so that the choice does not flicker.
            if gap(n) > face_gap + 1.0e-4 {
                (face, face_gap) = ((body, i), gap(n));
            }
        }
    }
    let mut edge = None;
    for (i, u) in axes_a.iter().enumerate() {
        for (j, v) in axes_b.iter().enumerate() {
            let Some(n) = u.cross(*v).try_normalize().filter(|_| u.cross(*v).length() > 0.05) else {
                continue;
            };
            if gap(n) > face_gap.max(edge.map_or(f64::NEG_INFINITY, |(_, g, _)| g)) + 1.0e-3 {
                edge = Some(((i, j), gap(n), outward(n)));
            }
        }
    }
    if face_gap > margin {
        return Vec::new();
    }
    if let Some(((i, j), _, n)) = edge {
        let support = |axes: &[DVec3; 3], half: DVec3, n: DVec3, skip: usize| {
            (0..3)
                .filter(|&k| k != skip)
                .map(|k| axes[k] * half[k] * axes[k].dot(n).signum())
                .sum::<DVec3>()
        };
        let (p, q) = (
            a.0 + support(&axes_a, half_a, n, i),
            b.0 + support(&axes_b, half_b, -n, j),
        );
        let (u, v, w) = (axes_a[i], axes_b[j], p - q);
        let (uv, uw, vw) = (u.dot(v), u.dot(w), v.dot(w));
        let s = (uv * vw - uw) / (1.0 - uv * uv);
        let t = (vw - uv * uw) / (1.0 - uv * uv);
        return vec![Touch {
            on_a: p + u * s,
            on_b: q + v * t,
            normal: n,
        }];
    }
    let ((reference, half_r, axes_r), (incident, half_i, axes_i)) = if face.0 == 0 {
        ((a, half_a, axes_a), (b, half_b, axes_b))
    } else {
        ((b, half_b, axes_b), (a, half_a, axes_a))
    };
    let towards = incident.0 - reference.0;
    let n = axes_r[face.1] * axes_r[face.1].dot(towards).signum();
    let k = (0..3)
        .max_by(|&i, &j| axes_i[i].dot(n).abs().total_cmp(&axes_i[j].dot(n).abs()))
        .unwrap();
    let (u, v) = ((k + 1) % 3, (k + 2) % 3);
    let middle = incident.0 - axes_i[k] * half_i[k] * axes_i[k].dot(n).signum();
    let mut polygon: Vec<DVec3> = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)]
        .map(|(s, t)| middle + axes_i[u] * half_i[u] * s + axes_i[v] * half_i[v] * t)
        .into();
    for side in [(face.1 + 1) % 3, (face.1 + 2) % 3] {
        for sign in [1.0, -1.0] {
            let over = |p: DVec3| sign * (p - reference.0).dot(axes_r[side]) - half_r[side];
            let mut clipped = Vec::new();
            for i in 0..polygon.len() {
                let (p, q) = (polygon[i], polygon[(i + 1) % polygon.len()]);
                let (d, e) = (over(p), over(q));
                if d <= 0.0 {
                    clipped.push(p);
                }
                if d * e < 0.0 {
                    clipped.push(p + (q - p) * (d / (d - e)));
                }
            }
            polygon = clipped;
        }
    }
    let touches = polygon
        .into_iter()
        .map(|p| {
            let height = (p - reference.0).dot(n) - half_r[face.1];
            Touch {
                on_a: p - n * height,
                on_b: p,
                normal: n,
            }
        })
        .collect();
    if face.0 == 0 { touches } else { flip(touches) }
}
