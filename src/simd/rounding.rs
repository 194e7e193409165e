//! How single precision is kept safe: an allowance for its rounding, and a unit of length in which nothing overflows.

/// Rounding allowance of single-precision culls, relative to the sum of the two bounding radii. Rotating, scaling and
/// moving a point costs less than a millionth.
pub const PAD: f32 = 4.0e-6;

/// The power of two that brings `size` between 1 and 2. Multiplying by it is exact.
pub fn unit_of(size: f32) -> f32 {
    let exponent = (size.to_bits() >> 23) & 0xff;
    // Bounding radii are far from the ends of the range, so this is a normal number.
    f32::from_bits((254 - exponent.clamp(1, 253)) << 23)
}
