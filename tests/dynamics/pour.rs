//! Knots poured into a bin. Sleep is off, so the pile must come to rest by contacts alone.

use crate::world::{World, any_turn};
use bevy_faceoff::testing::scenes::Scene;
use bevy_faceoff::testing::scenes::pour::{knots, walls};

/// Overlap of pairs in contact, as fractions of the diameter.
#[derive(Default)]
struct Depths {
    sum: f64,
    pairs: usize,
    most: f64,
}

impl Depths {
    /// Adds all pairs of knots, and of knots and walls, with a gap of at most that of bodies at rest.
    fn add(&mut self, world: &World) {
        let state = &world.state;
        for pair in &state.results.manifolds.pairs {
            let [a, b] = pair.bodies.map(|i| state.input.bodies.radius[i as usize]);
            let diameter = 2.0 * a.min(b);
            let points = state.results.manifolds.points_of(pair).iter();
            let nearest = points.map(|p| p.separation / diameter).fold(f32::INFINITY, f32::min);
            if nearest <= state.input.config.solver.rest_offset {
                let depth = f64::from(-nearest).max(0.0);
                self.sum += depth;
                self.pairs += 1;
                self.most = self.most.max(depth);
            }
        }
    }

    fn mean(&self) -> f64 {
        self.sum / self.pairs.max(1) as f64
    }
}

/// Pours `count` knots into a bin of `width` metres, and measures for so many seconds.
pub fn pour(count: usize, width: f32, seconds: usize) {
    let high = 60.0;
    let mut scene = Scene::new();
    walls(&mut scene, 40.0, width, high);
    let first = scene.bodies.len();
    let mut random = fastrand::Rng::with_seed(3);
    knots(&mut scene, count, (width / 1.1) as usize, || any_turn(&mut random));
    let mut world = World::of(&scene);
    let (mut run, mut still) = (Depths::default(), Depths::default());
    for _ in 0..64 * seconds {
        world.step();
        run.add(&world);
    }
    still.add(&world);
    let fastest = world.fastest();
    println!(
        "{count} knots after {seconds} s: fastest {fastest:.4} m/s; {} pairs in contact, {:.4} % deep on average and {:.3} % \
         at most; before {:.4} % and {:.3} %",
        still.pairs,
        100.0 * still.mean(),
        100.0 * still.most,
        100.0 * run.mean(),
        100.0 * run.most
    );
    for i in first..first + count {
        let c = world.center(i);
        let inside = c.x.abs().max(c.z.abs()) < f64::from(0.5 * width) && (0.0..f64::from(high)).contains(&c.y);
        assert!(inside, "knot {i} is at {c}");
    }
    assert!(still.pairs >= count, "{} pairs", still.pairs);
    for (name, depths) in [("on the way", &run), ("at rest", &still)] {
        assert!(depths.mean() < 0.01, "{name}: {} deep on average", depths.mean());
        assert!(depths.most < 0.05, "{name}: {} deep at most", depths.most);
    }
    assert!(fastest < 0.1, "{fastest} m/s");
}

#[test]
fn forty_knots_poured_into_a_bin_come_to_rest() {
    pour(40, 3.4, 6);
}

/// `cargo test --release --test stages -- --ignored --nocapture a_thousand_knots`
/// (mean overlap 0.0034 % of the diameter at rest, most 0.44 %; on the way 3.2 %; 5 minutes on a busy pair of cores).
#[test]
#[ignore = "takes minutes"]
fn a_thousand_knots_poured_into_a_bin_come_to_rest() {
    pour(1000, 7.8, 15);
}
