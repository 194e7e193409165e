//! The text of the panel. The default font has letters of equal width, so columns are aligned.

use super::averages::{StepTimes, Times};
use super::figures::Figures;
use crate::plugin::backend::ActiveBackend;
use crate::plugin::collisions::StepReport;
use crate::types::gpu_work::GpuWork;
use crate::types::stage::Stage;
use std::fmt::Display;
use std::time::Duration;

/// Where the step runs, and its clock.
pub(super) fn backend(active: Option<&ActiveBackend>, report: &StepReport, figures: &Figures, rate: f32) -> String {
    let place = match active {
        None => return "no StepPlugin: add FaceoffPlugins".into(),
        Some(ActiveBackend::Cpu { threads, reason }) => format!("CPU, {threads} threads: {reason}"),
        Some(ActiveBackend::Gpu { adapter, shared }) => {
            let whose = if *shared { ", shared with the renderer" } else { "" };
            let away = if report.step > 0 && report.gpu.is_none() {
                "\nsteps run on the CPU: hooks"
            } else {
                ""
            };
            format!("GPU {adapter}{whose}{away}")
        }
        Some(ActiveBackend::Opening) => "a GPU is being opened".into(),
        Some(ActiveBackend::Lost) => "the renderer's GPU is lost".into(),
        Some(ActiveBackend::None { reason }) => format!("no backend: {reason}"),
    };
    let clock = match figures {
        Figures { game_paused: true, .. } => "game paused".into(),
        Figures { paused: true, .. } => "physics paused".into(),
        Figures { speed, .. } => format!("speed {speed}"),
    };
    format!("{place}\nstep {}, {rate:.0}/s, {clock}", report.step)
}

/// The time of each stage and of the whole step.
pub(super) fn times(times: &StepTimes, report: &StepReport) -> String {
    let mut text = format!("{:<15}{:>9}{:>9}", "ms", "mean", "longest");
    let mut row = |name: &str, times: Times| {
        text += &format!("\n{name:<15}{:>9.3}{:>9.3}", millis(times.mean), millis(times.longest));
    };
    for stage in Stage::ALL {
        row(&stage.name().replace('_', " "), times.stages[stage as usize]);
    }
    row("whole step", times.total);
    if report.gpu.is_some() && times.stages.iter().all(|stage| stage.longest.is_zero()) {
        text += "\nthis GPU does not measure stages";
    }
    text
}

/// Counts of the last step.
pub(super) fn counts(report: &StepReport, figures: &Figures) -> String {
    let mut rows = Rows::default();
    rows.add("bodies", report.bodies);
    rows.add("asleep", report.sleeping);
    if let Some((islands, largest)) = figures.islands {
        rows.add("islands", islands);
        rows.add("largest island", largest);
    }
    rows.add("sphere pairs", report.sphere_pairs);
    rows.add("touching pairs", report.touching_pairs);
    if let Some(pairs) = figures.plane_pairs {
        rows.add("touching planes", pairs);
    }
    rows.add("triangle tests", report.triangle_tests);
    rows.add("face pairs", report.face_pairs);
    if let Some(manifolds) = figures.manifolds {
        rows.add("contact pairs", manifolds);
    }
    rows.add("contact points", report.contact_points);
    rows.add("substeps", report.collision_substeps);
    rows.add_some("approximate", report.approximate_pairs);
    rows.add_some("crowded bodies", report.crowded_bodies);
    rows.add_some("tables in bake", report.tables_in_bake);
    rows.text
}

/// What the last step asked of a GPU. Empty if it ran on the CPU.
pub(super) fn gpu(work: Option<&GpuWork>, report: &StepReport) -> String {
    let Some(work) = work else { return String::new() };
    let mut rows = Rows::default();
    rows.add("GPU dispatches", work.dispatches);
    rows.add("submissions", work.submissions);
    rows.add("uploaded", bytes(work.uploaded_bytes));
    rows.add("read back", bytes(work.read_back_bytes));
    rows.add("GPU memory", bytes(work.memory_bytes));
    rows.add("in flight", report.in_flight);
    rows.add("waits", report.waits);
    rows.text
}

/// Names and values in two columns.
#[derive(Default)]
struct Rows {
    text: String,
}

impl Rows {
    fn add(&mut self, name: &str, value: impl Display) {
        let separator = if self.text.is_empty() { "" } else { "\n" };
        self.text += &format!("{separator}{name:<15}{value:>9}");
    }

    fn add_some(&mut self, name: &str, count: usize) {
        if count > 0 {
            self.add(name, count);
        }
    }
}

fn millis(time: Duration) -> f64 {
    1e3 * time.as_secs_f64()
}

/// A number of bytes with a unit.
fn bytes(count: u64) -> String {
    let mut value = count as f64;
    for unit in ["B", "KiB", "MiB"] {
        if value < 1000.0 {
            let digits = usize::from(unit != "B" && value < 100.0);
            return format!("{value:.digits$} {unit}");
        }
        value /= 1024.0;
    }
    format!("{value:.1} GiB")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_have_a_unit() {
        for (count, text) in [
            (0, "0 B"),
            (999, "999 B"),
            (1_536, "1.5 KiB"),
            (200_000, "195 KiB"),
            (3 << 20, "3.0 MiB"),
            (5 << 30, "5.0 GiB"),
        ] {
            assert_eq!(bytes(count), text);
        }
    }

    #[test]
    fn the_work_of_a_gpu_is_shown() {
        let work = GpuWork {
            dispatches: 123,
            uploaded_bytes: 2048,
            memory_bytes: 3 << 20,
            ..GpuWork::default()
        };
        let report = StepReport {
            waits: 77,
            gpu: Some(work),
            ..StepReport::default()
        };
        let text = gpu(report.gpu.as_ref(), &report);
        for part in ["123", "2.0 KiB", "3.0 MiB", "77"] {
            assert!(text.contains(part), "{part} in {text}");
        }
        assert_eq!(gpu(None, &report), "");
        let adapter = ActiveBackend::Gpu {
            adapter: "Card".into(),
            shared: true,
        };
        let text = backend(Some(&adapter), &report, &Figures::default(), 64.0);
        assert!(text.contains("GPU Card, shared"), "{text}");
    }
}
