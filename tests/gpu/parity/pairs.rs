//! Every kind of scene in its modes, once on either side.

use super::band::Oracle;
use super::compare::{Tally, compare};
use super::contacts::{Differences, differences};
use super::scene::Scene;
use super::scenes::{COUNT, KINDS, Kit};
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::step::gpu::GpuStep;
use std::time::Instant;

/// Fewer than these would prove little.
const SCENES: usize = 20;
const ENOUGH_FACES: usize = 100_000;
const ENOUGH_CONTAINED: usize = 200;

pub fn same_as_on_the_cpu(gpu: &Gpu) {
    let kit = Kit::new();
    let mut step = GpuStep::new(gpu.clone()).unwrap();
    let (mut all, mut differing, mut scenes) = (Tally::default(), Differences::default(), 0);
    println!("\n{}", Tally::head());
    for kind in KINDS {
        for &modes in kind.modes {
            let name = format!("{}, {modes:?}", kind.name);
            let scene = kind.scene(&kit, modes);
            assert!(scene.bodies.len() >= COUNT);
            let start = Instant::now();
            let (tally, differ) = one_step(&scene, &mut step);
            println!("{} {:.1} s", tally.row(&name), start.elapsed().as_secs_f32());
            println!("{}", differ.row());
            let named = |text: String| format!("{name}: {text}");
            all.add(Tally {
                failures: tally.failures.iter().cloned().map(named).collect(),
                ..tally
            });
            differing.add(Differences {
                failures: differ.failures.iter().cloned().map(named).collect(),
                ..differ
            });
            scenes += 1;
        }
    }
    println!("{}", all.row("all"));
    println!("{}", differing.row());
    all.require_no_failures();
    all.require_few_excused(1000);
    let shown: Vec<_> = differing.failures.iter().take(8).collect();
    assert!(shown.is_empty(), "{} failures: {shown:#?}", differing.failures.len());
    // Where a contour encloses next to nothing, or a pair neither closes nor parts, rounding decides what answers.
    assert!(differing.contacts_off <= 3 + differing.contacts / 2000);
    assert!(differing.bodies_off <= 3 + differing.bodies / 2000);
    assert!(differing.planes > 300 && differing.planes_excused <= 3 + differing.planes / 200);
    assert!(scenes >= SCENES);
    assert!(all.faces >= ENOUGH_FACES && all.contained >= ENOUGH_CONTAINED);
}

fn one_step(scene: &Scene, step: &mut GpuStep) -> (Tally, Differences) {
    let cpu = scene.on_cpu();
    let gpu = scene.on_gpu(step);
    let oracle = Oracle::new(scene, &cpu);
    let (tally, agreed) = compare(scene, &cpu, &gpu, &oracle);
    (tally, differences(scene, &cpu, &gpu, &agreed))
}
