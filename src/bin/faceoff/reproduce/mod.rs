//! `faceoff reproduce`: the experiments of Aly & Elawady 2010, and what the paper does not show, as a report.

mod boxes;
mod figure7;
mod paper;
mod plot;
mod report;
mod tables;

use crate::{BackendChoice, Outcome, image, output};
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::shapes;
use boxes::Shape;
use indicatif::{ProgressBar, ProgressStyle};
use report::{Report, Table};
use serde_json::json;
use std::path::PathBuf;
use std::time::Instant;

/// Run the experiments of Aly & Elawady 2010 and write a report: report.html, which needs no other file, with CSV, SVG and JSON
/// files beside it.
#[derive(clap::Args)]
pub struct Options {
    /// The folder to write to; made if it is missing.
    #[arg(long, value_name = "DIR", default_value = "reproduced")]
    out: PathBuf,
    /// What is measured besides the CPU: auto adds a GPU if there is one, gpu the best adapter, even a software one.
    #[arg(long, value_enum, default_value = "auto")]
    backend: BackendChoice,
    /// Fewer steps, cases and sizes: for a first look. A software GPU driver takes longer than the rest.
    #[arg(long)]
    quick: bool,
    /// Seed of the random numbers.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// How much is measured.
struct Plan {
    seed: u64,
    adapter: Option<String>,
    /// Steps of each scene of table 1.
    steps: usize,
    /// Every so many rows of table 1 are run on the GPU.
    gpu_every: usize,
    /// Rounds of figure 7.
    rounds: usize,
    figure_7: &'static [usize],
    growth: &'static [usize],
    /// Touching pairs for each regime of recall.
    cases: usize,
    degrees: &'static [u32],
    images: &'static [u32],
    bar: ProgressBar,
}

impl Plan {
    fn new(options: &Options, adapter: Option<String>) -> Self {
        let software = adapter.as_deref().is_some_and(is_software);
        let quick = options.quick;
        let mut plan = Self {
            seed: options.seed,
            steps: if quick { 3 } else { 25 },
            // The last row of table 1 has the number 22.
            gpu_every: if quick {
                22
            } else if software {
                11
            } else {
                2
            },
            rounds: if quick { 3 } else { 15 },
            figure_7: if quick {
                &[100, 1000, paper::FIGURE_7_BODIES]
            } else {
                &[100, 300, 1000, paper::FIGURE_7_BODIES, 10_000, 30_000, 100_000]
            },
            growth: if quick {
                &[1000, 10_000]
            } else {
                &[1000, 10_000, 100_000, 1_000_000]
            },
            cases: if quick { 40 } else { 1000 },
            degrees: if quick { &[10, 5] } else { &[10, 5, 3, 2, 1] },
            images: if quick { &[32, 64] } else { &[64, 128, 256] },
            bar: ProgressBar::hidden(),
            adapter,
        };
        let rows = paper::TABLE_1.len();
        let runs = rows
            + if plan.adapter.is_some() {
                rows / plan.gpu_every
            } else {
                0
            };
        // Both shapes in both modes, a picture of each, and eight regimes of each.
        let total =
            4 * runs + 2 + plan.figure_7.len() + plan.growth.len() + 2 * plan.degrees.len() * plan.images.len() + 2 * 8;
        plan.bar = ProgressBar::new(total as u64);
        if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} measurements, {elapsed}") {
            plan.bar.set_style(style);
        }
        plan
    }

    /// How tables and legends name the GPU.
    fn gpu_name(&self) -> &'static str {
        if self.adapter.as_deref().is_some_and(is_software) {
            "software GPU driver"
        } else {
            "GPU"
        }
    }
}

/// Whether an adapter computes on the CPU, by its name.
fn is_software(adapter: &str) -> bool {
    let name = adapter.to_lowercase();
    ["llvmpipe", "lavapipe", "swiftshader", "basic render", "software"]
        .iter()
        .any(|word| name.contains(word))
}

/// Runs the command.
pub fn run(options: &Options) -> Outcome {
    output::folder(&options.out)?;
    // What cannot be written should be known before the work is done.
    output::check(&options.out.join("report.html"))?;
    let start = Instant::now();
    let plan = Plan::new(options, boxes::adapter(options.backend)?);
    let mut report = Report::default();
    let (degrees, pixels) = if options.quick { (5, 128) } else { (1, 256) };

    plan.bar.set_message("baking");
    let shape = |name, mesh, speed| -> Outcome<Shape> {
        Ok(Shape {
            name,
            mesh: tables::bake(&CollisionMesh::new(&mesh), degrees, pixels)?,
            speed,
        })
    };
    let plain_torus = Shape {
        name: "torus",
        mesh: CollisionMesh::new(&shapes::torus_240()),
        speed: 0.5,
    };
    let mut last = Report::default();
    // First, while the process is small: it measures the memory of the process.
    plan.bar.set_message("growth");
    boxes::growth(&plan, &plain_torus, &mut last)?;
    let both = [
        shape("torus", shapes::torus_240(), plain_torus.speed)?,
        shape("knot", shapes::knot_1120(), 3.0)?,
    ];

    plan.bar.set_message("table 1");
    report.heading("Table 1: broad and narrow phase");
    report.text(&format!(
        "Medians of {} steps. The paper's column is its table 1, on a GeForce 8800 GTX; a ratio above 1 means that ours is faster, \
         on other hardware. Sphere pairs are pairs of bodies whose bounding spheres overlap. The paper does not give the size of its \
         box; ours has a size at which there are about as many pairs. Face tables: {degrees} degrees, {pixels} x {pixels} pixels.",
        plan.steps
    ));
    boxes::table_1(&plan, &both, &mut report)?;

    report.heading("Figure 4: height images");
    for shape in &both {
        let canvas = image::single(&shape.mesh.mesh, 30.0, 30.0, 320);
        report.picture(
            &canvas,
            &format!("The {}: heights in units of the mesh, and visible faces", shape.name),
        )?;
    }
    plan.bar.set_message("figure 6");
    report.heading("Figure 6: the largest scenes");
    boxes::figure_6(&plan, &both, &mut report)?;

    plan.bar.set_message("figure 7");
    report.heading("Figure 7: more bodies, the same number of pairs");
    report.text(&format!(
        "One thread, medians of {} rounds. The paper ends at {} bodies. All triangles is a plain loop over all pairs of triangles of \
         each sphere pair, with a box test first. All three use the same broad phase.",
        plan.rounds,
        paper::FIGURE_7_BODIES
    ));
    figure7::figure_7(&plan, &both[0], &mut report)?;

    plan.bar.set_message("recall");
    report.heading("Recall of the approximate modes");
    report.text(
        "Against the exact mode, on random touching pairs. any: the share of touching pairs of which a mode finds at least one pair \
         of faces. share: the share of all intersecting pairs of faces that it finds. eq4 looks the table up by the paper's formula \
         as printed.",
    );
    tables::recall(&plan, &both, &mut report);

    plan.bar.set_message("bakes");
    report.heading("Size and bake time of the face table");
    tables::sizes(&plan, &both, &mut report)?;

    report.heading("Growth of a whole step");
    report.text("Tori on the CPU, exact. Memory is what the process grew by, where the system tells; it includes Bevy's entities.");
    report.append(last);
    plan.bar.finish_and_clear();

    let mut meta = Table::new("about", &["about", "value"]);
    let mut about = |name: &str, value: String| meta.rows.push(vec![json!(name), json!(value)]);
    about("bevy_faceoff", env!("CARGO_PKG_VERSION").to_owned());
    about(
        "command",
        format!(
            "reproduce{} --seed {}",
            if options.quick { " --quick" } else { "" },
            options.seed
        ),
    );
    about("processor", processor());
    about(
        "threads",
        std::thread::available_parallelism().map_or(1, usize::from).to_string(),
    );
    about("system", format!("{} {}", std::env::consts::OS, std::env::consts::ARCH));
    about(
        "GPU adapter",
        match &plan.adapter {
            Some(name) if is_software(name) => {
                format!(
                    "{name}. This is a software driver that computes on the CPU; its times say nothing about a graphics card."
                )
            }
            Some(name) => name.clone(),
            None => "none was measured".to_owned(),
        },
    );
    about("seed", options.seed.to_string());
    about("run time in seconds", format!("{:.0}", start.elapsed().as_secs_f64()));
    report.save(&options.out, &meta)?;
    output::table(None, &format!("wrote {}\n", options.out.join("report.html").display()))
}

/// The name of the processor, where the system tells.
fn processor() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = info.lines().find_map(|line| line.strip_prefix("model name"));
    name.map_or("unknown", |name| name.trim_start_matches([' ', '\t', ':']))
        .to_owned()
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}
