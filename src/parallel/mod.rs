//! Helpers for parallel loops whose results are bit-identical for any number of threads.

pub(crate) mod in_order;
pub(crate) mod loops;
pub(crate) mod per_thread;
