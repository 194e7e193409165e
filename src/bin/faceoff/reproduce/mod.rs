//! `faceoff reproduce`: the experiments of Aly & Elawady 2010, and what the paper does not show, as a report.

mod figure7;
mod growth;
mod paper;
mod plot;
mod report;
mod table1;
mod tables;
mod world;

use crate::{BackendChoice, Outcome, image, output};
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::shapes;
use indicatif::{ProgressBar, ProgressStyle};
use report::{Report, Table};
use serde_json::json;
use std::path::PathBuf;
use std::time::Instant;
use table1::{Device, MODES};
use world::{Shape, World};

/// Run the experiments of Aly & Elawady 2010 and write a report: report.html, which needs no other file, with CSV, SVG
/// and JSON files beside it.
#[derive(clap::Args)]
pub struct Options {
    /// The folder to write to; made if it is missing.
    #[arg(long, value_name = "DIR", default_value = "reproduced")]
    out: PathBuf,
    /// What is measured besides the CPU: auto adds a GPU if there is one, gpu the best adapter, even a software one.
    #[arg(long, value_enum, default_value = "auto")]
    backend: BackendChoice,
    /// Fewer steps, cases and sizes: for a first look, in less than a minute.
    #[arg(long)]
    quick: bool,
    /// Seed of the random numbers.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// How much is measured.
struct Plan {
    seed: u64,
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
    fn new(options: &Options) -> Self {
        let quick = options.quick;
        Self {
            seed: options.seed,
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
        }
    }

    /// Shows a bar for all measurements on these devices.
    fn show(&mut self, devices: &[Device]) {
        let rows: usize = devices.iter().map(|device| device.rows.len()).sum();
        let bakes = self.degrees.len() * self.images.len();
        let sizes = self.figure_7.len() + self.growth.len();
        // Each shape: table 1 in each mode, figure 6, and eight regimes of recall.
        let total = 2 * (MODES.len() * rows + 1 + bakes + 8) + sizes;
        self.bar = ProgressBar::new(total as u64);
        if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} measurements, {elapsed}") {
            self.bar.set_style(style);
        }
    }
}

/// The CPU, and the GPU if one is wanted and there.
fn devices(options: &Options) -> Outcome<Vec<Device>> {
    let steps = if options.quick { 3 } else { 25 };
    let rows = |wanted: &dyn Fn(usize) -> bool| paper::TABLE_1.iter().filter(|row| wanted(row.bodies)).collect();
    let mut devices = vec![Device {
        world: World::new(BackendChoice::Cpu)?,
        name: "CPU",
        rows: rows(&|_| true),
        steps,
    }];
    if options.backend == BackendChoice::Cpu {
        return Ok(devices);
    }
    let world = World::new(options.backend)?;
    if let Some(adapter) = world.adapter() {
        // The software driver takes seconds for a step of the largest box.
        let software = is_software(&adapter);
        devices.push(Device {
            world,
            name: if software { "software GPU driver" } else { "GPU" },
            rows: match (options.quick, software) {
                (true, true) => rows(&|bodies| bodies == 300),
                (true, false) | (false, true) => rows(&|bodies| bodies % 1100 == 0),
                (false, false) => rows(&|_| true),
            },
            steps: if software { 3 } else { steps },
        });
    }
    Ok(devices)
}

/// The version of a dependency, from the lock file that this program was built with.
fn version_of(name: &str) -> String {
    const LOCK: &str = include_str!("../../../../Cargo.lock");
    let package = format!("name = \"{name}\"\nversion = \"");
    let at = LOCK.find(&package).map(|at| &LOCK[at + package.len()..]);
    at.and_then(|rest| rest.split('"').next())
        .unwrap_or("unknown")
        .to_owned()
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
    let mut devices = devices(options)?;
    let mut plan = Plan::new(options);
    plan.show(&devices);
    let plan = plan;
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
    let both = [
        shape("torus", shapes::torus_240(), 0.5)?,
        shape("knot", shapes::knot_1120(), 3.0)?,
    ];

    plan.bar.set_message("table 1");
    report.heading("Table 1: broad and narrow phase");
    report.text(&format!(
        "Medians over the steps of the table. The paper's column is its table 1, on a GeForce 8800 GTX; a ratio above 1 means that \
         ours is faster, on other hardware. Sphere pairs are pairs of bodies whose bounding spheres overlap. The paper does not give \
         the size of its box; ours has a size at which there are about as many pairs. Each row is a run of its own, in \
         which bodies move as the mode's collisions make them, so that its pairs differ from those of other modes and numbers of \
         steps; the recall below compares equal poses. Face tables: a direction every {degrees} degrees, {pixels} x {pixels} pixels.",
    ));
    table1::table_1(&plan, &mut devices, &both, &mut report)?;

    report.heading("Figure 4: height images");
    for shape in &both {
        let canvas = image::single(&shape.mesh.mesh, 30.0, 30.0, 320, false);
        report.picture(
            &canvas,
            &format!("The {}: heights in units of the mesh, and visible faces", shape.name),
        )?;
    }
    plan.bar.set_message("figure 6");
    report.heading("Figure 6: the largest scenes");
    table1::figure_6(&plan, &mut devices[0], &both, &mut report)?;

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
    report.text(
        "Tori on the CPU, exact. Each row is a process of its own. Memory is the most that it had at any time, where the system tells; it \
         includes Bevy's entities.",
    );
    plan.bar.set_message("growth");
    growth::growth(&plan, &mut report)?;
    plan.bar.finish_and_clear();

    let mut meta = Table::new("about", &["about", "value"]);
    let mut about = |name: &str, value: String| meta.rows.push(vec![json!(name), json!(value)]);
    about("bevy_faceoff", env!("CARGO_PKG_VERSION").to_owned());
    about("bevy", version_of("bevy"));
    about("wgpu", version_of("wgpu"));
    about(
        "command",
        format!(
            "reproduce --backend {}{} --seed {}",
            options.backend.name(),
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
        match devices.iter().find_map(|device| device.world.adapter()) {
            Some(name) if is_software(&name) => {
                format!(
                    "{name}. This is a software driver that computes on the CPU; its times say nothing about a GPU."
                )
            }
            Some(name) => name,
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
