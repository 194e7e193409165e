//! What became of the meshes, for people and as JSON.

use super::shard::Shard;
use crate::{Outcome, output};
use serde::Serialize;
use std::path::Path;
use std::time::Duration;

/// What became of a mesh.
#[derive(Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    Baked,
    UpToDate,
    Failed,
}

/// What became of one mesh.
#[derive(Serialize)]
pub struct Report {
    pub source: String,
    /// The baked file; `None` for a folder that could not be read.
    pub target: Option<String>,
    pub status: Status,
    /// `None` if it failed.
    pub triangles: Option<u64>,
    /// The length of the baked file; `None` if it failed.
    pub bytes: Option<u64>,
    /// The time from the first look at the mesh.
    pub seconds: f64,
    /// About the file and the mesh, if it was baked.
    pub warnings: Vec<String>,
    pub error: Option<String>,
    /// About the run, not the mesh.
    #[serde(skip)]
    pub note: Option<String>,
}

impl Report {
    pub fn new(source: &Path, target: Option<&Path>) -> Self {
        Self {
            source: source.display().to_string(),
            target: target.map(|target| target.display().to_string()),
            status: Status::Failed,
            triangles: None,
            bytes: None,
            seconds: 0.0,
            warnings: Vec::new(),
            error: None,
            note: None,
        }
    }

    pub fn failed(source: &Path, target: Option<&Path>, error: String) -> Self {
        Self {
            error: Some(error),
            ..Self::new(source, target)
        }
    }

    /// Prints the warnings and the error to standard error, and else a line.
    pub fn print(&self, json: Option<&Path>) -> Outcome {
        for warning in self.note.iter().chain(&self.warnings) {
            output::log(&format!("warning: {}: {warning}", self.source));
        }
        let target = self.target.as_deref().unwrap_or_default();
        let line = match (self.status, &self.error) {
            (Status::Failed, error) => {
                output::log(&format!("error: {}", error.as_deref().unwrap_or("unknown")));
                return Ok(());
            }
            (Status::UpToDate, _) => format!("{target} is up to date\n"),
            (Status::Baked, _) => format!(
                "{} -> {target}: {} triangles, {} bytes, {:.2} s\n",
                self.source,
                self.triangles.unwrap_or_default(),
                self.bytes.unwrap_or_default(),
                self.seconds
            ),
        };
        output::table(json, &line)
    }
}

/// What became of all meshes of a run.
#[derive(Serialize)]
pub struct Summary {
    /// `None` if the run baked all meshes.
    shard: Option<Shard>,
    meshes: Vec<Report>,
    totals: Totals,
}

#[derive(Serialize)]
struct Totals {
    meshes: usize,
    baked: usize,
    up_to_date: usize,
    failed: usize,
    /// Triangles of the meshes that did not fail.
    triangles: u64,
    /// Size of the baked files.
    bytes: u64,
    /// The time of the whole run. Meshes are baked side by side, so theirs may add up to more.
    seconds: f64,
}

impl Summary {
    pub fn new(shard: Option<Shard>, meshes: Vec<Report>, time: Duration) -> Self {
        let count = |status| meshes.iter().filter(|report| report.status == status).count();
        Self {
            totals: Totals {
                meshes: meshes.len(),
                baked: count(Status::Baked),
                up_to_date: count(Status::UpToDate),
                failed: count(Status::Failed),
                triangles: meshes.iter().filter_map(|report| report.triangles).sum(),
                bytes: meshes.iter().filter_map(|report| report.bytes).sum(),
                seconds: time.as_secs_f64(),
            },
            shard,
            meshes,
        }
    }

    pub fn meshes(&self) -> usize {
        self.totals.meshes
    }

    pub fn failed(&self) -> usize {
        self.totals.failed
    }

    /// The totals in a line.
    pub fn line(&self) -> String {
        let Totals {
            meshes,
            baked,
            up_to_date,
            failed,
            seconds,
            ..
        } = self.totals;
        let s = if meshes == 1 { "" } else { "es" };
        format!("{meshes} mesh{s}: {baked} baked, {up_to_date} up to date, {failed} failed; {seconds:.2} s\n")
    }
}
