//! Bodies that cannot be used are taken out of the step and reported once; the others go on.

use crate::app::{DT, Sim, assert_near, ball_like, resting};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;
use bevy_faceoff::state::fault::BodyFault;
use std::time::{Duration, Instant};

const NAN: f32 = f32::NAN;
const INF: f32 = f32::INFINITY;

/// Two bodies that touch all the time, one that flies, and the one that will be broken, which touches both of the
/// first.
struct Company {
    sim: Sim,
    pair: [Entity; 2],
    flying: Entity,
    subject: Entity,
    steps: usize,
}

impl Company {
    fn new() -> Self {
        let mut sim = Sim::new();
        let cube = sim.mesh(&shapes::cube(1.0));
        let subject = sim.spawn((resting(&cube, Vec3::new(0.2, 0.1, 0.3)), Sensor));
        let pair = [0.0, 0.5].map(|x| sim.spawn((resting(&cube, Vec3::X * x), Sensor)));
        let flying = sim.spawn(ball_like(&cube, Vec3::Y * 20.0, Vec3::X));
        let mut company = Self {
            sim,
            pair,
            flying,
            subject,
            steps: 0,
        };
        company.run(3);
        company.assert_well();
        company
    }

    fn run(&mut self, steps: usize) {
        self.sim.step(steps);
        self.steps += steps;
        assert!(self.sim.touch(self.pair[0], self.pair[1]), "the others must go on");
        assert_near(
            self.sim.position(self.flying),
            Vec3::new(self.steps as f32 * DT, 20.0, 0.0),
            1e-4,
        );
    }

    fn assert_well(&self) {
        assert_eq!(self.sim.report().bodies, 4);
        for one in self.pair {
            assert!(self.sim.touch(one, self.subject));
        }
    }

    /// Breaks the subject, mends it, and breaks it again; the fault must be `expected` each time.
    fn suffers<B: Bundle>(mut self, name: &str, break_it: impl Fn() -> B, expected: impl Fn(BodyFault) -> bool) {
        let pose: Transform = self.sim.get(self.subject);
        for round in 1..=2 {
            let ended = self.sim.ended.len();
            self.sim.set(self.subject, break_it());
            self.run(10);
            assert_eq!(
                self.sim.rejected.len(),
                round,
                "{name}: told once and again only after it was mended"
            );
            let BodyRejected { entity, fault } = self.sim.rejected[round - 1];
            assert_eq!(entity, self.subject);
            assert!(expected(fault), "{name}: {fault:?}");
            assert_eq!(self.sim.report().bodies, 3, "{name}");
            assert_eq!(self.sim.ended.len(), ended + 2, "{name}: its touches ended");
            self.sim
                .world()
                .entity_mut(self.subject)
                .remove::<(Mass, Density, GravityScale, Restitution, Friction, ExternalForces)>()
                .remove::<(LinearDamping, AngularDamping, MaxLinearSpeed, MaxAngularSpeed)>();
            self.sim.set(
                self.subject,
                (pose, LinearVelocity::default(), AngularVelocity::default()),
            );
            self.run(2);
            assert_eq!(self.sim.rejected.len(), round, "{name}: mending is not told");
            self.assert_well();
        }
    }
}

fn pose(translation: Vec3, rotation: Quat, scale: Vec3) -> Transform {
    Transform {
        translation,
        rotation,
        scale,
    }
}

#[test]
fn a_transform_that_is_not_finite_takes_its_body_out() {
    let one = (Vec3::ZERO, Quat::IDENTITY, Vec3::ONE);
    for bad in [NAN, INF, -INF] {
        for broken in [
            pose(Vec3::new(0.0, bad, 0.0), one.1, one.2),
            pose(one.0, Quat::from_xyzw(bad, 0.0, 0.0, 1.0), one.2),
            pose(one.0, one.1, Vec3::new(1.0, 1.0, bad)),
        ] {
            Company::new().suffers(&format!("{broken:?}"), || broken, |f| f == BodyFault::NonFinitePose);
        }
    }
}

#[test]
fn a_scale_that_makes_a_body_flat_takes_it_out() {
    for scale in [
        Vec3::ZERO,
        Vec3::new(1.0, 0.0, 1.0),
        Vec3::new(1.0, 1.0, -0.0),
        Vec3::splat(1e-30),
        Vec3::new(1e-8, 1.0, 1.0),
    ] {
        Company::new().suffers(
            &format!("scale {scale}"),
            || Transform::from_scale(scale),
            |f| f == BodyFault::ZeroScale(scale),
        );
    }
}

#[test]
fn a_zero_quaternion_takes_its_body_out() {
    let zero = Transform::from_rotation(Quat::from_xyzw(0.0, 0.0, 0.0, 0.0));
    Company::new().suffers("zero quaternion", || zero, |f| f == BodyFault::ZeroRotation);
}

#[test]
fn a_quaternion_that_is_not_normalised_is_used_as_its_direction() {
    let mut company = Company::new();
    let subject = company.subject;
    company.sim.set(
        subject,
        pose(Vec3::ZERO, Quat::from_xyzw(0.0, 0.0, 7.0, 7.0), Vec3::ONE),
    );
    company.run(5);
    company.assert_well();
    assert!(company.sim.rejected.is_empty());
}

#[test]
fn positions_and_sizes_beyond_all_bounds_take_their_body_out() {
    for broken in [
        Transform::from_xyz(1e30, 0.0, 0.0),
        Transform::from_xyz(0.0, -3e38, 0.0),
        Transform::from_scale(Vec3::splat(1e30)),
        Transform::from_scale(Vec3::splat(f32::MAX)),
    ] {
        Company::new().suffers(&format!("{broken:?}"), || broken, |f| f == BodyFault::TooFar);
    }
}

#[test]
fn forces_beyond_all_bounds_give_a_speed_within_them() {
    for (size, mass) in [(1e15, 1.0), (1e25, 1.0), (f32::MAX, 1.0), (f32::MAX, 1e-6), (1e25, 1e6)] {
        let mut sim = Sim::new();
        let cube = sim.mesh(&shapes::cube(1.0));
        sim.spawn((cube.clone(), Transform::from_xyz(2.0, 0.0, 0.0)));
        let pushed = sim.spawn((RigidBody::Dynamic, cube.clone(), Mass(mass)));
        let [free, turned, thrown, spun] =
            [-20.0, -10.0, 10.0, 20.0].map(|y| sim.spawn((resting(&cube, Vec3::Y * y), Mass(mass))));
        let (force, torque) = (Vec3::X * size, Vec3::Z * size);
        sim.set(pushed, ExternalForces { force, ..default() });
        sim.set(free, ExternalForces { force, ..default() });
        sim.set(turned, ExternalForces { torque, ..default() });
        let impulse = ExternalForces {
            impulse: force,
            ..default()
        };
        sim.set(thrown, impulse);
        let angular_impulse = torque;
        sim.set(
            spun,
            ExternalForces {
                angular_impulse,
                ..default()
            },
        );
        sim.step(3);
        assert!(sim.position(pushed).is_finite() && sim.velocity(pushed).length() <= 1.0001e9);
        let fast = 1e6..1.0001e9;
        for (how, speed) in [
            ("force", sim.velocity(free).x),
            ("torque", sim.spin(turned).z),
            ("impulse", sim.velocity(thrown).x),
            ("angular impulse", sim.spin(spun).z),
        ] {
            assert!(fast.contains(&speed), "{how} of {size:e} on {mass} kg: {speed:e}");
        }
        assert!(sim.rejected.is_empty());
    }
}

#[test]
fn motion_that_is_not_finite_takes_its_body_out() {
    fn suffers<B: Bundle>(name: &'static str, break_it: impl Fn() -> B) {
        Company::new().suffers(name, break_it, |fault| {
            fault == BodyFault::NonFinite(name) && fault.to_string().contains(name)
        });
    }
    for bad in [NAN, INF, -INF] {
        let v = Vec3::new(0.0, 0.0, bad);
        suffers("LinearVelocity", || LinearVelocity(v));
        suffers("AngularVelocity", || AngularVelocity(v));
        suffers("GravityScale", || GravityScale(bad));
        suffers("Restitution", || Restitution::new(bad));
        suffers("Friction", || Friction::new(bad));
        suffers("LinearDamping", || LinearDamping(bad));
        suffers("AngularDamping", || AngularDamping(bad));
        let force = ExternalForces { torque: v, ..default() };
        suffers("ExternalForces", || force);
    }
    suffers("MaxLinearSpeed", || MaxLinearSpeed(NAN));
    suffers("MaxAngularSpeed", || MaxAngularSpeed(NAN));
    for bad in [NAN, -INF] {
        suffers("Mass", || Mass(bad));
        suffers("Density", || Density(bad));
    }
}

#[test]
fn who_wants_an_infinite_mass_is_told_of_static_bodies() {
    let expected =
        |name| move |f: BodyFault| f == BodyFault::Infinite(name) && f.to_string().contains("RigidBody::Static");
    Company::new().suffers("mass", || Mass(INF), expected("Mass"));
    Company::new().suffers("density", || Density(INF), expected("Density"));
}

#[test]
fn another_component_that_is_not_finite_is_news() {
    let mut company = Company::new();
    let subject = company.subject;
    company.sim.set(subject, Friction::new(NAN));
    company.run(2);
    company.sim.set(subject, (Friction::new(0.5), LinearDamping(NAN)));
    company.run(2);
    let faults: Vec<_> = company.sim.rejected.iter().map(|r| r.fault).collect();
    assert_eq!(
        faults,
        [BodyFault::NonFinite("Friction"), BodyFault::NonFinite("LinearDamping")]
    );
}

#[test]
fn a_mass_that_is_not_positive_or_has_no_inverse_takes_its_body_out() {
    for mass in [0.0, -0.0, -1.0, f32::MIN, 1e-40] {
        Company::new().suffers("mass", || Mass(mass), |f| f == BodyFault::Mass(mass));
    }
}

#[test]
fn another_fault_of_a_broken_body_is_news() {
    let mut company = Company::new();
    let subject = company.subject;
    company.sim.set(subject, Mass(-1.0));
    company.run(2);
    company.sim.set(subject, Mass(-2.0));
    company.run(2);
    assert_eq!(company.sim.rejected.len(), 1, "the same fault with another number");
    company.sim.set(subject, Transform::from_xyz(NAN, 0.0, 0.0));
    company.run(2);
    let faults: Vec<_> = company.sim.rejected.iter().map(|r| r.fault).collect();
    assert_eq!(faults, [BodyFault::Mass(-1.0), BodyFault::NonFinitePose]);
}

#[test]
fn what_users_set_on_a_broken_body_is_left_alone() {
    let mut company = Company::new();
    let subject = company.subject;
    company
        .sim
        .set(subject, (Transform::from_xyz(5.0, NAN, 7.0), LinearVelocity(Vec3::X)));
    company.run(5);
    let at = company.sim.position(subject);
    assert!(at.x == 5.0 && at.y.is_nan() && at.z == 7.0);
    assert_eq!(company.sim.velocity(subject), Vec3::X);
}

#[test]
fn a_body_broken_from_the_start_is_told_in_the_first_step() {
    let mut sim = Sim::new();
    let cube = sim.mesh(&shapes::cube(1.0));
    let body = sim.spawn(resting(&cube, Vec3::NAN));
    sim.step(1);
    assert_eq!(sim.rejected.len(), 1);
    assert_eq!(sim.rejected[0].entity, body);
    sim.world().despawn(body);
    sim.step(2);
    assert_eq!(sim.rejected.len(), 1);
}

#[test]
fn many_bodies_may_break_at_once() {
    let mut company = Company::new();
    let mesh: MeshCollider = company.sim.get(company.subject);
    for i in 0..50 {
        company
            .sim
            .spawn((resting(&mesh, Vec3::splat(0.1)), Mass(-1.0 - i as f32)));
    }
    company.run(5);
    assert_eq!(company.sim.rejected.len(), 50);
    company.assert_well();
}

#[test]
fn planes_that_cannot_be_used_are_told_and_return() {
    for (normal, distance) in [
        (Vec3::ZERO, 0.0),
        (Vec3::NAN, 0.0),
        (Vec3::new(INF, 0.0, 0.0), 0.0),
        (Vec3::Y, NAN),
        (Vec3::Y, INF),
    ] {
        let mut sim = Sim::new();
        let cube = sim.mesh(&shapes::cube(1.0));
        let body = sim.spawn(ball_like(&cube, Vec3::ZERO, Vec3::NEG_Y));
        let plane = sim.spawn((PlaneCollider { normal, distance }, Restitution::new(1.0)));
        let floor = sim.spawn((
            PlaneCollider::through(Vec3::NEG_Y * 2.0, Vec3::Y),
            Restitution::new(1.0),
        ));
        sim.step(10);
        assert_eq!(sim.rejected.len(), 1, "normal {normal}, distance {distance}");
        assert_eq!(sim.rejected[0].entity, plane);
        let fault = sim.rejected[0].fault;
        if normal == Vec3::Y {
            assert!(matches!(fault, BodyFault::PlaneDistance(_)), "{fault:?}");
        } else {
            assert!(matches!(fault, BodyFault::PlaneNormal(_)), "{fault:?}");
        }
        assert!(fault.to_string().contains("PlaneCollider"), "{fault}");
        sim.set(plane, PlaneCollider::through(Vec3::Y * 2.0, Vec3::NEG_Y));
        sim.step(500);
        assert_eq!(sim.rejected.len(), 1);
        for wall in [plane, floor] {
            let met = sim.started.iter().any(|s| [s.collider1, s.collider2].contains(&wall));
            assert!(met, "the body bounces between both planes");
        }
        assert!(sim.position(body).y.abs() < 2.0);
        sim.set(plane, PlaneCollider { normal, distance });
        sim.step(3);
        assert_eq!(sim.rejected.len(), 2);
    }
}

#[test]
fn a_plane_whose_restitution_is_not_finite_is_told() {
    let mut sim = Sim::new();
    let plane = sim.spawn((PlaneCollider::through(Vec3::ZERO, Vec3::Y), Restitution::new(NAN)));
    sim.step(5);
    assert_eq!(
        sim.rejected,
        [BodyRejected {
            entity: plane,
            fault: BodyFault::NonFinite("Restitution")
        }]
    );
}

#[test]
fn gravity_that_is_not_finite_counts_as_none() {
    let mut company = Company::new();
    for gravity in [Vec3::NAN, Vec3::new(0.0, -INF, 0.0)] {
        company.sim.world().insert_resource(Gravity(gravity));
        company.run(5);
        company.assert_well();
    }
    assert!(company.sim.rejected.is_empty());
}

#[test]
fn a_body_that_flies_out_of_bounds_is_told_once_and_nobody_else_suffers() {
    let mut company = Company::new();
    let mesh: MeshCollider = company.sim.get(company.subject);
    let fast = company
        .sim
        .spawn((resting(&mesh, Vec3::Y * 50.0), LinearVelocity(Vec3::Y * 1e30)));
    let falling = company.sim.spawn((resting(&mesh, Vec3::Y * 90.0), GravityScale(1e38)));
    company.sim.world().insert_resource(Gravity(Vec3::Y * 1e-6));
    company.run(10);
    company.assert_others(&[fast, falling]);
}

impl Company {
    fn assert_others(&self, gone: &[Entity]) {
        let told: Vec<_> = self.sim.rejected.iter().map(|r| r.entity).collect();
        assert_eq!(told.len(), gone.len(), "{:?}", self.sim.rejected);
        assert!(gone.iter().all(|g| told.contains(g)));
        self.assert_well();
    }
}

#[test]
fn a_mesh_that_failed_to_load_is_told_once_for_each_body() {
    let mut company = Company::new();
    let server = company.sim.world().resource::<AssetServer>().clone();
    let missing = MeshCollider(server.load("there_is_no_such_mesh.obj"));
    let bodies = [0.0, 0.1].map(|x| company.sim.spawn(resting(&missing, Vec3::X * x)));
    let start = Instant::now();
    while company.sim.rejected.len() < 2 {
        assert!(start.elapsed() < Duration::from_secs(60), "never told");
        company.run(1);
        std::thread::sleep(Duration::from_millis(2));
    }
    company.run(10);
    company.assert_others(&bodies);
    assert!(company.sim.rejected.iter().all(|r| r.fault == BodyFault::MeshFailed));
    let good: MeshCollider = company.sim.get(company.subject);
    company.sim.set(bodies[0], good);
    company.run(1);
    assert_eq!(company.sim.report().bodies, 5, "another mesh mends it");
}

#[test]
fn a_system_between_the_stages_may_despawn_bodies() {
    for before in [
        FaceoffSystems::BroadPhase,
        FaceoffSystems::Angles,
        FaceoffSystems::TriangleTest,
        FaceoffSystems::ForceScan,
        FaceoffSystems::Integrate,
        FaceoffSystems::Publish,
    ] {
        let mut company = Company::new();
        let subject = company.subject;
        company
            .sim
            .set(subject, (CollisionEventsEnabled, CollidingEntities::default()));
        company.sim.app.add_systems(
            FaceoffStep,
            (move |mut commands: Commands| commands.entity(subject).try_despawn())
                .before(before)
                .after(FaceoffSystems::Collect),
        );
        company.run(1);
        assert!(company.sim.app.world().get_entity(subject).is_err());
        company.run(2);
        assert_eq!(company.sim.report().bodies, 3, "despawned before {before:?}");
        assert_eq!(company.sim.touching().len(), 1);
        let ends = |e: &&CollisionEnd| [e.collider1, e.collider2].contains(&subject);
        assert_eq!(company.sim.ended.iter().filter(ends).count(), 2);
        assert!(company.sim.rejected.is_empty());
    }
}

#[test]
fn a_system_between_the_stages_may_remove_any_component() {
    for part in 0..4 {
        let mut company = Company::new();
        let subject = company.subject;
        company.sim.app.add_systems(
            FaceoffStep,
            (move |mut commands: Commands| {
                let mut body = commands.entity(subject);
                match part {
                    0 => body.remove::<MeshCollider>(),
                    1 => body.remove::<Transform>(),
                    2 => body.remove::<LinearVelocity>(),
                    _ => body.remove::<RigidBody>(),
                };
            })
            .in_set(FaceoffSystems::TriangleTest),
        );
        company.run(3);
        assert_eq!(company.sim.report().bodies, if part < 2 { 3 } else { 4 });
        assert!(company.sim.rejected.is_empty());
    }
}

#[test]
fn a_body_without_its_rigid_body_is_static() {
    let mut company = Company::new();
    let flying = company.flying;
    company.sim.world().entity_mut(flying).remove::<RigidBody>();
    let there = company.sim.position(flying);
    company.sim.step(10);
    assert_eq!(company.sim.position(flying), there);
    company.sim.set(flying, RigidBody::Dynamic);
    company.sim.step(64);
    assert_near(company.sim.position(flying), there + Vec3::X, 1e-4);
}

#[test]
fn a_body_without_velocities_stays_and_is_reported() {
    let mut company = Company::new();
    let subject = company.subject;
    let there = company.sim.position(subject);
    company
        .sim
        .world()
        .entity_mut(subject)
        .remove::<(LinearVelocity, AngularVelocity)>();
    company.run(10);
    company.assert_well();
    assert_eq!(company.sim.position(subject), there);
}

#[test]
fn a_body_without_its_mesh_collider_leaves_the_step() {
    let mut company = Company::new();
    let subject = company.subject;
    let mesh: MeshCollider = company.sim.get(subject);
    company.sim.world().entity_mut(subject).remove::<MeshCollider>();
    company.run(2);
    assert_eq!(company.sim.report().bodies, 3);
    assert_eq!(company.sim.ended.len(), 2);
    assert!(company.sim.rejected.is_empty());
    company.sim.set(subject, mesh);
    company.run(2);
    company.assert_well();
}
