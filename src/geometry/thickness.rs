//! Thickness of a closed mesh, measured by rays from its faces to the opposite surface.

use super::box_tree::BoxTree;
use super::weld::scattered;
use crate::geometry::{Aabb, Orientation, TriMesh};
use glam::{DVec3, Vec3};

/// The maximum number of rays, one per face.
const SAMPLES: usize = 4096;
/// The maximum number of ray-triangle tests in total: a fixed number, a number for each triangle, and a limit. Meshes
/// in cluster order need a small part of it. If the triangles are in random order, or many are long, every box contains
/// most of the mesh, and without a limit the rays could take minutes.
const BUDGET: [u64; 3] = [2_000_000, 50, 30_000_000];
/// The fraction of the sampled area that may be thinner than the result.
const QUANTILE: f64 = 0.02;

/// The thickness of a closed or nearly closed, consistently wound mesh, in mesh units; `None` for other meshes, or if
/// no ray leaves the mesh.
///
/// A ray runs from the centroid of each face backward through the solid to where it leaves the mesh. Rays from the
/// outer walls of a room never leave. The thickness at the face is the diameter of the ball that touches the face at
/// the ray's start and also touches the plane of the exit face: for parallel faces this is the length of the ray, for a
/// wedge it is less. Meshes of more than 4096 triangles are sampled. The result is the diameter that 98 % of the
/// sampled area reaches.
pub(super) fn thickness(mesh: &TriMesh) -> Option<f64> {
    let is_wound = match mesh.orientation() {
        Orientation::Outward | Orientation::Inward => true,
        Orientation::Mixed => false,
        Orientation::Open => !mesh.caps().is_empty(),
    };
    if !is_wound {
        return None;
    }
    let rays = Rays::new(mesh);
    let count = mesh.triangles().len();
    let (mut tests, mut found) = (0, Vec::new());
    let [fixed, each, limit] = BUDGET;
    let budget = (fixed + each * count as u64).min(limit);
    // Faces spread evenly however early the budget ends the loop: all, or multiples of the golden ratio.
    let golden = |k: usize| ((k as f64 * 0.618_033_988_749_894_9).fract() * count as f64) as usize;
    for (k, other) in scattered(count).take(SAMPLES).enumerate() {
        let t = if count <= SAMPLES { other } else { golden(k) };
        let [a, b, c] = rays.corners(t);
        let normal = (b - a).cross(c - a);
        let area = normal.length();
        // Welding may have collapsed the face.
        if area > 0.0
            && let Some(d) = rays.ball((a + b + c) / 3.0, -normal / area, &mut tests)
        {
            found.push((d, area));
        }
        if tests > budget {
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

/// A mesh that rays can be sent through.
struct Rays<'a> {
    mesh: &'a TriMesh,
    origin: DVec3,
    tree: BoxTree,
}

/// A ray on its way.
struct Search<'a> {
    start: DVec3,
    inverse: DVec3,
    /// The distance of the nearest face through which it leaves so far, and the cosine there.
    nearest: Option<(f64, f64)>,
    tests: &'a mut u64,
}

impl<'a> Rays<'a> {
    fn new(mesh: &'a TriMesh) -> Self {
        let boxes = (0..mesh.triangles().len()).map(|t| Aabb::around(mesh.welded_corners(t)));
        Self {
            mesh,
            origin: mesh.welded_corners(0)[0].as_dvec3(),
            tree: BoxTree::new(boxes),
        }
    }

    /// Corners relative to the origin.
    fn corners(&self, t: usize) -> [DVec3; 3] {
        self.mesh.welded_corners(t).map(|v| v.as_dvec3() - self.origin)
    }

    /// The diameter of the ball that touches the face at the start of the ray and the plane of the face through which
    /// the ray leaves.
    fn ball(&self, start: DVec3, direction: DVec3, tests: &mut u64) -> Option<f64> {
        let mut search = Search {
            start,
            inverse: direction.recip(),
            nearest: None,
            tests,
        };
        self.tree.visit(
            &mut search,
            |search, b| self.hits_box(search, b),
            |search, t| {
                *search.tests += 1;
                if let Some((distance, cosine)) = self.leaves_through(t, start, direction)
                    && search.nearest.is_none_or(|(n, _)| distance < n)
                {
                    search.nearest = Some((distance, cosine));
                }
            },
        );
        search.nearest.map(|(t, cosine)| 2.0 * t * cosine / (1.0 + cosine))
    }

    fn hits_box(&self, search: &Search, b: &Aabb) -> bool {
        let Search { start, inverse, .. } = *search;
        let limit = search.nearest.map_or(f64::INFINITY, |(t, _)| t);
        let at = |corner: Vec3| (corner.as_dvec3() - self.origin - start) * inverse;
        let (u, v) = (at(b.min), at(b.max));
        // A component is NaN where the ray lies in a face plane of the box. `min` and `max` ignore NaN.
        let pick = |x: f64, y: f64| (x.min(y), x.max(y));
        let ((x0, x1), (y0, y1), (z0, z1)) = (pick(u.x, v.x), pick(u.y, v.y), pick(u.z, v.z));
        let enter = x0.max(y0).max(z0).max(0.0);
        let leave = x1.min(y1).min(z1).min(limit);
        enter <= leave * (1.0 + 1e-9) || enter.is_nan() || leave.is_nan()
    }

    /// If the ray leaves the mesh through triangle `t`: the distance along the ray, and the cosine between the ray and
    /// the outward normal.
    fn leaves_through(&self, t: usize, start: DVec3, direction: DVec3) -> Option<(f64, f64)> {
        let [a, b, c] = self.corners(t);
        let (ab, ac) = (b - a, c - a);
        let normal = ab.cross(ac);
        let slope = direction.dot(normal);
        let cosine = slope / normal.length();
        // A face almost parallel to the ray does not bound the thickness along it.
        if cosine.is_nan() || cosine <= 1e-3 {
            return None;
        }
        let to_start = start - a;
        let cross = direction.cross(to_start);
        // Barycentric coordinates with a little slack, so that no ray passes between triangles at an edge or a corner.
        let v = cross.dot(ac) / slope;
        let w = -cross.dot(ab) / slope;
        let slack = -1e-9;
        let distance = -to_start.dot(normal) / slope;
        (v >= slack && w >= slack && v + w <= 1.0 - slack && distance > 0.0).then_some((distance, cosine))
    }
}
