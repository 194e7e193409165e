//! What touches: pairs of bodies with their intersecting faces, bodies and half-spaces, and the points between them.

use glam::Vec3;

/// TriangleTest's result.
#[derive(Clone, Debug, Default)]
pub struct Contacts {
    /// Pairs that touch, ascending.
    pub pairs: Vec<PairContact>,
    /// Intersecting faces of all pairs, one pair's after the other's.
    pub faces: Vec<FacePair>,
    /// Bodies that reach into half-spaces, ascending by body, then plane.
    pub planes: Vec<PlaneContact>,
    /// Where the pairs, and after them bodies and half-spaces, pushed each other: one pair's after the other's.
    pub points: Vec<ContactPoint>,
    /// Triangle against triangle tests made (pairs of triangles whose boxes overlap).
    pub triangle_tests: u64,
}

/// Two bodies that touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairContact {
    /// The two bodies, `a < b`.
    pub bodies: [u32; 2],
    /// One is closed and has the other, or a connected component of it, inside, and no faces were found to intersect; with an
    /// approximate culling mode some may.
    pub contained: bool,
    /// Where its faces start in [`Contacts::faces`].
    pub first_face: u32,
    /// How many there are.
    pub face_count: u32,
    /// Where to push.
    pub contact: Contact,
    /// Where its points start in [`Contacts::points`].
    pub first_point: u32,
    /// How many there are.
    pub point_count: u32,
    /// How strongly the two pushed each other along the normals of their points in the step, newton seconds; 0 unless the
    /// response is [`Response::Contacts`].
    pub impulse: f32,
    /// They did not touch at the beginning of the step, but on their ways within it: a sensor and another body, one of them with
    /// [`ContinuousCollision`](crate::plugin::components::ContinuousCollision). The contact is where they first touched.
    pub passing: bool,
}

/// A point at which two bodies push each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// In the world, metres.
    pub point: Vec3,
    /// Unit vector from the first body to the second.
    pub normal: Vec3,
}

/// One of the points at which two bodies pushed each other in a step, or might have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPoint {
    /// Halfway between both surfaces, in the world, metres: where it was as its collision substep began.
    pub point: Vec3,
    /// Unit vector from the first body to the second.
    pub normal: Vec3,
    /// How far the surfaces were apart, metres; negative where they overlapped.
    pub separation: f32,
    /// How strongly the two pushed each other there along the normal in that interval, newton seconds; 0 unless the response
    /// is [`Response::Contacts`], and for bodies asleep.
    pub impulse: f32,
}

/// Two faces that intersect, with their common segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacePair {
    /// Face of the first body's mesh, an index of the input mesh.
    pub a: u32,
    /// Face of the second body's mesh.
    pub b: u32,
    /// One end of the common segment in the world.
    pub start: Vec3,
    /// The other end; equal to `start` if they touch in a point. For coplanar faces the longest diagonal.
    pub end: Vec3,
}

/// A body that reaches into a half-space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneContact {
    /// The body.
    pub body: u32,
    /// Index of the half-space.
    pub plane: u32,
    /// Mean of the vertices inside, weighted by depth, in the world.
    pub point: Vec3,
    /// Unit vector from the body into the half-space.
    pub normal: Vec3,
    /// How far the deepest vertex is inside, metres.
    pub depth: f32,
    /// Where its points start in [`Contacts::points`].
    pub first_point: u32,
    /// How many there are.
    pub point_count: u32,
    /// As that of a [`PairContact`].
    pub impulse: f32,
}

impl Contacts {
    /// Removes all, keeping the memory.
    pub(crate) fn clear(&mut self) {
        self.pairs.clear();
        self.faces.clear();
        self.planes.clear();
        self.points.clear();
        self.triangle_tests = 0;
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
