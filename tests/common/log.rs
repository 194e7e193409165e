//! Captures the library's log for a test. A process has one log, so such a test runs in its own process.

#![allow(dead_code)]

use std::fmt::Debug;
use std::process::Command;
use std::sync::{Mutex, MutexGuard};
use tracing::field::{Field, Visit};
use tracing::{Event, Level, Metadata, span};

static LINES: Mutex<Vec<String>> = Mutex::new(Vec::new());

/// Environment variable that is set in the process of a single test.
const ALONE: &str = "FACEOFF_TEST_ALONE";

/// Runs the test with this full name in its own process and propagates its failure. Returns false in that process.
pub fn ran_alone(name: &str) -> bool {
    if std::env::var_os(ALONE).is_some() {
        return false;
    }
    let output = Command::new(std::env::current_exe().unwrap())
        .args([name, "--exact", "--include-ignored", "--nocapture"])
        .env(ALONE, "1")
        .output()
        .unwrap();
    let [said, errors] = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text));
    assert!(output.status.success(), "{said}{errors}");
    assert!(said.contains("1 passed"), "no test is called {name}: {said}");
    true
}

/// Captures lines of these levels from now on.
pub fn keep(levels: &'static [Level]) {
    tracing::subscriber::set_global_default(Log { levels }).unwrap();
}

/// All captured lines that were not taken.
pub fn lines() -> MutexGuard<'static, Vec<String>> {
    LINES.lock().unwrap()
}

/// Takes the lines logged since the last call.
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
