//! Contact manifolds of the same pairs within the same distance: from nothing, and from step to step with what each
//! library keeps of a pair.

use crate::ours::at_rest;
use crate::parry::{Kept as ParryKept, Parry};
use crate::scene::{Scene, Shape};
use crate::timing::{median, pool, ratio, time};
use bevy_faceoff::manifolds::cpu::{self, Scratch};
use bevy_faceoff::manifolds::{Manifolds, MarginPair};
use bevy_faceoff::state::mesh_arena::MeshArena;
use serde::Serialize;

/// The distances in metres within which contacts are found.
const MARGINS: [f32; 3] = [0.0, 0.002, 0.02];

/// The measurements of one scene within one distance.
#[derive(Serialize)]
pub struct Row {
    shape: Shape,
    margin: f32,
    pairs: usize,
    /// Seconds of each round, from nothing: ours and parry3d's.
    fresh: [Vec<f64>; 2],
    /// Seconds of each step in which all bodies move on, with what is kept of the step before.
    reused: [Vec<f64>; 2],
    /// The number of pairs with contacts in the last round from nothing.
    near: [usize; 2],
}

/// Measures one scene, one thread, in turns.
pub fn measure(shape: Shape, scene: &Scene, pairs: &[[u32; 2]], rounds: usize) -> Vec<Row> {
    MARGINS
        .map(|margin| pool(1).install(|| row(shape, scene, pairs, margin, rounds)))
        .into()
}

fn row(shape: Shape, scene: &Scene, pairs: &[[u32; 2]], margin: f32, rounds: usize) -> Row {
    let mut meshes = MeshArena::default();
    let mesh = meshes.add(scene.mesh.clone());
    let at = |steps| at_rest(scene, steps, mesh, &meshes);
    let margin_pairs: Vec<MarginPair> = pairs.iter().map(|&bodies| MarginPair { bodies, margin }).collect();
    let (mut scratch, mut found) = (Scratch::default(), Manifolds::default());
    let mut parry = Parry::new(scene);
    let mut kept = ParryKept::new(pairs.len());
    let mut row = Row {
        shape,
        margin,
        pairs: pairs.len(),
        fresh: [const { Vec::new() }; 2],
        reused: [const { Vec::new() }; 2],
        near: [0; 2],
    };

    let bodies = at(0);
    for _ in 0..rounds {
        scratch.forget();
        let mut ours = || cpu::run(&bodies, &meshes, &margin_pairs, &mut scratch, &mut found);
        row.fresh[0].push(time(&mut ours).0);
        let (seconds, manifolds) = time(|| parry.manifolds(pairs, margin));
        row.fresh[1].push(seconds);
        row.near = [found.pairs.len(), manifolds.near];
    }
    // The first step finds what the others reuse.
    for step in 0..=rounds {
        let bodies = at(step);
        let ours = time(|| cpu::run(&bodies, &meshes, &margin_pairs, &mut scratch, &mut found)).0;
        parry.move_to(scene, step);
        let peer = time(|| parry.update_manifolds(pairs, margin, &mut kept)).0;
        if step > 0 {
            row.reused[0].push(ours);
            row.reused[1].push(peer);
        }
    }
    row
}

/// Prints the rows of all scenes.
pub fn print(rows: &[Row]) {
    println!(
        "\nContact manifolds within the same distance, one thread, medians; ratios are medians of the rounds' ratios\n"
    );
    println!(
        "| shape | within, m | pairs | ours from nothing, us per pair | parry3d from nothing | times ours | ours from step to step | \
         parry3d from step to step | times ours | pairs with contacts, ours and parry3d |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for row in rows {
        let micros = |times: &[f64]| median(times.iter().copied()) * 1e6 / row.pairs as f64;
        let [fresh, reused] = [&row.fresh, &row.reused].map(|[ours, peer]| {
            let times = (ratio(peer, ours) * 100.0).floor() / 100.0;
            format!("{:.2} | {:.2} | {times:.2}", micros(ours), micros(peer))
        });
        println!(
            "| {} | {} | {} | {fresh} | {reused} | {} and {} |",
            row.shape.name(),
            row.margin,
            row.pairs,
            row.near[0],
            row.near[1]
        );
    }
}
