//! What parallel loops need to give the same bits for any number of threads.

pub(crate) mod in_order;
pub(crate) mod per_thread;
