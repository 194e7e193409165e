//! The fixed step: its stages in order, each in a folder of its own with one file per backend.
//!
//! | stage | reads | writes |
//! |---|---|---|
//! | [`broad_phase`] | bounding spheres, and how far bodies look | pairs whose spheres overlap |
//! | [`angles`] | those pairs, poses, support heights, face tables | pairs that no support plane separates, with relative poses and what is seen of each end |
//! | [`triangle_test`] | those pairs, triangles | touching pairs, intersecting faces, contacts |
//! | [`manifolds`] | the same pairs, vertices, edges and faces | the points at which bodies push each other |
//! | [`force_scan`] | contacts, or with [`Response::Contacts`](crate::types::settings::Response) the points, for the [`solver`] | one sum of impulses per body, or motions |
//! | [`integrate`] | those, gravity | velocities and poses |
//!
//! With `Response::Contacts` a step is cut into as many *detection intervals* as its bodies need, by how fast they move against
//! each other, and all stages but
//! the triangle test run in each; see [`solver`].
//!
//! Each stage has a file per backend: `cpu.rs` runs on rayon, `gpu.rs` declares the kernels in `shaders/` that do the same
//! on a device (see `crate::gpu`, and `crate::step::gpu::contacts` for a step with contacts). Continuous collision is the CPU's alone:
//! steps with a body that asks for it run there.
//!
//! [`state`] holds every array that passes between them. Stages know nothing of the ECS: the plugin copies components
//! in and results out.

pub mod cpu;
pub mod dynamics;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod order;
pub(crate) mod touches;
