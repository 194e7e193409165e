//! Touching pairs of bodies for the regimes in which recall is measured.

use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::TriMesh;
use bevy_faceoff::state::{Body, Contacts};
use bevy_faceoff::step::StepState;
use bevy_faceoff::types::settings::Culling;
use bevy_faceoff::types::stage::Stage;
use glam::{DQuat, DVec3, Quat, Vec3};
use std::f64::consts::TAU;

/// How two bodies touch.
#[derive(Clone, Copy)]
pub enum Kind {
    /// They moved straight towards each other until they touched, and this fraction of the smaller diameter farther.
    FirstContact(f64),
    /// They are at random positions where their bounding spheres overlap.
    Scene,
    /// Like `Scene`, but the centres are closer than half the sum of the radii.
    Deep,
    /// They are linked through their holes, then moved until they touched, and 1 % of the smaller diameter farther.
    Interlocked,
}

pub struct Regime {
    pub name: &'static str,
    pub kind: Kind,
    /// The ratio of the smaller to the larger diameter is below this.
    pub ratio_below: f64,
    /// The fraction of the requested cases to use. It is less than 1 where cases take long to find.
    pub share: f64,
}

const fn regime(name: &'static str, kind: Kind, ratio_below: f64, share: f64) -> Regime {
    Regime {
        name,
        kind,
        ratio_below,
        share,
    }
}

/// No bound on the ratio of diameters.
const ANY: f64 = 2.0;

pub const REGIMES: [Regime; 8] = [
    regime("first contact +0.1 %", Kind::FirstContact(0.001), ANY, 1.0),
    regime("first contact +5 %", Kind::FirstContact(0.05), ANY, 1.0),
    regime("scene", Kind::Scene, ANY, 1.0),
    regime("deep", Kind::Deep, ANY, 1.0),
    regime("interlocked +1 %", Kind::Interlocked, ANY, 0.25),
    regime("first contact +0.1 %, sizes < 0.3", Kind::FirstContact(0.001), 0.3, 1.0),
    regime("scene, sizes < 0.3", Kind::Scene, 0.3, 1.0),
    regime("deep, sizes < 0.3", Kind::Deep, 0.3, 1.0),
];

/// The poses of a pair. The first body is at the origin.
#[derive(Clone, Copy)]
pub struct Pair {
    pub diameters: [f64; 2],
    pub rotations: [Quat; 2],
    /// The vector from the first centre of mass to the second.
    pub offset: DVec3,
}

impl Pair {
    fn moved(self, by: DVec3) -> Self {
        Self {
            offset: self.offset + by,
            ..self
        }
    }

    fn smaller(&self) -> f64 {
        self.diameters[0].min(self.diameters[1])
    }

    pub fn bodies(&self, mesh: u32, center: Vec3, culling: Culling) -> [Body; 2] {
        [(0, DVec3::ZERO), (1, self.offset)].map(|(i, at)| {
            let (rotation, scale) = (self.rotations[i], self.diameters[i] as f32);
            Body {
                culling,
                ..Body::at_rest(
                    mesh,
                    at.as_vec3() - rotation * (scale * center),
                    rotation,
                    Vec3::splat(scale),
                )
            }
        })
    }
}

/// Runs the narrow phase on one pair at a time.
pub struct Tester {
    state: StepState,
    slot: u32,
    center: Vec3,
}

impl Tester {
    pub fn new(mesh: &CollisionMesh) -> Self {
        let mut state = StepState::default();
        Self {
            slot: state.input.meshes.add(mesh.clone()),
            center: mesh.mass.center,
            state,
        }
    }

    pub fn test(&mut self, pair: &Pair, culling: Culling) -> &Contacts {
        let Self { state, slot, center } = self;
        state.input.bodies.clear();
        for body in pair.bodies(*slot, *center, culling) {
            state
                .input
                .bodies
                .push(&body, &state.input.meshes)
                .expect("a usable body");
        }
        state.results.sphere_pairs.clear();
        state.results.sphere_pairs.push([0, 1]);
        bevy_faceoff::step::cpu::run(Stage::Angles, state);
        bevy_faceoff::step::cpu::run(Stage::TriangleTest, state);
        &state.results.contacts
    }

    fn meets(&mut self, pair: &Pair) -> bool {
        !self.test(pair, Culling::Exact).faces.is_empty()
    }

    /// The distance along the unit vector `direction` at which the second body touches the first; `None` if it does not
    /// within the distance `end`.
    fn distance_to_contact(&mut self, pair: &Pair, direction: DVec3, end: f64) -> Option<f64> {
        let step = 0.005 * pair.smaller();
        let mut at = 0.0;
        while at < end {
            if self.meets(&pair.moved(direction * at)) {
                let (mut before, mut after) = ((at - step).max(0.0), at);
                for _ in 0..20 {
                    let middle = 0.5 * (before + after);
                    if self.meets(&pair.moved(direction * middle)) {
                        after = middle;
                    } else {
                        before = middle;
                    }
                }
                return Some(after);
            }
            at += step;
        }
        None
    }
}

/// A random pair of the regime whose bounding spheres overlap and whose faces intersect. `core` is the centre line of
/// the mesh's tube, a closed curve.
pub fn sample(regime: &Regime, random: &mut fastrand::Rng, tester: &mut Tester, core: &[DVec3]) -> Pair {
    loop {
        let pair = placed(regime, random);
        let [a, b] = pair.diameters;
        if pair.smaller() >= regime.ratio_below * a.max(b) {
            continue;
        }
        let reach = 0.5 * (a + b);
        let distance = pair.offset.length();
        let found = match regime.kind {
            Kind::Scene => Some(pair),
            Kind::Deep => (distance < 0.5 * reach).then_some(pair),
            Kind::FirstContact(depth) => {
                let way = direction(random);
                // The random offset is in the xy plane; rotate it into the plane normal to the direction.
                let aside = DQuat::from_rotation_arc(DVec3::Z, way) * pair.offset;
                let before = (reach * reach - aside.length_squared()).max(0.0).sqrt();
                let start = Pair {
                    offset: aside - before * way,
                    ..pair
                };
                let found = tester.distance_to_contact(&start, way, 2.0 * before);
                found.map(|at| start.moved(way * (at + depth * pair.smaller())))
            }
            Kind::Interlocked => {
                let similar = pair.smaller() >= 0.6 * a.max(b);
                let linked = similar && linking_number(core, &pair) != 0 && !tester.meets(&pair);
                let way = direction(random);
                let found = linked.then(|| tester.distance_to_contact(&pair, way, 2.0 * reach + a));
                found.flatten().map(|at| pair.moved(way * (at + 0.01 * pair.smaller())))
            }
        };
        if let Some(pair) = found.filter(|p| p.offset.length() < reach)
            && tester.meets(&pair)
        {
            return pair;
        }
    }
}

/// A pair with random sizes and rotations, and a uniformly random offset at which the bounding spheres overlap. For
/// first contacts the offset is in the xy plane: it is the impact parameter.
fn placed(regime: &Regime, random: &mut fastrand::Rng) -> Pair {
    loop {
        let diameters = [0; 2].map(|_| 0.25 + 1.75 * random.f64());
        let rotations = [0; 2].map(|_| rotation(random));
        let offset = match regime.kind {
            Kind::FirstContact(_) => {
                let [x, y] = [0; 2].map(|_| 4.0 * random.f64() - 2.0);
                DVec3::new(x, y, 0.0)
            }
            _ => 2.0 * in_ball(random),
        };
        if offset.length() < 0.5 * (diameters[0] + diameters[1]) {
            return Pair {
                diameters,
                rotations,
                offset,
            };
        }
    }
}

fn in_ball(random: &mut fastrand::Rng) -> DVec3 {
    loop {
        let p = DVec3::from_array([0; 3].map(|_| 2.0 * random.f64() - 1.0));
        if p.length_squared() <= 1.0 {
            return p;
        }
    }
}

fn direction(random: &mut fastrand::Rng) -> DVec3 {
    loop {
        let p = in_ball(random);
        if p.length_squared() > 1.0e-3 {
            return p.normalize();
        }
    }
}

/// A uniformly random rotation (Shoemake 1992).
pub fn rotation(random: &mut fastrand::Rng) -> Quat {
    let (u, v, w) = (random.f64(), TAU * random.f64(), TAU * random.f64());
    let (a, b) = ((1.0 - u).sqrt(), u.sqrt());
    DQuat::from_xyzw(a * v.sin(), a * v.cos(), b * w.sin(), b * w.cos()).as_quat()
}

/// The centres of the rings of `around` vertices that make up a tube, relative to the centre of mass.
pub fn core(mesh: &TriMesh, around: usize, center: Vec3) -> Vec<DVec3> {
    let middle = |ring: &[Vec3]| (ring.iter().sum::<Vec3>() / ring.len() as f32 - center).as_dvec3();
    mesh.vertices().chunks(around).map(middle).collect()
}

/// The linking number of the two centre lines: the sum of the signed crossings, seen along z, of the first over the
/// second.
fn linking_number(core: &[DVec3], pair: &Pair) -> i32 {
    let curve = |i: usize, at: DVec3| -> Vec<DVec3> {
        let rotation = pair.rotations[i].as_dquat();
        core.iter().map(|&p| at + rotation * (pair.diameters[i] * p)).collect()
    };
    let (a, b) = (curve(0, DVec3::ZERO), curve(1, pair.offset));
    let mut sum = 0;
    for (i, &p) in a.iter().enumerate() {
        let s = a[(i + 1) % a.len()] - p;
        for (j, &q) in b.iter().enumerate() {
            let t = b[(j + 1) % b.len()] - q;
            let across = s.x * t.y - s.y * t.x;
            let (u, v) = (
                ((q.x - p.x) * t.y - (q.y - p.y) * t.x) / across,
                ((q.x - p.x) * s.y - (q.y - p.y) * s.x) / across,
            );
            let within = |x: f64| (0.0..1.0).contains(&x);
            if within(u) && within(v) && p.z + u * s.z > q.z + v * t.z {
                sum += if across > 0.0 { 1 } else { -1 };
            }
        }
    }
    sum
}
