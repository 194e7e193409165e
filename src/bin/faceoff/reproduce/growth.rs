//! Time and memory of a whole step as the number of bodies grows to a million.

use super::Plan;
use super::plot::{self, Series};
use super::report::{Report, Table};
use crate::Outcome;
use serde_json::{Value, json};
use std::process::Command;

/// Steps of each run.
const STEPS: usize = 5;

/// What one run took.
struct Run {
    step_ms: f64,
    /// The most memory that the process had, where the system tells.
    peak_bytes: Option<f64>,
}

/// Measures `faceoff simulate` in processes of its own: the memory of this one holds what earlier experiments left.
pub fn growth(plan: &Plan, report: &mut Report) -> Outcome {
    let mut table = Table::new(
        "growth",
        &["bodies", "step_ms", "us_per_body", "peak_megabytes", "bytes_per_body"],
    );
    let (mut time, mut memory) = (Vec::new(), Vec::new());
    // The memory of a process with one body is the app's, not the bodies'.
    let fixed = run(plan, 1)?.peak_bytes;
    for &bodies in plan.growth {
        let run = run(plan, bodies)?;
        let n = bodies as f64;
        let each = 1e3 * run.step_ms / n;
        let per_body = run.peak_bytes.zip(fixed).map(|(all, fixed)| (all - fixed) / n);
        table.rows.push(vec![
            json!(bodies),
            json!(run.step_ms),
            json!(each),
            json!(run.peak_bytes.map(|bytes| bytes / 1e6)),
            json!(per_body),
        ]);
        time.push((n, each));
        memory.extend(per_body.map(|bytes| (n, bytes)));
        plan.bar.inc(1);
    }
    let line = |points| {
        [Series {
            name: "CPU, exact, tori".to_owned(),
            points,
        }]
    };
    report.plot(
        "growth_time",
        plot::svg("Time of a whole step", "bodies", "microseconds per body", &line(time))?,
    );
    report.plot(
        "growth_memory",
        plot::svg(
            "Memory beyond that of a process with one body",
            "bodies",
            "bytes per body",
            &line(memory),
        )?,
    );
    report.table(&table);
    Ok(())
}

fn run(plan: &Plan, bodies: usize) -> Outcome<Run> {
    let arguments = [
        "simulate",
        "--backend",
        "cpu",
        "--bodies",
        &bodies.to_string(),
        "--steps",
        &STEPS.to_string(),
        "--seed",
        &plan.seed.to_string(),
        "--json",
        "-",
    ];
    let output = Command::new(std::env::current_exe()?).args(arguments).output()?;
    let text = String::from_utf8_lossy(&output.stderr);
    if !output.status.success() {
        return Err(format!("faceoff simulate with {bodies} bodies failed: {}", text.trim()).into());
    }
    let record: Value = serde_json::from_slice(&output.stdout)?;
    let steps = record["steps"].as_array().ok_or("simulate wrote no steps")?;
    Ok(Run {
        step_ms: super::median(steps.iter().filter_map(|step| step["step_ms"].as_f64())),
        peak_bytes: record["meta"]["peak_memory_bytes"].as_f64(),
    })
}
