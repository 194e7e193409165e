//! Determinism: the same input gives the same bits, with any number of threads.

use super::cloud::heap;
use bevy_faceoff::solver::SolverBodies;

fn bits(bodies: &SolverBodies) -> String {
    format!("{:?} {:?}", bodies.motions, bodies.sleep)
}

#[test]
fn threads_and_runs_give_the_same_bits() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut world = heap();
        pool.install(|| world.step(150));
        assert!(world.manifolds.pairs.len() > 300, "{}", world.manifolds.pairs.len());
        bits(&world.bodies)
    };
    let first = run(1);
    for threads in [1, 2, 7] {
        assert!(run(threads) == first, "{threads} threads");
    }
}
