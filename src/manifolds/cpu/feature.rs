//! Vertices over faces and edges over edges.

use super::side::{Side, Triangle};
use crate::simd::lanes::each;
use glam::DVec3;
use std::ops::RangeInclusive;

/// How far, as a sine, an edge may lead below a face at whose vertex it starts.
pub(crate) const BELOW: f64 = 0.02;
/// How far, as a sine, the normal of an edge may leave the arc between its faces' normals, and how near to a face's
/// normal it becomes that normal.
pub const ARC: f64 = 0.05;
/// Edges whose faces differ by less than this, as a sine, are flat, and their vertices and faces say all.
pub(crate) const FLAT: f64 = 1.0e-3;
/// Edges that differ by less than this, as a sine, are parallel and have no normal.
pub(crate) const PARALLEL: f64 = 1.0e-3;
/// How far outside a face a vertex's projection may lie, beside the face's edge.
pub(crate) const OUTSIDE: f64 = 1.0e-6;

/// A point at which the bodies push each other: a vertex over a face, an edge over an edge, or what stands for them.
#[derive(Clone, Copy, Debug)]
pub struct Feature {
    /// The points on the first and on the second body.
    pub points: [DVec3; 2],
    /// Unit vector from the first body to the second.
    pub normal: DVec3,
    /// From the first point to the second along the normal.
    pub separation: f64,
    /// Triangles on which the points lie.
    pub triangles: [u32; 2],
    /// What it was found from.
    pub origin: Origin,
}

/// What a [`Feature`] was found from.
///
/// Features are sorted by an unstable sort of the standard library, whose order of equals depends on the size of what is
/// sorted. So another size of this may exchange points that are equally deep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Origin {
    /// A vertex of this side over the other side's triangle. The triangle of its own side owns it.
    Vertex { side: u8, vertex: u32 },
    /// Two edges, by their places in the triangles, which own them.
    Edges([u8; 2]),
    /// A place in a patch. The key is the smallest of its contour.
    Patch { place: u8, key: Key },
    /// One body inside the other.
    Inside,
}

/// Where a contour passes from one triangle to the next: an edge of one side pierces a triangle of the other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Key {
    /// Whose edge it is.
    pub side: u8,
    pub edge: u32,
    pub triangle: u32,
}

impl Feature {
    /// For a vertex the side that it belongs to, and its number.
    pub fn vertex(&self) -> Option<(u8, u32)> {
        match self.origin {
            Origin::Vertex { side, vertex } => Some((side, vertex)),
            _ => None,
        }
    }

    /// Between its points.
    pub fn middle(&self) -> DVec3 {
        (self.points[0] + self.points[1]) * 0.5
    }
}

/// Two triangles and the heights of their corners over each other's planes.
pub struct TrianglePair<'a> {
    pub sides: &'a [Side<'a>; 2],
    pub triangles: [&'a Triangle; 2],
    /// Of the first triangle's corners over the second's plane, and of the second's over the first's.
    pub heights: [[f64; 3]; 2],
}

impl<'a> TrianglePair<'a> {
    /// Nothing if the two are clearly farther apart than `reach`.
    #[inline]
    pub fn new(sides: &'a [Side<'a>; 2], triangles: [&'a Triangle; 2], reach: f64) -> Option<Self> {
        let [a, b] = triangles;
        let heights = |of: &Triangle, over: &Triangle| each(|k| over.normal.dot(of.corners[k] - over.corners[0]));
        let beyond = |[x, y, z]: [f64; 3]| x.min(y).min(z) > reach || x.max(y).max(z) < -reach;
        let of_b = heights(b, a);
        if beyond(of_b) {
            return None;
        }
        let of_a = heights(a, b);
        (!beyond(of_a)).then_some(Self {
            sides,
            triangles,
            heights: [of_a, of_b],
        })
    }

    /// Calls `found` for all features that the triangles own whose separation is in `range`.
    #[inline]
    pub fn features(&self, range: &RangeInclusive<f64>, mut found: impl FnMut(Feature)) {
        let owned = [0, 1].map(|i| self.sides[i].features.owned[self.triangles[i].number as usize]);
        for (side, owned) in owned.into_iter().enumerate() {
            for k in 0..3 {
                if owned >> k & 1 == 1 && range.contains(&self.heights[side][k]) {
                    self.vertex(side, k).map(&mut found);
                }
            }
        }
        if owned[0] >> 3 == 0 || owned[1] >> 3 == 0 {
            return;
        }
        for k in 0..3 {
            for l in 0..3 {
                if owned[0] >> (3 + k) & 1 == 1 && owned[1] >> (3 + l) & 1 == 1 {
                    self.edges([k, l], range).map(&mut found);
                }
            }
        }
    }

    /// Corner `k` of the triangle of `side` over the other triangle.
    fn vertex(&self, side: usize, k: usize) -> Option<Feature> {
        let (own, over) = (self.triangles[side], self.triangles[1 - side]);
        let (p, height) = (own.corners[k], self.heights[side][k]);
        let foot = p - over.normal * height;
        for i in 0..3 {
            let edge = over.corners[(i + 1) % 3] - over.corners[i];
            let across = edge.cross(foot - over.corners[i]).dot(over.normal) * over.handed;
            // Nothing lies over a triangle that has collapsed.
            if across <= -OUTSIDE * edge.length_squared() {
                return None;
            }
        }
        let of = &self.sides[side];
        let vertex = of.features.triangles[own.number as usize][k];
        for &neighbor in of.features.neighbors_of(vertex) {
            let edge = of.vertex(neighbor) - p;
            let along = edge.dot(over.normal);
            if along < 0.0 && along * along > BELOW * BELOW * edge.length_squared() {
                return None;
            }
        }
        let (points, normal) = if side == 1 {
            ([foot, p], over.normal)
        } else {
            ([p, foot], -over.normal)
        };
        Some(Feature {
            points,
            normal,
            separation: height,
            triangles: self.triangles.map(|t| t.number),
            origin: Origin::Vertex {
                side: side as u8,
                vertex,
            },
        })
    }

    /// Edge `k` of the first triangle over edge `l` of the second.
    fn edges(&self, [k, l]: [usize; 2], range: &RangeInclusive<f64>) -> Option<Feature> {
        let a = Edge::new(&self.sides[0], self.triangles[0], k);
        let b = Edge::new(&self.sides[1], self.triangles[1], l);
        let cross = a.along.cross(b.along);
        let square = cross.length_squared();
        // The lines' distance comes first, as it rejects most.
        let way = b.start - a.start;
        let product = way.dot(cross);
        let most = range.start().abs().max(range.end().abs());
        if product * product > most * most * square {
            return None;
        }
        if square <= PARALLEL * PARALLEL * a.along.length_squared() * b.along.length_squared() {
            return None;
        }
        let at_a = way.cross(b.along).dot(cross) / square;
        let at_b = way.cross(a.along).dot(cross) / square;
        if !(0.0..=1.0).contains(&at_a) || !(0.0..=1.0).contains(&at_b) {
            return None;
        }
        let [own_a, own_b] = self.triangles.map(|t| t.normal);
        let (other_a, other_b) = (self.sides[0].across(a.number), self.sides[1].across(b.number));
        let mut normal = cross * square.sqrt().recip();
        // Rims face every way from one side of the sheet round to the other, so their neighbours decide.
        let towards = match (other_a, other_b) {
            (Some(other), _) => own_a + other,
            (None, Some(other)) => -(own_b + other),
            (None, None) => self.sides[1].center - self.sides[0].center,
        };
        if normal.dot(towards) < 0.0 {
            normal = -normal;
        }
        if !a.may_face(normal, other_a) || !b.may_face(-normal, other_b) {
            return None;
        }
        let mut nearest = (1.0 - 0.5 * ARC * ARC, normal);
        let faces = [Some(own_a), other_a, Some(-own_b), other_b.map(|n| -n)];
        for face in faces.into_iter().flatten() {
            let cosine = face.dot(normal);
            if cosine > nearest.0 {
                nearest = (cosine, face);
            }
        }
        let points = [a.start + a.along * at_a, b.start + b.along * at_b];
        let separation = nearest.1.dot(points[1] - points[0]);
        range.contains(&separation).then_some(Feature {
            points,
            normal: nearest.1,
            separation,
            triangles: self.triangles.map(|t| t.number),
            origin: Origin::Edges([k as u8, l as u8]),
        })
    }
}

/// An edge and the triangle that owns it.
#[derive(Clone, Copy)]
struct Edge<'a> {
    triangle: &'a Triangle,
    number: u32,
    start: DVec3,
    along: DVec3,
}

impl<'a> Edge<'a> {
    #[inline]
    fn new(side: &Side, triangle: &'a Triangle, k: usize) -> Self {
        Self {
            triangle,
            number: side.features.triangle_edges[triangle.number as usize][k],
            start: triangle.corners[k],
            along: triangle.corners[(k + 1) % 3] - triangle.corners[k],
        }
    }

    /// Whether the edge is convex, or a rim, and `normal` lies between the normals of its owner and of the `other` face.
    fn may_face(&self, normal: DVec3, other: Option<DVec3>) -> bool {
        let own = self.triangle.normal;
        let length = self.along.length();
        let turn = |from: DVec3, to: DVec3| self.triangle.handed * from.cross(to).dot(self.along);
        let least = -ARC * length;
        turn(own, normal) >= least
            && other.is_none_or(|other| turn(own, other) > FLAT * length && turn(normal, other) >= least)
    }
}
