//! Work that would stall Bevy's IO pool, done elsewhere and awaited.

use super::loader::LoadError;
use crate::projection::{Progress, bake_pool};
use bevy::tasks::{AsyncComputeTaskPool, TaskPool};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

/// Runs `job` on Bevy's pool for long computations. It is meant for jobs of milliseconds: it is not interrupted.
pub(super) async fn on_compute_pool<T: Send + 'static>(
    job: impl FnOnce() -> Result<T, LoadError> + Send + 'static,
) -> Result<T, LoadError> {
    finish(job, |run| {
        AsyncComputeTaskPool::get_or_init(TaskPool::default)
            .spawn(async move { run() })
            .detach();
    })
    .await
}

/// Runs `job` on the pool for bakes, for as long as the returned future lives: dropping it cancels the job's progress.
pub(crate) async fn on_bake_pool<T: Send + 'static>(
    job: impl FnOnce(&'static rayon::ThreadPool, &Progress) -> Result<T, LoadError> + Send + 'static,
) -> Result<T, LoadError> {
    let progress = Arc::new(Progress::default());
    let _guard = CancelOnDrop(progress.clone());
    let pool = bake_pool();
    finish(move || job(pool, &progress), |run| pool.spawn(run)).await
}

/// Awaits a job that `spawn` runs on another thread. A panic in it becomes an error: rayon would abort the process, and
/// a task of Bevy's would take its sender with it.
async fn finish<T: Send + 'static>(
    job: impl FnOnce() -> Result<T, LoadError> + Send + 'static,
    spawn: impl FnOnce(Box<dyn FnOnce() + Send>),
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
        // Nobody waits any more if the handle was dropped.
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
    use std::time::Duration;

    #[test]
    fn a_panic_is_an_error() {
        let on_bake = future::block_on(on_bake_pool(|_, _| -> Result<(), _> { panic!("on purpose") }));
        assert!(matches!(on_bake, Err(LoadError::Panicked(m)) if m == "on purpose"));
        let on_compute = future::block_on(on_compute_pool(|| -> Result<(), _> { panic!("{} purpose", "on") }));
        assert!(matches!(on_compute, Err(LoadError::Panicked(m)) if m == "on purpose"));
        // And the pools live on.
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
