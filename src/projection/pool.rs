//! The thread pool for background bakes.

use rayon::{ThreadPool, ThreadPoolBuilder};
use std::sync::OnceLock;

/// The shared thread pool for background bakes. It has half as many threads as there are cores, but at least one.
///
/// It is neither rayon's global pool nor the pool of the simulation: a pool runs injected jobs last, so a step that
/// shared a pool with a bake would wait for the bake. The pool is created at the first call and lives as long as the
/// process.
///
/// # Panics
///
/// If the system cannot start a thread and the calling thread already belongs to another pool.
pub fn bake_pool() -> &'static ThreadPool {
    static POOL: OnceLock<ThreadPool> = OnceLock::new();
    POOL.get_or_init(|| {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let builder = |threads: usize| {
            ThreadPoolBuilder::new()
                .num_threads(threads)
                .thread_name(|i| format!("faceoff bake {i}"))
        };
        builder((cores / 2).max(1))
            .build()
            .or_else(|error| {
                tracing::warn!("background bakes use one thread, because the thread pool could not be built: {error}");
                builder(1).build()
            })
            // Where no thread can be started, as on some platforms, the calling thread becomes the pool's worker.
            .or_else(|_| builder(1).use_current_thread().build())
            .expect("a pool with one thread")
    })
}
