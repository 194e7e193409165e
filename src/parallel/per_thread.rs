//! Memory that only one thread uses at a time.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// One for each thread of rayon's pool. One for each task would be much larger than caches, and cold at every step.
pub(crate) struct PerThread<T> {
    all: Vec<Mutex<T>>,
}

impl<T> Default for PerThread<T> {
    fn default() -> Self {
        Self { all: Vec::new() }
    }
}

impl<T: Default> PerThread<T> {
    /// Makes one for each thread of the current pool.
    pub fn ready(&mut self) -> &Self {
        let threads = rayon::current_num_threads();
        if self.all.len() < threads {
            self.all.resize_with(threads, Mutex::default);
        }
        self
    }

    /// The current thread's own.
    pub fn lock(&self) -> MutexGuard<'_, T> {
        let own = &self.all[rayon::current_thread_index().unwrap_or(0)];
        // Whatever a panic has left there is overwritten before it is read.
        own.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
