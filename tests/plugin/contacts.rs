//! What components and resources do to bodies in contact.

use crate::app::{DT, Sim, assert_near, resting, sorted};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;
use bevy_faceoff::state::ContactPoint;

/// Gravity, and ground at height 0.
fn on_the_ground() -> (Sim, MeshCollider) {
    let mut sim = Sim::new();
    sim.world().insert_resource(Gravity(Vec3::NEG_Y * 10.0));
    sim.spawn(PlaneCollider::through(Vec3::ZERO, Vec3::Y));
    let cube = sim.mesh(&shapes::cube(1.0));
    (sim, cube)
}

/// A cube that fell asleep on the ground.
fn asleep() -> (Sim, MeshCollider, Entity) {
    let (mut sim, cube) = on_the_ground();
    let body = sim.spawn(resting(&cube, Vec3::Y * 0.51));
    sim.step(80);
    assert!(sim.get::<Sleeping>(body).0);
    assert_eq!(sim.report().sleeping, 1);
    (sim, cube, body)
}

pub fn what_lies_still_falls_asleep_and_does_not_move_at_all() {
    let (mut sim, _, body) = asleep();
    let before = sim.get::<Transform>(body);
    sim.step(100);
    assert_eq!(sim.get::<Transform>(body), before);
    assert_eq!(sim.velocity(body), Vec3::ZERO);
    assert!(sim.get::<Sleeping>(body).0);
    assert_eq!(
        (sim.started.len(), sim.ended.len()),
        (1, 0),
        "asleep it still touches the ground"
    );
}

pub fn a_sleeper_wakes_by_whatever_disturbs_it() {
    let disturb: [(&str, fn(&mut Sim, &MeshCollider, Entity)); 9] = [
        ("an impulse", |sim, _, body| {
            let push = ExternalForces {
                impulse: Vec3::X,
                ..default()
            };
            sim.set(body, push);
        }),
        ("a force", |sim, _, body| {
            let push = ExternalForces {
                force: Vec3::X * 50.0,
                ..default()
            };
            sim.set(body, push);
        }),
        ("a velocity", |sim, _, body| sim.set(body, LinearVelocity(Vec3::X))),
        ("another place", |sim, _, body| {
            sim.set(body, Transform::from_xyz(0.0, 0.6, 0.0))
        }),
        ("a body that falls on it", |sim, cube, _| {
            sim.spawn((resting(cube, Vec3::Y * 1.54), LinearVelocity(Vec3::NEG_Y)));
        }),
        ("a user", |sim, _, body| sim.set(body, Sleeping(false))),
        ("another gravity", |sim, _, _| {
            sim.world().insert_resource(Gravity(Vec3::new(8.0, -8.0, 0.0)));
        }),
        ("another size", |sim, _, body| {
            sim.set(body, Transform::from_xyz(0.0, 0.51, 0.0).with_scale(Vec3::splat(0.9)));
        }),
        ("the loss of the ground", |sim, _, _| {
            let mut planes = sim.world().query_filtered::<Entity, With<PlaneCollider>>();
            let plane = planes.single(sim.app.world()).unwrap();
            sim.world().despawn(plane);
        }),
    ];
    for (name, disturb) in disturb {
        let (mut sim, cube, body) = asleep();
        disturb(&mut sim, &cube, body);
        sim.step(3);
        assert!(!sim.get::<Sleeping>(body).0, "{name} did not wake it");
    }
}

pub fn a_sleeper_wakes_when_the_mesh_under_it_goes() {
    let mut sim = Sim::new();
    sim.world().insert_resource(Gravity::default());
    let cube = sim.mesh(&shapes::cube(1.0));
    let floor = sim.spawn((cube.clone(), Transform::from_scale(Vec3::new(9.0, 1.0, 9.0))));
    let [below, above] = [1.01, 2.02].map(|y| sim.spawn(resting(&cube, Vec3::Y * y)));
    sim.step(100);
    assert!([below, above].iter().all(|&body| sim.get::<Sleeping>(body).0));
    let points = sim.collisions().get(below, above).unwrap().points.len();
    assert!(points >= 4, "asleep they keep their points");
    sim.step(20);
    assert_eq!(sim.collisions().get(below, above).unwrap().points.len(), points);
    // The floor slides aside by a little: what lies on it is looked at anew.
    sim.world().get_mut::<Transform>(floor).unwrap().translation.x += 0.1;
    sim.step(2);
    assert!(!sim.get::<Sleeping>(below).0 && !sim.get::<Sleeping>(above).0);
    sim.step(100);
    assert!(sim.get::<Sleeping>(above).0);
    sim.world().despawn(floor);
    sim.step(20);
    assert!(sim.velocity(above).y < -1.0 && sim.velocity(below).y < -1.0);
}

pub fn who_may_not_sleep_does_not() {
    let (mut sim, cube) = on_the_ground();
    let body = sim.spawn((resting(&cube, Vec3::Y * 0.51), SleepingDisabled));
    sim.step(120);
    assert!(!sim.get::<Sleeping>(body).0);
    sim.world().entity_mut(body).remove::<SleepingDisabled>();
    sim.step(80);
    assert!(sim.get::<Sleeping>(body).0);
    sim.world().resource_mut::<SolverSettings>().sleeping = false;
    sim.step(1);
    assert!(!sim.get::<Sleeping>(body).0);
}

pub fn collisions_hold_points_and_the_weight_on_them() {
    let mut sim = Sim::new();
    sim.world().insert_resource(Gravity(Vec3::NEG_Y * 10.0));
    let cube = sim.mesh(&shapes::cube(1.0));
    let floor = sim.spawn((cube.clone(), Transform::from_scale(Vec3::new(9.0, 1.0, 9.0))));
    let body = sim.spawn((resting(&cube, Vec3::Y * 1.01), Mass(3.0), SleepingDisabled));
    sim.step(100);
    let hit = sim.collisions().get(body, floor).expect("it lies there");
    assert!(hit.faces.unwrap().is_empty(), "with a gap between");
    assert_eq!([hit.collider1, hit.collider2], sorted(body, floor));
    let up = if hit.collider1 == floor { Vec3::Y } else { Vec3::NEG_Y };
    assert_near(hit.contact.normal, up, 1e-3);
    assert!((0.49..0.52).contains(&hit.contact.point.y));
    let weight = 3.0 * 10.0 * DT;
    assert!(
        (hit.impulse - weight).abs() < 0.02 * weight,
        "{} for {weight}",
        hit.impulse
    );
    assert!(
        hit.points
            .iter()
            .all(|p| p.normal.distance(up) < 1e-3 && (0.0..0.02).contains(&p.separation))
    );
    assert_eq!(sim.report().contact_points, hit.points.len());
    let mut manifolds = sim.collisions().manifolds();
    let (one, other, points) = manifolds.next().unwrap();
    assert_eq!(([one, other], points.len()), ([floor, body], hit.points.len()));
    assert!(manifolds.next().is_none());
}

pub fn every_corner_carries_a_quarter_of_the_weight_on_meshes_and_planes() {
    let weight = 3.0 * 10.0 * DT;
    for on_plane in [false, true] {
        let mut sim = Sim::new();
        sim.world().insert_resource(Gravity(Vec3::NEG_Y * 10.0));
        let cube = sim.mesh(&shapes::cube(1.0));
        let floor = if on_plane {
            sim.spawn(PlaneCollider::through(Vec3::Y * 0.5, Vec3::Y))
        } else {
            sim.spawn((cube.clone(), Transform::from_scale(Vec3::new(9.0, 1.0, 9.0))))
        };
        let place = Vec3::new(0.2, 1.005, -0.3);
        let body = sim.spawn((resting(&cube, place), Mass(3.0), SleepingDisabled));
        sim.step(100);
        let collisions = sim.collisions();
        let hit = collisions.get(body, floor).expect("it lies there");
        let same = collisions.get(floor, body).unwrap();
        assert_eq!(
            (same.collider1, same.collider2),
            (hit.collider1, hit.collider2),
            "in either order"
        );
        assert_eq!(sorted(hit.collider1, hit.collider2), sorted(body, floor));
        let up = if hit.collider1 == floor { Vec3::Y } else { Vec3::NEG_Y };
        assert_near(hit.contact.normal, up, 1e-3);
        assert!(
            (hit.impulse - weight).abs() < 0.02 * weight,
            "{} for {weight}",
            hit.impulse
        );
        let sum: f32 = hit.points.iter().map(|p| p.impulse).sum();
        assert!((sum - hit.impulse).abs() < 1e-5 * weight, "{sum} of {}", hit.impulse);
        for corner in [[-0.5, -0.5], [-0.5, 0.5], [0.5, -0.5], [0.5, 0.5]] {
            let corner = place + Vec3::new(corner[0], -0.5, corner[1]);
            let at = |p: &&ContactPoint| p.point.distance(corner) < 0.02;
            let here: f32 = hit.points.iter().filter(at).map(|p| p.impulse).sum();
            assert!((here - weight / 4.0).abs() < 0.02 * weight, "{here} at {corner}");
        }
        assert_eq!(collisions.len(), 1);
        for found in [
            collisions.iter().next(),
            collisions.of(floor).next(),
            collisions.of(body).next(),
        ] {
            assert_eq!(
                found.map(|c| (c.collider1, c.collider2)),
                Some((hit.collider1, hit.collider2))
            );
        }
        let stranger = sim.spawn(Name::new("stranger"));
        assert!(sim.collisions().get(body, stranger).is_none() && sim.collisions().get(floor, stranger).is_none());
    }
}

pub fn points_of_a_step_in_several_intervals_add_up_to_the_whole_impulse() {
    let mut sim = Sim::new();
    let cube = sim.mesh(&shapes::cube(1.0));
    let material = (Restitution::new(1.0), Friction::new(0.0));
    let wall = sim.spawn((PlaneCollider::through(Vec3::NEG_X, Vec3::X), material));
    let start = (resting(&cube, Vec3::X * 2.0), LinearVelocity(Vec3::X * -96.0));
    let body = sim.spawn((start, Mass(2.0), material));
    for _ in 0..8 {
        let before = sim.velocity(body).x;
        sim.step(1);
        let change = 2.0 * (sim.velocity(body).x - before);
        if change != 0.0 {
            assert!(sim.report().collision_substeps > 1);
            let hit = sim.collisions().get(body, wall).expect("it bounced there");
            let sum: f32 = hit.points.iter().map(|p| p.impulse).sum();
            assert!((sum - change).abs() < 1e-4 * change, "{sum} of {change}");
            assert!((hit.impulse - change).abs() < 1e-4 * change);
            assert!(
                hit.points
                    .iter()
                    .all(|p| p.impulse == 0.0 || (p.point.x + 1.0).abs() < 0.8)
            );
            return;
        }
    }
    panic!("it never met the wall");
}

pub fn without_response_points_lie_where_the_surfaces_are() {
    let mut sim = Sim::new();
    sim.world().insert_resource(Response::None);
    let cube = sim.mesh(&shapes::cube(1.0));
    let ground = sim.spawn(PlaneCollider::through(Vec3::Y * -0.499, Vec3::Y));
    // They move by a metre a step, and all that follows is of the beginning of the second.
    let velocity = LinearVelocity(Vec3::X * 64.0);
    let one = sim.spawn((resting(&cube, Vec3::ZERO), velocity));
    let other = sim.spawn((resting(&cube, Vec3::new(0.0, 0.99, 0.0)), velocity));
    sim.step(2);
    for (pair, height) in [([one, other], 0.495), ([one, ground], -0.4995)] {
        let hit = sim.collisions().get(pair[0], pair[1]).expect("they touch");
        assert!(hit.points.iter().all(|p| p.impulse == 0.0));
        let deep: Vec<_> = hit.points.iter().filter(|p| p.separation < 0.0).collect();
        assert!(deep.len() >= 4);
        for point in deep {
            assert!((point.point.y - height).abs() < 1e-4, "{point:?}");
            assert!((0.499..1.501).contains(&point.point.x), "{point:?}");
        }
    }
}

pub fn a_body_tells_its_centre_of_mass() {
    let mut sim = Sim::new();
    let cube = shapes::cube(1.0);
    let aside = cube.vertices().iter().map(|&v| v + Vec3::new(2.0, 0.0, 0.0)).collect();
    let mesh = sim.mesh(&TriMesh::new(aside, cube.triangles().to_vec()).unwrap());
    let pose = Transform::from_xyz(0.0, 5.0, 0.0)
        .with_rotation(Quat::from_rotation_z(std::f32::consts::FRAC_PI_2))
        .with_scale(Vec3::splat(3.0));
    let body = sim.spawn((RigidBody::Dynamic, mesh, pose, Mass(2.0)));
    sim.step(1);
    let center = sim.get::<ComputedCenterOfMass>(body);
    assert_near(*center, Vec3::X * 2.0, 1e-5);
    let world = center.in_world(&pose);
    assert_near(world, Vec3::new(0.0, 11.0, 0.0), 1e-5);
    // A push there turns nothing.
    let mut push = ExternalForces::default();
    push.add_impulse_at(Vec3::X * 4.0, world, world);
    sim.set(body, push);
    sim.step(1);
    assert_near(sim.velocity(body), Vec3::X * 2.0, 1e-4);
    assert_near(sim.spin(body), Vec3::ZERO, 1e-5);
    // Another mesh has another one.
    let centred = sim.mesh(&cube);
    sim.set(body, centred);
    sim.step(1);
    assert_near(*sim.get::<ComputedCenterOfMass>(body), Vec3::ZERO, 1e-6);
}

pub fn without_response_there_are_points_too() {
    let mut sim = Sim::new();
    sim.world().insert_resource(Response::None);
    let cube = sim.mesh(&shapes::cube(1.0));
    let ground = sim.spawn(PlaneCollider::through(Vec3::NEG_Y * 0.499, Vec3::Y));
    let one = sim.spawn(resting(&cube, Vec3::ZERO));
    let near = sim.spawn(resting(&cube, Vec3::X * 1.005));
    let deep = sim.spawn(resting(&cube, Vec3::new(0.1, 0.99, 0.1)));
    sim.step(2);
    assert!(
        sim.touch(one, deep) && !sim.touch(one, near),
        "what is near does not touch"
    );
    let pairs: Vec<_> = sim.collisions().manifolds().map(|(a, b, _)| sorted(a, b)).collect();
    for pair in [sorted(one, near), sorted(one, deep), sorted(one, ground)] {
        assert!(pairs.contains(&pair), "{pair:?} of {pairs:?}");
    }
    assert!(sim.collisions().get(one, deep).unwrap().points.len() >= 4);
    assert_eq!(sim.position(near), Vec3::X * 1.005);
}

pub fn friction_holds_or_lets_slide_by_the_rule_of_the_pair() {
    for (coefficient, rule, slides) in [
        (0.0, CombineRule::Average, false),
        (0.0, CombineRule::Min, true),
        (1.0, CombineRule::Max, false),
        (0.0, CombineRule::Multiply, true),
    ] {
        let (mut sim, cube) = on_the_ground();
        let friction = Friction::new(coefficient).with_combine(rule);
        let start = (resting(&cube, Vec3::Y * 0.505), LinearVelocity(Vec3::X * 2.0), friction);
        let body = sim.spawn(start);
        sim.step(128);
        let speed = sim.velocity(body).x;
        if slides {
            assert!((speed - 2.0).abs() < 0.01, "{rule:?}: {speed}");
        } else {
            assert!(speed.abs() < 0.01, "{rule:?}: {speed}");
            // From 2 m/s by 0.25 or 1 times gravity.
            let way = 2.0 / (10.0 * if rule == CombineRule::Max { 1.0 } else { 0.25 });
            assert!(
                (sim.position(body).x - way).abs() < 0.05 * way,
                "{rule:?}: {}",
                sim.position(body)
            );
        }
    }
}

pub fn damping_limits_and_locks_hold() {
    let mut sim = Sim::new();
    let cube = sim.mesh(&shapes::cube(1.0));
    let moving = |x: f32| {
        (
            resting(&cube, Vec3::X * x),
            LinearVelocity(Vec3::Z * 8.0),
            AngularVelocity(Vec3::Y * 4.0),
        )
    };
    let damped = sim.spawn((moving(0.0), LinearDamping(1.0), AngularDamping(0.5)));
    let limited = sim.spawn((moving(10.0), MaxLinearSpeed(3.0), MaxAngularSpeed(1.0)));
    let locked = sim.spawn((moving(20.0), LockedAxes::TRANSLATION_Z | LockedAxes::ROTATION));
    sim.step(64);
    let e = std::f32::consts::E;
    assert_near(sim.velocity(damped), Vec3::Z * 8.0 / e, 0.05);
    assert_near(sim.spin(damped), Vec3::Y * 4.0 / e.sqrt(), 0.05);
    assert_near(sim.velocity(limited), Vec3::Z * 3.0, 1e-4);
    assert_near(sim.spin(limited), Vec3::Y, 1e-4);
    assert_near(sim.position(locked), Vec3::X * 20.0, 1e-6);
    assert!(sim.get::<Transform>(locked).rotation.angle_between(Quat::IDENTITY) < 1e-6);
}

pub fn forces_go_on_and_impulses_act_once() {
    let mut sim = Sim::new();
    let cube = sim.mesh(&shapes::cube(1.0));
    let pushed = sim.spawn((resting(&cube, Vec3::ZERO), Mass(2.0)));
    let turned = sim.spawn((resting(&cube, Vec3::X * 10.0), Mass(2.0)));
    let mut forces = ExternalForces {
        force: Vec3::Y * 4.0,
        ..default()
    };
    forces.add_impulse_at(Vec3::Z * 6.0, Vec3::ZERO, Vec3::ZERO);
    sim.set(pushed, forces);
    let mut turn = ExternalForces::default();
    // At the end of an arm of 1: the cube's inertia is m / 6.
    turn.add_impulse_at(Vec3::Y, Vec3::X * 11.0, Vec3::X * 10.0);
    sim.set(turned, turn);
    sim.step(32);
    assert_near(sim.velocity(pushed), Vec3::new(0.0, 1.0, 3.0), 1e-4);
    let left = sim.get::<ExternalForces>(pushed);
    assert_eq!((left.force, left.impulse), (Vec3::Y * 4.0, Vec3::ZERO));
    assert_near(sim.velocity(turned), Vec3::Y * 0.5, 1e-4);
    assert_near(sim.spin(turned), Vec3::Z * 3.0, 1e-3);
}

pub fn density_mass_and_inertia_decide_how_an_impulse_answers() {
    let mut sim = Sim::new();
    let cube = sim.mesh(&shapes::cube(2.0));
    let push = ExternalForces {
        impulse: Vec3::X * 8.0,
        angular_impulse: Vec3::Z * 8.0,
        ..default()
    };
    let mut add = |x: f32, more: (Density, Option<Mass>, Option<AngularInertia>)| {
        let body = sim.spawn((resting(&cube, Vec3::X * x), push, more.0));
        if let Some(mass) = more.1 {
            sim.set(body, mass);
        }
        if let Some(inertia) = more.2 {
            sim.set(body, inertia);
        }
        body
    };
    // A cube of edge 2 has a volume of 8 and an inertia of 2/3 of its mass.
    let dense = add(0.0, (Density(2.0), None, None));
    let light = add(20.0, (Density(2.0), Some(Mass(4.0)), None));
    let slow = add(
        40.0,
        (Density(1.0), None, Some(AngularInertia::principal(Vec3::splat(80.0)))),
    );
    sim.step(1);
    for (body, v, w) in [(dense, 0.5, 0.75), (light, 2.0, 3.0), (slow, 1.0, 0.1)] {
        assert_near(sim.velocity(body), Vec3::X * v, 1e-4);
        assert_near(sim.spin(body), Vec3::Z * w, 1e-3);
    }
}

pub fn a_platform_that_moves_carries_what_stands_on_it() {
    let (mut sim, cube) = on_the_ground();
    let platform = sim.spawn((
        RigidBody::Kinematic,
        cube.clone(),
        Transform::from_xyz(0.0, 1.0, 0.0).with_scale(Vec3::new(6.0, 0.5, 6.0)),
        LinearVelocity(Vec3::X * 0.5),
    ));
    let rider = sim.spawn(resting(&cube, Vec3::Y * 1.76));
    sim.step(192);
    let moved = sim.position(platform).x;
    assert!((moved - 1.5).abs() < 1e-3, "{moved}");
    assert!((sim.position(rider).x - moved).abs() < 0.03, "{}", sim.position(rider));
    assert!(!sim.get::<Sleeping>(rider).0, "what moves keeps awake");
}

pub fn a_bullet_flagged_so_does_not_pass_a_sheet() {
    for flagged in [true, false] {
        let mut sim = Sim::new();
        let (ball, cube) = (sim.mesh(&shapes::ball(0.05, 2)), sim.mesh(&shapes::cube(1.0)));
        sim.spawn((cube, Transform::from_scale(Vec3::new(10.0, 10.0, 0.01))));
        let bullet = sim.spawn((resting(&ball, Vec3::Z * -1.0), LinearVelocity(Vec3::Z * 400.0)));
        if flagged {
            sim.set(bullet, ContinuousCollision);
        }
        sim.step(10);
        assert_eq!(sim.position(bullet).z < 0.0, flagged, "{}", sim.position(bullet));
    }
}

pub fn a_snapshot_of_a_pile_goes_on_to_the_bit() {
    let (mut sim, cube) = on_the_ground();
    let bodies: Vec<_> = (0..8)
        .map(|i| {
            let at = Vec3::new(0.1 * (i % 3) as f32, 0.6 + 1.05 * i as f32, 0.07 * i as f32);
            sim.spawn(resting(&cube, at))
        })
        .collect();
    let motions = |sim: &Sim| -> Vec<_> {
        let of = |&body: &Entity| {
            (
                sim.get::<Transform>(body),
                sim.velocity(body),
                sim.get::<Sleeping>(body),
            )
        };
        bodies.iter().map(of).collect()
    };
    // Falling, in the heap, and when some sleep.
    for before in [20, 40, 100, 300] {
        sim.step(before);
        let snapshot = Snapshot::take(sim.world());
        sim.step(30);
        let after = motions(&sim);
        sim.step(25);
        assert!(snapshot.restore(sim.world()).is_empty());
        sim.step(30);
        assert_eq!(motions(&sim), after);
    }
}

pub fn settings_and_components_that_cannot_be_used_are_told() {
    let (mut sim, cube) = on_the_ground();
    let body = sim.spawn(resting(&cube, Vec3::Y * 0.51));
    sim.world().resource_mut::<SolverSettings>().frequency = f32::NAN;
    sim.step(60);
    assert!((sim.position(body).y - 0.51).abs() < 0.01, "the defaults hold instead");
    assert_eq!(SolverSettings::default().fault(), None);
    let bad = SolverSettings {
        sleep_time: -1.0,
        ..default()
    };
    assert_eq!(bad.fault(), Some("sleep_time"));
    let flat = AngularInertia(Mat3::from_diagonal(Vec3::new(1.0, 0.0, 1.0)));
    sim.set(body, flat);
    sim.step(1);
    assert_eq!(sim.rejected.len(), 1);
    assert!(sim.rejected[0].fault.to_string().contains("AngularInertia::principal"));
}

/// A plane that collides with layer 2 alone holds a body of this layer. Another one falls through it.
pub fn planes_obey_layers() {
    for response in [Response::Contacts, Response::Impulse, Response::None] {
        let mut sim = Sim::new();
        sim.world().insert_resource(response);
        sim.world().insert_resource(Gravity::default());
        let cube = sim.mesh(&shapes::cube(1.0));
        let only_two = CollisionLayers {
            memberships: 1,
            filters: 2,
        };
        let plane = sim.spawn((PlaneCollider::through(Vec3::ZERO, Vec3::Y), only_two));
        let [held, falls] = [2, 1].map(|memberships| {
            let layers = CollisionLayers {
                memberships,
                ..default()
            };
            sim.spawn((resting(&cube, Vec3::new(4.0 * memberships as f32, 0.49, 0.0)), layers))
        });
        sim.step(2);
        assert!(sim.touch(plane, held), "{response:?}");
        assert!(!sim.touch(plane, falls), "{response:?}");
        sim.step(30);
        assert!(sim.position(falls).y < -0.5);
        if response == Response::Contacts {
            assert!((sim.position(held).y - 0.5).abs() < 0.01);
        }
    }
}
