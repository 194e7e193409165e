//! Characters: what they climb, slide along, ride on and land on.

use crate::app::{DT, Sim, assert_near};
use bevy::prelude::*;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::prelude::*;

const RADIUS: f32 = 0.3;
const HALF_LENGTH: f32 = 0.5;
/// From the centre of the capsule to its lowest point.
const DEPTH: f32 = RADIUS + HALF_LENGTH;
const SKIN: f32 = 0.01;

fn world() -> Sim {
    let mut sim = Sim::new();
    sim.world().insert_resource(Gravity(Vec3::NEG_Y * 9.81));
    sim
}

/// A character at a place, given by its feet.
fn spawn(sim: &mut Sim, feet: Vec3) -> Entity {
    let at = Transform::from_translation(feet + Vec3::Y * (DEPTH + SKIN));
    sim.spawn((Character::new(RADIUS, HALF_LENGTH), at))
}

fn feet(sim: &Sim, character: Entity) -> Vec3 {
    sim.position(character) - Vec3::Y * (DEPTH + SKIN)
}

fn ground(sim: &Sim, character: Entity) -> Option<GroundContact> {
    *sim.get::<CharacterGround>(character)
}

/// Sets the horizontal velocity, as a game does in each step.
fn go(sim: &mut Sim, character: Entity, velocity: Vec3) {
    let mut world = sim.world().entity_mut(character);
    let mut character = world.get_mut::<Character>().unwrap();
    character.velocity.x = velocity.x;
    character.velocity.z = velocity.z;
}

/// One step at this velocity. Returns the way.
fn walk(sim: &mut Sim, character: Entity, velocity: Vec3) -> Vec3 {
    let before = sim.position(character);
    go(sim, character, velocity);
    sim.step(1);
    sim.position(character) - before
}

/// A static box between two corners.
fn block(sim: &mut Sim, low: Vec3, high: Vec3) -> Entity {
    let cube = sim.mesh(&shapes::cube(1.0));
    sim.spawn((
        cube,
        Transform::from_translation(0.5 * (low + high)).with_scale(high - low),
    ))
}

/// A grid of triangles over a square about the origin.
fn grid(size: f32, cells: u32, height: impl Fn(f32, f32) -> f32) -> TriMesh {
    let at = |i: u32| (i as f32 / cells as f32 - 0.5) * size;
    let corner = |k: u32| {
        let (x, z) = (at(k % (cells + 1)), at(k / (cells + 1)));
        Vec3::new(x, height(x, z), z)
    };
    let vertices = (0..(cells + 1) * (cells + 1)).map(corner).collect();
    let faces = (0..cells * cells).flat_map(|k| {
        let a = k / cells * (cells + 1) + k % cells;
        let (b, c) = (a + 1, a + cells + 1);
        [[a, c, b], [b, c, c + 1]]
    });
    TriMesh::new(vertices, faces.collect()).unwrap()
}

/// A slope that rises along x from the origin.
fn slope(sim: &mut Sim, degrees: f32) -> Entity {
    let turn = Quat::from_rotation_z(degrees.to_radians());
    let cube = sim.mesh(&shapes::cube(1.0));
    let center = turn * Vec3::NEG_Y;
    sim.spawn((
        cube,
        Transform::from_translation(center)
            .with_rotation(turn)
            .with_scale(Vec3::new(40.0, 2.0, 10.0)),
    ))
}

pub fn climbs_stairs_and_comes_down_again() {
    for (rise, tread) in [(0.15, 0.3), (0.25, 0.25), (0.29, 0.5)] {
        let mut sim = world();
        block(&mut sim, Vec3::new(-10.0, -1.0, -3.0), Vec3::new(30.0, 0.0, 3.0));
        let count = 10;
        let low = |i: i32| Vec3::new(1.0 + i as f32 * tread, 0.0, -3.0);
        for i in 0..count {
            let high = Vec3::new(20.0, rise * (i + 1) as f32, 3.0);
            block(&mut sim, low(i), high);
        }
        let character = spawn(&mut sim, Vec3::ZERO);
        let top = rise * count as f32;
        let speed = 2.0;
        let mut highest = 0.0_f32;
        for _ in 0..(4.0 / DT) as usize {
            let way = walk(&mut sim, character, Vec3::X * speed);
            let height = feet(&sim, character).y;
            assert!(ground(&sim, character).is_some(), "in the air at {height}");
            assert!(way.y > -1e-3, "slips back at {height}");
            assert!((way.x - speed * DT).abs() < 1e-3, "{way} at {}", feet(&sim, character));
            highest = highest.max(height);
        }
        assert!(
            (feet(&sim, character).y - top).abs() < 2e-3,
            "{}",
            feet(&sim, character)
        );
        assert!(highest < top + 2e-3);
        for _ in 0..(7.0 / DT) as usize {
            walk(&mut sim, character, Vec3::NEG_X * speed);
            assert!(ground(&sim, character).is_some(), "flies at {}", feet(&sim, character));
        }
        assert!(feet(&sim, character).y.abs() < 2e-3);
        assert!(feet(&sim, character).x < -1.0);
    }
}

pub fn a_step_that_is_too_high_stops_it() {
    let mut sim = world();
    block(&mut sim, Vec3::new(-10.0, -1.0, -3.0), Vec3::new(10.0, 0.0, 3.0));
    block(&mut sim, Vec3::new(1.0, 0.0, -3.0), Vec3::new(10.0, 0.35, 3.0));
    let character = spawn(&mut sim, Vec3::ZERO);
    for _ in 0..128 {
        walk(&mut sim, character, Vec3::X * 3.0);
    }
    assert!(feet(&sim, character).y < 0.01 && feet(&sim, character).x < 0.8);
    assert_near(sim.get::<Character>(character).velocity, Vec3::ZERO, 1e-5);
}

pub fn slides_along_a_wall_and_stops_in_a_corner() {
    let mut sim = world();
    sim.spawn(PlaneCollider::through(Vec3::ZERO, Vec3::Y));
    block(&mut sim, Vec3::new(1.0, -1.0, -50.0), Vec3::new(2.0, 3.0, 5.0));
    block(&mut sim, Vec3::new(-5.0, -1.0, 5.0), Vec3::new(2.0, 3.0, 6.0));
    let character = spawn(&mut sim, Vec3::new(0.0, 0.0, -10.0));
    for _ in 0..64 {
        walk(&mut sim, character, Vec3::new(3.0, 0.0, 2.0));
    }
    for _ in 0..64 {
        let way = walk(&mut sim, character, Vec3::new(3.0, 0.0, 2.0));
        assert_near(way, Vec3::Z * 2.0 * DT, 2e-5);
        assert_near(sim.get::<Character>(character).velocity, Vec3::Z * 2.0, 1e-4);
    }
    let beside = 1.0 - RADIUS - SKIN;
    assert!((sim.position(character).x - beside).abs() < 1e-3);
    for _ in 0..64 * 8 {
        walk(&mut sim, character, Vec3::new(3.0, 0.0, 2.0));
    }
    assert_near(feet(&sim, character), Vec3::new(beside, 0.0, 5.0 - RADIUS - SKIN), 2e-3);
    assert_near(sim.get::<Character>(character).velocity, Vec3::ZERO, 1e-5);
}

pub fn stands_still_on_a_slope_and_walks_up_at_full_speed() {
    let mut sim = world();
    slope(&mut sim, 30.0);
    let character = spawn(&mut sim, Vec3::Y * 0.2);
    sim.step(64);
    let before = sim.position(character);
    sim.step(64 * 4);
    assert_eq!(sim.position(character), before);
    let normal = ground(&sim, character).unwrap().normal;
    assert_near(normal, Vec3::new(-0.5, 0.75_f32.sqrt(), 0.0), 1e-5);
    for _ in 0..64 {
        let way = walk(&mut sim, character, Vec3::X * 3.0);
        assert_near(way, Vec3::new(1.0, 30.0_f32.to_radians().tan(), 0.0) * 3.0 * DT, 1e-3);
    }
}

pub fn slides_down_a_steep_slope_and_does_not_climb_it() {
    let mut sim = world();
    slope(&mut sim, 60.0);
    sim.spawn(PlaneCollider::through(Vec3::ZERO, Vec3::Y));
    let character = spawn(&mut sim, Vec3::NEG_X);
    for _ in 0..64 * 3 {
        walk(&mut sim, character, Vec3::X * 4.0);
        assert!(feet(&sim, character).y < 0.02, "{}", feet(&sim, character));
    }
    // Who lands on it slides down, faster and faster.
    let character = spawn(&mut sim, Vec3::new(3.0, 9.0, 0.0));
    sim.step(64);
    let (mut fall, mut steps) = (0.0, 0);
    while feet(&sim, character).y > 0.5 {
        assert!(ground(&sim, character).is_none());
        let height = sim.position(character).y;
        sim.step(1);
        let further = height - sim.position(character).y;
        assert!(further > fall - 2e-3, "{further} {fall}");
        (fall, steps) = (further, steps + 1);
    }
    assert!(steps > 16 && fall > 6.0 * DT, "{steps} {fall}");
    sim.step(16);
    assert!(ground(&sim, character).is_some());
    // Pressed against it, slower.
    let character = spawn(&mut sim, Vec3::new(3.0, 7.0, 0.0));
    sim.step(32);
    for _ in 0..64 {
        assert!(walk(&mut sim, character, Vec3::X * 4.0).y < -0.3 * DT);
    }
}

pub fn rides_a_lift_and_a_turning_platform() {
    // Moved by its velocity, and by its Transform.
    for by_transform in [false, true] {
        let mut sim = world();
        let cube = sim.mesh(&shapes::cube(1.0));
        let lift = sim.spawn((
            RigidBody::Kinematic,
            cube.clone(),
            Transform::from_xyz(0.0, -0.5, 0.0).with_scale(Vec3::new(3.0, 1.0, 3.0)),
        ));
        let drive = |sim: &mut Sim, velocity: Vec3| {
            if by_transform {
                let at = sim.get::<Transform>(lift);
                sim.set(lift, at.with_translation(at.translation + velocity * DT));
            } else {
                sim.set(lift, LinearVelocity(velocity));
            }
            sim.step(1);
        };
        let character = spawn(&mut sim, Vec3::new(0.5, 0.0, 0.4));
        sim.step(8);
        for velocity in [Vec3::Y, Vec3::X, Vec3::NEG_Y, Vec3::new(1.0, 2.0, -1.0)].map(|velocity| 1.5 * velocity) {
            let apart = sim.position(character) - sim.position(lift);
            for _ in 0..64 {
                drive(&mut sim, velocity);
                let ground = ground(&sim, character).expect("on the lift");
                assert_eq!(ground.body, lift);
                assert_near(ground.velocity, velocity, 1e-2);
            }
            assert_near(sim.position(character) - sim.position(lift), apart, 5e-3);
            assert_near(sim.get::<Character>(character).velocity, Vec3::ZERO, 1e-2);
        }
        // Who jumps takes along the velocity of the lift.
        sim.world().get_mut::<Character>(character).unwrap().velocity.y = 3.0;
        drive(&mut sim, 1.5 * Vec3::new(1.0, 2.0, -1.0));
        assert!(ground(&sim, character).is_none());
        assert!((sim.get::<Character>(character).velocity.x - 1.5).abs() < 2e-2);
        sim.world().despawn(lift);
        sim.step(1);
    }
    let mut sim = world();
    let cube = sim.mesh(&shapes::cube(1.0));
    let table = sim.spawn((
        RigidBody::Kinematic,
        cube,
        Transform::from_xyz(0.0, -0.5, 0.0).with_scale(Vec3::new(8.0, 1.0, 8.0)),
        AngularVelocity(Vec3::Y),
    ));
    let character = spawn(&mut sim, Vec3::X * 2.0);
    for _ in 0..8 {
        walk(&mut sim, character, Vec3::ZERO);
    }
    let start = sim.get::<Transform>(table).rotation.inverse() * sim.position(character);
    for _ in 0..64 * 5 {
        sim.step(1);
        let place = sim.get::<Transform>(table).rotation.inverse() * sim.position(character);
        assert_near(place, start, 5e-3);
    }
    let ground = ground(&sim, character).unwrap();
    assert_near(ground.angular_velocity, Vec3::Y, 1e-2);
    assert!((ground.velocity.length() - 2.0).abs() < 0.02);
}

pub fn ground_that_is_placed_does_not_take_it_along() {
    for kind in [RigidBody::Kinematic, RigidBody::Dynamic] {
        let mut sim = world();
        let cube = sim.mesh(&shapes::cube(1.0));
        let place = Transform::from_xyz(0.0, -0.5, 0.0).with_scale(Vec3::new(3.0, 1.0, 3.0));
        let ground_body = sim.spawn((kind, cube, place, GravityScale(0.0)));
        let character = spawn(&mut sim, Vec3::new(0.5, 0.0, 0.4));
        sim.step(8);
        assert_eq!(ground(&sim, character).unwrap().body, ground_body);
        let before = sim.position(character);
        sim.set(ground_body, place.with_translation(Vec3::new(-20.0, -0.5, 0.0)));
        if kind == RigidBody::Kinematic {
            sim.set(ground_body, Teleport);
        }
        sim.step(1);
        assert_near(sim.position(character), before, 0.01);
        assert!(ground(&sim, character).is_none());
        let falls = Vec3::NEG_Y * 9.81 * DT;
        assert_near(sim.get::<Character>(character).velocity, falls, 1e-4);
    }
}

pub fn a_character_that_is_placed_leaves_its_ground() {
    let mut sim = world();
    let cube = sim.mesh(&shapes::cube(1.0));
    let ship = sim.spawn((
        RigidBody::Kinematic,
        cube,
        Transform::from_xyz(0.0, -0.5, 0.0).with_scale(Vec3::new(30.0, 1.0, 30.0)),
        LinearVelocity(Vec3::X * 10.0),
    ));
    block(&mut sim, Vec3::new(-5.0, 49.0, -5.0), Vec3::new(5.0, 50.0, 5.0));
    let pier = Transform::from_xyz(0.0, 50.0 + DEPTH + SKIN, 0.0);
    let goes_ashore = |sim: &mut Sim, character: Entity| {
        sim.set(character, pier);
        for _ in 0..4 {
            sim.step(1);
            assert_near(sim.position(character), pier.translation, 0.01);
            assert_near(sim.get::<Character>(character).velocity, Vec3::ZERO, 0.2);
        }
        assert_ne!(ground(sim, character).unwrap().body, ship);
    };
    let [walks, drives] = [-1.0, 1.0].map(|z| spawn(&mut sim, Vec3::Z * z));
    sim.step(4);
    for character in [walks, drives] {
        go(&mut sim, character, Vec3::ZERO);
    }
    sim.step(20);
    for character in [walks, drives] {
        assert_near(ground(&sim, character).unwrap().velocity, Vec3::X * 10.0, 1e-2);
    }
    goes_ashore(&mut sim, walks);
    sim.set(drives, RigidBodyDisabled);
    sim.step(50);
    assert!(ground(&sim, drives).is_none());
    sim.world().entity_mut(drives).remove::<RigidBodyDisabled>();
    goes_ashore(&mut sim, drives);
}

pub fn a_lift_that_meets_a_wall_leaves_it_there() {
    let mut sim = world();
    let cube = sim.mesh(&shapes::cube(1.0));
    let lift = sim.spawn((
        RigidBody::Kinematic,
        cube,
        Transform::from_xyz(0.0, -0.5, 0.0).with_scale(Vec3::new(6.0, 1.0, 6.0)),
        LinearVelocity(Vec3::X),
    ));
    block(&mut sim, Vec3::new(1.5, 0.05, -9.0), Vec3::new(9.0, 4.0, 9.0));
    let character = spawn(&mut sim, Vec3::ZERO);
    for _ in 0..64 * 3 {
        walk(&mut sim, character, Vec3::ZERO);
    }
    assert_eq!(ground(&sim, character).unwrap().body, lift);
    assert_near(feet(&sim, character), Vec3::X * (1.5 - RADIUS - SKIN), 2e-3);
}

pub fn crosses_hills_without_a_bump() {
    let height = |x: f32, z: f32| 1.5 * (0.25 * x).sin() * (0.2 * z + 0.5).cos() + 0.3 * (0.8 * x + 0.5 * z).sin();
    let steepest = 0.25 * 1.5 + 0.2 * 1.5 + 0.3 * (0.8 + 0.5);
    let mut sim = world();
    let hills = grid(140.0, 100, height);
    assert!(hills.triangles().len() > 10_000);
    let hills = sim.mesh(&hills);
    sim.spawn((hills, Transform::default()));
    let speed = 5.0;
    for heading in [0.0, 0.7, std::f32::consts::FRAC_PI_4] {
        let way = Vec3::new(f32::cos(heading), 0.0, f32::sin(heading));
        let start = -50.0 * way;
        let character = spawn(&mut sim, start + Vec3::Y * (height(start.x, start.z) + 0.5));
        sim.step(64);
        let begin = sim.position(character);
        for _ in 0..(100.0 / speed / DT) as usize {
            let step = walk(&mut sim, character, way * speed);
            let at = feet(&sim, character);
            assert!(ground(&sim, character).is_some(), "flies at {at}");
            let forward = step.dot(way);
            assert!((forward - speed * DT).abs() < 1e-4, "{forward} at {at}");
            assert!(step.y.abs() < speed * DT * steepest + 2e-3, "{} at {at}", step.y / DT);
            // A capsule on a concave slope is higher than the slope below its centre.
            let above = at.y - height(at.x, at.z);
            assert!((-0.25..0.3).contains(&above), "{above} above the hill at {at}");
        }
        let gone = sim.position(character) - begin;
        assert!((gone.dot(way) - 100.0).abs() < 0.2, "{gone}");
        assert!((gone - gone.dot(way) * way).with_y(0.0).length() < 0.01);
        sim.world().despawn(character);
    }
}

pub fn does_not_catch_on_the_edges_of_a_flat_floor() {
    let mut sim = world();
    let tiles = sim.mesh(&grid(10.0, 20, |_, _| 0.0));
    // Two floors with a common seam, and a plane.
    sim.spawn((tiles.clone(), Transform::from_xyz(5.0, 0.0, 0.0)));
    sim.spawn((tiles, Transform::from_xyz(-5.0, 0.0, 0.0)));
    sim.spawn(PlaneCollider::through(Vec3::new(0.0, 0.0, 20.0), Vec3::Y));
    for k in 0..12 {
        let angle = k as f32 * std::f32::consts::TAU / 12.0 + 0.05 * (k / 4) as f32;
        let way = Vec3::new(angle.cos(), 0.0, angle.sin());
        let character = spawn(&mut sim, -4.0 * way);
        sim.step(4);
        let height = sim.position(character).y;
        for _ in 0..128 {
            let step = walk(&mut sim, character, way * 4.0);
            assert_near(step, way * 4.0 * DT, 1e-5);
            assert!((sim.position(character).y - height).abs() < 2e-4);
        }
        sim.world().despawn(character);
    }
}

pub fn falls_lands_and_bumps_its_head() {
    let mut sim = world();
    sim.spawn(PlaneCollider::through(Vec3::ZERO, Vec3::Y));
    block(&mut sim, Vec3::new(-5.0, 2.5, -5.0), Vec3::new(5.0, 3.0, 5.0));
    let character = spawn(&mut sim, Vec3::Y * 0.5);
    sim.step(8);
    assert!(ground(&sim, character).is_none());
    let fallen = -0.5 * 9.81 * DT * DT * 8.0 * 9.0;
    assert!((feet(&sim, character).y - 0.5 - fallen).abs() < 1e-4);
    sim.step(64);
    assert!(ground(&sim, character).is_some());
    assert!(feet(&sim, character).y.abs() < 1e-3);
    assert_eq!(sim.get::<Character>(character).velocity, Vec3::ZERO);
    sim.world().get_mut::<Character>(character).unwrap().velocity = Vec3::new(1.0, 6.0, 0.0);
    let mut highest = 0.0_f32;
    for _ in 0..96 {
        sim.step(1);
        highest = highest.max(sim.position(character).y + DEPTH);
    }
    assert!((highest - 2.49).abs() < 2e-3, "{highest}");
    assert!(ground(&sim, character).is_some());
    assert!((sim.get::<Character>(character).velocity - Vec3::X).length() < 1e-4);
}

pub fn comes_out_of_what_it_was_spawned_in() {
    let mut sim = world();
    let floor = block(&mut sim, Vec3::new(-5.0, -1.0, -5.0), Vec3::new(5.0, 0.0, 5.0));
    let wall = block(&mut sim, Vec3::new(1.0, -1.0, -5.0), Vec3::new(2.0, 4.0, 5.0));
    for start in [Vec3::NEG_Y * 0.2, Vec3::NEG_Y * 0.6, Vec3::new(0.8, -0.1, 0.0)] {
        let character = spawn(&mut sim, start);
        sim.step(16);
        assert_eq!(ground(&sim, character).unwrap().collider, floor);
        assert!(feet(&sim, character).y.abs() < 2e-3, "{}", feet(&sim, character));
        assert!(feet(&sim, character).x < 1.0 - RADIUS);
        sim.world().despawn(character);
    }
    sim.world().despawn(wall);
}

pub fn comes_out_of_a_cube_wherever_it_is_in_it() {
    let mut sim = Sim::new();
    let cube = sim.mesh(&shapes::cube(1.0));
    sim.spawn((cube, Transform::from_rotation(Quat::from_rotation_x(0.4))));
    let mut rng = fastrand::Rng::with_seed(5);
    let mut random = || 2.0 * rng.f32() - 1.0;
    let mut characters = Vec::new();
    for _ in 0..300 {
        let at = 0.8 * Vec3::new(random(), random(), random());
        let turn = Quat::from_scaled_axis(3.0 * Vec3::new(random(), random(), random()));
        let at = Transform::from_translation(at).with_rotation(turn);
        characters.push(sim.spawn((Character::new(0.1, 0.4), at)));
    }
    sim.step(4);
    let shape = QueryShape::Capsule {
        radius: 0.1,
        half_length: 0.4,
    };
    for character in characters {
        let at = sim.get::<Transform>(character);
        let mut state = bevy::ecs::system::SystemState::<SpatialQuery>::new(sim.world());
        let world = state.get(sim.app.world()).unwrap();
        let found = world.overlapping(&shape, at.translation, at.rotation, &SpatialQueryFilter::default());
        assert!(found.is_empty(), "{at:?}");
        assert!(at.translation.length() < 2.0);
    }
}

pub fn pushes_a_crate_and_ignores_itself() {
    let mut sim = world();
    sim.spawn(PlaneCollider::through(Vec3::ZERO, Vec3::Y));
    let (wide, small) = (sim.mesh(&shapes::cube(1.0)), sim.mesh(&shapes::cube(0.5)));
    let pushed = sim.spawn((RigidBody::Dynamic, small, Transform::from_xyz(2.0, 0.26, 0.0)));
    let character = spawn(&mut sim, Vec3::ZERO);
    sim.set(character, RigidBody::Kinematic);
    let scale = Vec3::new(0.66, 1.4, 0.66);
    sim.spawn((wide, Transform::from_scale(scale), ChildOf(character)));
    for _ in 0..64 * 3 {
        walk(&mut sim, character, Vec3::X * 1.5);
    }
    assert!(sim.position(pushed).x > 3.0, "{}", sim.position(pushed));
    assert!(sim.position(character).x > 2.0, "{}", sim.position(character));
    assert!(sim.position(character).x < sim.position(pushed).x - 0.3);
    assert!(feet(&sim, character).y.abs() < 0.02);
}

pub fn bad_numbers_stop_it() {
    let mut sim = world();
    sim.spawn(PlaneCollider::through(Vec3::ZERO, Vec3::Y));
    let character = spawn(&mut sim, Vec3::Y);
    let before = sim.position(character);
    let good = sim.get::<Character>(character);
    let bad = [
        Character {
            velocity: Vec3::NAN,
            ..good.clone()
        },
        Character {
            radius: 0.0,
            ..good.clone()
        },
        Character {
            half_length: f32::INFINITY,
            ..good.clone()
        },
    ];
    for bad in bad {
        sim.set(character, bad);
        sim.step(3);
        assert_eq!(sim.position(character), before);
    }
    let odd = Character {
        step_height: f32::NAN,
        snap_distance: -1.0,
        skin: -1.0,
        max_slope: 9.0,
        ..good
    };
    sim.set(character, odd);
    sim.step(64);
    assert!(ground(&sim, character).is_some());
}

pub fn it_follows_the_physics_clock_and_repeats_to_the_bit() {
    let run = || {
        let mut sim = world();
        let hills = sim.mesh(&grid(20.0, 30, |x, z| 0.4 * (x + 0.3 * z).sin()));
        sim.spawn((hills, Transform::default()));
        let character = spawn(&mut sim, Vec3::Y);
        for k in 0..256 {
            walk(
                &mut sim,
                character,
                Quat::from_rotation_y(0.02 * k as f32) * Vec3::X * 3.0,
            );
        }
        let at = sim.position(character);
        sim.world().resource_mut::<Time<Physics>>().pause();
        sim.step(4);
        assert_eq!(sim.position(character), at);
        at
    };
    assert_eq!(run(), run());
}
