//! Meshes on meshes, moved by what contact generation and solver make of them together.

use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::components::RigidBody;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::stages::manifolds::cpu::planes;
use bevy_faceoff::stages::manifolds::{Manifolds, MarginPair, cpu};
use bevy_faceoff::stages::solver::*;
use bevy_faceoff::stages::state::{Body, StepConfig, StepState};
use glam::{DVec3, Quat, Vec3};

struct World {
    state: StepState,
    solver: Solver,
    warm: WarmStart,
    bodies: SolverBodies,
    sleeper: Sleeper,
    manifolds: Manifolds,
    found: cpu::Scratch,
    plane_scratch: planes::Scratch,
    settings: SolverSettings,
}

impl World {
    fn new() -> Self {
        let mut state = StepState::default();
        state.config = StepConfig {
            gravity: Vec3::NEG_Y * 9.81,
            ..state.config
        };
        Self {
            state,
            solver: Solver::default(),
            warm: WarmStart::default(),
            bodies: SolverBodies::default(),
            sleeper: Sleeper::default(),
            manifolds: Manifolds::default(),
            found: cpu::Scratch::default(),
            plane_scratch: planes::Scratch::default(),
            settings: SolverSettings {
                sleeping: false,
                ..SolverSettings::default()
            },
        }
    }

    fn mesh(&mut self, mesh: &TriMesh) -> u32 {
        self.state.meshes.add(CollisionMesh::new(mesh))
    }

    fn add(&mut self, kind: RigidBody, mesh: u32, scale: Vec3, position: Vec3, rotation: Quat) -> usize {
        let body = Body {
            kind,
            ..Body::at_rest(mesh, position, rotation, scale)
        };
        self.state.bodies.push(&body, &self.state.meshes).unwrap();
        self.state.bodies.len() - 1
    }

    /// After all bodies are there.
    fn begin(&mut self) {
        let keys: Vec<u64> = (0..self.state.bodies.len() as u64).collect();
        self.bodies
            .read(&self.state.bodies, &self.state.meshes, &self.state.planes, &keys);
    }

    fn step(&mut self) {
        let dt = self.state.config.dt;
        let detections = self.settings.detections(&self.bodies, dt);
        for _ in 0..detections {
            self.interval(dt / detections as f32, self.settings.substeps_per_detection(detections));
        }
    }

    fn interval(&mut self, dt: f32, substeps: u32) {
        let state = &mut self.state;
        let n = state.bodies.len();
        let motion = |i: usize| {
            let m = &self.bodies.motions[i];
            let b = &self.bodies.bodies[i];
            let fall = if b.kind == RigidBody::Dynamic { 9.81 * dt } else { 0.0 };
            (m.linear_velocity.length() + m.angular_velocity.length() * b.radius + fall) * dt
        };
        let mut pairs = Vec::new();
        for a in 0..n {
            for b in a + 1..n {
                if [a, b].iter().all(|&i| state.bodies.kind[i] != RigidBody::Dynamic) {
                    continue;
                }
                let (ra, rb) = (state.bodies.radius[a], state.bodies.radius[b]);
                let margin = 0.02 * ra.min(rb) + 1.5 * (motion(a) + motion(b));
                let distance = state.bodies.frame[a].center.distance(state.bodies.frame[b].center) as f32;
                if distance < ra + rb + margin {
                    pairs.push(MarginPair {
                        bodies: [a as u32, b as u32],
                        margin,
                    });
                }
            }
        }
        cpu::run(
            &state.bodies,
            &state.meshes,
            &pairs,
            &mut self.found,
            &mut self.manifolds,
        );
        let config = StepConfig { dt, ..state.config };
        planes::find(
            &state.bodies,
            &state.meshes,
            &state.planes,
            &config,
            &mut self.plane_scratch,
            &mut self.manifolds,
        );
        let interval = Interval {
            dt,
            substeps,
            gravity: state.config.gravity,
        };
        self.sleeper
            .wake(&mut self.bodies, &self.manifolds, &self.settings, &interval);
        self.solver.solve(
            &mut self.bodies,
            &self.manifolds,
            &mut self.warm,
            &self.settings,
            &interval,
        );
        self.sleeper
            .settle(&mut self.bodies, &self.manifolds, &self.settings, dt);
        self.bodies.write(&mut state.bodies, &state.meshes);
    }

    fn center(&self, i: usize) -> DVec3 {
        self.bodies.motions[i].center
    }

    fn deepest(&self) -> f32 {
        -self.manifolds.points.iter().map(|p| p.separation).fold(0.0, f32::min)
    }

    fn fastest(&self) -> f32 {
        self.bodies
            .motions
            .iter()
            .map(|m| m.linear_velocity.length())
            .fold(0.0, f32::max)
    }

    fn seconds(&mut self, count: u32) {
        for _ in 0..64 * count {
            self.step();
        }
    }

    /// A static box whose top is at 0.
    fn floor(&mut self, cube: u32) {
        self.add(
            RigidBody::Static,
            cube,
            Vec3::new(40.0, 1.0, 40.0),
            Vec3::NEG_Y * 0.5,
            Quat::IDENTITY,
        );
    }
}

/// What a cube of edge 1 keeps between itself and others.
const GAP: f32 = 0.00866;

#[test]
fn a_cube_rests_on_a_mesh() {
    let mut world = World::new();
    let cube = world.mesh(&shapes::cube(1.0));
    world.floor(cube);
    let at = Vec3::new(0.3, 0.5 + GAP, 0.2);
    let body = world.add(RigidBody::Dynamic, cube, Vec3::ONE, at, Quat::from_rotation_y(0.4));
    world.begin();
    let start = world.center(body);
    world.seconds(20);
    let moved = world.center(body).distance(start);
    println!("moved {moved:.6} m in 20 s");
    assert!(moved < 1.0e-3, "{moved}");
}

#[test]
fn ten_cubes_stay_on_each_other() {
    let mut world = World::new();
    let cube = world.mesh(&shapes::cube(1.0));
    world.floor(cube);
    let stack: Vec<usize> = (0..10)
        .map(|i| {
            let at = Vec3::Y * (0.5 + GAP + (1.0 + GAP) * i as f32);
            let turn = Quat::from_rotation_y(0.1 * i as f32);
            world.add(RigidBody::Dynamic, cube, Vec3::ONE, at, turn)
        })
        .collect();
    world.begin();
    let start: Vec<DVec3> = stack.iter().map(|&i| world.center(i)).collect();
    world.seconds(20);
    let moved = stack.iter().zip(&start).map(|(&i, s)| world.center(i).distance(*s));
    let most = moved.fold(0.0, f64::max);
    println!(
        "moved {most:.6} m in 20 s, deepest {}, fastest {}",
        world.deepest(),
        world.fastest()
    );
    assert!(most < 0.01 && world.fastest() < 1.0e-3, "{most}");
}

#[test]
fn a_chain_of_rings_hangs_still() {
    let mut world = World::new();
    let ring = world.mesh(&shapes::ring());
    let count = 50;
    for i in 0..count {
        let kind = if i == 0 { RigidBody::Static } else { RigidBody::Dynamic };
        let turn = Quat::from_rotation_y(if i % 2 == 0 { 0.0 } else { std::f32::consts::FRAC_PI_2 });
        world.add(kind, ring, Vec3::ONE, Vec3::NEG_Y * (0.74 * i as f32), turn);
    }
    world.begin();
    world.seconds(10);
    let links = (1..count).map(|i| world.center(i - 1).distance(world.center(i)));
    let longest = links.fold(0.0, f64::max);
    let (deepest, fastest) = (world.deepest(), world.fastest());
    println!("after 10 s: longest link {longest:.4} m, deepest {deepest:.5} m, fastest {fastest:.4} m/s");
    // Two diameters of the tube less than that of the ring, and the gap: 0.76 m and a little.
    assert!((0.74..0.79).contains(&longest), "{longest}");
    assert!(deepest < 0.02, "{deepest}");
    assert!(fastest < 0.3, "{fastest}");
}

#[test]
fn bodies_poured_into_a_bin_come_to_rest() {
    for (name, mesh, count, seconds) in [
        ("tori", shapes::torus_240(), 40, 6),
        ("knots", shapes::knot_1120(), 12, 6),
    ] {
        let mut world = World::new();
        let cube = world.mesh(&shapes::cube(1.0));
        let poured = world.mesh(&mesh);
        world.floor(cube);
        for (scale, at) in [
            (Vec3::new(1.0, 30.0, 6.0), Vec3::new(-2.0, 15.0, 0.0)),
            (Vec3::new(1.0, 30.0, 6.0), Vec3::new(2.0, 15.0, 0.0)),
            (Vec3::new(6.0, 30.0, 1.0), Vec3::new(0.0, 15.0, -2.0)),
            (Vec3::new(6.0, 30.0, 1.0), Vec3::new(0.0, 15.0, 2.0)),
        ] {
            world.add(RigidBody::Static, cube, scale, at, Quat::IDENTITY);
        }
        let mut random = fastrand::Rng::with_seed(3);
        for i in 0..count {
            let side = if i % 2 == 0 { 0.54 } else { -0.54 };
            let at = Vec3::new(1.6 * (random.f32() - 0.5), 0.8 + 0.9 * (i / 2) as f32, side);
            let turn = Quat::from_scaled_axis(Vec3::new(random.f32(), random.f32(), random.f32()) * 3.0);
            world.add(RigidBody::Dynamic, poured, Vec3::splat(0.8), at, turn);
        }
        world.begin();
        let mut deepest = 0.0f32;
        for _ in 0..64 * seconds {
            world.step();
            deepest = deepest.max(world.deepest());
        }
        let (still_deep, fastest) = (world.deepest(), world.fastest());
        println!("{name}: deepest on the way {deepest:.4} m, then {still_deep:.4} m, fastest {fastest:.4} m/s");
        for i in 5..5 + count {
            let c = world.center(i);
            assert!(c.x.abs() < 1.5 && c.z.abs() < 1.5 && c.y > 0.0, "{name} {i} is at {c}");
        }
        // The last ones land with 18 m/s.
        assert!(still_deep < 0.01 && deepest < 0.2, "{name}: {still_deep}, {deepest}");
        assert!(fastest < 0.1, "{name}: {fastest}");
    }
}
