//! Integrate: poses and velocities after the step.
//!
//! [`Response::None`](crate::types::settings::Response::None) and
//! [`Response::Impulse`](crate::types::settings::Response::Impulse) use semi-implicit Euler: first gravity and the
//! summed impulses change the velocities, then the new velocities change the poses.
//!
//! [`Response::Contacts`](crate::types::settings::Response::Contacts): the solver has integrated the motion in its
//! substeps. Bodies with continuous collision detection are stopped at their first impact (see [`ccd`](crate::ccd)),
//! and all bodies get their new poses.

pub mod cpu;
#[cfg(feature = "gpu")]
pub mod gpu;
