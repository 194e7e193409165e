//! A body that turns freely and whose moments of inertia all differ.

use super::mass::{Mass, masses};
use super::motion::Motion;
use super::world::Run;
use super::{Case, HZ};
use bevy::math::Vec3;
use bevy_faceoff::testing::scenes::flight::squeezed_knot;

/// One that keeps what it has, and one that flips.
pub fn cases() -> Vec<Case> {
    let keeps = [[1.0, 2.0, 3.0], [6.0, 0.5, 6.0], [0.1, 12.0, 0.3]];
    let case = |name: &str, quantity, scenes, judge: fn(&[Run]) -> String| Case {
        name: format!("squeezed knot in free rotation{name}, 60 s"),
        quantity,
        steps: 60 * HZ,
        other: None,
        scenes,
        judge: Box::new(judge),
    };
    let order = axes_by_moment();
    vec![
        case(
            "",
            "drift of angular momentum; lowest and highest energy, of the first",
            Box::new(move |_| keeps.map(|spin| squeezed_knot(Vec3::from_array(spin))).to_vec()),
            drift,
        ),
        case(
            " about the axes of its least, middle and largest moment",
            "flips: 0, some, 0",
            Box::new(move |_| {
                order
                    .map(|axis| squeezed_knot(Vec3::AXES[axis] * 5.0 + Vec3::splat(0.02)))
                    .to_vec()
            }),
            flips,
        ),
    ]
}

/// The squeezed knot's own axes, which its symmetry makes principal: that of the least moment first.
fn axes_by_moment() -> [usize; 3] {
    let inertia = Mass::of(&squeezed_knot(Vec3::ZERO).bodies[0]).inertia;
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| inertia.col(i)[i].total_cmp(&inertia.col(j)[j]));
    order
}

fn drift(runs: &[Run]) -> String {
    let (mut drift, mut low, mut high) = (0.0f64, f64::INFINITY, 0.0f64);
    for run in runs {
        let masses = masses(&run.scene);
        let before = Motion::of(&run.scene, &masses, &run.states[0]);
        for states in &run.states {
            let now = Motion::of(&run.scene, &masses, states);
            drift = drift.max(now.own.distance(before.own) / before.own.length());
            low = low.min(now.kinetic / before.kinetic);
            high = high.max(now.kinetic / before.kinetic);
        }
    }
    format!("{drift:.1e}; {:.3} %, {:.3} %", 100.0 * low, 100.0 * high)
}

/// How often the spin about the axis that it began with has turned round, as the body sees it.
fn flips(runs: &[Run]) -> String {
    let count = |run: &Run| {
        let spin = |k: usize| run.states[k][0].rotation.conjugate() * run.states[k][0].spin;
        let axis = spin(0).abs().to_array();
        let axis = (0..3).max_by(|&i, &j| axis[i].total_cmp(&axis[j])).unwrap_or(0);
        let (mut flips, mut up) = (0, true);
        for about in (0..run.states.len()).map(|k| spin(k)[axis]) {
            if about.abs() > 2.5 && up != (about > 0.0) {
                (flips, up) = (flips + 1, about > 0.0);
            }
        }
        flips.to_string()
    };
    runs.iter().map(count).collect::<Vec<_>>().join(", ")
}
