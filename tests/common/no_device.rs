//! What becomes of a test that needs a GPU on a machine without one.

use libtest_mimic::{Completion, Failed};

/// The test is reported as ignored, with the reason. With `FACEOFF_REQUIRE_GPU=1` it fails instead, so that a machine
/// that should have a GPU cannot skip the tests unnoticed.
pub fn ignored_or_failed(reason: impl ToString) -> Result<Completion, Failed> {
    let is_required = std::env::var_os("FACEOFF_REQUIRE_GPU").is_some_and(|value| value != "0");
    if is_required {
        Err(Failed::from(reason.to_string()))
    } else {
        Ok(Completion::ignored_with(reason.to_string()))
    }
}
