//! The contact constraint of one pair and its points, before they are loaded into lanes.

use glam::{Vec3, Vec3A};

/// The contact constraint of two bodies.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pair {
    pub colliders: [u32; 2],
    pub bodies: [u32; 2],
    /// Numbers of its bodies within its bundle.
    pub slots: [u32; 2],
    /// The first of its points in the manifolds.
    pub source: u32,
    /// Points of the pair: first number and count.
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
    /// The mass of the heavier body over that of the lighter one, if impulses move both, or if the lighter one is
    /// kinematic; 1 otherwise.
    pub mass_ratio: f32,
    /// How much softer its contact spring is than that of a pair with a static body; see
    /// [`softness`](super::softness::beside_kinematic).
    pub softness: f32,
    /// One body is kinematic and moves.
    pub driven: bool,
    /// Length of the substeps in which its impulses act, seconds.
    pub substep: f32,
    /// Whether the pair had contact points in the last collision substep.
    pub known: bool,
    /// In deep penetration: pushed apart along one direction, by its first point, until nothing overlaps.
    pub depenetrating: bool,
    /// The direction that resolves a conflict between contact points, in world axes; zero for other pairs. See
    /// [`Overlap::Conflicting`](super::overlap::Overlap::Conflicting).
    pub separating_direction: Vec3,
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
    /// How fast the normal rotates as the surfaces slide, radians per metre.
    pub normal_rotation: f32,
    /// The normal and two tangents: unit vectors. The normal points from the first body to the second.
    pub frame: [Vec3A; 3],
    /// Separation beyond the rest offset at the start of the collision substep.
    pub initial_separation: f32,
    /// Impulses of a substep, along the normal and along the tangents.
    pub normal_impulse: f32,
    pub friction_impulse: [f32; 2],
    /// From the point to where friction acts; see [`patch`](super::patch).
    pub friction_offset: Vec3A,
    /// The sum of the normal impulses of all earlier substeps; `normal_impulse` is not included.
    pub total_normal_impulse: f32,
    /// Whether the point has had an impulse in this collision substep or at the end of the last one.
    pub touched: bool,
    /// Whether the point has had restitution in this collision substep: the bodies separate.
    pub bounced: bool,
    /// Whether its numbers are valid, and it is part of the constraint.
    pub valid: bool,
}

impl Point {
    /// A point without effect.
    pub const NONE: Self = Self {
        anchors: [Vec3A::ZERO; 2],
        curvature_centers: [Vec3A::ZERO; 2],
        contact_fraction: 0.5,
        anchor_offset: Vec3A::ZERO,
        normal_rotation: 0.0,
        frame: [Vec3A::X, Vec3A::Y, Vec3A::Z],
        initial_separation: 0.0,
        normal_impulse: 0.0,
        friction_impulse: [0.0; 2],
        friction_offset: Vec3A::ZERO,
        total_normal_impulse: 0.0,
        touched: false,
        bounced: false,
        valid: false,
    };

    /// Unit vector from the first body to the second.
    pub fn normal(&self) -> Vec3A {
        self.frame[0]
    }

    /// The friction impulse in world axes.
    pub fn friction_vector(&self) -> Vec3A {
        self.frame[1] * self.friction_impulse[0] + self.frame[2] * self.friction_impulse[1]
    }
}

/// A normal and two tangents.
pub(super) fn frame(normal: Vec3) -> [Vec3A; 3] {
    let (t, u) = normal.any_orthonormal_pair();
    [normal, t, u].map(Vec3A::from)
}
