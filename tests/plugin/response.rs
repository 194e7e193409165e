//! What collisions do to velocities with one impulse per pair; `contacts` has what points with friction do.

use crate::app::{Sim, assert_near, ball_like, resting};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;

fn by_impulses() -> Sim {
    let mut sim = Sim::new();
    sim.world().insert_resource(Response::Impulse);
    sim
}

/// Mass and inertia tensor in the world, from the mesh's own moments.
fn inertia(sim: &Sim, body: Entity) -> (f32, Mat3) {
    let meshes = sim.app.world().resource::<Assets<CollisionMesh>>();
    let properties = meshes.get(&sim.get::<MeshCollider>(body).0).unwrap().mass;
    let mass = sim.app.world().get::<Mass>(body).map_or(properties.volume, |m| m.0);
    let m = properties.second_moment;
    let own = (Mat3::from_diagonal(Vec3::splat(m.x_axis.x + m.y_axis.y + m.z_axis.z)) - m) * (mass / properties.volume);
    let turn = Mat3::from_quat(sim.get::<Transform>(body).rotation);
    (mass, turn * own * turn.transpose())
}

/// Linear and angular momentum about the origin and kinetic energy, with the velocities as they are and the poses as
/// `inertia` had them.
fn momenta(sim: &Sim, bodies: &[(Entity, Vec3, f32, Mat3)]) -> (Vec3, Vec3, f32) {
    let (mut p, mut l, mut e) = (Vec3::ZERO, Vec3::ZERO, 0.0);
    for &(body, center, mass, inertia) in bodies {
        let (v, w) = (sim.velocity(body), sim.spin(body));
        p += mass * v;
        l += center.cross(mass * v) + inertia * w;
        e += 0.5 * (mass * v.dot(v) + w.dot(inertia * w));
    }
    (p, l, e)
}

#[test]
fn two_tori_bounce_and_keep_linear_and_angular_momentum_and_energy() {
    let mut sim = by_impulses();
    let torus = sim.mesh(&shapes::torus_240());
    let one = sim.spawn(ball_like(&torus, Vec3::new(-1.5, 0.1, 0.0), Vec3::X * 2.0));
    let other = sim.spawn(ball_like(&torus, Vec3::new(1.5, -0.1, 0.1), Vec3::X * -1.0));
    sim.set(
        one,
        (
            Mass(1.0),
            Transform::from_xyz(-1.5, 0.1, 0.0).with_rotation(Quat::from_rotation_y(0.4)),
        ),
    );
    sim.set(
        other,
        (
            Mass(3.0),
            Transform::from_xyz(1.5, -0.1, 0.1).with_rotation(Quat::from_rotation_x(0.9)),
        ),
    );
    let mut bounced = 0;
    for _ in 0..200 {
        let poses: Vec<_> = [one, other]
            .map(|body| {
                let (mass, inertia) = inertia(&sim, body);
                (body, sim.position(body), mass, inertia)
            })
            .into();
        let (p, l, e) = momenta(&sim, &poses);
        let v = sim.velocity(one);
        sim.step(1);
        let (p1, l1, e1) = momenta(&sim, &poses);
        assert_near(p1, p, 1e-5);
        assert_near(l1, l, 1e-5);
        assert!((e1 - e).abs() < 1e-5 * e, "energy {e} became {e1}");
        bounced += usize::from(sim.velocity(one) != v);
    }
    assert!(bounced > 0, "they never met");
    assert!(sim.spin(one).length() > 0.1, "an impulse off the centre turns");
    let (apart, parting) = (
        sim.position(other) - sim.position(one),
        sim.velocity(other) - sim.velocity(one),
    );
    assert!(parting.dot(apart) > 0.0, "they part");
    assert!(sim.collisions().is_empty());
}

/// Two balls head on along z, pole to pole; their velocities long after. Balls are symmetric about z, so nothing turns.
fn head_on(masses: [f32; 2], speeds: [f32; 2], restitution: [f32; 2]) -> [f32; 2] {
    let mut sim = by_impulses();
    let ball = sim.mesh(&shapes::ball(0.5, 2));
    let bodies = [0, 1].map(|i| {
        sim.spawn((
            resting(&ball, Vec3::Z * [-0.8, 0.8][i]),
            LinearVelocity(Vec3::Z * speeds[i]),
            Mass(masses[i]),
            Restitution::new(restitution[i]),
        ))
    });
    sim.step(100);
    assert_eq!(sim.started.len(), 1);
    bodies.map(|body| {
        assert_near(sim.velocity(body), Vec3::Z * sim.velocity(body).z, 1e-2);
        sim.velocity(body).z
    })
}

#[track_caller]
fn assert_speeds(found: [f32; 2], wanted: [f32; 2]) {
    for (f, w) in found.iter().zip(wanted) {
        assert!((f - w).abs() < 2e-3, "{found:?} instead of {wanted:?}");
    }
}

#[test]
fn equal_balls_exchange_their_speeds() {
    assert_speeds(head_on([2.0, 2.0], [1.0, -1.5], [1.0, 1.0]), [-1.5, 1.0]);
}

#[test]
fn unequal_balls_bounce_by_the_law_of_elastic_impact() {
    let ([a, b], [u, v]) = ([1.0, 4.0], [2.0, -0.5]);
    let wanted = [
        ((a - b) * u + 2.0 * b * v) / (a + b),
        ((b - a) * v + 2.0 * a * u) / (a + b),
    ];
    assert_speeds(head_on([a, b], [u, v], [1.0, 1.0]), wanted);
}

#[test]
fn balls_without_restitution_go_on_together() {
    assert_speeds(head_on([1.0, 3.0], [2.0, 0.0], [0.0, 0.0]), [0.5, 0.5]);
}

#[test]
fn two_balls_take_the_mean_of_their_restitutions() {
    // Parting speed is 0.3 times the closing speed of 2.
    assert_speeds(head_on([1.0, 1.0], [1.0, -1.0], [0.6, 0.0]), [-0.3, 0.3]);
}

#[test]
fn a_restitution_above_one_or_below_zero_counts_as_the_nearest_of_both() {
    assert_speeds(head_on([1.0, 1.0], [1.0, -1.0], [7.0, 7.0]), [-1.0, 1.0]);
    assert_speeds(head_on([1.0, 1.0], [1.0, -1.0], [-3.0, -3.0]), [0.0, 0.0]);
}

#[test]
fn a_body_without_mass_weighs_its_scaled_volume() {
    let mut sim = by_impulses();
    let ball = sim.mesh(&shapes::ball(0.5, 2));
    let heavy = sim.spawn(ball_like(&ball, Vec3::Z * -1.2, Vec3::Z));
    let light = sim.spawn(ball_like(&ball, Vec3::Z * 0.8, Vec3::ZERO));
    sim.world().get_mut::<Transform>(heavy).unwrap().scale = Vec3::splat(2.0);
    sim.step(100);
    // Eight times the mass, so the light one leaves at 16/9 and the heavy one keeps 7/9.
    assert_near(sim.velocity(heavy), Vec3::Z * (7.0 / 9.0), 1e-2);
    assert_near(sim.velocity(light), Vec3::Z * (16.0 / 9.0), 1e-2);
}

#[test]
fn without_response_bodies_pass_through_each_other_and_are_reported() {
    let mut sim = Sim::new();
    sim.world().insert_resource(Response::None);
    let torus = sim.mesh(&shapes::torus_240());
    let one = sim.spawn(ball_like(&torus, Vec3::X * -1.0, Vec3::X));
    let other = sim.spawn(ball_like(&torus, Vec3::X, Vec3::NEG_X));
    sim.spawn(PlaneCollider::through(Vec3::X * -1.5, Vec3::X));
    sim.step(128);
    assert_near(sim.position(one), Vec3::X, 1e-4);
    assert_near(sim.position(other), Vec3::X * -1.0, 1e-4);
    assert_eq!((sim.velocity(one), sim.velocity(other)), (Vec3::X, Vec3::NEG_X));
    let of_pair = |e: [Entity; 2]| e == crate::app::sorted(one, other);
    assert!(sim.started.iter().any(|s| of_pair([s.collider1, s.collider2])));
    assert!(sim.ended.iter().any(|s| of_pair([s.collider1, s.collider2])));
    sim.step(40);
    assert!(sim.position(other).x < -1.5, "the plane holds nobody back either");
    assert_eq!(sim.spin(one), Vec3::ZERO);
}

#[test]
fn without_response_gravity_still_pulls() {
    let mut sim = Sim::new();
    sim.world().insert_resource(Response::None);
    sim.world().insert_resource(Gravity::default());
    let cube = sim.mesh(&shapes::cube(1.0));
    let body = sim.spawn(resting(&cube, Vec3::ZERO));
    sim.step(64);
    assert_near(sim.velocity(body), Vec3::NEG_Y * 9.81, 1e-3);
}

#[test]
fn a_wall_of_full_restitution_reverses_the_speed() {
    let mut sim = by_impulses();
    let cube = sim.mesh(&shapes::cube(1.0));
    sim.spawn((
        PlaneCollider::through(Vec3::X * 2.0, Vec3::NEG_X),
        Restitution::new(1.0),
    ));
    let body = sim.spawn(ball_like(&cube, Vec3::ZERO, Vec3::new(3.0, 0.5, 0.0)));
    sim.step(80);
    assert_near(sim.velocity(body), Vec3::new(-3.0, 0.5, 0.0), 1e-3);
    assert_near(sim.spin(body), Vec3::ZERO, 1e-3);
}

#[test]
fn a_static_body_of_full_restitution_reverses_the_speed() {
    let mut sim = by_impulses();
    let ball = sim.mesh(&shapes::ball(0.5, 2));
    let wall = sim.spawn((ball.clone(), Transform::from_xyz(0.0, 0.0, 2.0), Restitution::new(1.0)));
    let body = sim.spawn(ball_like(&ball, Vec3::ZERO, Vec3::Z * 2.0));
    sim.step(80);
    assert_near(sim.velocity(body), Vec3::Z * -2.0, 1e-2);
    assert_eq!(sim.position(wall), Vec3::Z * 2.0);
}

#[test]
fn a_cube_dropped_on_a_floor_comes_to_rest_and_does_not_sink() {
    let mut sim = Sim::new();
    sim.world().insert_resource(Gravity::default());
    sim.spawn(PlaneCollider {
        normal: Vec3::Y * 5.0,
        distance: 1.0,
    });
    let cube = sim.mesh(&shapes::cube(1.0));
    let body = sim.spawn((resting(&cube, Vec3::Y * 3.0), Restitution::new(0.3)));
    sim.step(64 * 8);
    let rest = sim.position(body);
    assert!((rest.y - 1.5).abs() < 0.05, "the cube's centre is at {rest}");
    sim.step(64 * 20);
    assert_near(sim.position(body), rest, 0.02);
    assert!(sim.velocity(body).length() < 0.3, "{}", sim.velocity(body));
}

#[test]
fn six_walls_keep_bouncing_bodies_in_for_long() {
    let mut sim = Sim::new();
    let knot = sim.mesh(&shapes::knot_1120());
    for normal in [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z] {
        sim.spawn((PlaneCollider::through(normal * -1.5, normal), Restitution::new(1.0)));
    }
    let mut random = fastrand::Rng::with_seed(3);
    let mut random = || Vec3::from_array([0; 3].map(|_| random.f32() * 2.0 - 1.0));
    let bodies: Vec<Entity> = (0..12)
        .map(|_| sim.spawn(ball_like(&knot, random(), random() * 2.0)))
        .collect();
    for _ in 0..600 {
        sim.step(1);
        for &body in &bodies {
            let p = sim.position(body);
            assert!(p.is_finite() && p.abs().max_element() < 1.6, "{body} is at {p}");
        }
    }
    let planes = sim.started.len();
    assert!(planes > 100, "only {planes} bounces");
}

#[test]
fn a_body_on_its_edge_tips_over_towards_the_floor() {
    let mut sim = Sim::new();
    sim.world().insert_resource(Gravity::default());
    sim.spawn(PlaneCollider::through(Vec3::ZERO, Vec3::Y));
    let cube = sim.mesh(&shapes::cube(1.0));
    let start = Quat::from_rotation_z(0.5);
    let body = sim.spawn(resting(&cube, Vec3::Y * 0.8));
    sim.world().get_mut::<Transform>(body).unwrap().rotation = start;
    sim.step(64 * 6);
    let up = sim.get::<Transform>(body).rotation * Vec3::Y;
    let aligned = up.abs().max_element();
    assert!(aligned > 0.99, "the cube's axis still points to {up}");
    assert!((sim.position(body).y - 0.5).abs() < 0.06);
}
