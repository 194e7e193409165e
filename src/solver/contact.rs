//! The contact constraint of one pair, its points and their rows.

use super::motion::Mass;
use glam::{Vec3, Vec3A};

/// The contact constraint of two bodies.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pair {
    pub colliders: [u32; 2],
    pub bodies: [u32; 2],
    /// Numbers of its bodies within its island.
    pub slots: [u32; 2],
    /// The first of its points in the manifolds.
    pub source: u32,
    /// Its points: first number and count.
    pub first: u32,
    pub count: u32,
    pub friction: f32,
    pub restitution: f32,
    /// See [`ContactSurface::tangent_velocity`](crate::state::ContactSurface::tangent_velocity).
    pub tangent_velocity: Vec3,
    /// D: the bounding diameter of the smaller collider, metres.
    pub diameter: f32,
    /// The gap that the contact keeps, metres.
    pub rest_offset: f32,
    /// The mass of the heavier body over that of the lighter one, if impulses move both; 1 otherwise.
    pub mass_ratio: f32,
    /// Length of the substeps in which its impulses act, seconds.
    pub substep: f32,
    /// It had contact points in the last collision substep.
    pub known: bool,
    /// Some point is active.
    pub active: bool,
    /// In deep penetration: pushed apart along one direction, by its first point, until nothing overlaps.
    pub depenetrating: bool,
    /// The direction that resolves a conflict between contact points, in world axes; zero for other pairs. See
    /// [`Overlap::Conflicting`](super::overlap::Overlap::Conflicting).
    pub separating_direction: Vec3,
}

/// One row of a point's constraint: the normal or a tangent, with the Jacobian along it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    /// Unit vector. The normal points from the first body to the second and is constant once the point has touched.
    pub direction: Vec3A,
    /// The moment of a unit impulse about each centre of mass: `r x direction`.
    pub moments: [Vec3A; 2],
    /// The change of angular velocity by that moment.
    pub angular_responses: [Vec3A; 2],
}

/// A contact point of a pair.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    /// From each centre of mass to the point on the surface, at the start of the collision substep.
    pub anchors: [Vec3A; 2],
    /// From each centre of mass to the centre of curvature, at the start of the collision substep. For a flat surface
    /// it is the anchor.
    pub curvature_centers: [Vec3A; 2],
    /// Where impulses act, as a fraction of the way from the first anchor to the second.
    pub contact_fraction: f32,
    /// From the first anchor to the second, at the start of the collision substep.
    pub anchor_offset: Vec3A,
    /// The normal at the start of the collision substep.
    pub initial_normal: Vec3A,
    /// How fast the normal rotates as the surfaces slide, radians per metre.
    pub normal_rotation: f32,
    /// The normal and two tangents.
    pub rows: [Row; 3],
    /// Change of the relative velocity by a unit impulse along the normal, and along a tangent.
    pub inverse_effective_mass: [f32; 2],
    /// Separation beyond the rest offset at the start of the collision substep.
    pub initial_separation: f32,
    /// Separation beyond the rest offset now.
    pub separation: f32,
    /// Impulses of this substep, along the normal and along the tangents.
    pub normal_impulse: f32,
    pub friction_impulse: [f32; 2],
    /// The change of the three impulses in the last pass.
    pub change: [f32; 3],
    /// The direction in which they are extrapolated.
    pub search: [f32; 3],
    /// Relative velocity along the tangents by which the point drifts in a substep because its bodies rotate.
    pub drift: [f32; 2],
    /// Relative velocity of the surfaces along the tangents, in addition to that of the bodies.
    pub surface_speed: [f32; 2],
    /// From the point to where friction acts; see [`patch`](super::patch).
    pub friction_offset: Vec3A,
    /// The sum of the normal impulses of all earlier substeps; `normal_impulse` is not included.
    pub total_normal_impulse: f32,
    /// The normal velocity before an impact, negative.
    pub impact_velocity: f32,
    /// It had no impulse at the start of the substep, so an impulse now is an impact.
    pub may_impact: bool,
    /// It has an impact in this substep, with restitution.
    pub has_impact: bool,
    /// Its velocity after the impacts of this substep is at least the reversed one.
    pub rebounds: bool,
    /// It has had an impulse in this collision substep or at the end of the last one.
    pub touched: bool,
    /// It has had restitution in this collision substep: the bodies separate.
    pub bounced: bool,
    /// Its numbers are valid, and it is part of the constraint.
    pub valid: bool,
    /// It is solved in this substep.
    pub active: bool,
}

impl Row {
    const fn along(direction: Vec3A) -> Self {
        Self {
            direction,
            moments: [Vec3A::ZERO; 2],
            angular_responses: [Vec3A::ZERO; 2],
        }
    }

    /// Rows along `normal` and two tangents. [`update_points`](super::solve::update_points) sets the rest.
    pub fn frame(normal: Vec3) -> [Self; 3] {
        let (t, u) = normal.any_orthonormal_pair();
        [normal, t, u].map(|d| Self::along(d.into()))
    }
}

impl Point {
    /// A point without effect.
    pub const NONE: Self = Self {
        anchors: [Vec3A::ZERO; 2],
        curvature_centers: [Vec3A::ZERO; 2],
        contact_fraction: 0.5,
        anchor_offset: Vec3A::ZERO,
        initial_normal: Vec3A::X,
        normal_rotation: 0.0,
        rows: [Row::along(Vec3A::X), Row::along(Vec3A::Y), Row::along(Vec3A::Z)],
        inverse_effective_mass: [0.0; 2],
        initial_separation: 0.0,
        separation: 0.0,
        normal_impulse: 0.0,
        friction_impulse: [0.0; 2],
        change: [0.0; 3],
        search: [0.0; 3],
        drift: [0.0; 2],
        surface_speed: [0.0; 2],
        friction_offset: Vec3A::ZERO,
        total_normal_impulse: 0.0,
        impact_velocity: 0.0,
        may_impact: false,
        has_impact: false,
        rebounds: false,
        touched: false,
        bounced: false,
        valid: false,
        active: false,
    };

    /// Rotates the normal of curved surfaces that have not touched yet, as that of two balls that pass each other:
    /// their impulse acts along the normal at the moment of contact. `displacement` is how far the second centre of
    /// curvature has moved relative to the first.
    pub fn rotate_normal(&mut self, displacement: Vec3A) {
        if self.normal_rotation > 0.0 && !self.touched {
            let normal = self.initial_normal + self.normal_rotation * displacement;
            self.rows = Row::frame(normal.normalize_or(self.initial_normal).into());
        }
    }

    /// The separation beyond the rest offset after such a displacement.
    pub fn separation_after(&self, displacement: Vec3A) -> f32 {
        let along = self.initial_separation + self.normal().dot(displacement);
        if self.normal_rotation > 0.0 {
            // The distance between the centres of curvature is shorter along the rotated normal.
            along - 0.5 * self.normal().distance_squared(self.initial_normal) / self.normal_rotation
        } else {
            along
        }
    }

    /// Unit vector from the first body to the second.
    pub fn normal(&self) -> Vec3A {
        self.rows[0].direction
    }

    /// Sets the drift for a substep of `h` seconds in which the bodies rotate with these angular velocities, and the speed
    /// of surfaces that move with this velocity.
    pub fn set_drift(&mut self, spins: [Vec3A; 2], tangent_velocity: Vec3, h: f32) {
        let [a, b] = [0, 1].map(|side| spins[side].cross(spins[side].cross(self.anchors[side])));
        let drift = 0.5 * h * (b - a);
        let moving = Vec3A::from(tangent_velocity);
        self.surface_speed = [1, 2].map(|i| moving.dot(self.rows[i].direction));
        let [t, u] = self.surface_speed;
        self.drift = [(1, t), (2, u)].map(|(i, speed)| drift.dot(self.rows[i].direction) + speed);
    }

    /// Sets the place at which impulses act, from each centre of mass.
    pub fn set_anchors(&mut self, anchors: [Vec3A; 2], masses: [Mass; 2]) {
        let inverse_masses = masses[0].inverse_mass + masses[1].inverse_mass;
        let offsets = [Vec3A::ZERO, self.friction_offset, self.friction_offset];
        let mut inverse_effective_mass = [0.0; 3];
        for ((row, offset), k) in self.rows.iter_mut().zip(offsets).zip(&mut inverse_effective_mass) {
            let d = row.direction;
            row.moments = anchors.map(|anchor| (anchor + offset).cross(d));
            row.angular_responses = [0, 1].map(|side| masses[side].inverse_inertia * row.moments[side]);
            let turned = row.moments[0] * row.angular_responses[0] + row.moments[1] * row.angular_responses[1];
            *k = (inverse_masses * d * d + turned).element_sum();
        }
        // Both tangents use the same value. Otherwise friction would not point against the sliding direction.
        let [normal, t, u] = inverse_effective_mass;
        self.inverse_effective_mass = [normal, t.max(u)];
    }

    /// Multiplies its impulses, for substeps of another length. The total of the collision substep stays.
    pub fn scale_impulses(&mut self, factor: f32) {
        let impulse = factor * self.normal_impulse;
        self.total_normal_impulse += self.normal_impulse - impulse;
        self.normal_impulse = impulse;
        self.friction_impulse = self.friction_impulse.map(|impulse| factor * impulse);
    }

    /// The friction impulse in world axes.
    pub fn friction_vector(&self) -> Vec3A {
        self.rows[1].direction * self.friction_impulse[0] + self.rows[2].direction * self.friction_impulse[1]
    }
}
