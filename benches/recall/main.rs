//! Recall and speed of the approximate culling modes: `cargo bench --bench recall [CASES]`.
//!
//! Recall is relative to the exact mode, on random touching pairs of equal meshes with diameters 0.25 to 2. *any* is
//! the fraction of pairs for which at least one intersecting face pair is found. *share* is the fraction of all
//! intersecting face pairs that is found. "eq. 4" looks up the table by the formula of Aly & Elawady 2010 as
//! printed, which takes angles between 0 and 180 degrees in two planes. It exists only here, to show its effect.

mod cases;
#[path = "../narrow_phase/plain.rs"]
mod plain;
mod recall;
mod time;

use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::projection::{BakeSettings, Progress};

/// The number of sphere pairs for the measurement of time.
const TIMED: usize = 1000;

fn main() {
    let cases = std::env::args().find_map(|a| a.parse().ok()).unwrap_or(1000);
    let pool = rayon::ThreadPoolBuilder::new().build().expect("a pool");
    let settings = BakeSettings {
        faces: true,
        ..BakeSettings::default()
    };
    let meshes = [("torus 240", shapes::torus_240()), ("knot 1120", shapes::knot_1120())].map(|(name, mesh)| {
        let baked = CollisionMesh::bake(&mesh, settings, &pool, &Progress::default()).expect("nobody cancels");
        (name, mesh, baked)
    });
    println!(
        "{cases} touching pairs per regime (a quarter of that interlocked), tables of {0} x {0} pixels and {1} degree; any / \
         share\n",
        settings.image, settings.degrees
    );
    println!("| shape | regime | faces of collision | front-facing | eq. 4 as printed | face pairs per pair |");
    println!("|---|---|---|---|---|---|");
    for (name, mesh, baked) in &meshes {
        recall::measure(mesh, baked, cases, |regime, tally| print(name, regime, tally));
    }
    println!("\nSphere pairs whether they touch or not, one thread, medians of 5 interleaved rounds\n");
    println!(
        "| shape | method | triangle tests per sphere pair | us per sphere pair | faster than plain | touching | face pairs |"
    );
    println!("|---|---|---|---|---|---|---|");
    let single = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .expect("a thread");
    for (name, mesh, baked) in &meshes {
        single.install(|| time::table(name, mesh, baked, TIMED));
    }
}

fn print(name: &str, regime: &cases::Regime, tally: &recall::Tally) {
    let [faces, front, literal] = tally.found.map(|found| {
        format!(
            "{:.3} / {:.3}",
            found.any as f64 / tally.pairs as f64,
            found.faces as f64 / tally.faces as f64
        )
    });
    let mean = tally.faces as f64 / tally.pairs as f64;
    println!(
        "| {name} | {} | {faces} | {front} | {literal} | {mean:.1} |",
        regime.name
    );
}
