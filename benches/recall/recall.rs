//! The table of recall.

use crate::cases::{self, Pair, REGIMES, Regime, Tester};
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::TriMesh;
use bevy_faceoff::projection::{FaceTable, Group};
use bevy_faceoff::state::Contacts;
use bevy_faceoff::types::settings::Culling;
use glam::DVec3;
use std::collections::HashSet;

/// Vertices per ring of both meshes' tubes.
const AROUND: usize = 10;

#[derive(Clone, Copy, Default)]
struct Found {
    any: usize,
    faces: usize,
}

#[derive(Clone, Copy, Default)]
struct Tally {
    pairs: usize,
    faces: usize,
    /// For faces of collision, front-facing, and eq. 4.
    found: [Found; 3],
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

/// Prints a row per regime.
pub fn table(name: &str, mesh: &TriMesh, baked: &CollisionMesh, cases: usize) {
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
        print(name, regime, &tally);
    }
}

fn print(name: &str, regime: &Regime, tally: &Tally) {
    let [faces, front, literal] = tally.found.map(|found| {
        format!(
            "{:.3} / {:.3}",
            found.any as f64 / tally.pairs as f64,
            found.faces as f64 / tally.faces as f64
        )
    });
    let mean = tally.faces as f64 / tally.pairs as f64;
    println!(
        "| {name} | {} | {faces} | {front} | {literal} | {mean:.1} |",
        regime.name
    );
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
        found: [faces.len(), front.len(), literal].map(|faces| Found {
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
