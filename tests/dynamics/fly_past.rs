//! Bodies that pass each other at a small distance. Nothing touches, so no velocity may change.

use crate::ccd::oracle::{MovingMesh, distance};
use crate::ccd::shapes::{cuboid, sheet};
use crate::world::{World, any_turn};
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::state::{Body, BodyParams};
use bevy_faceoff::types::body::RigidBody;
use bevy_faceoff::types::material::Friction;
use glam::{Mat3, Quat, Vec3};

const DT: f32 = 1.0 / 64.0;

/// A prism along z, closed, whose outline in the plane of x and y is given counter-clockwise. It must be convex.
pub(super) fn prism(outline: &[[f32; 2]], half: f32) -> TriMesh {
    let n = outline.len() as u32;
    let ring = |z: f32| outline.iter().map(move |&[x, y]| Vec3::new(x, y, z));
    let vertices: Vec<Vec3> = ring(half).chain(ring(-half)).collect();
    let mut triangles = Vec::new();
    for i in 1..n - 1 {
        triangles.push([0, i, i + 1]);
        triangles.push([n, n + i + 1, n + i]);
    }
    for i in 0..n {
        let j = (i + 1) % n;
        triangles.push([i, n + i, n + j]);
        triangles.push([i, n + j, j]);
    }
    TriMesh::new(vertices, triangles).unwrap()
}

/// A ridge along z with slopes of 45 degrees, whose edge is at the origin.
fn ridge() -> TriMesh {
    prism(&[[0.0, 0.0], [-2.0, -2.0], [2.0, -2.0]], 2.0)
}

/// The largest change of velocity of a ball of radius 0.1 that passes the origin along x at a height, among so many
/// phases.
fn past(obstacle: &TriMesh, speed: f32, height: f32, gravity: f32, continuous: bool, phases: u32) -> f32 {
    let mut worst: f32 = 0.0;
    for phase in 0..phases {
        let mut world = World::new();
        world.state.input.config.gravity = Vec3::NEG_Y * gravity;
        let (ball, obstacle) = (world.mesh(&shapes::ball(0.1, 3)), world.mesh(obstacle));
        world.add(RigidBody::Static, obstacle, Vec3::ONE, Vec3::ZERO, Quat::IDENTITY);
        let steps = (1.0 / (speed * DT)).ceil();
        let velocity = Vec3::new(speed, 0.5 * gravity * 2.0 * steps * DT, 0.0);
        // At the origin after `steps` and a part of a step.
        let time = (steps + phase as f32 / phases as f32) * DT;
        let below = velocity.y * time - 0.5 * gravity * time * time;
        let at = Vec3::new(-speed * time, height - below, 0.0);
        let body = world.put(&Body {
            linear_velocity: velocity,
            params: BodyParams {
                continuous,
                ..BodyParams::default()
            },
            ..Body::at_rest(ball, at, Quat::IDENTITY, Vec3::ONE)
        });
        for step in 1..=2 * steps as u32 {
            world.step();
            let expected = velocity - Vec3::Y * gravity * DT * step as f32;
            worst = worst.max(world.velocity(body).distance(expected));
        }
    }
    worst
}

/// Speeds, and how far above the ridge.
const OVER_RIDGE: [(f32, f32); 6] = [
    (10.0, 0.01),
    (10.0, 0.04),
    (2.0, 0.003),
    (30.0, 0.02),
    (50.0, 0.001),
    (0.5, 0.001),
];

/// A ball flies over a ridge, in so many phases each.
pub fn over_a_ridge(phases: u32, ways: &[bool]) {
    for (speed, clearance) in OVER_RIDGE {
        for continuous in ways {
            let change = past(&ridge(), speed, 0.1 + clearance, 0.0, *continuous, phases);
            assert!(change < 1.0e-4, "{speed} m/s, {clearance} m above: {change} m/s");
        }
    }
}

#[test]
fn a_ball_flies_straight_on_over_a_ridge() {
    over_a_ridge(16, &[false, true]);
}

#[test]
fn a_ball_is_thrown_over_a_wall() {
    over_a_wall(16);
}

/// A ball is thrown over a wall, in so many phases.
pub fn over_a_wall(phases: u32) {
    let wall = prism(&[[-0.1, 0.0], [-0.1, -1.0], [0.1, -1.0], [0.1, 0.0]], 2.0);
    for clearance in [0.0146, 0.005] {
        // It is highest over the wall, whose edges it clears by a little less.
        let change = past(&wall, 6.0, 0.1 + clearance + 0.002, 9.81, false, phases);
        assert!(change < 1.0e-3, "{clearance} m above: {change} m/s");
    }
}

#[test]
fn a_box_slides_straight_on_over_a_groove() {
    over_a_groove(&[1.5, 3.0, 8.9], 4);
}

/// A box slides over a groove at these speeds, in so many phases each.
pub fn over_a_groove(speeds: &[f32], phases: u32) {
    // A floor of two blocks whose edges are chamfered, 1.5 inches apart.
    let [inch, wide] = [0.0254, 1.5 * 0.0254];
    let right = prism(
        &[
            [0.5 * wide, -inch],
            [0.5 * wide, -2.0],
            [8.0, -2.0],
            [8.0, 0.0],
            [0.5 * wide + inch, 0.0],
        ],
        3.0,
    );
    let left = prism(
        &[
            [-8.0, 0.0],
            [-8.0, -2.0],
            [-0.5 * wide, -2.0],
            [-0.5 * wide, -inch],
            [-0.5 * wide - inch, 0.0],
        ],
        3.0,
    );
    for &speed in speeds {
        for phase in 0..phases {
            let mut world = World::new();
            let meshes = [&left, &right].map(|mesh| world.mesh(mesh));
            let params = BodyParams {
                friction: Friction::new(0.0),
                ..BodyParams::default()
            };
            for mesh in meshes {
                world.put(&Body {
                    kind: RigidBody::Static,
                    params,
                    ..Body::at_rest(mesh, Vec3::ZERO, Quat::IDENTITY, Vec3::ONE)
                });
            }
            let size = Vec3::new(0.81, 1.83, 0.81);
            let slider = world.mesh(&cuboid(size));
            let at = Vec3::new(
                -1.2 - phase as f32 / phases as f32 * speed * DT,
                0.5 * size.y + 0.001,
                0.0,
            );
            let body = world.put(&Body {
                linear_velocity: Vec3::X * speed,
                params,
                ..Body::at_rest(slider, at, Quat::IDENTITY, Vec3::ONE)
            });
            let mut worst: f32 = 0.0;
            for _ in 0..(2.4 / (speed * DT)) as u32 {
                world.step();
                worst = worst.max((world.velocity(body) - Vec3::X * speed).length());
            }
            assert!(worst < 0.05, "{speed} m/s, phase {phase}: {worst} m/s");
        }
    }
}

/// What pairs do that pass each other.
#[derive(Default, Debug)]
pub struct Passes {
    /// Pairs whose true gap stays above 0.1 mm, but whose velocities change.
    pub deflected: usize,
    pub free: usize,
    /// Pairs that truly meet, but nothing happens.
    pub missed: usize,
    pub hits: usize,
    pub worst: f32,
}

/// A pair in one world, far from others.
struct Flight {
    bodies: [usize; 2],
    velocities: [Vec3; 2],
    paths: [MovingMesh; 2],
    /// Sum of the bulges of both, if they turn.
    bulge: f32,
}

/// A larger change of velocity, m/s, shows that a body has met another, though it be at a glancing angle.
const CHANGED: f32 = 1.0e-4;

/// How many of [`small_shapes`] are closed: the first ones.
const SOLIDS: usize = 5;

/// How far the surface for which a mesh stands lies beyond its facets, metres: that of a ball or of a torus. Bodies
/// that turn touch with it.
fn bulge(shape: &TriMesh, height: impl Fn(Vec3) -> f32) -> f32 {
    let places = (0..shape.triangles().len()).flat_map(|t| {
        let [a, b, c] = shape.corners(t);
        [(a + b + c) / 3.0, (a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0]
    });
    places.map(|p| -height(p)).fold(0.0, f32::max)
}

/// The bulge of each of [`small_shapes`].
fn bulges(shapes: &[TriMesh]) -> Vec<f32> {
    let ball = |p: Vec3| p.length() - 0.08;
    let torus = |p: Vec3| (p.truncate().length() - 0.07).hypot(p.z) - 0.025;
    let of = |(number, shape)| match number {
        2 => bulge(shape, ball),
        3 | 6 => bulge(shape, torus),
        _ => 0.0,
    };
    shapes.iter().enumerate().map(of).collect()
}

/// Bodies of diameter up to 0.2 m, convex, concave, open, thin.
fn small_shapes() -> Vec<TriMesh> {
    let part = |mesh: TriMesh, count: usize| {
        TriMesh::new(mesh.vertices().to_vec(), mesh.triangles()[..count].to_vec()).unwrap()
    };
    vec![
        cuboid(Vec3::splat(0.1)),
        cuboid(Vec3::new(0.15, 0.08, 0.03)),
        shapes::ball(0.08, 1),
        shapes::torus(8, 6, 0.07, 0.025),
        prism(&[[0.07, 0.0], [-0.05, 0.05], [-0.05, -0.05]], 0.05),
        sheet(0.13, 2),
        part(shapes::torus(8, 6, 0.07, 0.025), 48),
    ]
}

/// Throws `count` pairs past each other, at one speed for each world of 64 pairs.
pub fn throw(seed: u64, count: usize, spins: bool) -> Passes {
    let shapes = small_shapes();
    let bulges = bulges(&shapes);
    let mut random = fastrand::Rng::with_seed(seed);
    let mut passes = Passes::default();
    for _ in 0..count.div_ceil(64) {
        let mut world = World::weightless();
        let meshes: Vec<u32> = shapes.iter().map(|shape| world.mesh(shape)).collect();
        let speed = 0.5 * 100f32.powf(random.f32());
        let mut flights = Vec::new();
        // From well before they meet to well after, beginning anywhere within a step.
        let time = (0.3 / speed).max(2.0 * DT) + random.f32() * DT;
        let steps = (2.0 * time / DT).ceil() as u32;
        for i in 0..64 {
            let home = Vec3::new((i % 8) as f32, (i / 8) as f32, 0.0) * 16.0 - 56.0;
            let way = any_turn(&mut random) * Vec3::X;
            let aside = (any_turn(&mut random) * Vec3::X).cross(way).normalize() * (0.2 * random.f32());
            let common = (any_turn(&mut random) * Vec3::X) * random.f32() * 2.0;
            let ends = [home, home + aside - way * speed * time];
            let velocities = [common, common + way * speed];
            let mut bulge = 0.0;
            let bodies = [0, 1].map(|k| {
                let spin = if spins {
                    any_turn(&mut random) * Vec3::X * (8.0 * random.f32())
                } else {
                    Vec3::ZERO
                };
                let mesh = random.usize(..meshes.len());
                bulge += if spins { bulges[mesh] } else { 0.0 };
                world.put(&Body {
                    linear_velocity: velocities[k],
                    angular_velocity: spin,
                    mass: Some(1.0),
                    params: BodyParams {
                        // Shapes without thickness would cross others in a collision substep.
                        continuous: mesh >= SOLIDS,
                        ..BodyParams::default()
                    },
                    // They turn about any axis without wobble.
                    inertia: Some(Mat3::from_diagonal(Vec3::splat(2.0e-3))),
                    ..Body::at_rest(meshes[mesh], ends[k] - common * time, any_turn(&mut random), Vec3::ONE)
                })
            });
            let paths = bodies.map(|body| path(&world, body, steps as f32 * DT));
            flights.push(Flight {
                bodies,
                velocities,
                paths,
                bulge,
            });
        }
        let mut changes = vec![0f32; flights.len()];
        for _ in 0..steps {
            world.step();
            for (flight, change) in flights.iter().zip(&mut changes) {
                for (&body, velocity) in flight.bodies.iter().zip(flight.velocities) {
                    *change = change.max(world.velocity(body).distance(velocity));
                }
            }
        }
        for (flight, change) in flights.iter().zip(changes) {
            let Some(depth) = met(&flight.paths, flight.bulge) else {
                continue;
            };
            if depth == 0.0 {
                passes.free += 1;
                passes.deflected += usize::from(change > CHANGED);
                passes.worst = passes.worst.max(change);
            } else {
                passes.hits += 1;
                passes.missed += usize::from(change <= CHANGED);
            }
        }
    }
    passes
}

/// The free path of a body in so many seconds.
fn path(world: &World, body: usize, time: f32) -> MovingMesh {
    let bodies = &world.state.input.bodies;
    let slot = &world.state.input.meshes[bodies.mesh[body]].mesh;
    let (frame, center) = (&bodies.frame[body], slot.mass.center.as_dvec3());
    let place = |p: Vec3| frame.rotation * (p.as_dvec3() - center);
    MovingMesh {
        triangles: (0..slot.mesh.triangles().len())
            .map(|t| slot.mesh.corners(t).map(place))
            .collect(),
        center: frame.center,
        travel: bodies.linear_velocity[body].as_dvec3() * f64::from(time),
        turn: bodies.angular_velocity[body].as_dvec3() * f64::from(time),
    }
}

/// Whether two paths meet, by brute force: 0 if their gap stays above 0.1 mm and their `bulge`, the way on which they
/// intersect if that is longer than 5 mm, and `None` for what lies between.
fn met(paths: &[MovingMesh; 2], bulge: f32) -> Option<f64> {
    let least = 1.0e-4 + f64::from(bulge);
    let radius = |path: &MovingMesh| path.triangles.iter().flatten().map(|p| p.length()).fold(0.0, f64::max);
    let [a, b] = paths;
    let speed = (a.travel - b.travel).length() + a.turn.length() * radius(a) + b.turn.length() * radius(b);
    let apart = |t: f64| (a.center + a.travel * t).distance(b.center + b.travel * t) - radius(a) - radius(b);
    let (mut t, mut way) = (0.0, 0.0);
    let mut is_near = false;
    while t < 1.0 {
        let far = apart(t);
        let gap = if far > 0.02 { far } else { distance(paths, t, 0.5) };
        is_near |= gap <= least;
        // No nearer place is passed over, unless they are near anyway.
        let step = if gap == 0.0 { 1.0e-3 } else { gap.max(1.0e-4) } / speed;
        if gap == 0.0 {
            way += step * speed;
        }
        if way > 5.0e-3 {
            return Some(way);
        }
        t += step;
    }
    (!is_near).then_some(0.0)
}

/// Pairs that pass are not deflected, and those that hit are not missed, but for one in so many.
fn check_throws(seed: u64, count: usize, spins: bool, one_in: usize) {
    let passes = throw(seed, count, spins);
    println!("{passes:?}");
    assert!(passes.free.min(passes.hits) > count / 5, "{passes:?}");
    assert!(passes.deflected * one_in <= passes.free, "{passes:?}");
    assert!(passes.missed * one_in <= passes.hits, "{passes:?}");
}

/// No pair may be deflected or missed.
const NONE: usize = usize::MAX / 1_000_000;

#[test]
fn random_pairs_that_do_not_meet_pass_each_other() {
    check_throws(1, 2_000, false, NONE);
}

#[test]
fn random_pairs_that_turn_and_do_not_meet_pass_each_other() {
    check_throws(2, 2_000, true, NONE);
}

#[test]
#[ignore = "minutes"]
fn many_random_pairs_that_do_not_meet_pass_each_other() {
    check_throws(3, 50_000, false, NONE);
}

/// In a collision substep contact points move along lines. A body that turns by a hundredth of a radian while it flies
/// 5 cm leaves them by half a millimetre, so a few pairs that pass or graze at less are taken for the other.
#[test]
#[ignore = "minutes"]
fn many_random_pairs_that_turn_and_do_not_meet_pass_each_other() {
    check_throws(4, 50_000, true, 10_000);
}
