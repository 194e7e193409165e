//! Contact reports: touching pairs with their intersecting faces, bodies that penetrate planes, and contact
//! points.

use super::merge::merge;
use glam::Vec3;

/// What touches in a step.
#[derive(Clone, Debug, Default)]
pub struct Contacts {
    /// Touching pairs, ascending.
    pub pairs: Vec<PairContact>,
    /// Intersecting faces of all pairs, grouped by pair.
    pub faces: Vec<FacePair>,
    /// Whether the step was asked to list faces. If not, a GPU lists none.
    pub lists_faces: bool,
    /// Number of intersecting face pairs, listed or not.
    pub face_pairs: usize,
    /// Bodies that penetrate planes, ascending by body, then plane.
    pub planes: Vec<PlaneContact>,
    /// Contact points, grouped by pair: first those of `pairs`, then those of `planes`.
    pub points: Vec<ContactPoint>,
    /// Number of triangle-triangle tests, one per pair of triangles whose boxes overlap.
    pub triangle_tests: u64,
}

/// A pair of bodies that touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairContact {
    /// The two bodies, `a < b`.
    pub bodies: [u32; 2],
    /// Whether one body is closed and contains the other, or a connected component of it, without intersecting faces.
    /// With an approximate culling mode some intersecting faces may have been missed.
    pub contained: bool,
    /// First of its faces in [`Contacts::faces`].
    pub first_face: u32,
    /// Number of its faces.
    pub face_count: u32,
    /// Representative contact of the pair.
    pub contact: Contact,
    /// First of its points in [`Contacts::points`].
    pub first_point: u32,
    /// Number of its points.
    pub point_count: u32,
    /// Total normal impulse of the pair in the step, newton seconds; 0 unless the response is
    /// [`Response::Contacts`](crate::types::settings::Response::Contacts).
    pub impulse: f32,
    /// Whether the two did not touch at the start of the step, but within it. Reported for a sensor and another body if
    /// one of them has [`ContinuousCollision`](crate::plugin::components::ContinuousCollision); `contact` is their
    /// first contact.
    pub passing: bool,
}

/// The representative contact of a pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// World position, metres.
    pub point: Vec3,
    /// Unit vector from the first body to the second.
    pub normal: Vec3,
}

/// A contact point as it is reported. Speculative points, at which no impulse acted, are included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPoint {
    /// Midpoint between the two surfaces at the start of its collision substep, world position, metres.
    pub point: Vec3,
    /// Unit vector from the first body to the second.
    pub normal: Vec3,
    /// Distance of the surfaces along the normal, metres; negative where they overlap.
    pub separation: f32,
    /// Normal impulse in that collision substep, newton seconds; 0 for sleeping bodies, and unless the response is
    /// [`Response::Contacts`](crate::types::settings::Response::Contacts).
    pub impulse: f32,
}

/// Two intersecting faces and their common segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacePair {
    /// Face of the first body, an index of the source mesh.
    pub a: u32,
    /// Face of the second body.
    pub b: u32,
    /// Start of the common segment in the world.
    pub start: Vec3,
    /// End of the segment; equal to `start` if the faces touch in a point. For coplanar faces the segment is the
    /// longest diagonal of their common area.
    pub end: Vec3,
}

/// A body that penetrates a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneContact {
    /// The body.
    pub body: u32,
    /// Index of the plane.
    pub plane: u32,
    /// Depth-weighted mean of the penetrating vertices, in the world.
    pub point: Vec3,
    /// Unit vector from the body into the plane.
    pub normal: Vec3,
    /// Depth of the deepest vertex, metres.
    pub depth: f32,
    /// First of its points in [`Contacts::points`].
    pub first_point: u32,
    /// Number of its points.
    pub point_count: u32,
    /// Total normal impulse, as in a [`PairContact`].
    pub impulse: f32,
}

impl Contacts {
    /// Returns memory beyond twice what is used.
    pub(crate) fn shrink(&mut self) {
        self.pairs.shrink_to(2 * self.pairs.len());
        self.faces.shrink_to(2 * self.faces.len());
        self.planes.shrink_to(2 * self.planes.len());
        self.points.shrink_to(2 * self.points.len());
    }

    /// Empties all lists and keeps the memory.
    pub(crate) fn clear(&mut self) {
        self.pairs.clear();
        self.faces.clear();
        self.planes.clear();
        self.points.clear();
        self.face_pairs = 0;
        self.triangle_tests = 0;
    }

    /// The contacts of pairs and planes that are `wanted` by their bodies' numbers. Planes are numbered from
    /// `first_plane` on.
    pub(crate) fn select(&self, first_plane: u32, wanted: impl Fn([u32; 2]) -> bool) -> Self {
        let mut some = Self::like(self);
        for pair in self.pairs.iter().filter(|pair| wanted(pair.bodies)) {
            some.add_pair(pair, self);
        }
        for plane in &self.planes {
            if wanted([plane.body, first_plane + plane.plane]) {
                some.add_plane(plane, self);
            }
        }
        some
    }

    /// These contacts and others, in order.
    pub(crate) fn merged(&self, others: &Self) -> Self {
        let mut all = Self::like(self);
        let both = [self, others];
        let pairs = both.map(|some| some.pairs.iter().map(move |pair| (pair, some)));
        merge(pairs, |(pair, _)| pair.bodies, |(pair, from)| all.add_pair(pair, from));
        let planes = both.map(|some| some.planes.iter().map(move |plane| (plane, some)));
        let order = |&(plane, _): &(&PlaneContact, &Self)| [plane.body, plane.plane];
        merge(planes, order, |(plane, from)| all.add_plane(plane, from));
        all
    }

    /// The contacts that the triangle test has found, without points: overlapping pairs and planes.
    pub(crate) fn tested(&self) -> Self {
        let is_tested = |pair: &&PairContact| pair.face_count > 0 || pair.contained;
        let mut some = Self::like(self);
        for pair in self.pairs.iter().filter(is_tested) {
            let tested = PairContact {
                point_count: 0,
                impulse: 0.0,
                ..*pair
            };
            some.add_pair(&tested, self);
        }
        for plane in self.planes.iter().filter(|plane| plane.depth > 0.0) {
            let tested = PlaneContact {
                point_count: 0,
                impulse: 0.0,
                ..*plane
            };
            some.add_plane(&tested, self);
        }
        some
    }

    fn like(other: &Self) -> Self {
        Self {
            lists_faces: other.lists_faces,
            face_pairs: other.face_pairs,
            triangle_tests: other.triangle_tests,
            ..Self::default()
        }
    }

    fn add_pair(&mut self, pair: &PairContact, from: &Self) {
        let (first_face, first_point) = (self.faces.len() as u32, self.points.len() as u32);
        self.faces.extend_from_slice(from.faces_of(pair));
        self.points.extend_from_slice(from.points_of(pair));
        self.pairs.push(PairContact {
            first_face,
            first_point,
            ..*pair
        });
    }

    fn add_plane(&mut self, plane: &PlaneContact, from: &Self) {
        let first_point = self.points.len() as u32;
        self.points.extend_from_slice(from.points_on(plane));
        self.planes.push(PlaneContact { first_point, ..*plane });
    }

    /// The intersecting faces of one of [`Contacts::pairs`].
    pub fn faces_of(&self, pair: &PairContact) -> &[FacePair] {
        let first = pair.first_face as usize;
        &self.faces[first..first + pair.face_count as usize]
    }

    /// The points of one of [`Contacts::pairs`].
    pub fn points_of(&self, pair: &PairContact) -> &[ContactPoint] {
        self.points_from(pair.first_point, pair.point_count)
    }

    /// The points of one of [`Contacts::planes`].
    pub fn points_on(&self, plane: &PlaneContact) -> &[ContactPoint] {
        self.points_from(plane.first_point, plane.point_count)
    }

    fn points_from(&self, first: u32, count: u32) -> &[ContactPoint] {
        &self.points[first as usize..(first + count) as usize]
    }
}
