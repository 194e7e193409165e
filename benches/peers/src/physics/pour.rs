//! Knots poured into a bin.

use super::overlap::{Solid, depth};
use super::world::{Engine, Run, State};
use super::{Case, HZ, mean};
use bevy::math::{DVec3, Quat, Vec3};
use bevy_faceoff::testing::scenes::pour::knots;
use bevy_faceoff::testing::scenes::{Body, Scene, Shape, any_turn};

/// Width of the bin's inside.
const WIDTH: f32 = 3.4;
/// Knots side by side.
const SIDE: usize = 3;
/// From one layer of falling knots to the next.
const LAYER: f32 = 1.3;
const SECONDS: usize = 8;
/// How deep bodies overlap is looked at so often: it takes longer than a step.
const LOOK: usize = HZ;

/// `count` knots.
pub fn case(count: usize) -> Case {
    let name = format!("{count} knots poured into a bin, {SECONDS} s");
    Case {
        name,
        quantity: "leave the bin; fastest at the end; pairs that overlap at the end, their mean depth and the deepest; the deepest \
                   seen once a second on the way; depths in parts of the diameter",
        steps: SECONDS * HZ,
        other: Some(Engine::Parts),
        scenes: Box::new(move |_| vec![pour(count)]),
        judge: Box::new(judge),
    }
}

/// Room for all before they fall.
fn height(count: usize) -> f32 {
    LAYER * count.div_ceil(SIDE * SIDE) as f32 + 2.0
}

fn pour(count: usize) -> Scene {
    let mut scene = Scene::new();
    let bin = scene.add(Body::new(Shape::Bin, Vec3::ZERO, Quat::IDENTITY));
    (bin.fixed, bin.scale) = (true, Vec3::new(WIDTH, height(count), WIDTH));
    let mut random = fastrand::Rng::with_seed(3);
    knots(&mut scene, count, SIDE, || any_turn(&mut || random.f32()));
    scene
}

fn judge(runs: &[Run]) -> String {
    let run = &runs[0];
    let knots = &run.last()[1..];
    let half = f64::from(0.5 * WIDTH);
    let high = f64::from(height(knots.len()));
    let inside = |c: DVec3| c.x.abs().max(c.z.abs()) < half && (0.0..high).contains(&c.y);
    let left = knots.iter().filter(|knot| !inside(knot.center)).count();
    let fastest = knots.iter().map(|knot| knot.velocity.length()).fold(0.0, f64::max);
    let still = depths(knots);
    let on_the_way = run.states.iter().step_by(LOOK).flat_map(|states| depths(&states[1..]));
    let percent = |x: f64| format!("{:.2} %", 100.0 * x);
    let most = |depths: &[f64]| percent(depths.iter().copied().fold(0.0, f64::max));
    let average = if still.is_empty() {
        0.0
    } else {
        mean(still.iter().copied())
    };
    format!(
        "{left}; {fastest:.3} m/s; {}, {} and {}; {}",
        still.len(),
        percent(average),
        most(&still),
        most(&on_the_way.collect::<Vec<_>>())
    )
}

/// How deep knots lie in each other, and in the floor and walls: of those that do.
fn depths(knots: &[State]) -> Vec<f64> {
    let half = f64::from(0.5 * WIDTH);
    let solids: Vec<Solid> = knots.iter().map(|state| Solid::new(Shape::Knot, state)).collect();
    let mut depths = Vec::new();
    for (i, (solid, state)) in solids.iter().zip(knots).enumerate() {
        // What has left is counted elsewhere.
        let walls = (-solid.low).max(solid.high) - DVec3::new(half, f64::INFINITY, half);
        let wall = walls.x.max(walls.z).max(-solid.low.y);
        if wall > 0.0 && state.center.y > 0.0 && state.center.x.abs().max(state.center.z.abs()) < half {
            depths.push(wall);
        }
        depths.extend(solids[..i].iter().filter_map(|other| depth(solid, other)));
    }
    depths
}
