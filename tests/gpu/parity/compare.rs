//! The device's answer against the CPU's, face by face, and a count of everything that is excused.

use super::band::Oracle;
use super::scene::Scene;
use bevy_faceoff::state::PairContact;
use bevy_faceoff::step::StepState;
use bevy_faceoff::types::settings::Culling;
use std::collections::{BTreeMap, BTreeSet};

/// What came out of comparing.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    pub spheres: usize,
    pub touching: usize,
    pub contained: usize,
    pub faces: usize,
    /// Pairs of spheres in the band.
    pub spheres_excused: usize,
    /// Pairs of faces in the band that only the device reports, or only the CPU does.
    pub invented: usize,
    pub missed: usize,
    /// Faces seen from the side, in `FrontFacing` mode.
    pub edge_on: usize,
    /// Pairs of bodies whose direction lies at the border of a cell.
    pub views: usize,
    /// Pairs of bodies that touch on one side only, by faces or containment in the band.
    pub pairs_excused: usize,
    /// Everything that is wrong.
    pub failures: Vec<String>,
}

impl Tally {
    pub fn add(&mut self, other: Self) {
        self.spheres += other.spheres;
        self.touching += other.touching;
        self.contained += other.contained;
        self.faces += other.faces;
        self.spheres_excused += other.spheres_excused;
        self.invented += other.invented;
        self.missed += other.missed;
        self.edge_on += other.edge_on;
        self.views += other.views;
        self.pairs_excused += other.pairs_excused;
        self.failures.extend(other.failures);
    }

    /// The head of the table that [`Tally::row`] fills.
    pub fn head() -> String {
        format!(
            "{:36} {:>7} {:>8} {:>6} {:>7} | excused: {:>7} {:>8} {:>6} {:>7} {:>5} {:>6}",
            "scene",
            "spheres",
            "touching",
            "inside",
            "faces",
            "spheres",
            "invented",
            "missed",
            "edge on",
            "views",
            "bodies"
        )
    }

    /// One line of a table.
    pub fn row(&self, name: &str) -> String {
        format!(
            "{name:36} {:>7} {:>8} {:>6} {:>7} |          {:>7} {:>8} {:>6} {:>7} {:>5} {:>6}",
            self.spheres,
            self.touching,
            self.contained,
            self.faces,
            self.spheres_excused,
            self.invented,
            self.missed,
            self.edge_on,
            self.views,
            self.pairs_excused
        )
    }

    /// Panics with the first failures, if there are any.
    pub fn require_no_failures(&self) {
        let shown: Vec<&str> = self.failures.iter().take(8).map(String::as_str).collect();
        assert!(
            shown.is_empty(),
            "{} failures:\n{}",
            self.failures.len(),
            shown.join("\n")
        );
    }

    /// Panics if more is excused than rounding explains: of the faces one in `rarity`.
    pub fn require_few_excused(&self, rarity: usize) {
        let rare = |what: &str, count: usize, of: usize, one_in: usize| {
            assert!(count <= 3 + of / one_in, "{what}: {count} of {of} excused");
        };
        rare("spheres", self.spheres_excused, self.spheres, 1000);
        rare("faces", self.invented, self.faces, rarity);
        rare("missed faces", self.missed, self.faces, 20_000);
        rare("faces edge on", self.edge_on, self.faces, 2000);
        rare("views", self.views, self.touching, 1000);
        rare("bodies", self.pairs_excused, self.touching, 1000);
    }
}

/// A pair's faces, ascending, and whether one body is inside the other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PairFaces {
    pub faces: Vec<[u32; 2]>,
    pub contained: bool,
}

/// What a side found of each pair.
pub fn found(state: &StepState) -> BTreeMap<[u32; 2], PairFaces> {
    let of_pair = |pair: &PairContact| {
        let mut faces: Vec<_> = state
            .results
            .contacts
            .faces_of(pair)
            .iter()
            .map(|f| [f.a, f.b])
            .collect();
        faces.sort_unstable();
        let contained = pair.contained;
        (pair.bodies, PairFaces { faces, contained })
    };
    state.results.contacts.pairs.iter().map(of_pair).collect()
}

/// Compares one step of a scene. Also tells the pairs on which both agree.
pub fn compare(scene: &Scene, cpu: &StepState, gpu: &StepState, oracle: &Oracle) -> (Tally, BTreeSet<[u32; 2]>) {
    let mut tally = Tally {
        spheres: cpu.results.sphere_pairs.len(),
        touching: cpu.results.contacts.pairs.len(),
        faces: cpu.results.contacts.faces.len(),
        contained: cpu.results.contacts.pairs.iter().filter(|pair| pair.contained).count(),
        ..Default::default()
    };
    form(gpu, &mut tally);
    let [of_cpu, of_gpu]: [BTreeSet<_>; 2] =
        [cpu, gpu].map(|state| state.results.sphere_pairs.iter().copied().collect());
    for &pair in of_cpu.symmetric_difference(&of_gpu) {
        if oracle.spheres_in_band(pair) {
            tally.spheres_excused += 1;
        } else {
            tally.failures.push(format!("spheres {pair:?} on one side only"));
        }
    }

    let (of_cpu, of_gpu) = (found(cpu), found(gpu));
    let pairs: BTreeSet<_> = of_cpu.keys().chain(of_gpu.keys()).copied().collect();
    let mut agreed = BTreeSet::new();
    for pair in pairs {
        let (on_cpu, on_gpu) = (of_cpu.get(&pair), of_gpu.get(&pair));
        if on_cpu == on_gpu {
            agreed.insert(pair);
            continue;
        }
        let [on_cpu, on_gpu] = [on_cpu, on_gpu].map(|side| side.cloned().unwrap_or_default());
        let before = tally.failures.len();
        compare_pair(&mut tally, oracle, pair, &on_cpu, &on_gpu, scene);
        let one_sided = of_cpu.contains_key(&pair) != of_gpu.contains_key(&pair);
        tally.pairs_excused += usize::from(one_sided && tally.failures.len() == before);
    }
    (tally, agreed)
}

fn compare_pair(tally: &mut Tally, oracle: &Oracle, pair: [u32; 2], cpu: &PairFaces, gpu: &PairFaces, scene: &Scene) {
    let view_excused = oracle.view_in_band(pair);
    tally.views += usize::from(view_excused);
    let exact = pair.iter().all(|&i| scene.bodies[i as usize].culling == Culling::Exact);
    let sides = [("missed", &cpu.faces, &gpu.faces), ("invented", &gpu.faces, &cpu.faces)];
    for (what, has, lacks) in sides {
        for &faces in has.iter().filter(|faces| lacks.binary_search(faces).is_err()) {
            let in_band = oracle.faces_in_band(pair, faces);
            let meet = oracle.faces_meet(pair, faces);
            if what == "missed" && exact && meet && oracle.drift == 0.0 {
                // The kernels promise to miss nothing, in the band or not.
                tally
                    .failures
                    .push(format!("{pair:?}: faces {faces:?} meet and are missed"));
            } else if in_band {
                match what {
                    "missed" => tally.missed += 1,
                    _ => tally.invented += 1,
                }
            } else if meet && oracle.edge_on(pair, faces) {
                tally.edge_on += 1;
            } else if !(meet && view_excused) {
                let margin = oracle.margin(pair, faces);
                let modes = pair.map(|i| scene.bodies[i as usize].culling);
                tally.failures.push(format!(
                    "{pair:?} {modes:?}: faces {faces:?} {what}, margin {margin:.1e}, meet: {meet}"
                ));
            }
        }
    }
    // Faces in the band decide whether containment is asked for at all.
    let asked = cpu.faces.is_empty() == gpu.faces.is_empty();
    if asked && cpu.contained != gpu.contained && !oracle.inside_in_band(pair) {
        tally
            .failures
            .push(format!("{pair:?}: contained on the CPU is {}", cpu.contained));
    }
}

/// What must hold of every answer, whatever it is.
fn form(gpu: &StepState, tally: &mut Tally) {
    let contacts = &gpu.results.contacts;
    if !contacts.pairs.is_sorted_by(|p, q| p.bodies < q.bodies) || !gpu.results.sphere_pairs.is_sorted_by(|p, q| p < q)
    {
        tally.failures.push("pairs out of order or twice".into());
    }
    let mut next = 0;
    for pair in &contacts.pairs {
        let faces: BTreeSet<_> = contacts.faces_of(pair).iter().map(|f| [f.a, f.b]).collect();
        let fine = pair.bodies[0] < pair.bodies[1]
            && pair.first_face == next
            && faces.len() == pair.face_count as usize
            && pair.contained == faces.is_empty();
        if !fine {
            tally.failures.push(format!("{:?} is malformed", pair.bodies));
        }
        next += pair.face_count;
        let segments = contacts.faces_of(pair).iter().flat_map(|f| [f.start, f.end]);
        let finite = segments
            .chain([pair.contact.point, pair.contact.normal])
            .all(|v| v.is_finite());
        if !finite || (pair.contact.normal.length() - 1.0).abs() > 1.0e-5 {
            tally.failures.push(format!("{:?} has no finite contact", pair.bodies));
        }
    }
    if next as usize != contacts.faces.len() {
        tally.failures.push("faces of no pair".into());
    }
}
