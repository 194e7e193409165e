//! Hammers: a handle, and a head on top of it.

use crate::world::{GAP, World};
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::state::{Body, BodyParams, LocalPose, NewCompoundPart};
use bevy_faceoff::types::settings::Response;
use glam::{DMat3, Quat, Vec3};

/// A collider for a body: mesh, place and scale.
pub type Collider = (u32, (Vec3, Quat), Vec3);

/// Adds a body of these colliders and returns its number.
pub fn put(world: &mut World, body: &Body, center: Option<Vec3>, colliders: &[Collider]) -> usize {
    let first = world.state.input.bodies.len();
    let mut parts = Vec::new();
    for &(mesh, pose, scale) in colliders {
        let pose = LocalPose::from(pose);
        let collider = world.put(&body.collider(mesh, &pose, scale)) as u32;
        parts.push(NewCompoundPart {
            collider,
            pose,
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
pub fn hammer(cube: u32) -> [Collider; 2] {
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
pub fn merged() -> TriMesh {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    let cube = shapes::cube(1.0);
    for (_, (translation, rotation), scale) in hammer(0) {
        let first = vertices.len() as u32;
        vertices.extend(cube.vertices().iter().map(|&v| translation + rotation * (scale * v)));
        triangles.extend(cube.triangles().iter().map(|t| t.map(|i| i + first)));
    }
    TriMesh::new(vertices, triangles).unwrap()
}

/// Adds a hammer and returns its number.
pub fn hammer_at(world: &mut World, position: Vec3, rotation: Quat) -> usize {
    let cube = world.mesh(&shapes::cube(1.0));
    let body = Body::at_rest(cube, position, rotation, Vec3::ONE);
    put(world, &body, None, &hammer(cube))
}

pub fn flies() {
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
pub fn lowest(world: &World) -> f64 {
    let bodies = &world.state.input.bodies;
    let cube = shapes::cube(1.0);
    let corners = bodies.parts.iter().flat_map(|part| {
        let frame = &bodies.frame[part.collider as usize];
        let corner = |v: &Vec3| (frame.position + frame.rotation * (frame.scale * v.as_dvec3())).y;
        cube.vertices().iter().map(corner).collect::<Vec<_>>()
    });
    corners.fold(f64::INFINITY, f64::min)
}

pub fn rests() {
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

pub fn hits_like_the_merged_mesh() {
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
