//! Knots that fly into each other, with nothing outside: what they keep.

use super::Case;
use super::mass::masses;
use super::motion::Motion;
use super::world::{Engine, Run};
use bevy_faceoff::testing::scenes::{Scene, flight};
use bevy_faceoff::types::material::Friction;

/// `count` knots of restitution 1, with friction and without.
pub fn cases(count: usize) -> Vec<Case> {
    let case = |friction: f32| Case {
        name: format!("{count} knots in flight, restitution 1, friction {friction}, 300 steps"),
        quantity: "drift of momentum, of angular momentum; highest energy and energy at the end, of the first",
        steps: 300,
        other: Some(Engine::Parts),
        scenes: Box::new(move |_| vec![cloud(count, friction)]),
        judge: Box::new(judge),
    };
    // Without friction, nothing may take energy.
    vec![case(0.5), case(0.0)]
}

/// Knots that fly inward and past each other.
fn cloud(count: usize, friction: f32) -> Scene {
    let mut random = fastrand::Rng::with_seed(11);
    flight::cloud(count, &mut || random.f32(), |knot, _| {
        (knot.restitution, knot.friction) = (1.0, Friction::new(friction));
    })
}

fn judge(runs: &[Run]) -> String {
    let run = &runs[0];
    let masses = masses(&run.scene);
    let before = Motion::of(&run.scene, &masses, &run.states[0]);
    let (mut linear, mut angular, mut kinetic, mut last) = (0.0f64, 0.0f64, 0.0f64, 0.0);
    for states in &run.states {
        let now = Motion::of(&run.scene, &masses, states);
        linear = linear.max(now.linear.distance(before.linear) / before.linear_size);
        angular = angular.max(now.angular.distance(before.angular) / before.angular_size);
        last = now.kinetic / before.kinetic;
        kinetic = kinetic.max(last);
    }
    format!(
        "{linear:.1e}, {angular:.1e}; {:.2} %, {:.1} %",
        100.0 * kinetic,
        100.0 * last
    )
}
