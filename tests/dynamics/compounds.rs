//! Bodies of several colliders: mass, flight, rest, and continuous collision.

use crate::world::{GAP, World};
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::state::{Body, BodyParams, NewPart, Place};
use bevy_faceoff::types::body::RigidBody;
use bevy_faceoff::types::settings::Response;
use glam::{DMat3, DVec3, Mat3, Quat, Vec3};

/// A collider for a body: mesh, place and scale.
type Collider = (u32, (Vec3, Quat), Vec3);

/// Adds a body of these colliders and returns its number.
fn put(world: &mut World, body: &Body, center: Option<Vec3>, colliders: &[Collider]) -> usize {
    let first = world.state.input.bodies.len();
    let mut parts = Vec::new();
    for &(mesh, place, scale) in colliders {
        let place = Place::from(place);
        let collider = world.put(&body.collider(mesh, &place, scale)) as u32;
        parts.push(NewPart {
            collider,
            place,
            density: body.density,
        });
    }
    let input = &mut world.state.input;
    input.bodies.join(body, center, &parts, &input.meshes).unwrap();
    input.bodies.end_joins();
    first
}

const HANDLE: Vec3 = Vec3::new(0.1, 1.0, 0.1);
const HEAD: Vec3 = Vec3::new(0.5, 0.2, 0.25);

/// A handle, and a head on top of it.
fn hammer(cube: u32) -> [Collider; 2] {
    let top = 0.5 * (HANDLE.y + HEAD.y);
    // A quarter turn exchanges two of the head's axes.
    let turned = Quat::from_rotation_z(std::f32::consts::FRAC_PI_2);
    [
        (cube, (Vec3::new(0.2, 0.3, -0.1), Quat::IDENTITY), HANDLE),
        (
            cube,
            (Vec3::new(0.2, 0.3 + top, -0.1), turned),
            Vec3::new(HEAD.y, HEAD.x, HEAD.z),
        ),
    ]
}

/// Both as one mesh.
fn merged() -> TriMesh {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    let cube = shapes::cube(1.0);
    for (_, (translation, rotation), scale) in hammer(0) {
        let first = vertices.len() as u32;
        vertices.extend(cube.vertices().iter().map(|&v| translation + rotation * (scale * v)));
        triangles.extend(cube.triangles().iter().map(|t| t.map(|i| i + first)));
    }
    TriMesh::new(vertices, triangles).unwrap()
}

fn hammer_at(world: &mut World, position: Vec3, rotation: Quat) -> usize {
    let cube = world.mesh(&shapes::cube(1.0));
    let body = Body::at_rest(cube, position, rotation, Vec3::ONE);
    put(world, &body, None, &hammer(cube))
}

#[test]
fn mass_centre_and_inertia_are_those_of_the_merged_mesh() {
    let mut world = World::new();
    let turn = Quat::from_scaled_axis(Vec3::new(0.4, -1.1, 0.7));
    let number = hammer_at(&mut world, Vec3::new(3.0, -2.0, 1.0), turn);
    let merged = CollisionMesh::new(&merged()).mass;
    let bodies = &world.state.input.bodies;
    let compound = &bodies.compounds[0];
    assert_eq!((compound.number as usize, bodies.parts.len()), (number, 2));
    let mass = 1.0 / bodies.inverse_mass[number];
    assert!((mass / merged.volume - 1.0).abs() < 1.0e-5, "{mass}");
    assert!(compound.local_center.distance(merged.center.as_dvec3()) < 1.0e-6);
    let inertia = merged.inertia(DVec3::ONE, f64::from(merged.volume)).as_mat3();
    let own = compound.local_inverse_inertia.inverse();
    assert!(own.abs_diff_eq(inertia, 1.0e-4 * inertia.x_axis.x), "{own} {inertia}");
    // The tensor in the world is the same for both colliders.
    let axes = Mat3::from_quat(turn);
    let in_world = axes * compound.local_inverse_inertia * axes.transpose();
    for i in 0..2 {
        assert!(bodies.inverse_inertia[i].abs_diff_eq(in_world, 1.0e-3 * in_world.x_axis.x.abs()));
    }
}

#[test]
fn mass_inertia_and_centre_can_be_set() {
    let mut world = World::new();
    let cube = world.mesh(&shapes::cube(1.0));
    let mut body = Body::at_rest(cube, Vec3::ZERO, Quat::IDENTITY, Vec3::ONE);
    body.mass = Some(4.0);
    let center = Vec3::new(0.0, -1.0, 0.0);
    put(
        &mut world,
        &body,
        Some(center),
        &[(cube, (Vec3::ZERO, Quat::IDENTITY), Vec3::ONE)],
    );
    body.inertia = Some(Mat3::from_diagonal(Vec3::new(1.0, 2.0, 3.0)));
    put(
        &mut world,
        &body,
        None,
        &[(cube, (Vec3::ZERO, Quat::IDENTITY), Vec3::ONE)],
    );
    let bodies = &world.state.input.bodies;
    let [lowered, given] = [0, 1].map(|i| bodies.compounds[i]);
    assert_eq!(lowered.center, center.as_dvec3());
    // A cube about an axis at a distance of 1 from its centre: m (1/6 + 1).
    let moments = lowered.local_inverse_inertia.inverse();
    let wanted = 4.0 * Vec3::new(7.0 / 6.0, 1.0 / 6.0, 7.0 / 6.0);
    assert!(moments.abs_diff_eq(Mat3::from_diagonal(wanted), 1.0e-4), "{moments}");
    let wanted = Mat3::from_diagonal(Vec3::new(1.0, 0.5, 1.0 / 3.0));
    assert!(given.local_inverse_inertia.abs_diff_eq(wanted, 1.0e-6));
    assert_eq!([bodies.inverse_mass[0], bodies.inverse_mass[1]], [0.25; 2]);
}

#[test]
fn a_hammer_flies_about_its_centre_of_mass() {
    for response in [Response::Contacts, Response::Impulse] {
        let mut world = World::weightless();
        world.state.input.config.response = response;
        let cube = world.mesh(&shapes::cube(1.0));
        let mut body = Body::at_rest(cube, Vec3::ZERO, Quat::IDENTITY, Vec3::ONE);
        body.linear_velocity = Vec3::new(0.5, 1.0, 0.0);
        body.angular_velocity = Vec3::new(1.0, 0.3, 4.0);
        put(&mut world, &body, None, &hammer(cube));
        let start = world.state.input.bodies.compounds[0];
        let momentum = |world: &World| {
            let compound = &world.state.input.bodies.compounds[0];
            let axes = DMat3::from_quat(compound.rotation);
            let inertia = axes * compound.local_inverse_inertia.as_dmat3().inverse() * axes.transpose();
            inertia * compound.motion.angular_velocity.as_dvec3()
        };
        let before = momentum(&world);
        world.seconds(2);
        let bodies = &world.state.input.bodies;
        let compound = bodies.compounds[0];
        let wanted = start.center + 2.0 * body.linear_velocity.as_dvec3();
        assert!(
            compound.center.distance(wanted) < 1.0e-4,
            "{response:?} {}",
            compound.center
        );
        if response == Response::Contacts {
            assert!((momentum(&world) - before).length() < 1.0e-3 * before.length());
        }
        // Its parts keep their places.
        for (part, (_, (translation, rotation), _)) in bodies.parts.iter().zip(hammer(cube)) {
            let i = part.collider as usize;
            let place = compound.rotation.inverse() * (bodies.frame[i].position - compound.center);
            let wanted = translation.as_dvec3() - compound.local_center;
            assert!(place.distance(wanted) < 1.0e-6, "{place} {wanted}");
            let turned = (compound.motion.rotation * rotation).normalize();
            assert!(turned.angle_between(bodies.rotation[i]) < 1.0e-3);
        }
        assert!(world.state.results.sphere_pairs.is_empty(), "its parts form a pair");
    }
}

/// The lowest corner of a body of cubes.
fn lowest(world: &World) -> f64 {
    let bodies = &world.state.input.bodies;
    let cube = shapes::cube(1.0);
    let corners = bodies.parts.iter().flat_map(|part| {
        let frame = &bodies.frame[part.collider as usize];
        let corner = |v: &Vec3| (frame.position + frame.rotation * (frame.scale * v.as_dvec3())).y;
        cube.vertices().iter().map(corner).collect::<Vec<_>>()
    });
    corners.fold(f64::INFINITY, f64::min)
}

#[test]
fn a_hammer_falls_comes_to_rest_and_sleeps() {
    for on_plane in [false, true] {
        let mut world = World::new();
        world.state.input.config.solver.sleeping = true;
        if on_plane {
            world.state.input.planes.push(Default::default());
        }
        hammer_at(&mut world, Vec3::Y, Quat::from_rotation_x(0.3));
        if !on_plane {
            let cube = world.mesh(&shapes::cube(1.0));
            world.floor(cube);
        }
        world.seconds(6);
        let bodies = &world.state.input.bodies;
        let asleep = world.state.results.asleep.clone();
        assert_eq!(asleep[..2], [true; 2], "on a plane: {on_plane}");
        assert_eq!(bodies.compounds[0].motion.linear_velocity, Vec3::ZERO);
        let lowest = lowest(&world);
        assert!(
            lowest > -0.5 * f64::from(GAP) && lowest < 2.0 * f64::from(GAP),
            "{lowest}"
        );
        let before = world.state.input.bodies.frame[1].position;
        world.seconds(1);
        assert_eq!(
            world.state.input.bodies.frame[1].position, before,
            "it moves in its sleep"
        );
    }
}

#[test]
fn it_hits_like_the_merged_mesh() {
    let mut tracks = Vec::new();
    for joined in [true, false] {
        let mut world = World::new();
        world.state.input.planes.push(Default::default());
        let turn = Quat::from_rotation_x(2.3) * Quat::from_rotation_z(0.4);
        let cube = world.mesh(&shapes::cube(1.0));
        let mesh = world.mesh(&merged());
        let body = Body {
            restitution: 0.3,
            params: BodyParams::default(),
            angular_velocity: Vec3::new(0.0, 0.0, 1.0),
            ..Body::at_rest(if joined { cube } else { mesh }, Vec3::Y * 2.0, turn, Vec3::ONE)
        };
        if joined {
            put(&mut world, &body, None, &hammer(cube));
        } else {
            world.put(&body);
        }
        let mut track = Vec::new();
        for _ in 0..64 {
            world.step();
            track.push(world.state.input.bodies.frame[0].body_center);
        }
        tracks.push(track);
    }
    let furthest = tracks[0].iter().zip(&tracks[1]).map(|(a, b)| a.distance(*b));
    let furthest = furthest.fold(0.0, f64::max);
    // One impact amplifies what the order of points changes.
    assert!(furthest < 0.02, "{furthest}");
}

#[test]
fn a_fast_dumbbell_does_not_pass_through_a_thin_wall() {
    for spin in [0.0, 40.0] {
        let mut world = World::weightless();
        let ball = world.mesh(&shapes::ball(0.1, 2));
        let cube = world.mesh(&shapes::cube(1.0));
        let ends = [Vec3::Y, Vec3::NEG_Y].map(|end| (ball, (0.5 * end, Quat::IDENTITY), Vec3::ONE));
        let mut body = Body::at_rest(ball, Vec3::NEG_X * 4.0, Quat::IDENTITY, Vec3::ONE);
        body.linear_velocity = Vec3::X * 300.0;
        body.angular_velocity = Vec3::Z * spin;
        body.params.continuous = true;
        put(&mut world, &body, None, &ends);
        // Only one of the two balls meets the wall.
        let size = if spin == 0.0 { 0.8 } else { 4.0 };
        world.add(
            RigidBody::Static,
            cube,
            Vec3::new(0.01, size, size),
            Vec3::new(0.0, 0.5 - 0.5 * (size - 0.8), 0.0),
            Quat::IDENTITY,
        );
        // In the first step it meets the wall. Later it may swing around the edge.
        world.step();
        let bodies = &world.state.input.bodies;
        let before_wall = |i: usize| bodies.frame[i].center.x < 0.0;
        let stopped = before_wall(0) || before_wall(1);
        assert!(
            stopped && before_wall(0),
            "spin {spin}: {} {}",
            bodies.frame[0].center,
            bodies.frame[1].center
        );
    }
}
