//! The solver on the GPU: what [`Solver`](super::Solver) does, with bodies, contacts and the memory of impulses in buffers.
//!
//! A thread a pair solves the pair's points, a thread a body sums the impulses of its ends; the ends are sorted by body
//! once an interval. Every sum is in the order of pairs, so the same input gives the same bits.
//!
//! | file | holds |
//! |---|---|
//! | [`layout`] | what passes between kernels and host |
//! | [`kernels`] | the kernels, `shaders/solver_*.wgsl` |
//! | [`sleep`] | more of them, and their calls: which bodies are frozen |
//! | [`lists`] | the buffers |
//! | [`record`](mod@record) | an interval as calls |
//! | [`upload`] | from the host's bodies and contacts to the device's, and back |
//! | [`alone`] | a solver without the rest of the step |
//!
//! The device has no double precision: centres and rotations are kept in two parts, so that what moves slowly far from the
//! origin moves all the same. If there are more pairs or points than the lists hold, nothing is solved and the status says
//! so.

pub mod kernels;
pub mod layout;
pub mod lists;
pub mod record;
pub mod upload;

pub use kernels::KERNELS;
pub use lists::{Inputs, Lists, Room};
pub use record::{Passes, record, record_settle, record_solve};
