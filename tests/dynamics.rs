//! Meshes on meshes, moved by what contact generation and solver make of them together.

use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::components::RigidBody;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::stages::manifolds::cpu::planes;
use bevy_faceoff::stages::manifolds::{Manifolds, MarginPair, cpu};
use bevy_faceoff::stages::solver::*;
use bevy_faceoff::stages::state::{Body, StepConfig, StepState};
use glam::{DVec3, Quat, Vec3};
use std::time::{Duration, Instant};

/// The defaults, or what the environment says, as `name=value` with spaces between.
fn settings() -> SolverSettings {
    let mut settings = SolverSettings {
        sleeping: false,
        ..SolverSettings::default()
    };
    for word in std::env::var("SETTINGS").unwrap_or_default().split_whitespace() {
        let (name, value) = word.split_once('=').expect("name=value");
        let value: f32 = value.parse().expect("a number");
        match name {
            "push" => settings.push_speed = value,
            "substeps" => settings.substeps = value as u32,
            "relax" => settings.relax_iterations = value as u32,
            "bias" => settings.bias_iterations = value as u32,
            "rest" => settings.rest_offset = value,
            "omega" => settings.relaxation = value,
            "travel" => settings.detection_travel = value,
            "zeta" => settings.damping_ratio = value,
            "match" => settings.match_distance = value,
            _ => panic!("{name}?"),
        }
    }
    settings
}

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
    generating: Duration,
    solving: Duration,
    intervals: u32,
    steps: u32,
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
            settings: settings(),
            generating: Duration::ZERO,
            solving: Duration::ZERO,
            intervals: 0,
            steps: 0,
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
        let least = std::env::var("LEAST").ok().and_then(|s| s.parse().ok()).unwrap_or(1);
        let detections = self.settings.detections(&self.bodies, dt).max(least);
        for _ in 0..detections {
            self.interval(dt / detections as f32, self.settings.substeps_per_detection(detections));
        }
        self.intervals += detections;
        self.steps += 1;
    }

    fn interval(&mut self, dt: f32, substeps: u32) {
        let start = Instant::now();
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
        self.generating += start.elapsed();
        let start = Instant::now();
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
        self.solving += start.elapsed();
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

    fn tell(&self, what: &str) {
        println!(
            "{what}: {} pairs, {} points, deepest {:.5}, fastest {:.4}; {:.1} intervals a step; a step {:.2} ms generating, {:.2} ms solving",
            self.manifolds.pairs.len(),
            self.manifolds.points.len(),
            self.deepest(),
            self.fastest(),
            self.intervals as f32 / self.steps as f32,
            self.generating.as_secs_f64() * 1e3 / self.steps as f64,
            self.solving.as_secs_f64() * 1e3 / self.steps as f64,
        );
    }
}

#[test]
fn cube_on_a_mesh_floor() {
    let mut world = World::new();
    let cube = world.mesh(&shapes::cube(1.0));
    world.add(
        RigidBody::Static,
        cube,
        Vec3::new(20.0, 1.0, 20.0),
        Vec3::NEG_Y * 0.5,
        Quat::IDENTITY,
    );
    let body = world.add(
        RigidBody::Dynamic,
        cube,
        Vec3::ONE,
        Vec3::new(0.3, 0.51, 0.2),
        Quat::from_rotation_y(0.4),
    );
    world.begin();
    let start = world.center(body);
    for second in 0..60 {
        for _ in 0..64 {
            world.step();
        }
        if second % 20 == 0 || second == 59 {
            let way = world.center(body) - start;
            println!(
                "{second} s: moved {:.6} aside, height {:.6}",
                way.x.hypot(way.z),
                world.center(body).y
            );
        }
    }
    world.tell("cube");
}

#[test]
fn stack_of_ten_cubes() {
    let mut world = World::new();
    let cube = world.mesh(&shapes::cube(1.0));
    world.add(
        RigidBody::Static,
        cube,
        Vec3::new(20.0, 1.0, 20.0),
        Vec3::NEG_Y * 0.5,
        Quat::IDENTITY,
    );
    let stack: Vec<usize> = (0..10)
        .map(|i| {
            let at = Vec3::new(0.0, 0.5 + 1.0 * i as f32, 0.0);
            world.add(
                RigidBody::Dynamic,
                cube,
                Vec3::ONE,
                at,
                Quat::from_rotation_y(0.1 * i as f32),
            )
        })
        .collect();
    world.begin();
    let start: Vec<DVec3> = stack.iter().map(|&i| world.center(i)).collect();
    for second in 0..30 {
        for _ in 0..64 {
            world.step();
        }
        if second % 5 == 4 {
            let top = world.center(stack[9]) - start[9];
            println!("{second} s: top sinks {:.5}, aside {:.5}", -top.y, top.x.hypot(top.z));
        }
    }
    world.tell("stack");
}

#[test]
fn pyramid_of_cubes() {
    let mut world = World::new();
    let cube = world.mesh(&shapes::cube(1.0));
    world.add(
        RigidBody::Static,
        cube,
        Vec3::new(40.0, 1.0, 40.0),
        Vec3::NEG_Y * 0.5,
        Quat::IDENTITY,
    );
    let mut all = Vec::new();
    for row in 0..10 {
        for i in 0..10 - row {
            let at = Vec3::new(1.05 * (i as f32 + 0.5 * row as f32), 0.5 + row as f32, 0.0);
            all.push(world.add(RigidBody::Dynamic, cube, Vec3::ONE, at, Quat::IDENTITY));
        }
    }
    world.begin();
    let start: Vec<DVec3> = all.iter().map(|&i| world.center(i)).collect();
    for second in 0..30 {
        for _ in 0..64 {
            world.step();
        }
        if second % 5 == 4 {
            let farthest = all
                .iter()
                .zip(&start)
                .map(|(&i, s)| world.center(i).distance(*s))
                .fold(0.0, f64::max);
            println!("{second} s: farthest moved {farthest:.5}");
        }
    }
    world.tell("pyramid");
}

#[test]
fn chain_of_rings() {
    let mut world = World::new();
    let mesh = shapes::ring();
    let ring = world.mesh(&mesh);
    // Outer radius of the tube's middle 0.44, tube 0.06: each ring hangs in the one above.
    let count: usize = std::env::var("LINKS").ok().and_then(|s| s.parse().ok()).unwrap_or(50);
    let links: Vec<usize> = (0..count)
        .map(|i| {
            let kind = if i == 0 { RigidBody::Static } else { RigidBody::Dynamic };
            let turn = Quat::from_rotation_y(if i % 2 == 0 { 0.0 } else { std::f32::consts::FRAC_PI_2 });
            world.add(kind, ring, Vec3::ONE, Vec3::NEG_Y * (0.74 * i as f32), turn)
        })
        .collect();
    world.begin();
    println!("radius {}", world.state.bodies.radius[0]);
    let seconds = std::env::var("SECONDS").ok().and_then(|s| s.parse().ok()).unwrap_or(20);
    for second in 0..seconds {
        for _ in 0..64 {
            world.step();
        }
        let gaps = links
            .windows(2)
            .map(|w| world.center(w[0]).distance(world.center(w[1])));
        let longest = gaps.clone().fold(0.0, f64::max);
        let total = world.center(0).y - world.center(count - 1).y;
        if second % 2 == 1 || longest > 1.0 || count < 5 {
            if count < 5 {
                for m in &world.bodies.motions[1..] {
                    println!(
                        "  at {:.5} v {:.4} w {:.3}",
                        m.center, m.linear_velocity, m.angular_velocity
                    );
                }
                for p in &world.manifolds.points {
                    println!("    arm {:.4} n {:.3} s {:.5}", p.arms[0], p.normal, p.separation);
                }
            }
            let spin = world
                .bodies
                .motions
                .iter()
                .map(|m| m.angular_velocity.length())
                .fold(0.0, f32::max);
            let kinetic: f32 = (0..count)
                .filter(|&i| world.bodies.bodies[i].inverse_mass > 0.0)
                .map(|i| {
                    0.5 * world.bodies.motions[i].linear_velocity.length_squared() / world.bodies.bodies[i].inverse_mass
                })
                .sum();
            let potential: f64 = (0..count)
                .filter(|&i| world.bodies.bodies[i].inverse_mass > 0.0)
                .map(|i| 9.81 * world.center(i).y / world.bodies.bodies[i].inverse_mass as f64)
                .sum();
            println!(
                "{second} s: length {total:.4}, longest link {longest:.4}, deepest {:.5}, fastest {:.3}, spin {spin:.1}, kinetic {kinetic:.5} J, potential {potential:.4}",
                world.deepest(),
                world.fastest()
            );
        }
        if longest > 1.0 {
            println!("BROKEN");
            break;
        }
    }
    world.tell("chain");
}

#[test]
fn bodies_poured_into_a_bin() {
    for (name, mesh) in [("tori", shapes::torus_240()), ("knots", shapes::knot_1120())] {
        let mut world = World::new();
        let cube = world.mesh(&shapes::cube(1.0));
        let poured = world.mesh(&mesh);
        for (scale, at) in [
            (Vec3::new(6.0, 1.0, 6.0), Vec3::new(0.0, -0.5, 0.0)),
            (Vec3::new(1.0, 30.0, 6.0), Vec3::new(-2.0, 14.0, 0.0)),
            (Vec3::new(1.0, 30.0, 6.0), Vec3::new(2.0, 14.0, 0.0)),
            (Vec3::new(6.0, 30.0, 1.0), Vec3::new(0.0, 14.0, -2.0)),
            (Vec3::new(6.0, 30.0, 1.0), Vec3::new(0.0, 14.0, 2.0)),
        ] {
            world.add(RigidBody::Static, cube, scale, at, Quat::IDENTITY);
        }
        let mut random = fastrand::Rng::with_seed(3);
        for i in 0..60 {
            let at = Vec3::new(
                1.6 * (random.f32() - 0.5),
                0.8 + 0.9 * (i / 2) as f32,
                0.9 * ((i % 2) as f32 - 0.5) * 2.0 * 0.6,
            );
            let turn = Quat::from_scaled_axis(Vec3::new(random.f32(), random.f32(), random.f32()) * 3.0);
            world.add(RigidBody::Dynamic, poured, Vec3::splat(0.8), at, turn);
        }
        world.begin();
        for second in 0..10 {
            let start = Instant::now();
            for _ in 0..64 {
                world.step();
            }
            let out = (5..65).filter(|&i| {
                let c = world.center(i);
                c.x.abs() > 2.0 || c.z.abs() > 2.0 || c.y < -0.5
            });
            println!(
                "{name} {second} s: deepest {:.4}, fastest {:.3}, out {}, {:.1} ms a step",
                world.deepest(),
                world.fastest(),
                out.count(),
                start.elapsed().as_secs_f64() * 1e3 / 64.0
            );
        }
        world.tell(name);
    }
}
