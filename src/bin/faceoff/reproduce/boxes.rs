//! The paper's box in the product's own step: table 1, figure 6, and growth to a million bodies.

use super::plot::{self, Series};
use super::report::{Report, Table};
use super::{Plan, median, paper};
use crate::scenes::{self, Framing, SceneChoice};
use crate::{BackendChoice, CullingChoice, Outcome, frames, simulate};
use bevy::prelude::*;
use bevy_faceoff::prelude::*;
use bevy_faceoff::testing::scenes::paper::{Paper, default_side};
use bevy_faceoff::types::stage::Stage;
use serde_json::json;

/// A shape of the paper, with its face table.
pub struct Shape {
    pub name: &'static str,
    pub mesh: CollisionMesh,
    /// Largest speed in the paper, m/s.
    pub speed: f32,
}

/// A box of bodies, ready for its next step.
struct World {
    app: App,
    framing: Framing,
}

impl World {
    fn new(plan: &Plan, shape: &Shape, bodies: usize, backend: BackendChoice, culling: CullingChoice) -> Outcome<Self> {
        let mut app = app(backend, culling)?;
        let paper = Paper {
            bodies,
            side: default_side(bodies),
            speed: shape.speed,
            seed: plan.seed,
        };
        let framing = scenes::spawn(app.world_mut(), SceneChoice::Box, &paper, Some(&shape.mesh));
        app.finish();
        app.cleanup();
        // Bevy's first update has no time behind it and runs no step. The first step allocates.
        for _ in 0..3 {
            app.update();
        }
        Ok(Self { app, framing })
    }

    /// The medians of so many steps.
    fn measure(&mut self, steps: usize) -> Measured {
        let reports: Vec<StepReport> = (0..steps)
            .map(|_| {
                self.app.update();
                self.app.world().resource::<StepReport>().clone()
            })
            .collect();
        let of = |value: &dyn Fn(&StepReport) -> f64| median(reports.iter().map(value));
        let ms = |r: &StepReport, stage| r.time(stage).as_secs_f64() * 1e3;
        Measured {
            sphere_pairs: of(&|r| r.sphere_pairs as f64),
            touching: of(&|r| r.touching_pairs as f64),
            broad_ms: of(&|r| ms(r, Stage::BroadPhase)),
            narrow_ms: of(&|r| ms(r, Stage::Angles) + ms(r, Stage::TriangleTest)),
            step_ms: of(&|r| r.total.as_secs_f64() * 1e3),
        }
    }
}

struct Measured {
    sphere_pairs: f64,
    touching: f64,
    broad_ms: f64,
    narrow_ms: f64,
    step_ms: f64,
}

/// The adapter that a GPU run would use; `None` where the choice is the CPU or there is no GPU.
pub fn adapter(backend: BackendChoice) -> Outcome<Option<String>> {
    if backend == BackendChoice::Cpu {
        return Ok(None);
    }
    let app = app(backend, CullingChoice::Exact)?;
    Ok(match app.world().resource() {
        ActiveBackend::Gpu { adapter, .. } => Some(adapter.clone()),
        _ => None,
    })
}

/// Table 1, with the paper's row beside ours.
pub fn table_1(plan: &Plan, shapes: &[Shape; 2], report: &mut Report) -> Outcome {
    let mut table = Table::new(
        "table1",
        &[
            "shape",
            "bodies",
            "backend",
            "culling",
            "sphere_pairs",
            "touching_pairs",
            "broad_ms",
            "narrow_ms",
            "both_ms",
            "us_per_sphere_pair",
            "paper_pairs",
            "paper_ms",
            "paper_us_per_pair",
            "paper_ms_over_ours",
        ],
    );
    let modes = [CullingChoice::Exact, CullingChoice::Faces];
    for shape in shapes {
        let (mut ms, mut cost) = (Vec::new(), Vec::new());
        let printed = |row: &paper::Printed| {
            if shape.name == "knot" {
                row.knot_ms
            } else {
                row.torus_ms
            }
        };
        let line = |name: &str, points| Series {
            name: name.to_owned(),
            points,
        };
        let of_paper = |value: &dyn Fn(&paper::Printed) -> f64| {
            paper::TABLE_1
                .iter()
                .map(|row| (row.bodies as f64, value(row)))
                .collect()
        };
        ms.push(line("paper, GeForce 8800 GTX", of_paper(&printed)));
        cost.push(line(
            "paper, GeForce 8800 GTX",
            of_paper(&|row| 1e3 * printed(row) / f64::from(row.pairs)),
        ));
        for (backend, name) in [(BackendChoice::Cpu, "CPU"), (BackendChoice::Gpu, "GPU")] {
            if name == "GPU" && plan.adapter.is_none() {
                continue;
            }
            // Opening a device and compiling kernels takes longer than the steps of a scene.
            let every = if name == "GPU" { plan.gpu_every } else { 1 };
            for culling in modes {
                let name = if name == "GPU" { plan.gpu_name() } else { name };
                let (mut all, mut each) = (Vec::new(), Vec::new());
                for (i, row) in paper::TABLE_1.iter().enumerate() {
                    if (i + 1) % every != 0 {
                        continue;
                    }
                    let mut world = World::new(plan, shape, row.bodies, backend, culling)?;
                    let m = world.measure(plan.steps);
                    let both = m.broad_ms + m.narrow_ms;
                    let per_pair = 1e3 * both / m.sphere_pairs.max(1.0);
                    table.rows.push(vec![
                        json!(shape.name),
                        json!(row.bodies),
                        json!(name),
                        json!(culling.name()),
                        json!(m.sphere_pairs as u64),
                        json!(m.touching as u64),
                        json!(m.broad_ms),
                        json!(m.narrow_ms),
                        json!(both),
                        json!(per_pair),
                        json!(row.pairs),
                        json!(printed(row)),
                        json!(1e3 * printed(row) / f64::from(row.pairs)),
                        json!(printed(row) / both),
                    ]);
                    all.push((row.bodies as f64, both));
                    each.push((row.bodies as f64, per_pair));
                    plan.bar.inc(1);
                }
                ms.push(line(&format!("{name}, {}", culling.name()), all));
                cost.push(line(&format!("{name}, {}", culling.name()), each));
            }
        }
        let name = shape.name;
        report.plot(
            &format!("table1_{name}"),
            plot::svg(
                &format!("Table 1, {name}: broad and narrow phase"),
                "bodies",
                "milliseconds per step",
                &ms,
            )?,
        );
        report.plot(
            &format!("cost_{name}"),
            plot::svg(
                &format!("Table 1, {name}: cost of a pair"),
                "bodies",
                "microseconds per sphere pair",
                &cost,
            )?,
        );
    }
    report.table(&table);
    Ok(())
}

/// Figure 6: the largest boxes of table 1.
pub fn figure_6(plan: &Plan, shapes: &[Shape; 2], report: &mut Report) -> Outcome {
    let bodies = paper::TABLE_1.iter().map(|row| row.bodies).max().unwrap_or_default();
    for shape in shapes {
        let mut world = World::new(plan, shape, bodies, BackendChoice::Cpu, CullingChoice::Exact)?;
        let picture = frames::draw(world.app.world_mut(), &world.framing);
        report.picture(&picture, &format!("{bodies} bodies of shape {} in the box", shape.name))?;
        plan.bar.inc(1);
    }
    Ok(())
}

/// Memory and time of a step as the number of bodies grows.
pub fn growth(plan: &Plan, torus: &Shape, report: &mut Report) -> Outcome {
    let mut table = Table::new(
        "growth",
        &["bodies", "step_ms", "us_per_body", "memory_mib", "bytes_per_body"],
    );
    let (mut time, mut memory) = (Vec::new(), Vec::new());
    for &bodies in plan.growth {
        let before = resident();
        let mut world = World::new(plan, torus, bodies, BackendChoice::Cpu, CullingChoice::Exact)?;
        let m = world.measure(5);
        let bytes = resident()
            .zip(before)
            .map(|(after, before)| after.saturating_sub(before) as f64);
        let n = bodies as f64;
        let each = 1e3 * m.step_ms / n;
        table.rows.push(vec![
            json!(bodies),
            json!(m.step_ms),
            json!(each),
            json!(bytes.map(|b| b / 1048576.0)),
            json!(bytes.map(|b| b / n)),
        ]);
        time.push((n, each));
        memory.extend(bytes.map(|b| (n, b / n)));
        plan.bar.inc(1);
    }
    let line = |name: &str, points| {
        [Series {
            name: name.to_owned(),
            points,
        }]
    };
    report.plot(
        "growth_time",
        plot::svg(
            "Time of a whole step",
            "bodies",
            "microseconds per body",
            &line("CPU, exact, tori", time),
        )?,
    );
    report.plot(
        "growth_memory",
        plot::svg("Memory", "bodies", "bytes per body", &line("CPU, exact, tori", memory))?,
    );
    report.table(&table);
    Ok(())
}

/// Bytes of this process in memory, where the system tells.
fn resident() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    Some(1024 * line.trim().trim_end_matches("kB").trim().parse::<u64>().ok()?)
}
