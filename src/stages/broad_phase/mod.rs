//! BroadPhase: which bounding spheres overlap.
//!
//! A uniform grid whose cells are as large as the largest sphere: two that overlap lie in the same cell or in
//! neighbouring ones. Bodies are sorted by cell in rows along x, so that a cell and its neighbours along x are one run;
//! each body then looks at the rest of its own row and at the four neighbouring rows that come later in the order, and
//! sees every pair once.
//!
//! One body much larger than the rest makes all cells as large, and the grid no better than all pairs.

pub mod cpu;
#[cfg(feature = "gpu")]
pub mod gpu;

/// Cells on either side of the origin, per axis. Bodies farther out share the outermost cells, which costs time and
/// loses nothing.
const CELLS: i64 = 1 << 19;

/// The cell coordinate of `x` in cells of size `1 / per_meter`. Monotone, so that neighbours stay neighbours.
fn cell(x: f32, per_meter: f64) -> u64 {
    let c = (x as f64 * per_meter).floor();
    (c.clamp(-(CELLS as f64), CELLS as f64 - 1.0) as i64 + CELLS) as u64
}

/// Bits per axis in a key; one more than a cell coordinate needs, so that stepping to a neighbour never carries.
const BITS: u32 = 21;

/// Sort key of a cell: rows of constant (y, z) are runs.
fn key(x: u64, y: u64, z: u64) -> u64 {
    (z << (2 * BITS)) | (y << BITS) | x
}
