//! Bounds of the errors of single precision.

/// Relative rounding error of a product of two vectors in single precision.
pub(crate) const ERROR: f32 = 2.0e-6;

/// Largest error of a normal's direction, radians. Less certain normals count as unknown.
pub(crate) const DIRECTION_ERROR: f32 = 1.0e-3;
/// Factor on radii, for rounding.
pub(crate) const AROUND_ERROR: f32 = 1.001;
/// The tilt of a triangle whose normal is not known: all heights are possible.
pub const ANY_TILT: f32 = 4.0;
