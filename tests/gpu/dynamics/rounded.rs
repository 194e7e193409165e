//! Balls and capsules that roll on the device, and heaps of rounded bodies on both sides.

use super::parity::both;
use crate::world::{World, any_turn};
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::state::{Body, BodyParams, Plane};
use bevy_faceoff::types::body::RigidBody;
use bevy_faceoff::types::material::Friction;
use glam::{Quat, Vec3};
use std::collections::BTreeMap;

/// Radius of what rolls, metres.
const RADIUS: f32 = 0.1;
/// How far it rolls, metres.
const WAY: f32 = 10.0;

/// Ground at a height of 0.
#[derive(Clone, Copy, Debug)]
pub enum Ground {
    Block,
    HalfSpace,
}

fn rough() -> BodyParams {
    BodyParams {
        friction: Friction {
            coefficient: 0.8,
            ..Friction::default()
        },
        ..BodyParams::default()
    }
}

fn world_with(ground: Ground) -> World {
    let mut world = World::new();
    match ground {
        Ground::Block => {
            let cube = world.mesh(&shapes::cube(1.0));
            world.put(&Body {
                kind: RigidBody::Static,
                params: rough(),
                ..Body::at_rest(cube, Vec3::NEG_Y * 0.5, Quat::IDENTITY, Vec3::new(24.0, 1.0, 8.0))
            });
        }
        Ground::HalfSpace => world.state.input.planes.push(Plane {
            normal: Vec3::Y,
            distance: 0.0,
            friction: rough().friction,
            ..Plane::default()
        }),
    }
    world
}

/// Rolls a mesh along x, and requires that it keeps its speed within a thousandth.
fn roll(name: &str, ground: Ground, mesh: CollisionMesh, turn: Quat, speed: f32) {
    let mut world = world_with(ground);
    let mesh = world.state.input.meshes.add(mesh);
    let body = world.put(&Body {
        linear_velocity: Vec3::X * speed,
        angular_velocity: Vec3::NEG_Z * (speed / RADIUS),
        params: rough(),
        ..Body::at_rest(mesh, Vec3::Y * (RADIUS * 1.0005), turn, Vec3::ONE)
    });
    let mut range = [f32::INFINITY, 0.0f32];
    let start = world.center(body).x;
    for _ in 0..(64.0 * WAY / speed) as u32 {
        world.step();
        let now = world.velocity(body).length() / speed;
        range = [range[0].min(now), range[1].max(now)];
    }
    let way = world.center(body).x - start;
    println!(
        "{name} on {ground:?} at {speed} m/s: {way:.3} m, {:.5} to {:.5} of its speed",
        range[0], range[1]
    );
    assert!(range[0] > 0.999 && range[1] < 1.001, "{name}: {range:?}");
}

pub fn balls_roll(ground: Ground) {
    for speed in [1.0, 5.0] {
        roll(
            "a ball",
            ground,
            CollisionMesh::ball(RADIUS).unwrap(),
            Quat::IDENTITY,
            speed,
        );
    }
}

pub fn capsules_roll(ground: Ground) {
    let capsule = CollisionMesh::capsule(RADIUS, 0.4).unwrap();
    let across = Quat::from_rotation_x(std::f32::consts::FRAC_PI_2);
    roll("a capsule", ground, capsule, across, 1.0);
}

/// Bodies of all rounded shapes that fall through each other's way onto a mesh and a half-space.
fn heap() -> World {
    let mut world = world_with(Ground::Block);
    world.state.input.planes.push(Plane::default());
    let meshes = [
        CollisionMesh::ball(0.25).unwrap(),
        CollisionMesh::capsule(0.15, 0.5).unwrap(),
        CollisionMesh::cuboid(Vec3::new(0.6, 0.4, 0.5), 0.08).unwrap(),
        CollisionMesh::cylinder(0.3, 0.4, 0.05).unwrap(),
        CollisionMesh::new(&shapes::torus_240()),
    ];
    let slots = meshes.map(|mesh| world.state.input.meshes.add(mesh));
    let mut random = fastrand::Rng::with_seed(5);
    for i in 0..15 {
        let across = Vec3::new(random.f32() - 0.5, 0.0, random.f32() - 0.5);
        world.put(&Body {
            linear_velocity: Vec3::NEG_Y * 2.0 + 4.0 * Vec3::new(random.f32() - 0.5, 0.0, random.f32() - 0.5),
            angular_velocity: 6.0 * across,
            ..Body::at_rest(
                slots[i % slots.len()],
                across + Vec3::Y * (0.6 + 0.45 * i as f32),
                any_turn(&mut random),
                Vec3::ONE,
            )
        });
    }
    world
}

/// Step by step from the same poses: who touches whom, and how strongly.
pub fn reports() {
    let mut worlds = both(heap);
    let (mut pairs, mut missed, mut points) = (0, 0, [0, 0]);
    let mut impulses = [0.0f32; 2];
    for _ in 0..120 {
        worlds.iter_mut().for_each(World::step);
        let touching = worlds.each_ref().map(|world| {
            let contacts = &world.state.results.contacts;
            let pairs = contacts.pairs.iter().map(|pair| (pair.bodies, pair.impulse));
            let planes = contacts.planes.iter();
            let planes = planes.map(|plane| ([plane.body, u32::MAX - plane.plane], plane.impulse));
            pairs.chain(planes).collect::<BTreeMap<_, _>>()
        });
        let [cpu, gpu] = &touching;
        missed += cpu.keys().filter(|pair| !gpu.contains_key(*pair)).count();
        missed += gpu.keys().filter(|pair| !cpu.contains_key(*pair)).count();
        pairs += cpu.len();
        for i in 0..2 {
            impulses[i] += touching[i].values().sum::<f32>();
            points[i] += worlds[i].state.results.manifolds.points.len();
        }
        follow(&mut worlds);
    }
    println!("{pairs} pairs, {missed} on one side only; {points:?} points; impulses sum to {impulses:?} N s");
    assert!(pairs > 300 && missed <= pairs / 50);
    assert!(points[0].abs_diff(points[1]) <= points[0] / 50);
    assert!((impulses[0] - impulses[1]).abs() < 0.02 * impulses[0]);
}

/// Gives the device the poses of the CPU, so that chaos does not part the two.
fn follow([cpu, gpu]: &mut [World; 2]) {
    for i in 0..cpu.state.input.bodies.len() {
        let motion = cpu.state.input.bodies.motion(i);
        gpu.state.input.bodies.set_motion(i, &motion);
    }
    gpu.place_frames();
}

/// A heap of rounded bodies comes to rest without overlaps.
pub fn comes_to_rest() {
    let mut world = heap();
    world.seconds(5);
    let deepest = world.deepest();
    let count = world.state.input.bodies.len();
    let lowest = (1..count).map(|i| world.center(i).y).fold(f64::INFINITY, f64::min);
    println!(
        "deepest {deepest:.1e} m, lowest centre {lowest:.3} m, fastest {:.3} m/s",
        world.fastest()
    );
    assert!(deepest < 0.002 && lowest > 0.1 && world.fastest() < 3.0);
}
