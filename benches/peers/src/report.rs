//! The report: tables on standard output, and the same data as JSON.

use crate::engine::{Kind, THREADS};
use crate::judge::Dispute;
use crate::manifolds;
use crate::narrow::{Narrow, ParryNarrow};
use crate::parry::PREDICTIONS;
use crate::scene::Shape;
use crate::steps::Run;
use crate::timing::{median, ratio};
use serde::Serialize;
use std::collections::BTreeMap;

/// All measurements.
#[derive(Serialize)]
pub struct Report {
    /// The machine.
    pub machine: Machine,
    /// The version of each library.
    pub versions: Vec<(&'static str, String)>,
    /// The number of bodies.
    pub bodies: usize,
    /// The seed of the random numbers.
    pub seed: u64,
    /// The narrow phase of each shape.
    pub narrow: Vec<Narrow>,
    /// Contact manifolds of each shape.
    pub manifolds: Vec<manifolds::Row>,
    /// The runs of all engines for each shape.
    pub steps: Vec<(Shape, Vec<Run>)>,
}

/// The machine as described by the operating system.
#[derive(Serialize)]
pub struct Machine {
    /// The processor.
    pub cpu: String,
    /// The number of cores that this process may use.
    pub cores: usize,
    /// The one-minute load average, before and after.
    pub load: [String; 2],
}

impl Machine {
    /// The current machine.
    pub fn here() -> Self {
        let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let model = text.lines().find_map(|line| line.strip_prefix("model name"));
        Self {
            cpu: model.map_or("unknown".into(), |m| m.trim_start_matches([' ', '\t', ':']).into()),
            cores: std::thread::available_parallelism().map_or(0, usize::from),
            load: [load(), String::new()],
        }
    }

    /// Records the load at the end.
    pub fn finish(&mut self) {
        self.load[1] = load();
    }

    /// A line about these libraries on this machine.
    pub fn heading<'a>(&self, versions: impl Iterator<Item = &'a (&'static str, String)>) -> String {
        let versions: Vec<String> = versions.map(|(name, version)| format!("{name} {version}")).collect();
        let [before, after] = &self.load;
        format!(
            "{}; {}, {} cores, load {before} before and {after} after; {THREADS} threads for each engine",
            versions.join(", "),
            self.cpu,
            self.cores
        )
    }
}

fn load() -> String {
    let text = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
    text.split(' ').next().unwrap_or_default().into()
}

/// The versions in the lock file. avian3d depends on an older parry3d; the newest is the one measured.
pub fn versions() -> Vec<(&'static str, String)> {
    let lock = include_str!("../Cargo.lock");
    let version = |name: &str| {
        let head = format!("name = \"{name}\"\nversion = \"");
        let last = lock.rsplit_once(&head)?.1;
        Some(last.split('"').next()?.to_owned())
    };
    ["bevy_faceoff", "parry3d", "rapier3d", "avian3d", "bevy"]
        .into_iter()
        .map(|name| (name, version(name).unwrap_or_default()))
        .collect()
}

/// Formats a ratio, truncated so that it never looks better than it is.
fn cut(x: f64) -> String {
    format!("{:.2}", (x * 100.0).floor() / 100.0)
}

impl Report {
    /// Whether the independent test found bevy_faceoff wrong in a disagreement.
    pub fn is_our_fault(&self) -> bool {
        let hits = self
            .narrow
            .iter()
            .flat_map(|n| [&n.parry.first_hits, &n.parry.larger_first]);
        hits.flat_map(|hits| &hits.disputes).any(Dispute::is_our_fault)
    }

    /// Prints the tables.
    pub fn print(&self) {
        let Machine { cpu, cores, load } = &self.machine;
        let versions: Vec<String> = self.versions.iter().map(|(name, v)| format!("{name} {v}")).collect();
        println!(
            "{}; {cpu}, {cores} cores, load {} to {}",
            versions.join(", "),
            load[0],
            load[1]
        );
        if !self.narrow.is_empty() {
            self.print_narrow();
            manifolds::print(&self.manifolds);
            self.print_broad();
            self.print_threads();
        }
        if !self.steps.is_empty() {
            self.print_steps();
        }
    }

    fn print_narrow(&self) {
        println!(
            "\nNarrow phase of the first step of {} bodies, one thread, medians of {} interleaved rounds; ratios are medians \
             of the rounds' ratios\n",
            self.bodies,
            self.narrow[0].ours.len()
        );
        println!("| shape | what | us per sphere pair | times ours | times our first hit | touching pairs |");
        println!("|---|---|---|---|---|---|");
        for narrow in &self.narrow {
            let name = format!("{} {}", narrow.shape.name(), narrow.triangles);
            let pairs = narrow.sphere_pairs;
            let micros = |times: &[f64]| median(times.iter().copied()) * 1e6 / pairs as f64;
            let first = |times: &[f64]| cut(ratio(times, &narrow.ours_first));
            println!(
                "| {name}, {pairs} sphere pairs | ours, exact: all {} face pairs, with segments and contacts | {:.2} | 1 | {} | {} and \
                 {} wholly inside another |",
                narrow.face_pairs,
                micros(&narrow.ours),
                first(&narrow.ours),
                narrow.touching,
                narrow.contained
            );
            println!(
                "| {name} | ours, first hit, by `queries::touching` | {:.2} | {} | {} | the same |",
                micros(&narrow.ours_first),
                cut(ratio(&narrow.ours_first, &narrow.ours)),
                first(&narrow.ours_first),
            );
            let parry = &narrow.parry;
            for (order, hits) in [
                ("as they come", &parry.first_hits),
                ("larger body first", &parry.larger_first),
            ] {
                let same = match hits.disputes.len() {
                    0 => "the same".into(),
                    n => format!("and {n} in dispute, see below"),
                };
                let [time, times_ours, times_first] = if hits.disputes.iter().any(Dispute::is_our_fault) {
                    ["ours is wrong".into(), String::new(), String::new()]
                } else {
                    let times = &hits.seconds;
                    [
                        format!("{:.2}", micros(times)),
                        cut(ratio(times, &narrow.ours)),
                        first(times),
                    ]
                };
                println!(
                    "| {name} | parry3d `intersection_test`: first hit, {order} | {time} | {times_ours} | {times_first} | {}, {same} |",
                    hits.both
                );
            }
            for ((prediction, times), found) in PREDICTIONS.iter().zip(&parry.manifolds).zip(&parry.manifold_pairs) {
                let near = match found.near - found.touching {
                    0 => String::new(),
                    n => format!(", and {n} that gape"),
                };
                println!(
                    "| {name} | parry3d `contact_manifolds` within {prediction} m, from nothing | {:.2} | {} | {} | {}{near} |",
                    micros(times),
                    cut(ratio(times, &narrow.ours)),
                    first(times),
                    found.touching,
                );
            }
        }
        for narrow in &self.narrow {
            let ParryNarrow {
                first_hits,
                larger_first,
                ..
            } = &narrow.parry;
            // Most disagreements occur in both orders.
            let disputes = first_hits.disputes.iter().chain(&larger_first.disputes);
            let disputes: BTreeMap<[u32; 2], &Dispute> = disputes.map(|d| (d.pair, d)).collect();
            for dispute in disputes.values() {
                print_dispute(narrow.shape, dispute);
            }
        }
    }

    fn print_broad(&self) {
        println!("\nBroad phase of the same step, one thread, the same rounds\n");
        println!("| shape | what | ms | times ours | pairs |");
        println!("|---|---|---|---|---|");
        let ms = |times: &[f64]| median(times.iter().copied()) * 1e3;
        for narrow in &self.narrow {
            let name = narrow.shape.name();
            println!(
                "| {name} | ours: grid, from nothing | {:.3} | 1 | {} of spheres |",
                ms(&narrow.ours_broad),
                narrow.sphere_pairs
            );
            let parry = &narrow.parry;
            for (what, times) in [
                ("tree, built anew", &parry.broad_rebuilt),
                ("tree, fitted to bodies that moved", &parry.broad_refitted),
            ] {
                println!(
                    "| {name} | parry3d: {what} | {:.3} | {} | {} of boxes; misses {} that touch |",
                    ms(times),
                    cut(ratio(times, &narrow.ours_broad)),
                    parry.box_pairs,
                    parry.boxes_miss
                );
            }
        }
    }

    fn print_threads(&self) {
        println!(
            "\nOur narrow phase on two threads, the same rounds, each the second time in a row; the control is arithmetic in registers\n"
        );
        println!("| shape | one thread, ms | two threads, ms | times faster | control, times faster |");
        println!("|---|---|---|---|---|");
        for narrow in &self.narrow {
            let ms = |times: &[f64]| median(times.iter().copied()) * 1e3;
            println!(
                "| {} | {:.2} | {:.2} | {} | {} |",
                narrow.shape.name(),
                ms(&narrow.ours_threads[0]),
                ms(&narrow.ours_threads[1]),
                cut(ratio(&narrow.ours_threads[0], &narrow.ours_threads[1])),
                cut(ratio(&narrow.control[0], &narrow.control[1]))
            );
        }
    }

    fn print_steps(&self) {
        println!(
            "\nWhole steps of {} bodies with response, {THREADS} threads each, one step each in turn; medians over the steps done. \
             Trajectories part after the first step\n",
            self.bodies
        );
        println!(
            "| shape | engine | steps | first, ms | median, ms | ours over the same steps, ms | times ours | times ours, steps 2 to 8 | first step: touching \
             by both, only ours, only it | touching pairs, median | highest energy over that at the start | |"
        );
        println!("|---|---|---|---|---|---|---|---|---|---|---|---|");
        for (shape, runs) in &self.steps {
            let ours = &runs[0].seconds;
            for run in runs {
                let name = match run.engine {
                    Kind::Ours => "ours",
                    Kind::Contacts => "ours, contacts",
                    Kind::Rapier => "rapier3d",
                    Kind::RapierFaceoff => "rapier3d, parry_faceoff",
                    Kind::Avian => "avian3d",
                    Kind::AvianFaceoff => "avian3d, avian_faceoff",
                };
                let steps = run.seconds.len();
                let failure = run.failure.as_deref().unwrap_or_default();
                if steps == 0 {
                    println!("| {} | {name} | 0 | | | | | | | | | {failure} |", shape.name());
                    continue;
                }
                let ms = |times: &[f64]| median(times.iter().copied()) * 1e3;
                let same = &ours[..steps.min(ours.len())];
                let early = run.seconds.get(1..8).zip(ours.get(1..8));
                let [both, only_ours, only_it] = run.first;
                println!(
                    "| {} | {name} | {steps} | {:.2} | {:.2} | {:.2} | {} | {} | {both}, {only_ours}, {only_it} | {} | {} | {failure} |",
                    shape.name(),
                    run.seconds[0] * 1e3,
                    ms(&run.seconds),
                    ms(same),
                    cut(ratio(&run.seconds, same)),
                    // In later steps the engines differ in the number of pairs that still touch.
                    early.map_or(String::new(), |(run, ours)| cut(ratio(run, ours))),
                    median(run.touching.iter().map(|&n| n as f64)),
                    run.energy.map_or(String::new(), cut),
                );
            }
        }
    }
}

fn print_dispute(shape: Shape, dispute: &Dispute) {
    let Dispute {
        pair, ours, distance, ..
    } = dispute;
    println!(
        "\n{}: {} says that bodies {} and {} touch; in double precision their surfaces {}: {}.",
        shape.name(),
        if *ours { "only ours" } else { "only parry3d" },
        pair[0],
        pair[1],
        match distance {
            0.0 => "intersect".into(),
            d => format!("are {:.4} mm apart", d * 1e3),
        },
        match (dispute.rounding, dispute.is_our_fault()) {
            (true, _) => "a matter of rounding",
            (_, true) => "ours is wrong",
            (_, false) => "parry3d is wrong",
        }
    );
}
