//! Time per step of small games: apps with default settings on the CPU, `cargo bench --bench small_games [NAME]`.
//!
//! Each game looks for a performance cliff: a cost that depends on something irrelevant, such as a velocity that all
//! bodies share. Times depend on the machine; the counts beside them are the same everywhere.

mod games;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_faceoff::prelude::*;
use games::{GAMES, Game};
use std::time::Duration;

/// One fixed step.
const STEP: Duration = Duration::from_nanos(15_625_000);

fn main() {
    let only = std::env::args().skip(1).find(|arg| !arg.starts_with('-'));
    println!(
        "| game | bodies | steps | mean ms | median ms | worst ms | median outside of the stages, us | most parallel stages | most pairs | \
         most points | most collision substeps | asleep at the end |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|");
    for game in GAMES {
        if only.as_ref().is_none_or(|only| game.name.contains(only.as_str())) {
            play(game);
        }
    }
}

fn play(game: &Game) {
    let mut app = App::new();
    let step = StepPlugin {
        backend: Backend::Cpu,
        ..default()
    };
    app.add_plugins((MinimalPlugins, FaceoffHeadlessPlugins { step, ..default() }))
        .insert_resource(Time::<Fixed>::from_duration(STEP))
        .insert_resource(TimeUpdateStrategy::ManualDuration(STEP));
    app.finish();
    app.cleanup();
    (game.spawn)(app.world_mut());
    // In Bevy's first update no time has passed, so it runs no step.
    app.update();

    let (mut times, mut rest) = (Vec::new(), Vec::new());
    let (mut parallel_stages, mut asleep) = (0, 0);
    let (mut bodies, mut pairs, mut points, mut collision_substeps) = (0, 0, 0, 0);
    for _ in 0..game.steps {
        app.update();
        let report = app.world().resource::<StepReport>();
        times.push(report.total);
        rest.push(report.total.saturating_sub(report.stages.iter().sum()));
        parallel_stages = parallel_stages.max(report.parallel_stages);
        bodies = report.bodies;
        asleep = report.sleeping;
        pairs = pairs.max(report.sphere_pairs);
        points = points.max(report.contact_points);
        collision_substeps = collision_substeps.max(report.collision_substeps);
    }
    times.sort();
    rest.sort();
    let ms = |time: Duration| time.as_secs_f64() * 1e3;
    println!(
        "| {} | {bodies} | {} | {:.3} | {:.3} | {:.2} | {:.0} | {parallel_stages} | {pairs} | {points} | {collision_substeps} | {asleep} |",
        game.name,
        game.steps,
        ms(times.iter().sum::<Duration>()) / times.len() as f64,
        ms(times[times.len() / 2]),
        ms(times[times.len() - 1]),
        1e3 * ms(rest[rest.len() / 2]),
    );
}
