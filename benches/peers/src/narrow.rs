//! The narrow phase of the first step and the broad phase before it, interleaved, with the same pairs for all
//! libraries.

use crate::judge::Dispute;
use crate::ours::Stages;
use crate::parry::{BroadPhase, Manifolds, PREDICTIONS, Parry};
use crate::scene::{Scene, Shape};
use crate::timing::{control, pool, time};
use serde::Serialize;
use std::collections::BTreeSet;

/// The measurements of one scene.
#[derive(Serialize)]
pub struct Narrow {
    /// The mesh.
    pub shape: Shape,
    /// The number of triangles of the mesh.
    pub triangles: usize,
    /// The number of pairs whose bounding spheres overlap. They are the input of all but the broad phases.
    pub sphere_pairs: usize,
    /// The number of pairs whose surfaces intersect, according to bevy_faceoff.
    pub touching: usize,
    /// The number of pairs of which one body is wholly inside the other, according to bevy_faceoff.
    pub contained: usize,
    /// The number of face pairs that intersect, according to bevy_faceoff.
    pub face_pairs: usize,
    /// Seconds of each round of bevy_faceoff's narrow phase.
    pub ours: Vec<f64>,
    /// Seconds of each round of its first hits, which must find the same pairs.
    pub ours_first: Vec<f64>,
    /// Seconds of each round of all hits, on one thread and on two.
    pub ours_threads: [Vec<f64>; 2],
    /// Seconds of each round of the control loop, on one thread and on two.
    pub control: [Vec<f64>; 2],
    /// Seconds of each round of bevy_faceoff's broad phase.
    pub ours_broad: Vec<f64>,
    /// The measurements of parry3d.
    pub parry: ParryNarrow,
}

/// parry3d on the same scene.
#[derive(Serialize, Default)]
pub struct ParryNarrow {
    /// First hits of the pairs in the given order of bodies.
    pub first_hits: FirstHits,
    /// First hits of the same pairs with the larger body first.
    pub larger_first: FirstHits,
    /// Seconds of each round of contact manifolds, for each of [`PREDICTIONS`].
    pub manifolds: [Vec<f64>; 2],
    /// The manifolds found, for each of [`PREDICTIONS`].
    pub manifold_pairs: [Manifolds; 2],
    /// Seconds of each round of the broad phase with a rebuilt tree.
    pub broad_rebuilt: Vec<f64>,
    /// Seconds of each round of the broad phase with a tree refitted to moved boxes.
    pub broad_refitted: Vec<f64>,
    /// The number of pairs of overlapping boxes.
    pub box_pairs: usize,
    /// The number of pairs that touch although their boxes do not overlap. It should be 0.
    pub boxes_miss: usize,
}

/// The first hits of a peer compared with those of bevy_faceoff.
#[derive(Serialize, Default)]
pub struct FirstHits {
    /// Seconds of each round.
    pub seconds: Vec<f64>,
    /// The number of pairs that both report.
    pub both: usize,
    /// The pairs that only one of the two reports, with the answer of the independent test.
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

/// The pairs of bodies whose bounding spheres overlap, ascending.
pub fn sphere_pairs(scene: &Scene) -> Vec<[u32; 2]> {
    let mut stages = Stages::new(scene);
    stages.broad_phase();
    stages.sphere_pairs().to_vec()
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
            // Time the second of two runs: in a game the caches of each thread hold data of the step before.
            pool.install(|| stages.narrow_phase());
            narrow.ours_threads[threads].push(pool.install(|| time(|| stages.narrow_phase()).0));
            narrow.control[threads].push(pool.install(|| time(control).0));
        }
    }
    narrow
}
