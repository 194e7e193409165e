//! Progress and cancellation of a bake, shared between the baking thread and the waiting thread.

use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use thiserror::Error;

/// The bake was cancelled through its [`Progress`].
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error("the bake was cancelled")]
pub struct Cancelled;

/// The progress of a bake, and a way to cancel it.
#[derive(Debug, Default)]
pub struct Progress {
    done: AtomicU32,
    total: AtomicU32,
    cancelled: AtomicBool,
}

impl Progress {
    /// The number of directions drawn so far, and the total number, which is 0 before the bake has begun.
    pub fn get(&self) -> (u32, u32) {
        (self.done.load(Ordering::Relaxed), self.total.load(Ordering::Relaxed))
    }

    /// Cancels the bake. It stops soon and returns [`Cancelled`].
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    pub(crate) fn begin(&self, total: u32) {
        self.total.store(total, Ordering::Relaxed);
    }

    pub(crate) fn advance(&self, by: u32) -> Result<(), Cancelled> {
        self.done.fetch_add(by, Ordering::Relaxed);
        if self.cancelled.load(Ordering::Relaxed) {
            return Err(Cancelled);
        }
        Ok(())
    }
}
