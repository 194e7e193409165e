//! Shapes to ask with.

use super::placed::Placed;
use crate::asset::CollisionMesh;
use crate::geometry::shapes;
use glam::{DQuat, DVec3, Vec3};
use std::sync::LazyLock;

/// A shape to ask with, in its own axes. A ball, a box, a capsule and a closed mesh are solid: they overlap what is
/// inside them.
///
/// A shape is valid if its numbers are finite, radii and lengths are not negative, half sizes are positive, the scale
/// does not make the mesh flat, and the largest half size is at most a million times the smallest. Asked with a shape
/// or a pose that is not valid, every query finds nothing.
#[derive(Clone, Copy, Debug)]
pub enum QueryShape<'a> {
    /// A mesh with a scale along its own axes, which may mirror.
    Mesh(&'a CollisionMesh, Vec3),
    /// A ball about the origin. A radius of 0 makes it a point.
    Ball {
        /// Metres.
        radius: f64,
    },
    /// A box about the origin. Its half sizes are rounded to single precision.
    Box {
        /// Half the lengths of its edges, metres.
        half_size: DVec3,
    },
    /// All points that are no farther than `radius` from a segment of the y axis about the origin.
    Capsule {
        /// Metres.
        radius: f64,
        /// Half the length of the segment, metres. 0 makes it a ball.
        half_length: f64,
    },
}

/// A box of edge 1.
static UNIT_CUBE: LazyLock<CollisionMesh> = LazyLock::new(|| CollisionMesh::new(&shapes::cube(1.0)));

/// A shape with a pose.
pub(super) enum PlacedShape<'a> {
    Mesh(Placed<'a>),
    Round(Round),
}

/// All points that are no farther than `radius` from a segment.
#[derive(Clone, Copy)]
pub(super) struct Round {
    /// The ends of the segment; equal for a ball.
    pub ends: [DVec3; 2],
    pub radius: f64,
}

impl<'a> QueryShape<'a> {
    /// The axis-aligned bounding box of the shape with a pose: least and largest coordinates, metres. `None` if the
    /// shape or the pose is not valid.
    pub fn bounding_box(&self, translation: DVec3, rotation: DQuat) -> Option<[DVec3; 2]> {
        Some(match self.placed(translation, rotation)? {
            PlacedShape::Mesh(mesh) => mesh.bounding_box(),
            PlacedShape::Round(round) => round.bounding_box(),
        })
    }

    /// The shape with a pose, if both are valid.
    pub(super) fn placed(&self, translation: DVec3, rotation: DQuat) -> Option<PlacedShape<'a>> {
        let mesh = |mesh: &'a CollisionMesh, scale: Vec3| {
            let placed = Placed::new(mesh, translation, rotation, scale).ok()?;
            Some(if mesh.mesh.is_thin() {
                let [start, _, end] = placed.corners(0);
                PlacedShape::Round(Round {
                    ends: [start, end].map(|end| placed.in_world(end)),
                    radius: placed.rounding(),
                })
            } else {
                PlacedShape::Mesh(placed)
            })
        };
        let round = |radius: f64, half_length: f64| {
            let axis = rotation.normalize() * (DVec3::Y * half_length);
            let is_length = |length: f64| length >= 0.0 && length.is_finite();
            let is_valid = is_length(radius) && is_length(half_length) && translation.is_finite() && axis.is_finite();
            is_valid.then_some(PlacedShape::Round(Round {
                ends: [translation - axis, translation + axis],
                radius,
            }))
        };
        match *self {
            Self::Mesh(baked, scale) => mesh(baked, scale),
            Self::Box { half_size } if half_size.cmpgt(DVec3::ZERO).all() => {
                mesh(&UNIT_CUBE, (2.0 * half_size).as_vec3())
            }
            Self::Box { .. } => None,
            Self::Ball { radius } => round(radius, 0.0),
            Self::Capsule { radius, half_length } => round(radius, half_length),
        }
    }
}

impl PlacedShape<'_> {
    /// Its point that is farthest along a unit direction.
    pub fn farthest(&self, direction: DVec3) -> DVec3 {
        match self {
            Self::Mesh(mesh) => mesh.farthest(direction),
            Self::Round(Round { ends: [p, q], radius }) => {
                let end = if direction.dot(*p - *q) > 0.0 { *p } else { *q };
                end + direction * *radius
            }
        }
    }
}

impl Round {
    /// Least and largest coordinates.
    pub fn bounding_box(&self) -> [DVec3; 2] {
        let Self { ends: [p, q], radius } = *self;
        [p.min(q) - radius, p.max(q) + radius]
    }
}
