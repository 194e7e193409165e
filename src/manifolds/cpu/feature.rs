//! Contact features: vertex-face and edge-edge.

use super::feature_bits::{CROSSING, FeatureBit, FeatureBits};
use super::side::{Side, Triangle, rounding};
use crate::simd::lanes::{bits, each};
use glam::DVec3;
use std::ops::RangeInclusive;

/// Sine of the largest angle by which an edge of a vertex may lead below the face.
pub(crate) const BELOW: f64 = 0.02;
/// Sine of the largest angle by which an edge's normal may leave the arc between the normals of its faces. A normal
/// that close to a face normal is replaced by it.
pub const ARC: f64 = 0.05;
/// Sine of the angle between its faces below which an edge counts as flat. Its vertices and faces then give all
/// features.
pub(crate) const FLAT: f64 = 1.0e-3;
/// Sine of the angle below which two edges are parallel and have no common normal.
pub(crate) const PARALLEL: f64 = 1.0e-3;
/// How far outside a face the projection of a vertex may lie, relative to the length of the face's edge.
pub(crate) const OUTSIDE: f64 = 1.0e-6;

/// A contact feature: vertex-face, edge-edge, or a point that stands for a deep overlap.
#[derive(Clone, Copy, Debug)]
pub struct Feature {
    /// The points on the first and the second body.
    pub points: [DVec3; 2],
    /// Unit vector from the first body to the second.
    pub normal: DVec3,
    /// Signed distance from the first point to the second along the normal.
    pub separation: f64,
    /// Triangles on which the points lie.
    pub triangles: [u32; 2],
    /// What it was derived from.
    pub origin: Origin,
}

/// What a [`Feature`] was derived from.
///
/// Features are sorted by an unstable sort of the standard library, whose order of equal elements depends on their
/// size. A change of this type's size may therefore swap points of equal depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Origin {
    /// A vertex of this side over the other side's triangle. The triangle of its own side owns the vertex.
    Vertex { side: u8, vertex: u32 },
    /// Two edges, by their positions in the triangles that own them.
    Edges([u8; 2]),
    /// A vertex of `side` near an edge of the other side, given by its position in the triangle that owns it. The
    /// triangle of `side` owns the vertex.
    VertexEdge { side: u8, edge: u8, vertex: u32 },
    /// Two vertices, by their positions in the triangles that own them.
    Vertices([u8; 2]),
    /// A point of the patch of this number.
    Patch { place: u8, number: u32 },
    /// Containment of one body in the other.
    Inside,
}

impl Feature {
    /// Side and index of the vertex of a vertex-face feature.
    pub fn vertex(&self) -> Option<(u8, u32)> {
        match self.origin {
            Origin::Vertex { side, vertex } => Some((side, vertex)),
            _ => None,
        }
    }

    /// Midpoint of its two points.
    pub fn middle(&self) -> DVec3 {
        (self.points[0] + self.points[1]) * 0.5
    }
}

/// Two triangles, with the heights of their corners over each other's planes.
pub struct TrianglePair<'a> {
    pub sides: &'a [Side<'a>; 2],
    pub triangles: [&'a Triangle; 2],
    /// Heights of the first triangle's corners over the second's plane, and of the second's over the first's.
    pub heights: [[f64; 3]; 2],
}

impl<'a> TrianglePair<'a> {
    /// `None` if the planes show that the two are farther apart than `reach`.
    #[inline(always)]
    pub fn new(sides: &'a [Side<'a>; 2], triangles: [&'a Triangle; 2], reach: f64) -> Option<Self> {
        let [a, b] = triangles;
        let heights = |of: &Triangle, over: &Triangle| each(|k| over.normal.dot(of.corners[k] - over.corners[0]));
        let of_b = heights(b, a);
        if is_beyond(of_b, reach) {
            return None;
        }
        let of_a = heights(a, b);
        (!is_beyond(of_a, reach)).then_some(Self {
            sides,
            triangles,
            heights: [of_a, of_b],
        })
    }

    /// Whether the planes do not show that the two are farther apart than `reach`.
    #[inline]
    pub fn is_within(&self, reach: f64) -> bool {
        let [of_a, of_b] = self.heights;
        !is_beyond(of_a, reach) && !is_beyond(of_b, reach)
    }

    /// Calls `found` for each of these features that exists and whose separation is in `range`.
    #[inline]
    pub fn features(&self, range: &RangeInclusive<f64>, feature_bits: FeatureBits, mut found: impl FnMut(Feature)) {
        for bit in bits(u32::from(feature_bits & !CROSSING)) {
            match FeatureBit::of(bit) {
                FeatureBit::Vertex { side, k } => {
                    if range.contains(&self.heights[side][k]) {
                        self.vertex(side, k).map(&mut found);
                    }
                }
                FeatureBit::Edges(edges) => {
                    self.edges(edges, range).map(&mut found);
                }
            }
        }
    }

    /// The vertex-face feature of corner `k` of `side`'s triangle over the other triangle.
    fn vertex(&self, side: usize, k: usize) -> Option<Feature> {
        let (own, over) = (self.triangles[side], self.triangles[1 - side]);
        let (p, height) = (own.corners[k], self.heights[side][k]);
        let foot = p - over.normal * height;
        for i in 0..3 {
            let edge = over.corners[(i + 1) % 3] - over.corners[i];
            let across = edge.cross(foot - over.corners[i]).dot(over.normal) * over.winding_sign;
            // A degenerate triangle has no interior.
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
        Some(self.vertex_over_plane(side, k))
    }

    /// The feature of corner `k` of `side`'s triangle and the other triangle's plane.
    pub fn vertex_over_plane(&self, side: usize, k: usize) -> Feature {
        let (own, over) = (self.triangles[side], self.triangles[1 - side]);
        let (p, height) = (own.corners[k], self.heights[side][k]);
        let foot = p - over.normal * height;
        let (points, normal) = if side == 1 {
            ([foot, p], over.normal)
        } else {
            ([p, foot], -over.normal)
        };
        Feature {
            points,
            normal,
            separation: height,
            triangles: self.triangles.map(|t| t.number),
            origin: Origin::Vertex {
                side: side as u8,
                vertex: self.sides[side].features.triangles[own.number as usize][k],
            },
        }
    }

    /// The edge-edge feature of edge `k` of the first triangle and edge `l` of the second.
    fn edges(&self, places: [usize; 2], range: &RangeInclusive<f64>) -> Option<Feature> {
        let lines = Lines::new(self, places);
        // The distance of the lines is tested first, because it rejects most pairs.
        let product = lines.way.dot(lines.cross);
        let most = range.start().abs().max(range.end().abs());
        if product * product > most * most * lines.square || lines.are_parallel() {
            return None;
        }
        let at = lines.nearest();
        if !at.iter().all(|at| (0.0..=1.0).contains(at)) {
            return None;
        }
        let faces = lines.other_faces(self.sides);
        let normal = lines.normal(self.sides, faces);
        let [a, b] = &lines.edges;
        if !a.may_face(normal, faces[0]) || !b.may_face(-normal, faces[1]) {
            return None;
        }
        let feature = lines.feature(self, places, at, normal, faces);
        range.contains(&feature.separation).then_some(feature)
    }

    /// The feature of the lines through these two edges; `None` if they are parallel.
    pub fn edge_lines(&self, places: [usize; 2]) -> Option<Feature> {
        let lines = Lines::new(self, places);
        (!lines.are_parallel()).then(|| {
            let faces = lines.other_faces(self.sides);
            lines.feature(self, places, lines.nearest(), lines.normal(self.sides, faces), faces)
        })
    }
}

/// The lines through an edge of each of two triangles.
struct Lines<'a> {
    edges: [Edge<'a>; 2],
    /// From the start of the first edge to that of the second.
    way: DVec3,
    /// The cross product of the edges, and its squared length.
    cross: DVec3,
    square: f64,
}

impl<'a> Lines<'a> {
    #[inline(always)]
    fn new(pair: &TrianglePair<'a>, [k, l]: [usize; 2]) -> Self {
        let a = Edge::new(&pair.sides[0], pair.triangles[0], k);
        let b = Edge::new(&pair.sides[1], pair.triangles[1], l);
        let cross = a.along.cross(b.along);
        Self {
            edges: [a, b],
            way: b.start - a.start,
            cross,
            square: cross.length_squared(),
        }
    }

    #[inline(always)]
    fn are_parallel(&self) -> bool {
        let [a, b] = self.edges.each_ref().map(|edge| edge.along.length_squared());
        self.square <= PARALLEL * PARALLEL * a * b
    }

    /// Where the lines are nearest, as fractions of the edges.
    #[inline(always)]
    fn nearest(&self) -> [f64; 2] {
        let [a, b] = &self.edges;
        [b, a].map(|other| self.way.cross(other.along).dot(self.cross) / self.square)
    }

    /// The normals of the faces on the other side of the edges.
    fn other_faces(&self, sides: &[Side; 2]) -> [Option<DVec3>; 2] {
        [0, 1].map(|i| sides[i].across(self.edges[i].number))
    }

    /// The common normal of the lines, from the first body to the second.
    fn normal(&self, sides: &[Side; 2], [other_a, other_b]: [Option<DVec3>; 2]) -> DVec3 {
        let [own_a, own_b] = self.edges.each_ref().map(|edge| edge.triangle.normal);
        let normal = self.cross * self.square.sqrt().recip();
        // Boundary edges of a sheet have all normals from one side round to the other, so the other body's faces
        // determine the sign.
        let towards = match (other_a, other_b) {
            (Some(other), _) => own_a + other,
            (None, Some(other)) => -(own_b + other),
            (None, None) => sides[1].center - sides[0].center,
        };
        if normal.dot(towards) < 0.0 { -normal } else { normal }
    }

    fn feature(
        &self,
        pair: &TrianglePair,
        places: [usize; 2],
        at: [f64; 2],
        normal: DVec3,
        [other_a, other_b]: [Option<DVec3>; 2],
    ) -> Feature {
        let mut nearest = (1.0 - 0.5 * ARC * ARC, normal);
        // Between rounded surfaces normals change without steps.
        let is_rounded = rounding(pair.sides) > 0.0;
        let [own_a, own_b] = pair.triangles.map(|t| t.normal);
        let faces = [Some(own_a), other_a, Some(-own_b), other_b.map(|n| -n)];
        for face in faces.into_iter().flatten().filter(|_| !is_rounded) {
            let cosine = face.dot(normal);
            if cosine > nearest.0 {
                nearest = (cosine, face);
            }
        }
        let points = [0, 1].map(|i| self.edges[i].start + self.edges[i].along * at[i]);
        Feature {
            points,
            normal: nearest.1,
            separation: nearest.1.dot(points[1] - points[0]),
            triangles: pair.triangles.map(|t| t.number),
            origin: Origin::Edges(places.map(|place| place as u8)),
        }
    }
}

/// Whether corners are all farther from a plane than `reach`, on one side.
#[inline(always)]
fn is_beyond([x, y, z]: [f64; 3], reach: f64) -> bool {
    x.min(y).min(z) > reach || x.max(y).max(z) < -reach
}

/// An edge of the triangle that owns it.
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

    /// Whether `normal` lies between the normals of the owner and of the `other` face, and the edge is convex or a
    /// boundary edge.
    fn may_face(&self, normal: DVec3, other: Option<DVec3>) -> bool {
        let own = self.triangle.normal;
        let length = self.along.length();
        let turn = |from: DVec3, to: DVec3| self.triangle.winding_sign * from.cross(to).dot(self.along);
        let least = -ARC * length;
        turn(own, normal) >= least
            && other.is_none_or(|other| turn(own, other) > FLAT * length && turn(normal, other) >= least)
    }
}
