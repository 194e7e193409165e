//! The thread pool for bakes in the background.

use rayon::{ThreadPool, ThreadPoolBuilder};
use std::sync::OnceLock;

/// The shared pool on which background bakes run: half of the cores, at least one.
///
/// It is not rayon's global pool, and the simulation has another one: a pool serves injected jobs last, so a step that
/// shared a pool with a bake would wait for the bake. It is made when first asked for and lives as long as the process.
///
/// # Panics
///
/// If the system starts no thread and the calling thread already works for another pool.
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
                tracing::warn!("no full pool for background bakes, one thread instead: {error}");
                builder(1).build()
            })
            // Where no thread can be started there is only the calling one, so it can be the pool's worker.
            .or_else(|_| builder(1).use_current_thread().build())
            .expect("a pool with one thread")
    })
}
