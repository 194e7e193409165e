//! Contact manifolds: the contact points that the solver works on.

use super::contacts::ContactPoint;
use super::merge::merge;
use glam::Vec3;

/// The contact points of a pair of colliders.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Manifold {
    /// The two colliders, `a < b`.
    pub bodies: [u32; 2],
    /// First of its points in [`Manifolds::points`].
    pub first_point: u32,
    /// Number of its points.
    pub point_count: u32,
}

/// A contact point.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ManifoldPoint {
    /// Anchors: the point on each collider's surface relative to its body's centre of mass, in world axes, metres.
    /// Where a finely tessellated curved surface touches, the anchor lies on the smooth surface through its vertices.
    pub anchors: [Vec3; 2],
    /// Unit vector from the first body to the second. Between finely tessellated surfaces that are convex in all
    /// directions it is the normal of the smooth surfaces, on the line between their centres of curvature.
    pub normal: Vec3,
    /// Signed distance of the meshes along the normal, metres; negative where the bodies overlap. On a plane, the
    /// distance of the smooth surface.
    pub separation: f32,
    /// By how much the smooth surfaces are nearer to each other than `separation` tells, metres; 0 for other surfaces.
    /// The solver keeps the smooth surfaces apart.
    #[serde(default)]
    pub bulge: f32,
    /// Radius of curvature of each body's surface at its anchor, metres, in the direction in which the body rolls: 0 at
    /// a vertex or crease, infinite where the surface is flat. As the body rotates, the solver keeps the anchor below
    /// the centre of curvature: the contact of a rolling ball stays below its centre, and the contact of a corner
    /// rotates with the corner.
    #[serde(with = "infinite_as_none")]
    pub curvature_radii: [f32; 2],
    /// Rotation of the normal per distance that the smooth surfaces slide along each other, rad/m, from the largest
    /// radii of curvature of both; 0 for other surfaces. The solver rotates the normal until the point carries an
    /// impulse.
    pub normal_rotation: f32,
    /// Faces on which the anchors lie, indices of the source meshes.
    pub faces: [u32; 2],
}

/// How the surfaces of a pair touch.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ContactSurface {
    /// Coefficient of friction, 0 or more.
    pub friction: f32,
    /// Coefficient of restitution, 0 to 1.
    pub restitution: f32,
    /// Velocity of the second surface relative to the first, in addition to the motion of the bodies, m/s in world
    /// axes: the velocity of a conveyor belt if it is the second, its opposite if it is the first.
    pub tangent_velocity: Vec3,
}

/// The contact manifolds of all pairs.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Manifolds {
    /// Manifolds, ascending by bodies; manifolds with planes come last.
    pub pairs: Vec<Manifold>,
    /// Contact points, grouped by pair.
    pub points: Vec<ManifoldPoint>,
    /// Colliders and surface of pairs whose surface a hook has changed, ascending.
    pub surfaces: Vec<([u32; 2], ContactSurface)>,
}

impl Manifolds {
    /// Copies `others` into the existing memory.
    #[cfg(feature = "bevy")]
    pub(crate) fn copy_from(&mut self, others: &Self) {
        self.pairs.clone_from(&others.pairs);
        self.points.clone_from(&others.points);
        self.surfaces.clone_from(&others.surfaces);
    }

    /// Empties the lists and keeps the memory.
    pub(crate) fn clear(&mut self) {
        self.pairs.clear();
        self.points.clear();
        self.surfaces.clear();
    }

    /// Returns memory beyond twice what is used.
    pub(crate) fn shrink(&mut self) {
        self.pairs.shrink_to(2 * self.pairs.len());
        self.points.shrink_to(2 * self.points.len());
        self.surfaces.shrink_to(2 * self.surfaces.len());
    }

    /// Completes a pair whose points start at `first`. A pair without points is not added.
    pub(crate) fn end_pair(&mut self, bodies: [u32; 2], first: usize) {
        let count = self.points.len() - first;
        if count > 0 {
            self.pairs.push(Manifold {
                bodies,
                first_point: first as u32,
                point_count: count as u32,
            });
        }
    }

    /// Writes into `all` these manifolds with further points, whose pairs ascend and are of bodies, not planes.
    pub(crate) fn with_points(&self, added: &[([u32; 2], ManifoldPoint)], first_plane: u32, all: &mut Self) {
        all.clear();
        all.surfaces.extend_from_slice(&self.surfaces);
        let mut added = added.iter().peekable();
        let mut add_alone = |all: &mut Self, until: Option<(bool, [u32; 2])>| {
            let is_before = |pair: [u32; 2]| until.is_none_or(|until| pair_order(pair, first_plane) < until);
            while let Some((pair, point)) = added.next_if(|(pair, _)| is_before(*pair)) {
                let first = all.points.len();
                all.points.push(*point);
                all.end_pair(*pair, first);
            }
            added.next_if(|(pair, _)| Some(pair_order(*pair, first_plane)) == until)
        };
        for pair in &self.pairs {
            let more = add_alone(all, Some(pair_order(pair.bodies, first_plane)));
            let first = all.points.len();
            all.points.extend_from_slice(self.points_of(pair));
            all.points.extend(more.map(|(_, point)| *point));
            all.end_pair(pair.bodies, first);
        }
        add_alone(all, None);
    }

    /// The manifolds of the `wanted` pairs.
    pub(crate) fn select(&self, wanted: impl Fn([u32; 2]) -> bool) -> Self {
        let mut some = Self::default();
        for pair in self.pairs.iter().filter(|pair| wanted(pair.bodies)) {
            some.add_pair(pair, self);
        }
        let surfaces = self.surfaces.iter().filter(|(pair, _)| wanted(*pair));
        some.surfaces.extend(surfaces.copied());
        some
    }

    /// These manifolds and others, in order.
    pub(crate) fn merged(&self, others: &Self, first_plane: u32) -> Self {
        let mut all = Self::default();
        let both = [self, others];
        let pairs = both.map(|some| some.pairs.iter().map(move |pair| (pair, some)));
        let order = |&(pair, _): &(&Manifold, &Self)| pair_order(pair.bodies, first_plane);
        merge(pairs, order, |(pair, from)| all.add_pair(pair, from));
        let surfaces = both.map(|some| some.surfaces.iter().copied());
        merge(surfaces, |&(pair, _)| pair, |surface| all.surfaces.push(surface));
        all
    }

    fn add_pair(&mut self, pair: &Manifold, from: &Self) {
        let first = self.points.len();
        self.points.extend_from_slice(from.points_of(pair));
        self.end_pair(pair.bodies, first);
    }

    /// Contact points of a pair, which must be in ascending order; empty if it has none. Plane `i` has the number
    /// `first_plane + i`.
    pub(crate) fn find(&self, bodies: [u32; 2], first_plane: u32) -> &[ManifoldPoint] {
        let wanted = pair_order(bodies, first_plane);
        let found = self
            .pairs
            .binary_search_by_key(&wanted, |pair| pair_order(pair.bodies, first_plane));
        found.map_or(&[], |at| self.points_of(&self.pairs[at]))
    }

    /// The surface of a pair, if it differs from that of its colliders.
    pub(crate) fn surface_of(&self, bodies: [u32; 2]) -> Option<&ContactSurface> {
        let found = self.surfaces.binary_search_by_key(&bodies, |&(pair, _)| pair);
        found.ok().map(|at| &self.surfaces[at].1)
    }

    /// The points of one of [`Manifolds::pairs`].
    pub fn points_of(&self, pair: &Manifold) -> &[ManifoldPoint] {
        let first = pair.first_point as usize;
        &self.points[first..first + pair.point_count as usize]
    }
}

impl ContactSurface {
    /// This surface with values of `other` in place of invalid ones.
    pub(crate) fn checked(self, other: &Self) -> Self {
        let coefficient = |own: f32, other: f32| if own.is_finite() { own.max(0.0) } else { other };
        Self {
            friction: coefficient(self.friction, other.friction),
            restitution: coefficient(self.restitution, other.restitution).min(1.0),
            tangent_velocity: if self.tangent_velocity.is_finite() {
                self.tangent_velocity
            } else {
                other.tangent_velocity
            },
        }
    }
}

impl ManifoldPoint {
    /// The point of the same pair in the other order.
    #[cfg(feature = "bevy")]
    pub(crate) fn flipped(self) -> Self {
        let ([a, b], [radius_a, radius_b], [face_a, face_b]) = (self.anchors, self.curvature_radii, self.faces);
        Self {
            anchors: [b, a],
            normal: -self.normal,
            curvature_radii: [radius_b, radius_a],
            faces: [face_b, face_a],
            ..self
        }
    }

    /// The point with anchors relative to the bodies' centres of mass, from anchors relative to the colliders'.
    /// `offsets` lead from the bodies' centres to the colliders'.
    pub(crate) fn shifted(self, offsets: [Vec3; 2]) -> Self {
        let [a, b] = self.anchors;
        Self {
            anchors: [a + offsets[0], b + offsets[1]],
            ..self
        }
    }

    /// From the centre of mass of each body to the centre of curvature below its anchor, world axes, metres. For a flat
    /// surface, the anchor instead. `offsets` lead from the bodies' centres of mass to the colliders'.
    pub(crate) fn curvature_centers(&self, offsets: [Vec3; 2]) -> [Vec3; 2] {
        let outward = [self.normal, -self.normal];
        [0, 1].map(|side| {
            let (anchor, radius) = (self.anchors[side], self.curvature_radii[side]);
            // No deeper than the collider's centre of mass. For a ball that is exactly its centre of curvature.
            let max_depth = (anchor - offsets[side]).dot(outward[side]).max(0.0);
            let depth = if radius < f32::INFINITY {
                radius.min(max_depth)
            } else {
                0.0
            };
            anchor - depth * outward[side]
        })
    }

    /// Signed distance of the smooth surfaces from the first anchor to the second along the normal, metres.
    pub(crate) fn gap(&self) -> f32 {
        self.separation - self.bulge
    }

    /// The reported form of the point; `center` is the first body's centre of mass.
    pub(crate) fn in_world(&self, center: Vec3, impulse: f32) -> ContactPoint {
        ContactPoint {
            point: center + self.anchors[0] + self.normal * (0.5 * self.gap()),
            normal: self.normal,
            separation: self.separation,
            impulse,
        }
    }
}

/// Sort key of a pair. Pairs with planes, which have the numbers from `first_plane` on, come last.
pub(crate) fn pair_order(bodies: [u32; 2], first_plane: u32) -> (bool, [u32; 2]) {
    (bodies[1] >= first_plane, bodies)
}

/// The point of least separation.
pub(crate) fn nearest(points: &[ManifoldPoint]) -> Option<&ManifoldPoint> {
    points.iter().min_by(|p, q| p.separation.total_cmp(&q.separation))
}

/// Writes infinite numbers as `None`, because JSON has no infinity.
mod infinite_as_none {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub fn serialize<S: Serializer>(numbers: &[f32; 2], serializer: S) -> Result<S::Ok, S::Error> {
        let finite = numbers.map(|number| (number != f32::INFINITY).then_some(number));
        finite.serialize(serializer)
    }

    pub fn deserialize<'d, D: Deserializer<'d>>(deserializer: D) -> Result<[f32; 2], D::Error> {
        let finite = <[Option<f32>; 2]>::deserialize(deserializer)?;
        Ok(finite.map(|number| number.unwrap_or(f32::INFINITY)))
    }
}
