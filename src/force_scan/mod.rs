//! ForceScan: the response of bodies to their contacts.
//!
//! [`Response::Impulse`](crate::types::settings::Response::Impulse): every contact applies one impulse along its
//! normal, which reverses the closing speed times the mean coefficient of restitution. There is one entry per body and
//! contact; entries are sorted by body and summed by a segmented scan. All contacts see the same velocities, so a body
//! with `n` contacts counts as `n` bodies of `1/n` its mass, one for each contact (mass splitting). Its new velocity is
//! the mean of theirs, so pairs never add kinetic energy. Planes may add a little, because they also push penetrating
//! bodies out. Pairs do not: bodies that overlap at rest stay as they are.
//!
//! [`Response::Contacts`](crate::types::settings::Response::Contacts): islands that something disturbs wake, the
//! [`solver`](crate::solver) runs, touching pairs are recorded, and islands at rest fall [`asleep`](crate::sleep).

pub mod cpu;
#[cfg(feature = "gpu")]
pub mod gpu;
mod impulse;
pub(crate) mod touches;
