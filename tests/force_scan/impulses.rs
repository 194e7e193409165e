//! Contacts and impulses: positions, directions, and conservation laws.

use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::state::Body;
use bevy_faceoff::step::StepState;
use bevy_faceoff::types::body::RigidBody;
use bevy_faceoff::types::stage::Stage;
use glam::{Mat3, Quat, Vec3};

fn step(state: &mut StepState) {
    for stage in Stage::ALL {
        bevy_faceoff::step::cpu::run(stage, state);
    }
}

/// Makes the bodies after a step the input of the next.
fn again(state: &mut StepState) {
    let bodies = std::mem::take(&mut state.input.bodies);
    for i in 0..bodies.len() {
        let body = Body {
            kind: bodies.kind[i],
            linear_velocity: bodies.linear_velocity[i],
            angular_velocity: bodies.angular_velocity[i],
            restitution: bodies.restitution[i],
            ..Body::at_rest(bodies.mesh[i], bodies.position[i], bodies.rotation[i], bodies.scale[i])
        };
        state.input.bodies.push(&body, &state.input.meshes).unwrap();
    }
}

fn directions(count: usize) -> impl Iterator<Item = Vec3> {
    let mut random = fastrand::Rng::with_seed(7);
    std::iter::repeat_with(move || Vec3::from_array([0; 3].map(|_| random.f32() - 0.5)))
        .filter(|v| (0.1..0.5).contains(&v.length()))
        .map(Vec3::normalize)
        .take(count)
}

#[test]
fn balls_push_each_other_along_the_line_of_centres_whatever_their_scale() {
    for (direction, scale) in directions(200).zip(
        [Vec3::ONE, Vec3::new(-1.0, 1.0, 1.0), Vec3::splat(-2.0)]
            .into_iter()
            .cycle(),
    ) {
        let mut state = StepState::default();
        let ball = state.input.meshes.add(CollisionMesh::new(&shapes::ball(0.5, 3)));
        let second = 0.98 * (0.5 + 0.5 * scale.x.abs()) * direction;
        let at = Vec3::new(3.0, -1.0, 2.0);
        for (position, scale) in [(at, Vec3::ONE), (at + second, scale)] {
            let body = Body::at_rest(ball, position, Quat::from_rotation_y(0.3), scale);
            state.input.bodies.push(&body, &state.input.meshes).unwrap();
        }
        step(&mut state);
        let contact = state.results.contacts.pairs[0].contact;
        let angle = contact.normal.angle_between(direction).to_degrees();
        assert!(angle < 3.0, "{direction} {scale}: {angle} degrees off");
        assert!(contact.point.distance(at + 0.5 * direction) < 0.03, "{contact:?}");
    }
}

#[test]
fn segments_lie_on_both_bodies() {
    let mut state = StepState::default();
    let torus = state.input.meshes.add(CollisionMesh::new(&shapes::torus_240()));
    for (position, angle) in [(Vec3::new(10.0, 0.0, 0.0), 0.0), (Vec3::new(10.35, 0.1, 0.05), 1.3)] {
        let body = Body::at_rest(torus, position, Quat::from_rotation_x(angle), Vec3::splat(1.5));
        state.input.bodies.push(&body, &state.input.meshes).unwrap();
    }
    step(&mut state);
    let mesh = shapes::torus_240();
    let pair = state.results.contacts.pairs[0];
    assert!(pair.face_count > 10);
    for hit in state.results.contacts.faces_of(&pair) {
        for (face, body) in [(hit.a, 0), (hit.b, 1)] {
            let frame = state.input.bodies.frame[body];
            let corners = mesh
                .corners(face as usize)
                .map(|p| frame.rotation * (frame.scale * p.as_dvec3()) + frame.position);
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize();
            for p in [hit.start, hit.end] {
                let height = normal.dot(p.as_dvec3() - corners[0]);
                assert!(height.abs() < 3.0e-6, "{p} is {height} off face {face}");
            }
        }
    }
}

#[test]
fn head_on_balls_keep_momentum_and_bounce_by_their_restitution() {
    for restitution in [0.0, 0.5, 1.0] {
        let mut state = StepState::default();
        let ball = state.input.meshes.add(CollisionMesh::new(&shapes::ball(0.5, 4)));
        for side in [-1.0, 1.0] {
            let body = Body {
                linear_velocity: Vec3::X * -side,
                restitution,
                ..Body::at_rest(ball, Vec3::X * 0.6 * side, Quat::IDENTITY, Vec3::ONE)
            };
            state.input.bodies.push(&body, &state.input.meshes).unwrap();
        }
        for _ in 0..64 {
            step(&mut state);
            again(&mut state);
        }
        let [a, b] = [0, 1].map(|i| state.input.bodies.linear_velocity[i]);
        assert!((a + b).length() < 1.0e-5, "{a} {b}");
        assert!((b.x - restitution).abs() < 0.02, "restitution {restitution}: {b}");
    }
}

#[test]
fn a_crowd_keeps_momentum_and_gains_no_energy() {
    let mut state = StepState::default();
    let torus = state.input.meshes.add(CollisionMesh::new(&shapes::torus_240()));
    let mut random = fastrand::Rng::with_seed(3);
    let mut vector = move |size: f32| Vec3::from_array([0; 3].map(|_| size * (random.f32() - 0.5)));
    for _ in 0..150 {
        let body = Body {
            linear_velocity: vector(4.0),
            angular_velocity: vector(4.0),
            restitution: 1.0,
            ..Body::at_rest(
                torus,
                vector(5.0),
                Quat::from_scaled_axis(vector(6.0)),
                Vec3::splat(0.8),
            )
        };
        state.input.bodies.push(&body, &state.input.meshes).unwrap();
    }
    let measure = |state: &StepState| {
        let b = &state.input.bodies;
        let mut sums = (Vec3::ZERO, 0.0f64, 0.0f32);
        for i in 0..b.len() {
            let (m, v, w) = (1.0 / b.inverse_mass[i], b.linear_velocity[i], b.angular_velocity[i]);
            let inertia: Mat3 = b.inverse_inertia[i].inverse();
            sums.0 += m * v;
            sums.1 += (0.5 * m * v.length_squared() + 0.5 * w.dot(inertia * w)) as f64;
            sums.2 += m * v.length();
        }
        sums
    };
    let (momentum, mut energy, size) = measure(&state);
    let mut touched = 0;
    for _ in 0..120 {
        // Without rotation: rotating an anisotropic body at constant angular velocity is not free motion and changes
        // its energy.
        for stage in Stage::ALL {
            bevy_faceoff::step::cpu::run(stage, &mut state);
            if stage == Stage::TriangleTest {
                touched += state.results.contacts.pairs.len();
                energy = measure(&state).1;
            }
        }
        let (after, energy_after, _) = measure(&state);
        assert!((after - momentum).length() < 1.0e-4 * size, "{momentum} {after}");
        assert!(energy_after <= energy * (1.0 + 1.0e-5), "{energy} {energy_after}");
        again(&mut state);
    }
    assert!(touched > 1000, "{touched}");
}

#[test]
fn kinematic_and_static_bodies_are_not_pushed() {
    for kind in [RigidBody::Kinematic, RigidBody::Static] {
        let mut state = StepState::default();
        let ball = state.input.meshes.add(CollisionMesh::new(&shapes::ball(0.5, 2)));
        for (side, kind) in [(-1.0, kind), (1.0, RigidBody::Dynamic)] {
            let body = Body {
                kind,
                linear_velocity: Vec3::X * -side,
                restitution: 1.0,
                ..Body::at_rest(ball, Vec3::X * 0.49 * side, Quat::IDENTITY, Vec3::ONE)
            };
            state.input.bodies.push(&body, &state.input.meshes).unwrap();
        }
        step(&mut state);
        assert_eq!(
            state.input.bodies.linear_velocity[0],
            Vec3::X,
            "its velocity stays the same"
        );
        let expected = if kind == RigidBody::Kinematic { 3.0 } else { 1.0 };
        assert!((state.input.bodies.linear_velocity[1].x - expected).abs() < 0.02);
    }
}
