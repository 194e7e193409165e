//! The narrow phase of the first step, and the broad phase before it: the same pairs for all, taking turns.

use crate::judge::Dispute;
use crate::ours::Stages;
use crate::parry::{BroadPhase, Manifolds, PREDICTIONS, Parry};
use crate::scene::{Scene, Shape};
use crate::timing::{control, pool, time};
use serde::Serialize;
use std::collections::BTreeSet;

/// What was measured of one scene.
#[derive(Serialize)]
pub struct Narrow {
    /// Its mesh.
    pub shape: Shape,
    /// Triangles of the mesh.
    pub triangles: usize,
    /// Pairs whose bounding spheres overlap: the work of all but the broad phases.
    pub sphere_pairs: usize,
    /// Pairs whose surfaces intersect, by ours.
    pub touching: usize,
    /// Pairs of which one is wholly inside the other, by ours.
    pub contained: usize,
    /// Pairs of faces that intersect, by ours.
    pub face_pairs: usize,
    /// Seconds of each round.
    pub ours: Vec<f64>,
    /// The same of our first hits, which have to name the same pairs.
    pub ours_first: Vec<f64>,
    /// All hits on one thread and on two.
    pub ours_threads: [Vec<f64>; 2],
    /// The arithmetic loop on one thread and on two.
    pub control: [Vec<f64>; 2],
    /// Our broad phase.
    pub ours_broad: Vec<f64>,
    /// The same by parry3d.
    pub parry: ParryNarrow,
}

/// parry3d on the same scene.
#[derive(Serialize, Default)]
pub struct ParryNarrow {
    /// First hits of the pairs as they come.
    pub first_hits: FirstHits,
    /// First hits of the same pairs, the larger body first.
    pub larger_first: FirstHits,
    /// Seconds of each round, for each of [`PREDICTIONS`].
    pub manifolds: [Vec<f64>; 2],
    /// What they found.
    pub manifold_pairs: [Manifolds; 2],
    /// Seconds of each round with the tree built anew.
    pub broad_rebuilt: Vec<f64>,
    /// Seconds of each round with the tree fitted to moved boxes.
    pub broad_refitted: Vec<f64>,
    /// Pairs of overlapping boxes.
    pub box_pairs: usize,
    /// Pairs that touch but whose boxes do not overlap: there should be none.
    pub boxes_miss: usize,
}

/// Which pairs touch, by a peer's first hits.
#[derive(Serialize, Default)]
pub struct FirstHits {
    /// Seconds of each round.
    pub seconds: Vec<f64>,
    /// How many pairs both it and ours name.
    pub both: usize,
    /// Pairs that only one of the two names, with the truth.
    pub disputes: Vec<Dispute>,
}

impl FirstHits {
    fn compare(scene: &Scene, ours: &[[u32; 2]], peer: &[[u32; 2]]) -> Self {
        let ascending = |&[a, b]: &[u32; 2]| [a.min(b), a.max(b)];
        let [ours, peer] = [ours, peer].map(|pairs| pairs.iter().map(ascending).collect::<BTreeSet<_>>());
        let disputed = ours.symmetric_difference(&peer);
        Self {
            seconds: Vec::new(),
            both: ours.intersection(&peer).count(),
            disputes: disputed.map(|p| Dispute::new(scene, *p, ours.contains(p))).collect(),
        }
    }
}

/// Measures one scene.
pub fn measure(shape: Shape, scene: &Scene, rounds: usize) -> Narrow {
    let (one, two) = (pool(1), pool(2));
    let mut stages = Stages::new(scene);
    stages.broad_phase();
    let pairs = stages.sphere_pairs().to_vec();
    stages.narrow_phase();
    let touching = stages.touching();
    let all_touching = stages.all_touching();
    assert_eq!(
        stages.first_hits(),
        all_touching,
        "our first hits are those of all our hits"
    );
    let parry = Parry::new(scene);
    let mut tree = BroadPhase::new(&parry);
    let larger_first = parry.larger_first(&pairs);
    let boxes: BTreeSet<[u32; 2]> = tree.rebuilt().into_iter().collect();
    let mut narrow = Narrow {
        shape,
        triangles: scene.mesh.mesh.triangles().len(),
        sphere_pairs: pairs.len(),
        touching: touching.len(),
        contained: stages.contained(),
        face_pairs: stages.face_pairs(),
        ours: Vec::new(),
        ours_first: Vec::new(),
        ours_threads: [const { Vec::new() }; 2],
        control: [const { Vec::new() }; 2],
        ours_broad: Vec::new(),
        parry: ParryNarrow {
            first_hits: FirstHits::compare(scene, &touching, &parry.first_hits(&pairs)),
            larger_first: FirstHits::compare(scene, &touching, &parry.first_hits(&larger_first)),
            manifold_pairs: PREDICTIONS.map(|p| parry.manifolds(&pairs, p)),
            box_pairs: boxes.len(),
            boxes_miss: touching.iter().filter(|p| !boxes.contains(*p)).count(),
            ..Default::default()
        },
    };

    let peer = &mut narrow.parry;
    for _ in 0..rounds {
        narrow.ours.push(one.install(|| time(|| stages.narrow_phase()).0));
        narrow.ours_first.push(one.install(|| time(|| stages.first_hits()).0));
        peer.first_hits.seconds.push(time(|| parry.first_hits(&pairs)).0);
        peer.larger_first
            .seconds
            .push(time(|| parry.first_hits(&larger_first)).0);
        for (prediction, times) in PREDICTIONS.into_iter().zip(&mut peer.manifolds) {
            times.push(time(|| parry.manifolds(&pairs, prediction)).0);
        }
        narrow.ours_broad.push(one.install(|| time(|| stages.broad_phase()).0));
        peer.broad_rebuilt.push(time(|| tree.rebuilt()).0);
        tree.misfit();
        peer.broad_refitted.push(time(|| tree.refitted()).0);
        for (threads, pool) in [&one, &two].into_iter().enumerate() {
            // The second of two, as in a game, where threads meet what they worked on a step before.
            pool.install(|| stages.narrow_phase());
            narrow.ours_threads[threads].push(pool.install(|| time(|| stages.narrow_phase()).0));
            narrow.control[threads].push(pool.install(|| time(control).0));
        }
    }
    narrow
}
