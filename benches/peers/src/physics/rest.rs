//! What stands and lies still: by itself, in stacks, in piles.

use super::world::{Engine, Run};
use super::{Case, HZ};
use bevy_faceoff::testing::scenes::Scene;
use bevy_faceoff::testing::scenes::rest;

/// Whoever has moved farther, in metres, does not stand where it was put.
const FALLEN: f64 = 0.3;

/// A cube's diameter is its diagonal.
const DIAGONAL: f32 = 1.732_050_8;

/// All are given so many seconds to find a place: rings are polygons and do not fit exactly.
const SETTLING: usize = 2;

/// A cube, a stack, a pyramid, piles of rings.
pub fn cases() -> Vec<Case> {
    vec![
        case("cube on a mesh", 60, true, Engine::Primitives, |gap| {
            rest::cube(1.0, gap * DIAGONAL)
        }),
        case("stack of 10 cubes", 30, true, Engine::Primitives, |gap| {
            rest::stack(10, gap * DIAGONAL)
        }),
        case("pyramid of 15 cubes", 30, true, Engine::Primitives, |gap| {
            rest::pyramid(5, gap * DIAGONAL)
        }),
        case("5 rings on one axis", 30, true, Engine::Parts, |gap| {
            rest::rings(0.0, gap)
        }),
        // They tilt until they find support: nothing is said of how high they end.
        case("5 rings across each other", 30, false, Engine::Parts, |gap| {
            rest::rings(0.25, gap)
        }),
    ]
}

/// With the height of the top at the end, if it is known.
fn case(name: &str, seconds: usize, height: bool, other: Engine, scene: fn(f32) -> Scene) -> Case {
    Case {
        name: format!("{name}, {seconds} s"),
        quantity: if height {
            "moves at most, and in the last second; ends too high (+) or sunk (-)"
        } else {
            "moves at most, and in the last second"
        },
        steps: HZ * (SETTLING + seconds),
        other: Some(other),
        scenes: Box::new(move |gap| vec![scene(gap)]),
        judge: Box::new(move |runs| judge(&runs[0], height.then(|| scene(0.0)).as_ref())),
    }
}

/// Compares heights with a scene in which all touch exactly.
fn judge(run: &Run, touching: Option<&Scene>) -> String {
    let first = (SETTLING * HZ).min(run.states.len() - 1);
    let farthest = |from: usize, to: usize| {
        let both = run.states[from].iter().zip(&run.states[to]);
        both.map(|(from, to)| to.center.distance(from.center))
            .fold(0.0, f64::max)
    };
    if let Some(step) = (0..run.states.len()).find(|&step| farthest(0, step) > FALLEN) {
        return format!("**falls, after {:.1} s**", step as f64 / HZ as f64);
    }
    let most = (first..run.states.len())
        .map(|step| farthest(first, step))
        .fold(0.0, f64::max);
    let last = run.states.len() - 1;
    let [most, creep] = [most, farthest(last.saturating_sub(HZ), last)].map(|x| format!("{:.3} mm", 1e3 * x));
    // The last one was put on top.
    let top = run.scene.bodies.len() - 1;
    let height = |touching: &Scene| run.states[last][top].center.y - f64::from(touching.bodies[top].position.y);
    let height = touching.map_or(String::new(), |touching| format!("; {:+.2} mm", 1e3 * height(touching)));
    format!("{most}, {creep}{height}")
}
