//! The bake of many meshes side by side.
//!
//! One thread pool does all work: a mesh is a task in it, and the face table of a mesh is many. This thread starts
//! meshes in the order of the plan while there is memory, and prints in the same order what became of them, so that the
//! output does not depend on which is ready first. No task waits for memory or for another mesh, so the pool cannot
//! block.

use super::bar::Bar;
use super::claim::is_claimed;
use super::one::{self, Claimed};
use super::plan::{Entry, Work};
use super::report::{Report, Status};
use super::{Options, memory};
use crate::Outcome;
use bevy_faceoff::projection::Progress;
use bytesize::ByteSize;
use std::collections::{BTreeMap, VecDeque};
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::channel;
use std::time::Duration;

/// How often the bar is drawn.
const TICK: Duration = Duration::from_millis(50);

/// The stack of a thread in bytes. While a thread waits for others to finish parts of its mesh, it may begin another
/// mesh.
const STACK: usize = 16 << 20;

/// Bakes all entries. Returns their reports in order, and whether all could be printed.
///
/// # Errors
/// If the system cannot start threads.
pub fn bake(options: &Options, entries: &[Entry]) -> Outcome<(Vec<Report>, Outcome)> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(options.threads)
        .stack_size(STACK)
        .build()?;
    let threads = pool.current_num_threads();
    let mut queue = Queue {
        entries,
        fresh: 0..entries.len(),
        left: VecDeque::new(),
    };
    let mut waiting: Option<Start> = None;
    let mut running: BTreeMap<usize, Running> = BTreeMap::new();
    let mut printer = Printer::new(options.json.as_deref(), entries.len());
    let (send, ended) = channel();
    pool.in_place_scope(|scope| {
        loop {
            while running.len() < threads {
                let Some(start) = waiting.take().or_else(|| queue.next(options, threads)) else {
                    break;
                };
                let taken: u64 = running.values().map(|mesh| mesh.need).sum();
                if !running.is_empty() && taken.saturating_add(start.need) > options.memory.as_u64() {
                    waiting = Some(start);
                    break;
                }
                let Start { at, claimed, need } = start;
                let entry = &entries[at];
                let (Work::Bake(_), Some(target)) = (&entry.work, &entry.target) else {
                    printer.add(at, failures(entry));
                    continue;
                };
                let progress = Arc::new(Progress::default());
                let (send, pool) = (send.clone(), &pool);
                let shown = progress.clone();
                running.insert(at, Running { need, progress: shown });
                scope.spawn(move |_| {
                    let report = one::bake(options, (&entry.sources[0], target), claimed, pool, &progress);
                    // The receiver outlives the scope.
                    let _ = send.send((at, report));
                });
            }
            if running.is_empty() {
                break;
            }
            let (at, report) = loop {
                printer.show(&running);
                if let Ok(one) = ended.recv_timeout(TICK) {
                    break one;
                }
            };
            let need = running.remove(&at).map_or(0, |mesh| mesh.need);
            match report {
                None => queue.left.push_back(at),
                Some(mut report) => {
                    if need > options.memory.as_u64() && report.status != Status::UpToDate {
                        report.note = Some(alone(need, options.memory));
                    }
                    printer.add(at, vec![report]);
                }
            }
        }
    });
    Ok((printer.reports, printer.printed))
}

/// A mesh that may be started.
struct Start {
    /// Its place among the entries.
    at: usize,
    claimed: Claimed,
    /// The memory that it may take, in bytes.
    need: u64,
}

/// A mesh that is being baked.
struct Running {
    /// The memory that it may take, in bytes.
    need: u64,
    progress: Arc<Progress>,
}

/// The entries that are not done.
struct Queue<'a> {
    entries: &'a [Entry],
    /// Entries that have not been started.
    fresh: Range<usize>,
    /// Entries that were left to other processes.
    left: VecDeque<usize>,
}

impl Queue<'_> {
    /// The next mesh: one that was left to another process which has ended its claim, or the next in order, or at last
    /// one that is still claimed.
    fn next(&mut self, options: &Options, threads: usize) -> Option<Start> {
        let is_free = |at: &usize| {
            self.entries[*at]
                .target
                .as_deref()
                .is_none_or(|target| !is_claimed(target))
        };
        let free = self.left.front().is_some_and(is_free);
        let (at, claimed) = if free { None } else { self.fresh.next() }
            .map(|at| (at, Claimed::Leave))
            .or_else(|| {
                let claimed = if free { Claimed::Leave } else { Claimed::Bake };
                self.left.pop_front().map(|at| (at, claimed))
            })?;
        let need = match &self.entries[at].work {
            Work::Bake(input) => memory::estimate(&input.mesh, &options.settings(input.settings), threads),
            Work::Fail(_) => 0,
        };
        Some(Start { at, claimed, need })
    }
}

/// The reports of an entry whose error is known: one for each of its files.
fn failures(entry: &Entry) -> Vec<Report> {
    let Work::Fail(error) = &entry.work else {
        return Vec::new();
    };
    let report = |source| Report::failed(source, entry.target.as_deref(), error.clone());
    entry.sources.iter().map(|source| report(source)).collect()
}

fn alone(need: u64, limit: ByteSize) -> String {
    format!(
        "its bake may take {:.1} of memory, more than --memory {limit:.1}, so it was baked alone",
        ByteSize(need)
    )
}

/// Prints reports in the order of the entries, and keeps them.
struct Printer<'a> {
    json: Option<&'a Path>,
    bar: Bar,
    /// Reports that wait for those of an earlier entry.
    early: BTreeMap<usize, Vec<Report>>,
    /// The entry whose reports come next.
    next: usize,
    reports: Vec<Report>,
    printed: Outcome,
}

impl<'a> Printer<'a> {
    fn new(json: Option<&'a Path>, entries: usize) -> Self {
        Self {
            json,
            bar: Bar::new(entries),
            early: BTreeMap::new(),
            next: 0,
            reports: Vec::new(),
            printed: Ok(()),
        }
    }

    /// Takes the reports of an entry. Those of one entry have the same error, which is printed once.
    fn add(&mut self, at: usize, reports: Vec<Report>) {
        self.early.insert(at, reports);
        while let Some(reports) = self.early.remove(&self.next) {
            self.next += 1;
            if let Some(report) = reports.first() {
                let printed = self.bar.beside(|| report.print(self.json));
                self.printed = std::mem::replace(&mut self.printed, Ok(())).and(printed);
            }
            self.reports.extend(reports);
        }
    }

    fn show(&self, running: &BTreeMap<usize, Running>) {
        let done = self.next + self.early.len();
        self.bar.show(done, running.values().map(|mesh| &*mesh.progress));
    }
}
