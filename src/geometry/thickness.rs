//! How thick what lies behind a closed mesh's faces is: rays from its faces to the surface opposite.

use crate::geometry::{Aabb, Orientation, TriMesh};
use glam::{DVec3, Vec3};

/// At most this many faces send a ray.
const SAMPLES: usize = 4096;
/// Rays stop after this many triangle tests in all. Meshes in cluster order need a small part of it; one whose
/// triangles come in random order has boxes that hold everything, and must not take minutes.
const BUDGET: u64 = 30_000_000;
/// The part of the sampled surface that may be thinner than the result.
const QUANTILE: f64 = 0.02;
/// Children per node of the box hierarchy, and triangles per leaf.
const WIDTH: usize = 8;

/// The thickness of a closed mesh with consistent faces, in mesh units; `None` if no ray leaves it.
///
/// From the middle of each face a ray runs backward to where it leaves the mesh; from a room's outer walls it never does. The
/// ball that touches the face there and the plane of the exit measures how thick the mesh is: for parallel faces its
/// diameter is the length of the ray, for a wedge it is smaller. Meshes of more than 4096 triangles are sampled. The result
/// is the diameter that 98 % of the sampled area reaches.
pub(super) fn thickness(mesh: &TriMesh) -> Option<f64> {
    if matches!(mesh.orientation(), Orientation::Mixed | Orientation::Open) {
        return None;
    }
    let tree = BoxTree::new(mesh);
    let count = mesh.triangles().len();
    let (mut tests, mut found) = (0, Vec::new());
    for k in 0..count.min(SAMPLES) {
        let t = if count <= SAMPLES {
            k
        } else {
            // Multiples of the golden ratio spread evenly however early the budget ends the loop.
            ((k as f64 * 0.618_033_988_749_894_9).fract() * count as f64) as usize
        };
        let [a, b, c] = tree.corners(t);
        let normal = (b - a).cross(c - a);
        let area = normal.length();
        // Joined corners may leave nothing of a face.
        if area > 0.0
            && let Some(d) = tree.ball((a + b + c) / 3.0, -normal / area, &mut tests)
        {
            found.push((d, area));
        }
        if tests > BUDGET {
            break;
        }
    }
    found.sort_by(|x, y| x.0.total_cmp(&y.0));
    let total: f64 = found.iter().map(|f| f.1).sum();
    let mut below = 0.0;
    found
        .iter()
        .find(|f| {
            below += f.1;
            below > QUANTILE * total
        })
        .map(|f| f.0)
        .filter(|d| *d > 0.0 && d.is_finite())
}

/// Boxes around runs of eight triangles, runs of eight such boxes, and so on. It fits whatever order the triangles come in,
/// and is fast if neighbours in the list are neighbours in space.
struct BoxTree<'a> {
    mesh: &'a TriMesh,
    origin: DVec3,
    /// From the leaves upward; the last level has one box.
    levels: Vec<Vec<Aabb>>,
}

impl<'a> BoxTree<'a> {
    fn new(mesh: &'a TriMesh) -> Self {
        let count = mesh.triangles().len();
        let leaves: Vec<Aabb> = (0..count.div_ceil(WIDTH))
            .map(|i| Aabb::around((i * WIDTH..count.min((i + 1) * WIDTH)).flat_map(|t| mesh.welded_corners(t))))
            .collect();
        let mut levels = vec![leaves];
        while levels[levels.len() - 1].len() > 1 {
            let above = levels[levels.len() - 1]
                .chunks(WIDTH)
                .map(|run| run.iter().fold(Aabb::EMPTY, |a, b| a.union(*b)))
                .collect();
            levels.push(above);
        }
        Self {
            mesh,
            origin: mesh.welded_corners(0)[0].as_dvec3(),
            levels,
        }
    }

    /// Corners relative to the tree's origin.
    fn corners(&self, t: usize) -> [DVec3; 3] {
        self.mesh.welded_corners(t).map(|v| v.as_dvec3() - self.origin)
    }

    /// The diameter of the ball between the start of a ray and the plane of the face through which it leaves.
    fn ball(&self, start: DVec3, direction: DVec3, tests: &mut u64) -> Option<f64> {
        let mut nearest: Option<(f64, f64)> = None;
        let inverse = direction.recip();
        let mut stack = vec![(self.levels.len() - 1, 0)];
        while let Some((level, i)) = stack.pop() {
            let limit = nearest.map_or(f64::INFINITY, |(t, _)| t);
            if !self.hits_box(&self.levels[level][i], start, inverse, limit) {
                continue;
            }
            if level > 0 {
                let end = self.levels[level - 1].len().min((i + 1) * WIDTH);
                stack.extend((i * WIDTH..end).map(|child| (level - 1, child)));
                continue;
            }
            let end = self.mesh.triangles().len().min((i + 1) * WIDTH);
            *tests += WIDTH as u64;
            for t in i * WIDTH..end {
                if let Some((distance, cosine)) = self.leaves_through(t, start, direction)
                    && nearest.is_none_or(|(n, _)| distance < n)
                {
                    nearest = Some((distance, cosine));
                }
            }
        }
        nearest.map(|(t, cosine)| 2.0 * t * cosine / (1.0 + cosine))
    }

    fn hits_box(&self, b: &Aabb, start: DVec3, inverse: DVec3, limit: f64) -> bool {
        let at = |corner: Vec3| (corner.as_dvec3() - self.origin - start) * inverse;
        let (u, v) = (at(b.min), at(b.max));
        // A component is NaN where the ray runs within a face of the box: min and max then drop it.
        let pick = |x: f64, y: f64| (x.min(y), x.max(y));
        let ((x0, x1), (y0, y1), (z0, z1)) = (pick(u.x, v.x), pick(u.y, v.y), pick(u.z, v.z));
        let enter = x0.max(y0).max(z0).max(0.0);
        let leave = x1.min(y1).min(z1).min(limit);
        enter <= leave * (1.0 + 1e-9) || enter.is_nan() || leave.is_nan()
    }

    /// Distance along the ray, and cosine between the ray and the outward normal, if the ray leaves the mesh here.
    fn leaves_through(&self, t: usize, start: DVec3, direction: DVec3) -> Option<(f64, f64)> {
        let [a, b, c] = self.corners(t);
        let (ab, ac) = (b - a, c - a);
        let normal = ab.cross(ac);
        let slope = direction.dot(normal);
        let cosine = slope / normal.length();
        // A face almost along the ray says nothing about thickness across it.
        if cosine.is_nan() || cosine <= 1e-3 {
            return None;
        }
        let to_start = start - a;
        let cross = direction.cross(to_start);
        // Barycentric coordinates with a little slack, so that a ray does not slip through an edge or a corner.
        let v = cross.dot(ac) / slope;
        let w = -cross.dot(ab) / slope;
        let slack = -1e-9;
        let distance = -to_start.dot(normal) / slope;
        (v >= slack && w >= slack && v + w <= 1.0 - slack && distance > 0.0).then_some((distance, cosine))
    }
}
