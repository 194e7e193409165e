//! Recall by regime. `faceoff reproduce` includes this file too.

use super::cases::{self, Pair, REGIMES, Regime, Tester};
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::TriMesh;
use bevy_faceoff::projection::{FaceTable, Group};
use bevy_faceoff::state::Contacts;
use bevy_faceoff::types::settings::Culling;
use glam::DVec3;
use std::collections::HashSet;

/// Vertices per ring of both meshes' tubes.
const AROUND: usize = 10;

/// What a mode found.
#[derive(Clone, Copy, Default)]
pub struct Detections {
    /// Pairs of bodies of which it found anything.
    pub any: usize,
    /// Intersecting face pairs.
    pub faces: usize,
}

/// What there is, and what each mode found of it.
#[derive(Clone, Copy, Default)]
pub struct Tally {
    /// Touching pairs of bodies.
    pub pairs: usize,
    /// Intersecting face pairs.
    pub faces: usize,
    /// For faces of collision, front-facing, and eq. 4.
    pub found: [Detections; 3],
}

impl Tally {
    fn add(&mut self, other: &Self) {
        self.pairs += other.pairs;
        self.faces += other.faces;
        for (sum, found) in self.found.iter_mut().zip(&other.found) {
            sum.any += found.any;
            sum.faces += found.faces;
        }
    }
}

/// Measures each regime in turn, and hands it to `row`.
pub fn measure(mesh: &TriMesh, baked: &CollisionMesh, cases: usize, mut row: impl FnMut(&Regime, &Tally)) {
    let core = cases::core(mesh, AROUND, baked.mass.center);
    let mut inverse = vec![0; mesh.triangles().len()];
    for (t, &face) in baked.mesh.face_ids().iter().enumerate() {
        inverse[face as usize] = t as u32;
    }
    for (number, regime) in REGIMES.iter().enumerate() {
        let cases = (cases as f64 * regime.share).ceil() as usize;
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        let work = |thread: usize| {
            // Each thread has its own pool: a case takes microseconds, and waiting for other threads would take longer.
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(1)
                .build()
                .expect("a thread");
            pool.install(|| {
                let mut tester = Tester::new(baked);
                let mut tally = Tally::default();
                for case in (thread..cases).step_by(threads) {
                    let mut random = fastrand::Rng::with_seed((number as u64) << 32 | case as u64);
                    let pair = cases::sample(regime, &mut random, &mut tester, &core);
                    tally.add(&judge(&mut tester, &pair, baked, &inverse));
                }
                tally
            })
        };
        let mut tally = Tally::default();
        std::thread::scope(|scope| {
            let work = &work;
            let running: Vec<_> = (0..threads).map(|thread| scope.spawn(move || work(thread))).collect();
            for thread in running {
                tally.add(&thread.join().expect("no panic"));
            }
        });
        row(regime, &tally);
    }
}

fn judge(tester: &mut Tester, pair: &Pair, baked: &CollisionMesh, inverse: &[u32]) -> Tally {
    let set = |contacts: &Contacts| -> HashSet<[u32; 2]> { contacts.faces.iter().map(|f| [f.a, f.b]).collect() };
    let exact = set(tester.test(pair, Culling::Exact));
    let faces = set(tester.test(pair, Culling::FacesOfCollision));
    let front = set(tester.test(pair, Culling::FrontFacing));
    assert!(faces.is_subset(&exact), "faces of collision invented a hit");
    assert!(front.is_subset(&exact), "front-facing invented a hit");
    let table = baked.faces.as_ref().expect("a table was asked for");
    let groups = [(0, pair.offset), (1, -pair.offset)]
        .map(|(i, to_other)| literal(table, pair.rotations[i].as_dquat().inverse() * to_other));
    let literal = exact
        .iter()
        .filter(|hit| (0..2).all(|i| groups[i].contains(inverse[hit[i] as usize])))
        .count();
    Tally {
        pairs: 1,
        faces: exact.len(),
        found: [faces.len(), front.len(), literal].map(|faces| Detections {
            any: usize::from(faces > 0),
            faces,
        }),
    }
}

/// The group for direction `d` by eq. 4 of Aly & Elawady 2010 as printed: the angles to the z axis in the xz and yz
/// planes.
fn literal(table: &FaceTable, d: DVec3) -> Group<'_> {
    let steps = |other: f64| {
        let angle = (d.z / other.hypot(d.z)).clamp(-1.0, 1.0).acos().to_degrees();
        (angle / f64::from(table.grid().step())).round() as u32
    };
    table.at(steps(d.y), steps(d.x))
}
