//! Scratch memory for each thread of a pool.

use super::loops;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// One value per thread of the thread pool. One per task would take much more memory than the caches hold.
pub(crate) struct PerThread<T> {
    all: Vec<Mutex<T>>,
}

impl<T> Default for PerThread<T> {
    fn default() -> Self {
        Self { all: Vec::new() }
    }
}

impl<T: Default> PerThread<T> {
    /// Makes sure that there is one value for each thread of the current pool.
    pub fn ready(&mut self) -> &Self {
        let threads = loops::threads();
        if self.all.len() < threads {
            self.all.resize_with(threads, Mutex::default);
        }
        self
    }

    /// The value of the current thread.
    pub fn lock(&self) -> MutexGuard<'_, T> {
        let own = &self.all[rayon::current_thread_index().unwrap_or(0)];
        // A poisoned value is fine: scratch memory is overwritten before it is read.
        own.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
