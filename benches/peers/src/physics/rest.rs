//! What stands and lies still: by itself, in stacks, in piles.

use super::scene::{Body, RING_TUBE, Scene, Shape};
use super::world::{Engine, Run};
use super::{Case, HZ};
use bevy::math::{Quat, Vec3};
use std::f32::consts::FRAC_PI_2;

/// Whoever has moved farther, in metres, does not stand where it was put.
const FALLEN: f64 = 0.3;

/// All are given so many seconds to find a place: rings are polygons and do not fit exactly.
const SETTLING: usize = 2;

/// A cube, a stack, a pyramid, piles of rings.
pub fn cases() -> Vec<Case> {
    vec![
        case("cube on a mesh", 60, true, Engine::Primitives, |gap| {
            cubes(vec![[0.3, 0.0, 0.2]], 0.4, gap)
        }),
        case("stack of 10 cubes", 30, true, Engine::Primitives, |gap| {
            cubes((0..10).map(|i| [0.0, i as f32, 0.0]).collect(), 0.1, gap)
        }),
        case("pyramid of 15 cubes", 30, true, Engine::Primitives, |gap| {
            let rows = (0..5).flat_map(|row| (0..5 - row).map(move |k| (row as f32, k as f32)));
            // Neighbours are out of each other's sight.
            let places = rows.map(|(row, k)| [1.05 * (k + 0.5 * row), row, 0.0]);
            cubes(places.collect(), 0.0, gap)
        }),
        case("5 rings on one axis", 30, true, Engine::Parts, |gap| rings(0.0, gap)),
        // They tilt until they find support: nothing is said of how high they end.
        case("5 rings across each other", 30, false, Engine::Parts, |gap| {
            rings(0.25, gap)
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

/// Cubes of edge 1 at such places: y counts layers. Each is turned by `twist` more than the one before.
fn cubes(places: Vec<[f32; 3]>, twist: f32, gap: f32) -> Scene {
    // A cube's diameter is its diagonal.
    let gap = gap * 3.0f32.sqrt();
    let mut scene = Scene::new(true);
    scene.floor(Vec3::new(40.0, 1.0, 40.0), Quat::IDENTITY);
    // The only one is turned, too.
    let first = usize::from(places.len() == 1);
    for (i, [x, layer, z]) in places.into_iter().enumerate() {
        let at = Vec3::new(x, 0.5 + gap + (1.0 + gap) * layer, z);
        scene.add(Body::new(
            Shape::Cube,
            at,
            Quat::from_rotation_y(twist * (first + i) as f32),
        ));
    }
    scene
}

/// Rings that lie on each other, each shifted by `shift` against that below, to and fro.
fn rings(shift: f32, gap: f32) -> Scene {
    let mut scene = Scene::new(true);
    scene.floor(Vec3::new(40.0, 1.0, 40.0), Quat::IDENTITY);
    let tube = RING_TUBE as f32;
    for i in 0..5 {
        let at = Vec3::new(shift * (i % 2) as f32, tube + gap + (2.0 * tube + gap) * i as f32, 0.0);
        let turn = Quat::from_rotation_y(0.4 * i as f32) * Quat::from_rotation_x(FRAC_PI_2);
        scene.add(Body::new(Shape::Ring, at, turn));
    }
    scene
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
