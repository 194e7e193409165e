//! A proof that from outside only the front faces, or only the back faces, of a mesh are visible.
//!
//! It holds for a surface with an inside and an outside whose triangles all point outward: a line of sight first meets
//! the surface where it enters. Consistent winding and a positive total volume do not suffice. One component may be
//! inside out, or a surface may intersect itself and show its back.
//!
//! So the proof checks that the surface does not intersect itself; then each component separates space. It also checks
//! that each component that is visible from outside has a volume of the right sign. If the proof fails for any reason,
//! all triangles are drawn from both sides. That costs time but does not change the result.

use crate::geometry::union_find::UnionFind;
use crate::geometry::{Orientation, TriMesh};
use glam::{DVec3, Vec3};
use std::collections::HashMap;

/// Which side of the triangles is visible from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Facing {
    /// Only front faces (counter-clockwise).
    Outward,
    /// Only back faces.
    Inward,
    /// Not proved: possibly both.
    Unknown,
}

/// The maximum number of box pairs to test before the proof is abandoned: about 50 ms.
const MAX_PAIRS: usize = 20_000_000;

/// Distances (relative to the size of the mesh) and angles below this count as zero.
const TOLERANCE: f64 = 1.0e-9;

struct Surface {
    corners: Vec<[DVec3; 3]>,
    /// Corners by position: equal numbers for equal positions.
    welded: Vec<[u32; 3]>,
    /// The smallest distance that counts as a gap, in mesh units.
    gap: f64,
}

/// Tries to prove which side of `mesh` is visible from outside.
pub(super) fn prove(mesh: &TriMesh) -> Facing {
    let inward = match mesh.orientation() {
        Orientation::Outward => false,
        Orientation::Inward => true,
        Orientation::Mixed | Orientation::Open => return Facing::Unknown,
    };
    let surface = Surface::of(mesh);
    if surface.is_manifold() && surface.is_embedded() && surface.components_face(inward) {
        if inward { Facing::Inward } else { Facing::Outward }
    } else {
        Facing::Unknown
    }
}

impl Surface {
    fn of(mesh: &TriMesh) -> Self {
        let mut number: HashMap<[u32; 3], u32> = HashMap::new();
        let bounds = mesh.aabb();
        let (corners, welded) = (0..mesh.triangles().len())
            .map(|t| {
                let corners = mesh.corners(t);
                let welded = corners.map(|p| {
                    let next = number.len() as u32;
                    *number
                        .entry((p + Vec3::ZERO).to_array().map(f32::to_bits))
                        .or_insert(next)
                });
                (corners.map(Vec3::as_dvec3), welded)
            })
            .unzip();
        let size = (bounds.max.as_dvec3() - bounds.min.as_dvec3()).length();
        Self {
            corners,
            welded,
            gap: size * TOLERANCE,
        }
    }

    /// Whether each edge belongs to exactly two triangles. (Mesh validation also counts dropped triangles of zero
    /// area.)
    fn is_manifold(&self) -> bool {
        let mut edges: HashMap<(u32, u32), u32> = HashMap::with_capacity(self.welded.len() * 3 / 2);
        for &[a, b, c] in &self.welded {
            for (u, v) in [(a, b), (b, c), (c, a)] {
                *edges.entry((u.min(v), u.max(v))).or_default() += 1;
            }
        }
        edges.values().all(|&count| count == 2)
    }

    /// Whether all common points of two triangles are on a common corner or edge.
    fn is_embedded(&self) -> bool {
        let boxes: Vec<(DVec3, DVec3)> = self
            .corners
            .iter()
            .map(|&[a, b, c]| (a.min(b).min(c), a.max(b).max(c)))
            .collect();
        let extent = boxes.iter().fold(DVec3::NEG_INFINITY, |m, b| m.max(b.1))
            - boxes.iter().fold(DVec3::INFINITY, |m, b| m.min(b.0));
        let axis = extent.max_position();
        let mut order: Vec<usize> = (0..boxes.len()).collect();
        order.sort_by(|&i, &j| boxes[i].0[axis].total_cmp(&boxes[j].0[axis]));
        let mut pairs = 0;
        for (k, &i) in order.iter().enumerate() {
            for &j in &order[k + 1..] {
                if boxes[j].0[axis] > boxes[i].1[axis] {
                    break;
                }
                pairs += 1;
                if pairs > MAX_PAIRS {
                    return false;
                }
                let overlap = boxes[i].0.cmple(boxes[j].1).all() && boxes[j].0.cmple(boxes[i].1).all();
                if overlap && !self.meet_properly(i, j) {
                    return false;
                }
            }
        }
        true
    }

    /// Whether triangles `i` and `j` have no points in common but those of a common corner or edge.
    fn meet_properly(&self, i: usize, j: usize) -> bool {
        let shared: Vec<(usize, usize)> = (0..9)
            .map(|k| (k / 3, k % 3))
            .filter(|&(p, q)| self.welded[i][p] == self.welded[j][q])
            .collect();
        let (a, b) = (self.corners[i], self.corners[j]);
        match shared[..] {
            [] => self.apart(a, b),
            [(p, q)] => {
                let apex = a[p];
                let rays = |t: [DVec3; 3], k: usize| [t[(k + 1) % 3] - apex, t[(k + 2) % 3] - apex];
                wedges_apart(rays(a, p), rays(b, q))
            }
            [(p, q), (r, s)] => {
                let along = a[r] - a[p];
                let (u, v) = (along.cross(a[3 - p - r] - a[p]), along.cross(b[3 - q - s] - a[p]));
                // Folded onto each other, they would have an area in common.
                u.dot(v) <= 0.0 || u.cross(v).length() > TOLERANCE * u.length() * v.length()
            }
            _ => false,
        }
    }

    /// Whether a separating axis exists. The candidates are the normals, the cross products of edges, and the edge
    /// normals within each plane.
    fn apart(&self, a: [DVec3; 3], b: [DVec3; 3]) -> bool {
        let edges = |t: [DVec3; 3]| [t[1] - t[0], t[2] - t[1], t[0] - t[2]];
        let (ea, eb) = (edges(a), edges(b));
        let (na, nb) = (ea[0].cross(ea[1]), eb[0].cross(eb[1]));
        [na, nb]
            .into_iter()
            .chain((0..9).map(|k| ea[k / 3].cross(eb[k % 3])))
            .chain(ea.map(|e| na.cross(e)))
            .chain(eb.map(|e| nb.cross(e)))
            .filter_map(DVec3::try_normalize)
            .any(|axis| {
                let range = |t: [DVec3; 3]| {
                    let [x, y, z] = t.map(|p| p.dot(axis));
                    (x.min(y).min(z), x.max(y).max(z))
                };
                let ((a0, a1), (b0, b1)) = (range(a), range(b));
                b0 - a1 > self.gap || a0 - b1 > self.gap
            })
    }

    /// Whether each component that is visible from outside encloses a volume of the required sign.
    fn components_face(&self, inward: bool) -> bool {
        let sign = if inward { -1.0 } else { 1.0 };
        let component = self.components();
        let count = component.iter().max().map_or(0, |c| c + 1);
        let origin = self.corners[0][0];
        let mut volume = vec![0.0; count];
        let mut bulk = vec![0.0; count];
        for (t, &c) in self.corners.iter().zip(&component) {
            let [x, y, z] = t.map(|p| p - origin);
            let v = x.dot(y.cross(z));
            volume[c] += v;
            bulk[c] += v.abs();
        }
        if (0..count).any(|c| volume[c].abs() <= TOLERANCE * bulk[c]) {
            return false;
        }
        // A component of the other sign must be inside the rest, like the wall of a cavity. Surfaces do not intersect,
        // so it is wholly inside or wholly outside.
        (0..count).filter(|&c| volume[c] * sign < 0.0).all(|c| {
            let start = (0..self.corners.len()).find(|&t| component[t] == c).unwrap_or(0);
            let point = self.corners[start][0];
            let solid: f64 = (0..self.corners.len())
                .filter(|&t| component[t] != c)
                .map(|t| solid_angle(self.corners[t].map(|p| p - point)))
                .sum();
            solid * sign > 2.0 * std::f64::consts::PI
        })
    }

    /// For each triangle, the index of its component.
    fn components(&self) -> Vec<usize> {
        let vertices = self.welded.iter().flatten().max().map_or(0, |&v| v as usize + 1);
        let mut joined = UnionFind::new(vertices);
        for &[a, b, c] in &self.welded {
            joined.join(a, b);
            joined.join(a, c);
        }
        let mut number = vec![usize::MAX; vertices];
        let mut count = 0;
        self.welded
            .iter()
            .map(|t| {
                let slot = &mut number[joined.root(t[0]) as usize];
                if *slot == usize::MAX {
                    *slot = count;
                    count += 1;
                }
                *slot
            })
            .collect()
    }
}

/// Whether two wedges, each spanned by two rays from a common apex, have only the apex in common.
///
/// It suffices to find a plane through the apex that separates the wedges. Only one wedge may touch the plane, along at
/// most one ray, or both may along different rays.
fn wedges_apart(a: [DVec3; 2], b: [DVec3; 2]) -> bool {
    let (a, b) = (a.map(DVec3::normalize), b.map(DVec3::normalize));
    let (na, nb) = (a[0].cross(a[1]), b[0].cross(b[1]));
    let range = |axis: DVec3, rays: [DVec3; 2]| {
        let (x, y) = (rays[0].dot(axis), rays[1].dot(axis));
        (x.min(y), x.max(y))
    };
    // The plane of one wedge, with the other wedge strictly on one side.
    let beside = |axis: DVec3, rays| {
        axis.try_normalize().is_some_and(|axis| {
            let (low, high) = range(axis, rays);
            low > TOLERANCE || high < -TOLERANCE
        })
    };
    if beside(na, b) || beside(nb, a) {
        return true;
    }
    // A plane through one ray of each wedge, with the other two rays strictly on different sides.
    let through = |i: usize, j: usize| {
        a[i].cross(b[j]).try_normalize().is_some_and(|axis| {
            let (x, y) = (a[1 - i].dot(axis), b[1 - j].dot(axis));
            a[i].cross(b[j]).length() > TOLERANCE
                && (x < -TOLERANCE && y > TOLERANCE || x > TOLERANCE && y < -TOLERANCE)
        })
    };
    if (0..4).any(|k| through(k / 2, k % 2)) {
        return true;
    }
    // Both wedges in one plane: within it, a ray of one wedge separates its other ray from both rays of the other
    // wedge.
    let within = |normal: DVec3, own: [DVec3; 2], other: [DVec3; 2]| {
        (0..2).any(|k| {
            normal.cross(own[k]).try_normalize().is_some_and(|axis| {
                let side = own[1 - k].dot(axis);
                let (low, high) = range(axis, other);
                side > TOLERANCE && high < -TOLERANCE || side < -TOLERANCE && low > TOLERANCE
            })
        })
    };
    within(na, a, b) || within(nb, b, a)
}

/// The signed solid angle of a triangle seen from the origin, positive if the triangle faces away from the origin (van
/// Oosterom and Strackee 1983).
fn solid_angle([a, b, c]: [DVec3; 3]) -> f64 {
    let (x, y, z) = (a.length(), b.length(), c.length());
    let det = a.dot(b.cross(c));
    2.0 * det.atan2(x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y)
}
