//! The scenes of the benchmark.

use bevy::prelude::*;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::prelude::*;

/// A scene and its number of steps.
pub struct Game {
    pub name: &'static str,
    pub steps: usize,
    pub spawn: fn(&mut World),
}

const fn game(name: &'static str, steps: usize, spawn: fn(&mut World)) -> Game {
    Game { name, steps, spawn }
}

/// All scenes.
pub const GAMES: &[Game] = &[
    game("one body in flight", 128, |world| {
        let cube = mesh(world, &shapes::cube(1.0));
        world.spawn((RigidBody::Dynamic, cube, Transform::default(), LinearVelocity(Vec3::X)));
    }),
    game("one cube on the ground", 128, |world| boxes(world, 1)),
    game("ten cubes on the ground", 128, |world| boxes(world, 10)),
    game("formation of balls at rest", 64, |world| formation(world, &ball(), 0.0)),
    game("formation of balls, 3 m/s", 64, |world| formation(world, &ball(), 3.0)),
    game("formation of balls, 10 m/s", 32, |world| {
        formation(world, &ball(), 10.0)
    }),
    game("formation of balls, 100 m/s", 32, |world| {
        formation(world, &ball(), 100.0)
    }),
    game("formation of tori, 10 m/s", 64, |world| {
        formation(world, &torus(), 10.0)
    }),
    game("formation of tori, 100 m/s", 64, |world| {
        formation(world, &torus(), 100.0)
    }),
    game("formation of balls over a terrain, 30 m/s", 32, |world| {
        terrain(world, 64);
        formation(world, &ball(), 30.0);
    }),
    game("swarm of balls that falls for 3 s", 256, |world| {
        swarm(world, &ball(), 46.0)
    }),
    game("swarm of tori that falls for 3 s", 256, |world| {
        swarm(world, &torus(), 46.0)
    }),
    game("pile of tori, awake", 256, pile),
    game("pile of tori, awake, and a far bullet", 256, |world| {
        pile(world);
        far_bullet(world);
    }),
    game("pile of tori, awake, and a far plate that turns", 256, |world| {
        pile(world);
        far_plate(world);
    }),
    game("pile of tori, awake, and a far ball between two walls", 256, |world| {
        pile(world);
        far_impacts(world);
    }),
    game("pile of tori, asleep after a while", 1500, sleeping_pile),
    game("pile of tori, asleep after a while, and a far bullet", 1500, |world| {
        sleeping_pile(world);
        far_bullet(world);
    }),
    game("500 bodies of 8 cubes in flight", 64, |world| {
        cubes_of_eight(world, true)
    }),
    game("4,000 cubes at the same places that do not collide", 64, |world| {
        cubes_of_eight(world, false)
    }),
    game("10,000 cubes in flight, far from each other", 64, |world| {
        let cube = mesh(world, &shapes::cube(1.0));
        for place in lattice(10_000, 3.0) {
            world.spawn((RigidBody::Dynamic, cube.clone(), place));
        }
    }),
    game("ten cubes in flight, none static", 64, |world| level(world, 0)),
    game("ten cubes in flight, 1,000 static", 64, |world| level(world, 1_000)),
    game("ten cubes in flight, 100,000 static", 256, |world| {
        level(world, 100_000)
    }),
    game("4,000 cubes asleep on a floor, ten in flight", 128, sleepers),
    game("one cube spawned and one despawned a step, 20,000 static", 64, spawning),
    game("4,000 cubes asleep, and a ball that rolls between them", 256, |world| {
        sleepers(world);
        let ball = mesh(world, &ball());
        let push = move |mut steps: Local<u32>, mut commands: Commands| {
            *steps += 1;
            if *steps == 64 {
                let place = Transform::from_xyz(1.0, 0.3, -1.0);
                let rolls = LinearVelocity(Vec3::new(0.2, 0.0, 20.0));
                commands.spawn((RigidBody::Dynamic, ball.clone(), place, rolls));
            }
        };
        world.resource_mut::<Schedules>().add_systems(FixedUpdate, push);
    }),
    game(
        "one cube spawned and one despawned a step, 4,000 asleep",
        128,
        |world| {
            sleepers(world);
            spawner(world);
        },
    ),
    game("one static cube moved a step, 100,000 static", 128, |world| {
        level(world, 100_000);
        let moved = |mut cubes: Query<(&RigidBody, &mut Transform)>, mut at: Local<usize>| {
            *at += 1;
            let mut fixed = cubes.iter_mut().filter(|(kind, _)| **kind == RigidBody::Static);
            if let Some((_, mut place)) = fixed.nth(37 * *at) {
                place.translation.y += 0.1;
            }
        };
        world.resource_mut::<Schedules>().add_systems(FixedUpdate, moved);
    }),
    game("ball in a room", 256, |world| {
        let room = shapes::cube(4.0);
        let inward = room.triangles().iter().map(|&[a, b, c]| [a, c, b]).collect();
        let room = TriMesh::new(room.vertices().to_vec(), inward).expect("a room");
        let room = mesh(world, &room);
        world.spawn((RigidBody::Static, room, Transform::default()));
        let ball = mesh(world, &ball());
        world.spawn((
            RigidBody::Dynamic,
            ball,
            Transform::default(),
            LinearVelocity(Vec3::new(3.0, 0.0, 1.0)),
        ));
    }),
    game("first step on a terrain of 524,288 triangles", 1, |world| {
        terrain(world, 512);
        let ball = mesh(world, &ball());
        world.spawn((RigidBody::Dynamic, ball, Transform::from_xyz(0.0, 20.0, 0.0)));
    }),
];

fn mesh(world: &mut World, mesh: &TriMesh) -> MeshCollider {
    let baked = CollisionMesh::new(mesh);
    MeshCollider(world.resource_mut::<Assets<CollisionMesh>>().add(baked))
}

/// So many static cubes, and ten that fall above them.
fn level(world: &mut World, count: usize) {
    let cube = mesh(world, &shapes::cube(1.0));
    for place in lattice(count, 3.0) {
        world.spawn((RigidBody::Static, cube.clone(), place));
    }
    for i in 0..10 {
        let place = Transform::from_xyz(3.0 * i as f32, 400.0, 0.0);
        world.spawn((RigidBody::Dynamic, cube.clone(), place));
    }
}

/// Cubes that fall asleep on a floor, and ten that fall above them.
fn sleepers(world: &mut World) {
    let cube = mesh(world, &shapes::cube(1.0));
    let floor = Transform::from_scale(Vec3::new(400.0, 1.0, 400.0)).with_translation(Vec3::new(60.0, -0.501, 60.0));
    world.spawn((RigidBody::Static, cube.clone(), floor));
    for i in 0..4_000 {
        let place = Transform::from_xyz(2.0 * (i % 64) as f32, 0.5005, 2.0 * (i / 64) as f32);
        world.spawn((RigidBody::Dynamic, cube.clone(), place));
    }
    for i in 0..10 {
        let place = Transform::from_xyz(3.0 * i as f32, 400.0, 0.0);
        world.spawn((RigidBody::Dynamic, cube.clone(), place));
    }
}

/// A level in which a cube comes and another goes in every step.
fn spawning(world: &mut World) {
    level(world, 20_000);
    spawner(world);
}

fn spawner(world: &mut World) {
    let cube = mesh(world, &shapes::cube(1.0));
    let spawn = move |mut commands: Commands, mut last: Local<Option<Entity>>| {
        if let Some(last) = last.take() {
            commands.entity(last).despawn();
        }
        let place = Transform::from_xyz(0.0, 500.0, 0.0);
        *last = Some(commands.spawn((RigidBody::Dynamic, cube.clone(), place)).id());
    };
    world.resource_mut::<Schedules>().add_systems(FixedUpdate, spawn);
}

/// A ball of 1,280 triangles with a diameter of 0.5 m.
fn ball() -> TriMesh {
    shapes::ball(0.25, 3)
}

/// A torus of 240 triangles with a diameter of 0.5 m.
fn torus() -> TriMesh {
    let torus = shapes::torus_240();
    let vertices = torus.vertices().iter().map(|v| *v * 0.25).collect();
    TriMesh::new(vertices, torus.triangles().to_vec()).expect("a torus")
}

fn boxes(world: &mut World, count: usize) {
    world.spawn(PlaneCollider::through(Vec3::ZERO, Vec3::Y));
    let cube = mesh(world, &shapes::cube(1.0));
    for i in 0..count {
        let place = Transform::from_xyz(1.5 * i as f32, 1.0, 0.0);
        world.spawn((RigidBody::Dynamic, cube.clone(), place));
    }
}

/// 27 bodies with the same velocity, separated by a fifth of their size.
fn formation(world: &mut World, shape: &TriMesh, speed: f32) {
    world.insert_resource(Gravity(Vec3::ZERO));
    block(world, shape, 20.0, LinearVelocity(Vec3::new(0.6, 0.0, 0.8) * speed));
}

/// A block of 27 bodies, dropped above the ground.
fn swarm(world: &mut World, shape: &TriMesh, height: f32) {
    world.spawn(PlaneCollider::through(Vec3::ZERO, Vec3::Y));
    block(world, shape, height, LinearVelocity::default());
}

fn block(world: &mut World, shape: &TriMesh, height: f32, velocity: LinearVelocity) {
    let mesh = mesh(world, shape);
    for i in 0..27 {
        let at = Vec3::new((i % 3) as f32, (i / 3 % 3) as f32, (i / 9) as f32) * 0.6;
        let place = Transform::from_translation(at + Vec3::Y * height);
        world.spawn((RigidBody::Dynamic, mesh.clone(), place, velocity));
    }
}

/// Places on a lattice.
fn lattice(count: usize, distance: f32) -> impl Iterator<Item = Transform> {
    let side = (count as f32).cbrt().ceil() as usize;
    let place = move |i: usize| Vec3::new((i % side) as f32, (i / side % side) as f32, (i / side / side) as f32);
    (0..count).map(move |i| Transform::from_translation(distance * place(i)))
}

/// 500 groups of eight cubes each: bodies of eight colliders, or cubes that do not collide. Each group, or cube, rotates.
fn cubes_of_eight(world: &mut World, joined: bool) {
    let cube = mesh(world, &shapes::cube(1.0));
    let spin = AngularVelocity(Vec3::Y);
    let none = CollisionLayers {
        memberships: 0,
        filters: 0,
    };
    for place in lattice(500, 8.0) {
        let body = joined.then(|| world.spawn((RigidBody::Dynamic, place, spin)).id());
        for own in lattice(8, 1.1) {
            match body {
                Some(body) => world.spawn((cube.clone(), own, ChildOf(body))),
                None => world.spawn((RigidBody::Dynamic, cube.clone(), place * own, spin, none)),
            };
        }
    }
}

/// A ball of 5 cm in flight at 100 m/s, far from everything else.
fn far_bullet(world: &mut World) {
    let mesh = mesh(world, &shapes::ball(0.025, 2));
    let place = Transform::from_xyz(0.0, 1000.0, 0.0);
    let velocity = LinearVelocity(Vec3::Y * 100.0);
    world.spawn((RigidBody::Dynamic, mesh, place, GravityScale(0.0), velocity));
}

/// A plate of 1 cm thickness that turns in flight, far from everything else.
fn far_plate(world: &mut World) {
    let mesh = mesh(world, &shapes::cube(1.0));
    let place = Transform::from_xyz(0.0, 1000.0, 0.0).with_scale(Vec3::new(1.0, 0.01, 1.0));
    let spin = AngularVelocity(Vec3::X * 10.0);
    world.spawn((RigidBody::Dynamic, mesh, place, GravityScale(0.0), spin));
}

/// A ball of 5 cm that flies between two walls and hits one in nearly every step, far from everything else.
fn far_impacts(world: &mut World) {
    let [ball, wall] = [shapes::ball(0.025, 2), shapes::cube(1.0)].map(|shape| mesh(world, &shape));
    for side in [-0.5, 0.5] {
        let place = Transform::from_xyz(side, 1000.0, 0.0).with_scale(Vec3::new(0.1, 1.0, 1.0));
        world.spawn((RigidBody::Static, wall.clone(), place));
    }
    let place = Transform::from_xyz(0.0, 1000.0, 0.0);
    let velocity = LinearVelocity(Vec3::X * 60.0);
    let elastic = (Restitution::new(1.0), Friction::new(0.0), GravityScale(0.0));
    world.spawn((RigidBody::Dynamic, ball, place, velocity, elastic));
}

/// 108 tori that fall into a pile and rest there, awake.
fn pile(world: &mut World) {
    pile_of(world, SleepingDisabled);
}

/// A pile of 108 tori that falls asleep after some seconds.
fn sleeping_pile(world: &mut World) {
    pile_of(world, ());
}

fn pile_of(world: &mut World, sleeping: impl Bundle + Copy) {
    world.spawn(PlaneCollider::through(Vec3::ZERO, Vec3::Y));
    for normal in [Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z] {
        world.spawn(PlaneCollider::through(-1.2 * normal, normal));
    }
    let mesh = mesh(world, &torus());
    for i in 0..108 {
        let layer = (i / 9) as f32;
        let at =
            Vec3::new((i % 3) as f32 - 1.0, 0.5 + 0.6 * layer, (i / 3 % 3) as f32 - 1.0) * Vec3::new(0.7, 1.0, 0.7);
        let place = Transform::from_translation(at).with_rotation(Quat::from_rotation_x(i as f32));
        world.spawn((RigidBody::Dynamic, mesh.clone(), place, sleeping));
    }
}

/// A hilly terrain of `2 * cells * cells` triangles, 100 m wide.
fn terrain(world: &mut World, cells: usize) {
    let at = |i: usize| i as f32 / cells as f32 * 100.0 - 50.0;
    let point = |i: usize| {
        let (x, z) = (at(i % (cells + 1)), at(i / (cells + 1)));
        Vec3::new(x, (0.3 * x).sin() + (0.2 * z).cos(), z)
    };
    let vertices = (0..(cells + 1) * (cells + 1)).map(point).collect();
    let corner = |x: usize, z: usize| (z * (cells + 1) + x) as u32;
    let cell = |i: usize| {
        let (x, z) = (i % cells, i / cells);
        let [a, b, c, d] = [corner(x, z), corner(x, z + 1), corner(x + 1, z + 1), corner(x + 1, z)];
        [[a, b, c], [a, c, d]]
    };
    let triangles = (0..cells * cells).flat_map(cell).collect();
    let hills = TriMesh::new(vertices, triangles).expect("hills");
    let mesh = mesh(world, &hills);
    world.spawn((RigidBody::Static, mesh, Transform::default()));
}
