//! Angles: how the two bodies of a pair lie to each other, whether a support plane separates them, and which triangles
//! look from one to the other.
//!
//! The paper computes here, for each end of a pair, the direction to the other body in the body's own axes. The same
//! direction is the first axis of a support test: body `a` reaches at most `H_a(u)` along `u`, body `b` at most
//! `H_b(-u)` back, so the two are apart if `H_a(u) + H_b(-u) < d . u` for any `u`, where `d` runs from centre to centre.
//! Further axes come from Gilbert's iteration (Gilbert 1966) on the support points behind the heights: each is the
//! direction of the nearest point known of the Minkowski difference. Heights are upper bounds
//! ([`SupportHeights`](crate::projection::SupportHeights)), so no touching pair is rejected.
//!
//! For what is left the directions give each end's [`View`](crate::state::View), by its own body's
//! [`Culling`](crate::types::settings::Culling): in the mesh's own axes the direction is `M^-1 d`, where `M` turns and scales
//! the body, because that is how a line of sight moves with it; its two projection angles name a group in the face
//! table. Two bodies whose centres coincide have no direction, and show all triangles.

pub mod cpu;
#[cfg(feature = "gpu")]
pub mod gpu;

/// Axes tried per pair. Each costs two look-ups; eight reject 91 % (tori) and 85 % (knots) of the
/// overlapping spheres' pairs that do not touch.
pub const AXES: usize = 8;
