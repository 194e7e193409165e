//! The progress bar of a run.

use bevy_faceoff::projection::Progress;
use indicatif::{ProgressBar, ProgressStyle};

/// What a mesh counts in the bar, so that it moves during a long bake.
const MESH: u64 = 1000;

/// A bar over all meshes on a terminal; else nothing.
pub struct Bar {
    bar: ProgressBar,
    meshes: u64,
}

impl Bar {
    pub fn new(meshes: usize) -> Self {
        let meshes = meshes as u64;
        let bar = ProgressBar::new(meshes * MESH);
        if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar} {percent} %, {eta} left") {
            bar.set_style(style);
        }
        Self { bar, meshes }
    }

    /// Shows how many meshes are done, and how far those are that are being baked.
    pub fn show<'a>(&self, done: usize, running: impl Iterator<Item = &'a Progress>) {
        if self.bar.is_hidden() {
            return;
        }
        let parts = running.map(|progress| match progress.get() {
            (_, 0) => 0,
            (done, total) => MESH * u64::from(done) / u64::from(total),
        });
        self.bar.set_position(done as u64 * MESH + parts.sum::<u64>());
        self.bar.set_message(format!("{done} of {} meshes", self.meshes));
    }

    /// Prints something while the bar is hidden.
    pub fn beside<T>(&self, print: impl FnOnce() -> T) -> T {
        self.bar.suspend(print)
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
