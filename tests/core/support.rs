//! Meshes, random poses and brute force for the tests of queries.

use bevy_faceoff::geometry::{TriMesh, shapes};
use glam::{DMat3, DQuat, DVec3, Vec3};

/// A surface with hills, open.
pub fn hills(cells: usize) -> TriMesh {
    let point = |i: usize| {
        let [x, z] = [i % (cells + 1), i / (cells + 1)].map(|k| k as f32 / cells as f32 * 20.0 - 10.0);
        Vec3::new(x, (0.9 * x).sin() + (0.7 * z).cos(), z)
    };
    let vertices = (0..(cells + 1) * (cells + 1)).map(point).collect();
    let corner = |x: usize, z: usize| (z * (cells + 1) + x) as u32;
    let cell = |i: usize| {
        let (x, z) = (i % cells, i / cells);
        let [a, b, c, d] = [corner(x, z), corner(x, z + 1), corner(x + 1, z + 1), corner(x + 1, z)];
        [[a, b, c], [a, c, d]]
    };
    TriMesh::new(vertices, (0..cells * cells).flat_map(cell).collect()).unwrap()
}

/// Faces of both windings.
pub fn mixed() -> TriMesh {
    let torus = shapes::torus_240();
    let turned = |(i, t): (usize, &[u32; 3])| if i % 3 == 0 { [t[0], t[2], t[1]] } else { *t };
    let triangles = torus.triangles().iter().enumerate().map(turned).collect();
    TriMesh::new(torus.vertices().to_vec(), triangles).unwrap()
}

/// Half of a torus, open.
pub fn open_torus() -> TriMesh {
    let torus = shapes::torus_240();
    let triangles = torus.triangles().iter().copied().take(120).collect();
    TriMesh::new(torus.vertices().to_vec(), triangles).unwrap()
}

/// A cube whose faces point inward.
pub fn room(edge: f64) -> TriMesh {
    let cube = shapes::cube(edge);
    let triangles = cube.triangles().iter().map(|t| [t[0], t[2], t[1]]).collect();
    TriMesh::new(cube.vertices().to_vec(), triangles).unwrap()
}

pub struct Random(pub fastrand::Rng);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(fastrand::Rng::with_seed(seed))
    }

    pub fn unit(&mut self) -> f64 {
        2.0 * self.0.f64() - 1.0
    }

    pub fn vector(&mut self) -> DVec3 {
        DVec3::new(self.unit(), self.unit(), self.unit())
    }

    pub fn direction(&mut self) -> DVec3 {
        loop {
            let v = self.vector();
            if v.length_squared() > 0.01 && v.length_squared() < 1.0 {
                return v.normalize();
            }
        }
    }

    pub fn rotation(&mut self) -> DQuat {
        DQuat::from_rotation_x(3.0 * self.unit())
            * DQuat::from_rotation_y(3.0 * self.unit())
            * DQuat::from_rotation_z(3.0 * self.unit())
    }

    /// A uniform scale of 1, unequal ones, and mirrored ones.
    pub fn scale(&mut self) -> Vec3 {
        match self.0.u8(0..4) {
            0 => Vec3::new(0.3, 1.7, 1.0),
            1 => Vec3::new(-0.3, 1.7, 1.0),
            _ => Vec3::ONE,
        }
    }
}

#[derive(Clone, Copy)]
pub struct Pose {
    pub translation: DVec3,
    pub rotation: DQuat,
    pub scale: Vec3,
}

/// The triangles of a placed mesh, relative to `origin`, in the order of the faces.
pub fn triangles(mesh: &TriMesh, pose: &Pose, origin: DVec3) -> Vec<[DVec3; 3]> {
    let axes = DMat3::from_quat(pose.rotation.normalize());
    let place = |p: Vec3| axes * (pose.scale.as_dvec3() * p.as_dvec3()) + (pose.translation - origin);
    (0..mesh.triangles().len())
        .map(|t| mesh.corners(t).map(place))
        .collect()
}

/// The point of a segment nearest to `p`.
pub fn nearest_on_segment(p: DVec3, a: DVec3, b: DVec3) -> DVec3 {
    let way = b - a;
    a + way * ((p - a).dot(way) / way.length_squared()).clamp(0.0, 1.0)
}

/// The point of a triangle nearest to `p`: its foot on the plane if that is inside, else on the nearest edge.
pub fn nearest_on_triangle(p: DVec3, t: &[DVec3; 3]) -> DVec3 {
    let normal = (t[1] - t[0]).cross(t[2] - t[0]).normalize();
    let foot = p - normal * normal.dot(p - t[0]);
    let is_inside = (0..3).all(|k| normal.dot((t[(k + 1) % 3] - t[k]).cross(foot - t[k])) >= 0.0);
    if is_inside {
        return foot;
    }
    let edges = (0..3).map(|k| nearest_on_segment(p, t[k], t[(k + 1) % 3]));
    edges
        .min_by(|a, b| a.distance_squared(p).total_cmp(&b.distance_squared(p)))
        .unwrap()
}

/// The distance of two segments.
pub fn segments(p: [DVec3; 2], q: [DVec3; 2]) -> f64 {
    let ends = [
        p[0].distance(nearest_on_segment(p[0], q[0], q[1])),
        p[1].distance(nearest_on_segment(p[1], q[0], q[1])),
        q[0].distance(nearest_on_segment(q[0], p[0], p[1])),
        q[1].distance(nearest_on_segment(q[1], p[0], p[1])),
    ];
    let nearest = ends.into_iter().fold(f64::INFINITY, f64::min);
    // The common perpendicular of the lines, if its ends are on the segments.
    let (u, v, w) = (p[1] - p[0], q[1] - q[0], q[0] - p[0]);
    let normal = u.cross(v);
    let squared = normal.length_squared();
    let (s, t) = (w.cross(v).dot(normal) / squared, w.cross(u).dot(normal) / squared);
    if (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
        nearest.min(w.dot(normal).abs() / squared.sqrt())
    } else {
        nearest
    }
}

/// Whether a segment crosses a triangle.
pub fn crosses(p: DVec3, q: DVec3, t: &[DVec3; 3]) -> bool {
    let volume = |a: DVec3, b: DVec3, c: DVec3| (a - p).dot((b - p).cross(c - p));
    let normal = (t[1] - t[0]).cross(t[2] - t[0]);
    let sides = [normal.dot(p - t[0]) > 0.0, normal.dot(q - t[0]) > 0.0];
    let around = [0, 1, 2].map(|k| volume(q, t[k], t[(k + 1) % 3]) > 0.0);
    sides[0] != sides[1] && around == [around[0]; 3]
}

/// The distance of a segment, or of a point if both ends are equal, from a triangle.
pub fn segment_distance(p: DVec3, q: DVec3, t: &[DVec3; 3]) -> f64 {
    let point = |p: DVec3| p.distance(nearest_on_triangle(p, t));
    if p == q {
        return point(p);
    }
    if crosses(p, q, t) {
        return 0.0;
    }
    let edges = (0..3).map(|k| segments([p, q], [t[k], t[(k + 1) % 3]]));
    edges.fold(point(p).min(point(q)), f64::min)
}

/// How often the surface winds around a point: the sum of the solid angles (van Oosterom and Strackee 1983).
pub fn winding(p: DVec3, triangles: &[[DVec3; 3]]) -> f64 {
    let angle = |t: &[DVec3; 3]| {
        let [a, b, c] = t.map(|v| v - p);
        let [u, v, w] = [a.length(), b.length(), c.length()];
        let below = u * v * w + a.dot(b) * w + b.dot(c) * u + c.dot(a) * v;
        2.0 * a.dot(b.cross(c)).atan2(below)
    };
    triangles.iter().map(angle).sum::<f64>() / (4.0 * std::f64::consts::PI)
}

/// Whether a closed surface has a point inside: an odd number of its faces is above.
pub fn contains(faces: &[[DVec3; 3]], p: DVec3, is_mixed: bool) -> bool {
    if !is_mixed {
        return winding(p, faces).abs() > 0.5;
    }
    let end = p + DVec3::new(0.123, 0.456, 100.0);
    faces.iter().filter(|t| crosses(p, end, t)).count() % 2 == 1
}

/// Whether two surfaces in general position intersect: an edge of one crosses a face of the other.
pub fn surfaces_cross(some: &[[DVec3; 3]], others: &[[DVec3; 3]]) -> bool {
    let bounds = |t: &[DVec3; 3]| [t[0].min(t[1]).min(t[2]), t[0].max(t[1]).max(t[2])];
    let boxes: Vec<_> = others.iter().map(bounds).collect();
    let edge_crosses = |s: &[DVec3; 3], t: &[DVec3; 3]| (0..3).any(|k| crosses(s[k], s[(k + 1) % 3], t));
    some.iter().any(|s| {
        let [low, high] = bounds(s);
        let meet = |[least, most]: &[DVec3; 2]| low.cmple(*most).all() && least.cmple(high).all();
        let near = others.iter().zip(&boxes).filter(|(_, bounds)| meet(bounds));
        near.into_iter().any(|(t, _)| edge_crosses(s, t) || edge_crosses(t, s))
    })
}

pub fn random_pose(random: &mut Random, far: f64) -> Pose {
    Pose {
        translation: random.vector() * far,
        rotation: random.rotation(),
        scale: random.scale(),
    }
}
