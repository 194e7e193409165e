//! Background jobs of the asset loader, on thread pools other than Bevy's IO pool.

use super::error::LoadError;
use crate::projection::{Progress, bake_pool};
use bevy::tasks::{AsyncComputeTaskPool, TaskPool};
use std::collections::VecDeque;
use std::mem;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Runs `job` on Bevy's pool for asynchronous computations. For jobs of milliseconds, because it cannot be cancelled.
pub(crate) async fn on_compute_pool<T: Send + 'static>(
    job: impl FnOnce() -> Result<T, LoadError> + Send + 'static,
) -> Result<T, LoadError> {
    finish(job, |run| {
        AsyncComputeTaskPool::get_or_init(TaskPool::default)
            .spawn(async move { run() })
            .detach();
    })
    .await
}

/// Runs `job` on the pool for bakes, after all jobs that were queued before. Dropping the returned future cancels the
/// job.
pub(crate) async fn on_bake_pool<T: Send + 'static>(
    job: impl FnOnce(&'static rayon::ThreadPool, &Progress) -> Result<T, LoadError> + Send + 'static,
) -> Result<T, LoadError> {
    let progress = Arc::new(Progress::default());
    let _guard = CancelOnDrop(progress.clone());
    let pool = bake_pool();
    static QUEUE: Queue = Queue::new();
    finish(move || job(pool, &progress), |run| QUEUE.push(pool, run)).await
}

/// A queue that runs one job at a time, in order.
///
/// Each job has the whole pool. Jobs that run at the same time would all finish late and hold their memory together,
/// and a thread that waits for a part of one job would start another one in the meantime.
///
/// The queue does not depend on futures, so that a future that nobody polls does not block it.
struct Queue(Mutex<Waiting>);

struct Waiting {
    jobs: VecDeque<Job>,
    /// Whether a thread is running the jobs.
    running: bool,
}

type Job = Box<dyn FnOnce() + Send>;

impl Queue {
    const fn new() -> Self {
        Self(Mutex::new(Waiting {
            jobs: VecDeque::new(),
            running: false,
        }))
    }

    /// Appends a job. It must not panic.
    fn push(&'static self, pool: &'static rayon::ThreadPool, job: Job) {
        let mut waiting = self.lock();
        waiting.jobs.push_back(job);
        if !mem::replace(&mut waiting.running, true) {
            pool.spawn(|| {
                while let Some(job) = self.next() {
                    job();
                }
            });
            // Where no thread can be started, this one is the pool's.
            while let Some(rayon::Yield::Executed) = pool.yield_now() {}
        }
    }

    fn next(&self) -> Option<Job> {
        let mut waiting = self.lock();
        let job = waiting.jobs.pop_front();
        waiting.running = job.is_some();
        job
    }

    fn lock(&self) -> MutexGuard<'_, Waiting> {
        // No job runs while the lock is held, so the data of a poisoned lock is consistent.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Awaits a job that `spawn` runs on another thread. A panic of the job becomes an error: otherwise rayon would abort
/// the process, and a task of Bevy would drop the sender.
async fn finish<T: Send + 'static>(
    job: impl FnOnce() -> Result<T, LoadError> + Send + 'static,
    spawn: impl FnOnce(Job),
) -> Result<T, LoadError> {
    let (sender, receiver) = async_channel::bounded(1);
    spawn(Box::new(move || {
        let result = catch_unwind(AssertUnwindSafe(job)).unwrap_or_else(|payload| {
            let message = payload
                .downcast_ref::<String>()
                .cloned()
                .or_else(|| payload.downcast_ref::<&str>().map(|s| s.to_string()))
                .unwrap_or_else(|| "no message".into());
            Err(LoadError::Panicked(message))
        });
        // The receiver is gone if the handle was dropped.
        let _ = sender.try_send(result);
    }));
    receiver
        .recv()
        .await
        .unwrap_or_else(|_| Err(LoadError::Panicked("its thread ended".into())))
}

struct CancelOnDrop(Arc<Progress>);

impl Drop for CancelOnDrop {
    fn drop(&mut self) {
        self.0.cancel();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::tasks::futures_lite::future;
    use rayon::prelude::*;
    use std::sync::OnceLock;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::time::Duration;

    #[test]
    fn bakes_run_one_after_the_other() {
        // The pool for bakes may have a single thread, on which jobs never run at the same time.
        static POOL: OnceLock<rayon::ThreadPool> = OnceLock::new();
        static QUEUE: Queue = Queue::new();
        static RUNNING: AtomicUsize = AtomicUsize::new(0);
        let pool = POOL.get_or_init(|| rayon::ThreadPoolBuilder::new().num_threads(4).build().unwrap());
        let (ended, ends) = std::sync::mpsc::channel();
        for i in 0..50 {
            let ended = ended.clone();
            let job = move || {
                let others = RUNNING.fetch_add(1, Ordering::SeqCst);
                (0..8)
                    .into_par_iter()
                    .for_each(|_| std::thread::sleep(Duration::from_micros(200)));
                RUNNING.fetch_sub(1, Ordering::SeqCst);
                ended.send((i, others)).unwrap();
            };
            QUEUE.push(pool, Box::new(job));
        }
        let first: Vec<_> = ends.iter().take(50).collect();
        assert_eq!(first, (0..50).map(|i| (i, 0)).collect::<Vec<_>>());
        // A queue that has become empty starts again.
        QUEUE.push(pool, Box::new(move || ended.send((50, 0)).unwrap()));
        assert_eq!(ends.recv_timeout(Duration::from_secs(10)).unwrap(), (50, 0));
    }

    #[test]
    fn a_panic_is_an_error() {
        let on_bake = future::block_on(on_bake_pool(|_, _| -> Result<(), _> { panic!("on purpose") }));
        assert!(matches!(on_bake, Err(LoadError::Panicked(m)) if m == "on purpose"));
        let on_compute = future::block_on(on_compute_pool(|| -> Result<(), _> { panic!("{} purpose", "on") }));
        assert!(matches!(on_compute, Err(LoadError::Panicked(m)) if m == "on purpose"));
        // The pools still work.
        assert!(matches!(future::block_on(on_bake_pool(|_, _| Ok(5))), Ok(5)));
        assert!(matches!(future::block_on(on_compute_pool(|| Ok(6))), Ok(6)));
    }

    #[test]
    fn dropping_the_future_cancels() {
        let (started, start) = std::sync::mpsc::channel();
        let (ended, end) = std::sync::mpsc::channel();
        let mut future = Box::pin(on_bake_pool(move |_, progress| {
            started.send(()).unwrap();
            while progress.advance(1).is_ok() {
                std::thread::sleep(Duration::from_millis(1));
            }
            ended.send(()).unwrap();
            Ok(())
        }));
        assert!(future::block_on(future::poll_once(&mut future)).is_none());
        start.recv_timeout(Duration::from_secs(10)).unwrap();
        drop(future);
        end.recv_timeout(Duration::from_secs(10)).unwrap();
    }
}
