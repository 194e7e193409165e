//! Collision meshes of simple shapes: balls, capsules and boxes, exactly round; cylinders and cones, finely
//! tessellated.

use super::collision_mesh::CollisionMesh;
use crate::geometry::mesh::MAX_COORDINATE;
use crate::geometry::{MeshError, TriMesh, shapes};
use crate::projection::BakeSettings;
use glam::Vec3;
use thiserror::Error;

/// The sides of cylinders and cones.
pub const SIDES: u32 = 64;

/// The largest rounding, in units of a shape's size: something is left of the core.
const MOST_ROUND: f32 = 0.499;

/// The least size of a box's core, in units of its longest edge.
const LEAST_CORE: f32 = 1.0e-3;

/// Why a shape cannot be made.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ShapeError {
    /// A length is not a number, or too small or too large.
    #[error("its {what} is {value}, but must be more than 0 and at most {MAX_COORDINATE}")]
    Length {
        /// Which length it is.
        what: &'static str,
        /// Its value.
        value: f32,
    },
    /// The rounding is not a number, or negative or too large.
    #[error("its rounding is {0}, but must be 0 to {MAX_COORDINATE}")]
    Rounding(f32),
    /// The mesh of the shape is not valid: its lengths differ too much.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

impl CollisionMesh {
    /// A ball about the origin: a point with a rounding. Its surface is exactly round, and a contact with it costs
    /// little.
    ///
    /// # Errors
    /// If the radius is not positive, or too large.
    pub fn ball(radius: f32) -> Result<Self, ShapeError> {
        check("radius", radius)?;
        Ok(Self::rounded(&TriMesh::segment([Vec3::ZERO; 2])?, radius))
    }

    /// A capsule: all that is within `radius` of a segment of the y axis about the origin. `length` is that of the
    /// segment, without the half balls at its ends; 0 makes it a ball.
    ///
    /// # Errors
    /// If the radius is not positive, the length is negative, or one of them is too large.
    pub fn capsule(radius: f32, length: f32) -> Result<Self, ShapeError> {
        check("radius", radius)?;
        if length != 0.0 {
            check("length", length)?;
        }
        let end = 0.5 * length * Vec3::Y;
        Ok(Self::rounded(&TriMesh::segment([-end, end])?, radius))
    }

    /// A box about the origin with edges of these lengths. A `rounding` of more than 0 is taken off the box first, so
    /// that it keeps its size; it is a little less than half of the shortest edge at most.
    ///
    /// # Errors
    /// If a length is not positive, or too large.
    pub fn cuboid(size: Vec3, rounding: f32) -> Result<Self, ShapeError> {
        for (what, value) in [
            ("size along x", size.x),
            ("size along y", size.y),
            ("size along z", size.z),
        ] {
            check(what, value)?;
        }
        // The core has a volume that its mesh can show.
        let most = 0.5 * (size.min_element() - LEAST_CORE * size.max_element());
        let rounding = check_rounding(rounding)?.min(most).max(0.0);
        let core = size - 2.0 * rounding;
        let cube = shapes::cube(1.0);
        let vertices = cube.vertices().iter().map(|p| *p * core).collect();
        Ok(Self::rounded(
            &TriMesh::new(vertices, cube.triangles().to_vec())?,
            rounding,
        ))
    }

    /// A cylinder about the y axis, with its centre at the origin: a prism of [`SIDES`] sides. A `rounding` of more
    /// than 0 is taken off it first, so that it keeps its size.
    ///
    /// # Errors
    /// If a length is not positive, or too large.
    pub fn cylinder(radius: f32, height: f32, rounding: f32) -> Result<Self, ShapeError> {
        check("radius", radius)?;
        check("height", height)?;
        let rounding = check_rounding(rounding)?
            .min(MOST_ROUND * height)
            .min(2.0 * MOST_ROUND * radius);
        let rings = [0.5, -0.5].map(|y| (radius - rounding, y * (height - 2.0 * rounding)));
        Ok(Self::rounded(&turned(rings)?, rounding))
    }

    /// A cone about the y axis with its tip up, and its centre of mass a quarter of its height above its base, which is
    /// at `-height / 4`. It has [`SIDES`] sides. A `rounding` of more than 0 is added to it.
    ///
    /// # Errors
    /// If a length is not positive, or too large.
    pub fn cone(radius: f32, height: f32, rounding: f32) -> Result<Self, ShapeError> {
        check("radius", radius)?;
        check("height", height)?;
        let rounding = check_rounding(rounding)?;
        Ok(Self::rounded(
            &turned([(0.0, 0.75 * height), (radius, -0.25 * height)])?,
            rounding,
        ))
    }

    /// Bakes a mesh with a rounding.
    fn rounded(mesh: &TriMesh, rounding: f32) -> Self {
        let settings = BakeSettings {
            rounding,
            ..BakeSettings::default()
        };
        Self::without_faces(mesh, settings)
    }
}

fn check(what: &'static str, value: f32) -> Result<(), ShapeError> {
    let is_valid = value > 0.0 && value <= MAX_COORDINATE;
    is_valid.then_some(()).ok_or(ShapeError::Length { what, value })
}

fn check_rounding(rounding: f32) -> Result<f32, ShapeError> {
    let is_valid = (0.0..=MAX_COORDINATE).contains(&rounding);
    is_valid.then_some(rounding).ok_or(ShapeError::Rounding(rounding))
}

/// The solid between two circles about the y axis, each a radius and a height, the upper one first. A radius of 0 makes
/// it a point.
fn turned(circles: [(f32, f32); 2]) -> Result<TriMesh, MeshError> {
    let mut vertices = circles.map(|(_, y)| y * Vec3::Y).to_vec();
    for (radius, y) in circles {
        vertices.extend((0..SIDES).map(|i| {
            let (sin, cos) = (std::f32::consts::TAU * i as f32 / SIDES as f32).sin_cos();
            Vec3::new(radius * cos, y, -radius * sin)
        }));
    }
    let at = |circle: u32, i: u32| 2 + circle * SIDES + i % SIDES;
    let mut faces = Vec::new();
    for i in 0..SIDES {
        faces.push([1, at(1, i + 1), at(1, i)]);
        faces.push([at(1, i), at(1, i + 1), at(0, i)]);
        if circles[0].0 > 0.0 {
            faces.push([0, at(0, i), at(0, i + 1)]);
            faces.push([at(0, i), at(1, i + 1), at(0, i + 1)]);
        }
    }
    TriMesh::new(vertices, faces)
}
