//! Bodies that roll without being driven. A perfect wheel keeps its speed; one of facets may lose what they lose, and
//! none gains any. Sleep is off, because it would hide both.

use super::motion::Motion;
use crate::world::{World, any_turn};
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::state::{Body, BodyParams, Plane};
use bevy_faceoff::types::body::RigidBody;
use bevy_faceoff::types::material::Friction;
use glam::{Quat, Vec3};
use std::f32::consts::TAU;

/// What a body rolls on, along x.
#[derive(Clone, Copy, Debug)]
pub enum Ground {
    Block,
    HalfSpace,
    /// Two half-spaces at right angles.
    Groove,
}

/// A body that rolls without sliding.
struct Roller {
    world: World,
    body: usize,
    /// Energy at the start, joules.
    energy: f64,
    speed: f64,
}

impl Roller {
    /// A body of this mesh, whose contact is `radius` below its centre, at `speed`.
    fn new(mesh: &TriMesh, radius: f32, turn: Quat, ground: Ground, speed: f32) -> Self {
        let mut world = World::new();
        match ground {
            Ground::Block => {
                let cube = world.mesh(&shapes::cube(1.0));
                let size = Vec3::new(100.0, 1.0, 10.0);
                world.add(
                    RigidBody::Static,
                    cube,
                    size,
                    Vec3::new(40.0, -0.5, 0.0),
                    Quat::IDENTITY,
                );
            }
            Ground::HalfSpace => world.state.input.planes.push(Plane::default()),
            Ground::Groove => {
                for side in [-1.0, 1.0] {
                    world.state.input.planes.push(Plane {
                        normal: Vec3::new(0.0, 1.0, side).normalize(),
                        ..Plane::default()
                    });
                }
            }
        }
        let mesh = world.mesh(mesh);
        // A rest offset above it. In the groove the contacts are nearer to the axis.
        let (height, arm) = match ground {
            Ground::Groove => (radius * 1.001 * 2.0f32.sqrt(), radius / 2.0f32.sqrt()),
            _ => (radius * 1.001, radius),
        };
        let body = world.put(&Body {
            kind: RigidBody::Dynamic,
            linear_velocity: Vec3::X * speed,
            angular_velocity: Vec3::NEG_Z * (speed / arm),
            ..Body::at_rest(mesh, Vec3::Y * height, turn, Vec3::ONE)
        });
        Self::of(world, body)
    }

    fn of(world: World, body: usize) -> Self {
        let mut roller = Self {
            world,
            body,
            energy: 0.0,
            speed: 0.0,
        };
        (roller.energy, roller.speed) = (roller.energy(), roller.speed());
        roller
    }

    /// Kinetic and potential energy.
    fn energy(&self) -> f64 {
        let weight =
            self.world.state.input.config.gravity.length() / self.world.state.input.bodies.inverse_mass[self.body];
        Motion::of(&self.world).kinetic + f64::from(weight) * self.world.center(self.body).y
    }

    fn speed(&self) -> f64 {
        f64::from(self.world.velocity(self.body).length())
    }

    /// Lets it roll for so many steps. The part of its speed that it keeps must be in this range, and it must never
    /// have more than this part of its energy.
    fn keeps(&mut self, name: &str, steps: u32, range: std::ops::RangeInclusive<f64>, most: f64) {
        let mut highest = 0.0f64;
        for _ in 0..steps {
            self.world.step();
            highest = highest.max(self.energy() / self.energy);
        }
        let kept = self.speed() / self.speed;
        println!("{name}: keeps {kept:.5} of its speed, and has at most {highest:.5} of its energy");
        assert!(range.contains(&kept), "{name}: {kept}");
        assert!(highest <= most, "{name}: {highest}");
    }
}

#[test]
fn a_ball_rolls_on_at_its_speed() {
    let mut random = fastrand::Rng::with_seed(5);
    let ball = shapes::ball(0.1, 3);
    for ground in [Ground::Block, Ground::HalfSpace, Ground::Groove] {
        for (speed, seconds) in [(0.05, 60), (0.2, 60), (1.0, 20), (5.0, 2)] {
            let mut ball = Roller::new(&ball, 0.1, any_turn(&mut random), ground, speed);
            let name = format!("{ground:?}, {speed} m/s, {seconds} s");
            ball.keeps(&name, 64 * seconds, 0.998..=1.001, 1.002);
        }
    }
}

/// A ball and a wheel, for so many steps.
#[allow(dead_code, reason = "the tests on a device call it")]
pub fn keep_their_speed(ground: Ground, steps: u32) {
    for (name, mesh) in [("ball", shapes::ball(0.3, 3)), ("cylinder", cylinder(96, 0.3, 0.1))] {
        let mut roller = Roller::new(&mesh, 0.3, Quat::from_rotation_z(0.4), ground, 3.0);
        roller.keeps(&format!("{ground:?}, {name}"), steps, 0.998..=1.001, 1.002);
    }
}

#[test]
fn a_marble_rolls_through_a_room() {
    let mut random = fastrand::Rng::with_seed(6);
    for ground in [Ground::Block, Ground::HalfSpace] {
        let mut marble = Roller::new(&shapes::ball(0.005, 3), 0.005, any_turn(&mut random), ground, 1.0);
        marble.keeps(&format!("{ground:?}"), 64 * 17, 0.98..=1.001, 1.002);
    }
}

#[test]
fn wheels_roll_on_at_their_speed() {
    let mut random = fastrand::Rng::with_seed(7);
    for ground in [Ground::Block, Ground::HalfSpace] {
        for (name, mesh) in [
            ("cylinder of 96 sides", cylinder(96, 0.3, 0.1)),
            ("cylinder of 192 sides", cylinder(192, 0.3, 0.1)),
            ("torus", shapes::torus(96, 48, 0.2, 0.1)),
            ("ball of 1280 triangles", shapes::ball(0.3, 3)),
            ("ball of 5120 triangles", shapes::ball(0.3, 4)),
        ] {
            // Its axis stays across its way.
            let turn = Quat::from_rotation_z(TAU * random.f32());
            let mut wheel = Roller::new(&mesh, 0.3, turn, ground, 3.0);
            wheel.keeps(&format!("{ground:?}, {name}"), 64 * 12, 0.998..=1.001, 1.002);
        }
    }
}

#[test]
fn coarse_balls_and_wheels_gain_no_energy() {
    let mut random = fastrand::Rng::with_seed(8);
    for ground in [Ground::Block, Ground::HalfSpace] {
        for (name, mesh, spins) in [
            ("ball of 80 triangles", shapes::ball(0.3, 1), true),
            ("ball of 320 triangles", shapes::ball(0.3, 2), true),
            ("cylinder of 12 sides", cylinder(12, 0.3, 0.1), false),
            ("cylinder of 24 sides", cylinder(24, 0.3, 0.1), false),
            ("torus", shapes::torus(24, 12, 0.2, 0.1), false),
        ] {
            for speed in [0.3, 3.0] {
                let turn = if spins {
                    any_turn(&mut random)
                } else {
                    Quat::from_rotation_z(TAU * random.f32())
                };
                // One that falls over may be faster for a while.
                let mut wheel = Roller::new(&mesh, 0.3, turn, ground, speed);
                wheel.keeps(&format!("{ground:?}, {name}, {speed} m/s"), 64 * 8, 0.0..=2.0, 1.002);
            }
        }
    }
}

#[test]
fn a_ball_rolls_down_a_ball() {
    // It rolls until friction no longer holds it, and then slides.
    let mut world = World::new();
    let (large, small) = (world.mesh(&shapes::ball(1.0, 4)), world.mesh(&shapes::ball(0.2, 3)));
    world.add(
        RigidBody::Static,
        large,
        Vec3::ONE,
        Vec3::ZERO,
        Quat::from_rotation_x(0.4),
    );
    let body = world.put(&Body {
        kind: RigidBody::Dynamic,
        linear_velocity: Vec3::X * 0.5,
        angular_velocity: Vec3::NEG_Z * 2.5,
        params: BodyParams {
            friction: Friction::new(2.0),
            ..BodyParams::default()
        },
        ..Body::at_rest(small, Vec3::Y * 1.2002, Quat::from_rotation_x(1.0), Vec3::ONE)
    });
    let mut roller = Roller::of(world, body);
    let start = Motion::of(&roller.world).kinetic;
    let height = roller.world.center(body).y;
    let mass = 1.0 / f64::from(roller.world.state.input.bodies.inverse_mass[body]);
    for step in 0..64 {
        roller.world.step();
        let center = roller.world.center(body);
        if center.y < 0.9 {
            break;
        }
        let wanted = start + 9.81 * mass * (height - center.y);
        let found = Motion::of(&roller.world).kinetic;
        println!("step {step}: {center}, energy {:.5} of theory's", found / wanted);
        assert!((found / wanted - 1.0).abs() < 0.02, "step {step}: {found} for {wanted}");
    }
    assert!(roller.world.center(body).y < 1.0);
}

#[test]
fn a_ball_slides_round_a_drum_as_along_a_polygon() {
    // It loses the part of its velocity along the normal of each facet that it comes to. By default it passes six
    // facets in a collision substep, and turns by all of them at once.
    let sides = 1024;
    let polygon = f64::from(TAU / sides as f32).cos().powi(sides as i32);
    for (travel, least) in [(0.25, 0.92), (0.025, polygon - 0.01)] {
        let mut world = World::weightless();
        let solver = &mut world.state.input.config.solver;
        (solver.collision_substep_travel, solver.max_collision_substeps) = (travel, 64);
        let (drum, ball) = (
            world.mesh(&drum(sides, 1.0, 1.1, 1.0)),
            world.mesh(&shapes::ball(0.1, 3)),
        );
        let params = BodyParams {
            friction: Friction::new(0.0),
            ..BodyParams::default()
        };
        world.put(&Body {
            kind: RigidBody::Static,
            params,
            ..Body::at_rest(drum, Vec3::ZERO, Quat::IDENTITY, Vec3::ONE)
        });
        let body = world.put(&Body {
            kind: RigidBody::Dynamic,
            linear_velocity: Vec3::X * 5.0,
            params,
            ..Body::at_rest(ball, Vec3::NEG_Y * 0.8999, Quat::from_rotation_x(1.0), Vec3::ONE)
        });
        let mut roller = Roller::of(world, body);
        let steps = (64.0 * TAU * 0.9 / 5.0) as u32;
        roller.keeps(&format!("travel {travel}, one turn"), steps, least..=1.0001, 1.0002);
    }
}

/// A cylinder about the z axis.
fn cylinder(sides: u32, radius: f32, width: f32) -> TriMesh {
    let ends = [-0.5 * width, 0.5 * width];
    let mut vertices: Vec<Vec3> = ends.iter().flat_map(|&z| circle(sides, radius, z)).collect();
    vertices.extend(ends.map(|z| Vec3::Z * z));
    let at = |end: u32, k: u32| end * sides + k % sides;
    let faces = (0..sides).flat_map(|k| {
        let [a, b, c, d] = [at(0, k), at(0, k + 1), at(1, k + 1), at(1, k)];
        [[a, b, c], [a, c, d], [b, a, 2 * sides], [d, c, 2 * sides + 1]]
    });
    TriMesh::new(vertices, faces.collect()).unwrap()
}

/// A tube about the z axis.
fn drum(sides: u32, inner: f32, outer: f32, width: f32) -> TriMesh {
    let z = 0.5 * width;
    let rings = [(outer, -z), (outer, z), (inner, z), (inner, -z)];
    let vertices = rings.iter().flat_map(|&(radius, z)| circle(sides, radius, z)).collect();
    let at = |ring: u32, k: u32| ring % 4 * sides + k % sides;
    let faces = (0..sides).flat_map(|k| {
        (0..4).flat_map(move |ring| {
            let [a, b, c, d] = [at(ring, k), at(ring, k + 1), at(ring + 1, k + 1), at(ring + 1, k)];
            [[a, b, c], [a, c, d]]
        })
    });
    TriMesh::new(vertices, faces.collect()).unwrap()
}

fn circle(sides: u32, radius: f32, z: f32) -> impl Iterator<Item = Vec3> {
    (0..sides).map(move |k| {
        let (sin, cos) = (TAU * k as f32 / sides as f32).sin_cos();
        Vec3::new(radius * cos, radius * sin, z)
    })
}
