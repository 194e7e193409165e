//! The threads of the CPU stages.

use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
use std::error::Error;
use std::io;

/// A pool of as many threads as asked for; 0 means one per core. `None` if that is a single thread: then the calling
/// thread does the work.
///
/// Where no thread can be started, as in a browser, the calling thread does all work, whatever is asked for.
///
/// # Errors
/// If the system has threads but cannot start these.
pub fn step_pool(threads: usize) -> Result<Option<ThreadPool>, ThreadPoolBuildError> {
    let builder = ThreadPoolBuilder::new().num_threads(threads);
    match builder.thread_name(|i| format!("faceoff step {i}")).build() {
        Ok(pool) => Ok(Some(pool).filter(|pool| pool.current_num_threads() > 1)),
        Err(error) if has_no_threads(&error) => Ok(None),
        Err(error) => Err(error),
    }
}

/// Whether the platform has no threads.
fn has_no_threads(error: &ThreadPoolBuildError) -> bool {
    let error = error.source().and_then(|error| error.downcast_ref::<io::Error>());
    error.is_some_and(|error| error.kind() == io::ErrorKind::Unsupported)
}
