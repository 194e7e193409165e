//! Progress bars for bakes.

use crate::Outcome;
use bevy_faceoff::projection::{BakeSettings, Progress};
use indicatif::{ProgressBar, ProgressStyle};
use std::time::Duration;

/// Runs a bake with a progress bar. There is no bar without a face table, because the bake is then fast.
pub fn with_bar<T: Send, E: Send + Into<Box<dyn std::error::Error>>>(
    name: &str,
    settings: BakeSettings,
    bake: impl FnOnce(&Progress) -> Result<T, E> + Send,
) -> Outcome<T> {
    let progress = Progress::default();
    if !settings.faces {
        return bake(&progress).map_err(Into::into);
    }
    let bar = ProgressBar::new(0).with_message(name.to_owned());
    if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} directions, {eta} left") {
        bar.set_style(style);
    }
    std::thread::scope(|scope| {
        let baking = scope.spawn(|| bake(&progress));
        while !baking.is_finished() {
            let (done, total) = progress.get();
            bar.set_length(total.into());
            bar.set_position(done.into());
            std::thread::sleep(Duration::from_millis(20));
        }
        bar.finish_and_clear();
        match baking.join() {
            Ok(result) => result.map_err(Into::into),
            Err(_) => Err(format!("{name}: the bake panicked, which is a bug: please report it").into()),
        }
    })
}
