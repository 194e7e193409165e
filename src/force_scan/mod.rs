//! ForceScan: what contacts do to the bodies.
//!
//! With [`Response::Impulse`](crate::types::settings::Response::Impulse) there is one impulse per contact, one entry per body and
//! contact, sorted by body, summed by a segmented scan. A contact answers with a single impulse along its normal that turns the
//! closing speed round by the mean restitution. All contacts are answered at once from the same velocities, so a body in `n` contacts
//! counts as `n` bodies of `1/n` its mass, one for each contact (mass splitting): their mean velocity is the body's new one, and
//! pairs cannot add kinetic energy. Planes can, a little: they also push out what is inside. Pairs do not; bodies that overlap
//! at rest stay as they are.
//!
//! With [`Response::Contacts`](crate::types::settings::Response::Contacts) islands of bodies are woken, the
//! [`solver`](crate::solver) runs, touches are noted, and islands at rest fall [`asleep`](crate::sleep).

pub mod cpu;
#[cfg(feature = "gpu")]
pub mod gpu;
mod impulse;
pub(crate) mod touches;
