//! Meshes in several resolutions, and pairs of them whose contacts do not grow with the number of triangles.

use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::state::Body;
use bevy_faceoff::step::StepState;
use bevy_faceoff::testing::external;
use bevy_faceoff::types::stage::Stage;
use glam::{DQuat, Quat, Vec3};

/// Scenes with meshes of growing resolution.
pub struct Case {
    pub name: &'static str,
    /// Functions that build a scene with the given number of poses.
    pub scenes: Vec<Box<dyn Fn(usize) -> Scene>>,
}

/// Pairs of bodies, ready for the narrow phase.
pub struct Scene {
    pub state: StepState,
    /// The number of triangles of each body of a pair, as shown in the table.
    pub triangles: String,
}

/// The number of intersecting face pairs for each touching pair of bodies, within 5 %.
const FACE_PAIRS: usize = 100;

/// All cases.
pub fn all() -> Vec<Case> {
    let balls: Vec<fn() -> TriMesh> = vec![|| shapes::ball(0.5, 4), || shapes::ball(0.5, 6), || {
        shapes::ball(0.5, 8)
    }];
    let knots: Vec<fn() -> TriMesh> = vec![
        || shapes::torus_knot(2, 3, 112, 20, 0.42),
        || shapes::torus_knot(2, 3, 448, 80, 0.42),
        || shapes::torus_knot(2, 3, 1792, 320, 0.42),
    ];
    let case = |name, sizes: &Vec<fn() -> TriMesh>, place: fn(&TriMesh, usize) -> Scene| Case {
        name,
        scenes: sizes
            .iter()
            .map(|&mesh| Box::new(move |poses| place(&mesh(), poses)) as Box<dyn Fn(usize) -> Scene>)
            .collect(),
    };
    vec![
        case("balls touch", &balls, touching),
        case("knots touch", &knots, touching),
        case("balls a hair apart", &balls, apart),
        case("knots a hair apart", &knots, apart),
        case("ball in ball", &balls, contained),
        Case {
            name: "small bodies on terrain",
            scenes: [80u32, 320, 1280]
                .map(|side| Box::new(move |poses: usize| on_terrain(side, 625 * poses)) as Box<dyn Fn(usize) -> Scene>)
                .into(),
        },
    ]
}

/// Bodies of 320 triangles scattered over a whole terrain, about half of them touching it. The triangles of the terrain
/// are as large as the bodies at every resolution.
fn on_terrain(side: u32, bodies: usize) -> Scene {
    let height = |x: f32, y: f32| 2.0 * (0.13 * x).sin() * (0.09 * y).cos() + 0.4 * (0.7 * x + 0.5 * y).sin();
    let point = |i: u32| {
        let (x, y) = ((i % (side + 1)) as f32, (i / (side + 1)) as f32);
        Vec3::new(x, y, height(x, y))
    };
    let square = |i: u32| {
        let corner = i / side * (side + 1) + i % side;
        let [a, b, c, d] = [corner, corner + 1, corner + side + 1, corner + side + 2];
        [[a, b, d], [a, d, c]]
    };
    let terrain = TriMesh::new(
        (0..(side + 1) * (side + 1)).map(point).collect(),
        (0..side * side).flat_map(square).collect(),
    );
    let terrain = CollisionMesh::new(&terrain.expect("a mesh"));
    let triangles = terrain.mesh.triangles().len();
    let mut state = StepState::default();
    let [ground, ball] = [terrain, CollisionMesh::new(&shapes::ball_320())].map(|mesh| state.input.meshes.add(mesh));
    let mut random = fastrand::Rng::with_seed(78);
    let mut all = vec![Body::at_rest(ground, Vec3::ZERO, Quat::IDENTITY, Vec3::ONE)];
    for _ in 0..bodies {
        let [x, y] = [0; 2].map(|_| 1.0 + random.f32() * (side as f32 - 2.0));
        let at = Vec3::new(x, y, height(x, y) + 2.0 * random.f32());
        let turn = rotation(&mut random);
        all.push(Body::at_rest(ball, at, turn, Vec3::ONE));
    }
    for body in &all {
        state
            .input
            .bodies
            .push(body, &state.input.meshes)
            .expect("a usable body");
    }
    state.results.sphere_pairs = (1..all.len() as u32).map(|i| [0, i]).collect();
    Scene {
        state,
        triangles: format!("{triangles} and 320"),
    }
}

/// A nut on the thread of a bolt, whose surfaces are close to each other all around. The meshes are external files, so
/// the case is skipped if they are not found. There is only one resolution.
pub fn nut_on_bolt() -> Option<Case> {
    let meshes = external::nut_and_bolt()?;
    let scene = move |poses: usize| {
        let mut state = StepState::default();
        let [nut, bolt] = meshes.each_ref().map(|mesh| state.input.meshes.add(mesh.clone()));
        for pose in 0..poses {
            let height = 0.0007 + 0.0094 * pose as f32 / poses as f32;
            let turn = Quat::from_rotation_z(0.4 * pose as f32);
            for body in [
                Body::at_rest(bolt, Vec3::ZERO, Quat::IDENTITY, Vec3::ONE),
                Body::at_rest(nut, Vec3::Z * height, turn, Vec3::ONE),
            ] {
                state
                    .input
                    .bodies
                    .push(&body, &state.input.meshes)
                    .expect("a usable body");
            }
        }
        state.results.sphere_pairs = pairs(poses);
        Scene {
            state,
            triangles: meshes
                .each_ref()
                .map(|m| m.mesh.triangles().len().to_string())
                .join(" and "),
        }
    };
    Some(Case {
        name: "nut on bolt",
        scenes: vec![Box::new(scene)],
    })
}

fn pairs(count: usize) -> Vec<[u32; 2]> {
    (0..count as u32).map(|i| [2 * i, 2 * i + 1]).collect()
}

fn touching(mesh: &TriMesh, poses: usize) -> Scene {
    placed(mesh, poses, |pair| {
        // Bisect between a distance at which the bodies are apart and one at which too many faces cross.
        let (mut apart, mut crossing) = (pair.reach, 0.0);
        let mut best = (usize::MAX, apart);
        for _ in 0..60 {
            let way = 0.5 * (apart + crossing);
            let count = pair.face_pairs(way);
            let off = count.abs_diff(FACE_PAIRS);
            if off < best.0 {
                best = (off, way);
            }
            if off * 20 <= FACE_PAIRS {
                break;
            }
            if count < FACE_PAIRS {
                apart = way;
            } else {
                crossing = way;
            }
        }
        (best.1, 1.0)
    })
}

/// Pairs that are apart by less than a thousandth of their size.
fn apart(mesh: &TriMesh, poses: usize) -> Scene {
    placed(mesh, poses, |pair| {
        let (mut apart, mut touching) = (pair.reach, 0.0);
        while apart - touching > 5.0e-4 * pair.reach {
            let way = 0.5 * (apart + touching);
            if pair.touches(way) {
                touching = way;
            } else {
                apart = way;
            }
        }
        (apart, 1.0)
    })
}

/// Pairs in which the second body has half the size and is inside the first.
fn contained(mesh: &TriMesh, poses: usize) -> Scene {
    placed(mesh, poses, |pair| (0.1 * pair.reach, 0.5))
}

/// Two bodies with the same mesh in given rotations. The second can be moved along `direction`.
struct Pair<'a> {
    state: &'a mut StepState,
    slot: u32,
    center: Vec3,
    rotations: [Quat; 2],
    direction: Vec3,
    /// At this distance and beyond they are apart.
    reach: f32,
}

impl Pair<'_> {
    fn bodies(&self, way: f32, scale: f32) -> [Body; 2] {
        let [a, b] = self.rotations;
        let place = |rotation: Quat, at: Vec3, scale: f32| {
            let position = at - rotation * (scale * self.center);
            Body::at_rest(self.slot, position, rotation, Vec3::splat(scale))
        };
        [place(a, Vec3::ZERO, 1.0), place(b, way * self.direction, scale)]
    }

    fn run(&mut self, way: f32) {
        let bodies = self.bodies(way, 1.0);
        self.state.input.bodies.clear();
        for body in bodies {
            self.state
                .input
                .bodies
                .push(&body, &self.state.input.meshes)
                .expect("a usable body");
        }
        self.state.results.sphere_pairs = vec![[0, 1]];
        bevy_faceoff::step::cpu::run(Stage::Angles, self.state);
        bevy_faceoff::step::cpu::run(Stage::TriangleTest, self.state);
    }

    fn face_pairs(&mut self, way: f32) -> usize {
        self.run(way);
        self.state.results.contacts.faces.len()
    }

    fn touches(&mut self, way: f32) -> bool {
        self.run(way);
        !self.state.results.contacts.pairs.is_empty()
    }
}

/// A scene of pairs. For each pair `find` returns the distance of the second body along its direction, and its scale.
fn placed(mesh: &TriMesh, poses: usize, find: impl Fn(&mut Pair) -> (f32, f32)) -> Scene {
    let mut random = fastrand::Rng::with_seed(77);
    let mesh = CollisionMesh::new(mesh);
    let mut state = StepState::default();
    let slot = state.input.meshes.add(mesh.clone());
    let mut bodies = Vec::new();
    for _ in 0..poses {
        let rotations = [0; 2].map(|_| rotation(&mut random));
        let mut pair = Pair {
            state: &mut state,
            slot,
            center: mesh.mass.center,
            direction: rotation(&mut random) * Vec3::X,
            rotations,
            reach: 2.0 * mesh.radius,
        };
        let (way, scale) = find(&mut pair);
        bodies.extend(pair.bodies(way, scale));
    }
    state.input.bodies.clear();
    for body in &bodies {
        state
            .input
            .bodies
            .push(body, &state.input.meshes)
            .expect("a usable body");
    }
    state.results.sphere_pairs = pairs(poses);
    Scene {
        state,
        triangles: mesh.mesh.triangles().len().to_string(),
    }
}

fn rotation(random: &mut fastrand::Rng) -> Quat {
    let [u, v, w] = [0; 3].map(|_| random.f64());
    let (a, b) = ((1.0 - u).sqrt(), u.sqrt());
    let (v, w) = (v * std::f64::consts::TAU, w * std::f64::consts::TAU);
    DQuat::from_xyzw(a * v.sin(), a * v.cos(), b * w.sin(), b * w.cos()).as_quat()
}
