//! What the library logs, kept for a test to read. A process has one log, and so one test that reads it.

#![allow(dead_code)]

use std::fmt::Debug;
use std::sync::{Mutex, MutexGuard};
use tracing::field::{Field, Visit};
use tracing::{Event, Level, Metadata, span};

static LINES: Mutex<Vec<String>> = Mutex::new(Vec::new());

/// Keeps the lines of these levels from now on.
pub fn keep(levels: &'static [Level]) {
    tracing::subscriber::set_global_default(Log { levels }).unwrap();
}

/// All that was kept and not taken.
pub fn lines() -> MutexGuard<'static, Vec<String>> {
    LINES.lock().unwrap()
}

/// What was logged since the last call.
pub fn take() -> Vec<String> {
    std::mem::take(&mut lines())
}

struct Log {
    levels: &'static [Level],
}

struct Message<'a>(&'a mut String);

impl Visit for Message<'_> {
    fn record_debug(&mut self, field: &Field, value: &dyn Debug) {
        if field.name() == "message" {
            *self.0 = format!("{value:?}");
        }
    }
}

impl tracing::Subscriber for Log {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        metadata.target().starts_with("bevy_faceoff") && self.levels.contains(metadata.level())
    }
    fn new_span(&self, _: &span::Attributes<'_>) -> span::Id {
        span::Id::from_u64(1)
    }
    fn record(&self, _: &span::Id, _: &span::Record<'_>) {}
    fn record_follows_from(&self, _: &span::Id, _: &span::Id) {}
    fn event(&self, event: &Event<'_>) {
        let mut message = String::new();
        event.record(&mut Message(&mut message));
        lines().push(message);
    }
    fn enter(&self, _: &span::Id) {}
    fn exit(&self, _: &span::Id) {}
}
