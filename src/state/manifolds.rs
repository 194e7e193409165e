//! Where two bodies push each other: the points that a solver works on.

use super::contacts::ContactPoint;
use glam::Vec3;

/// All contact points of a pair of bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Manifold {
    /// The two bodies, `a < b`.
    pub bodies: [u32; 2],
    /// Where its points start in [`Manifolds::points`].
    pub first_point: u32,
    /// How many there are.
    pub point_count: u32,
}

/// A point at which two bodies push each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ManifoldPoint {
    /// The point on each body's surface, from its centre of mass, turned with the world, metres. Where a corner of a finely
    /// cut round surface touches, the point is where the round surface would touch.
    pub arms: [Vec3; 2],
    /// Unit vector from the first body to the second. Between finely cut surfaces that are round all ways it lies between the
    /// centres of the balls that they are at the point.
    pub normal: Vec3,
    /// How far the second body's point lies from the first's along the normal, metres; negative where they overlap.
    pub separation: f32,
    /// Radius of curvature of each body's surface at its point, metres: 0 on a corner or crease, infinite where it is flat.
    /// The solver lets the point lie under the centre of curvature, which turns with the body: so that of a ball that rolls
    /// stays below its centre, and that of a corner goes with the corner.
    pub roundness: [f32; 2],
    /// How fast the normal turns as such surfaces slide along each other, radians per metre: as that of balls with the radii
    /// that they have where they are least round. 0 for others. The solver lets the normal turn until the point pushes.
    pub turn: f32,
    /// The faces the points lie on, by the numbers of the input meshes.
    pub faces: [u32; 2],
}

/// The contact points of all pairs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Manifolds {
    /// Ascending by bodies; those with half-spaces come last.
    pub pairs: Vec<Manifold>,
    /// One pair's after the other's.
    pub points: Vec<ManifoldPoint>,
}

impl Manifolds {
    /// Makes these the same as `others`, in the memory they have.
    #[cfg(feature = "bevy")]
    pub(crate) fn copy(&mut self, others: &Self) {
        self.pairs.clone_from(&others.pairs);
        self.points.clone_from(&others.points);
    }

    /// Removes all, keeping the memory.
    pub(crate) fn clear(&mut self) {
        self.pairs.clear();
        self.points.clear();
    }

    /// Adds the pair whose points are those from `first` on, if there are any.
    pub(crate) fn close(&mut self, bodies: [u32; 2], first: usize) {
        let count = self.points.len() - first;
        if count > 0 {
            self.pairs.push(Manifold {
                bodies,
                first_point: first as u32,
                point_count: count as u32,
            });
        }
    }

    /// The points of these bodies, which are in order; none if there are none. Half-spaces have the numbers from
    /// `planes_from` on.
    pub(crate) fn find(&self, bodies: [u32; 2], planes_from: u32) -> &[ManifoldPoint] {
        let wanted = place(bodies, planes_from);
        let found = self
            .pairs
            .binary_search_by_key(&wanted, |pair| place(pair.bodies, planes_from));
        found.map_or(&[], |at| self.points_of(&self.pairs[at]))
    }

    /// The points of one of [`Manifolds::pairs`].
    pub fn points_of(&self, pair: &Manifold) -> &[ManifoldPoint] {
        let first = pair.first_point as usize;
        &self.points[first..first + pair.point_count as usize]
    }
}

impl ManifoldPoint {
    /// The same as it is reported, for a first body whose centre of mass is at `center`.
    pub(crate) fn in_world(&self, center: Vec3, impulse: f32) -> ContactPoint {
        ContactPoint {
            point: center + self.arms[0] + self.normal * (0.5 * self.separation),
            normal: self.normal,
            separation: self.separation,
            impulse,
        }
    }
}

/// Where a pair stands in the order of pairs: those with half-spaces, which are numbered from `planes_from` on, come last.
pub(crate) fn place(bodies: [u32; 2], planes_from: u32) -> (bool, [u32; 2]) {
    (bodies[1] >= planes_from, bodies)
}

/// Where the surfaces are nearest to each other, or overlap most.
pub(crate) fn nearest(points: &[ManifoldPoint]) -> Option<&ManifoldPoint> {
    points.iter().min_by(|p, q| p.separation.total_cmp(&q.separation))
}
