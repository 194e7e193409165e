//! What a game decides about pairs itself: conveyor belts, one-way platforms, friends that pass through each other.
//! Other tests run them beside a GPU.

use crate::app::{Sim, assert_near, resting, sorted};
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;

/// The velocity of a belt, m/s.
#[derive(Component)]
#[require(ActiveCollisionHooks = ActiveCollisionHooks::MODIFY_CONTACTS)]
struct Belt(Vec3);

/// A platform through which bodies rise.
#[derive(Component)]
#[require(ActiveCollisionHooks = ActiveCollisionHooks::MODIFY_CONTACTS)]
struct OneWay;

/// A coefficient of friction with everything.
#[derive(Component)]
#[require(ActiveCollisionHooks = ActiveCollisionHooks::MODIFY_CONTACTS)]
struct Slippery(f32);

/// Members of the same team pass through each other.
#[derive(Component, PartialEq)]
#[require(ActiveCollisionHooks = ActiveCollisionHooks::FILTER_PAIRS)]
struct Team(u32);

/// A body that was asked about.
#[derive(Component)]
struct Asked;

#[derive(SystemParam)]
struct Rules<'w, 's> {
    belts: Query<'w, 's, &'static Belt>,
    one_way: Query<'w, 's, (), With<OneWay>>,
    slippery: Query<'w, 's, &'static Slippery>,
    teams: Query<'w, 's, &'static Team>,
    velocities: Query<'w, 's, &'static LinearVelocity>,
}

impl CollisionHooks for Rules<'_, '_> {
    fn filter_pairs(&self, one: Entity, other: Entity, commands: &mut Commands) -> bool {
        commands.entity(one).insert(Asked);
        !matches!((self.teams.get(one), self.teams.get(other)), (Ok(a), Ok(b)) if a == b)
    }

    fn modify_contacts(&self, contacts: &mut ContactPair, _: &mut Commands) -> bool {
        for (side, sign) in [(contacts.collider1, -1.0), (contacts.collider2, 1.0)] {
            if let Ok(belt) = self.belts.get(side) {
                contacts.surface.tangent_velocity += sign * belt.0;
            }
            if let Ok(slippery) = self.slippery.get(side) {
                contacts.surface.friction = slippery.0;
            }
        }
        let other = match [contacts.collider1, contacts.collider2].map(|side| self.one_way.contains(side)) {
            [true, false] => contacts.body2,
            [false, true] => contacts.body1,
            _ => return true,
        };
        let rises = self.velocities.get(other).is_ok_and(|velocity| velocity.y > 0.1);
        !rises && contacts.points.iter().all(|point| point.separation > -0.1)
    }
}

/// A world with gravity and these hooks.
fn with_rules() -> Sim {
    let mut sim = Sim::with_plugin(CollisionHooksPlugin::<Rules>::default());
    sim.world().insert_resource(Response::Contacts);
    sim.world().insert_resource(Gravity::default());
    sim
}

const FLOOR: Vec3 = Vec3::new(40.0, 1.0, 40.0);

pub fn a_belt_carries_a_crate_at_its_speed() {
    let (fast, slow) = (Vec3::new(1.5, 0.0, -0.5), Vec3::X * 0.03);
    for (on_plane, wanted) in [(false, fast), (true, fast), (false, slow)] {
        let mut sim = with_rules();
        let cube = sim.mesh(&shapes::cube(1.0));
        let belt = Belt(wanted);
        if on_plane {
            sim.spawn((PlaneCollider::through(Vec3::ZERO, Vec3::Y), belt));
        } else {
            let floor = Transform::from_xyz(0.0, -0.5, 0.0).with_scale(FLOOR);
            sim.spawn((cube.clone(), floor, belt));
        }
        let crates = [0.0, 3.0].map(|z| sim.spawn(resting(&cube, Vec3::new(0.0, 0.5, z))));
        sim.step(64);
        for body in crates {
            assert_near(sim.velocity(body), wanted, 0.02);
            assert_near(sim.spin(body), Vec3::ZERO, 0.05);
        }
        sim.step(64);
        let start = sim.position(crates[0]);
        sim.step(64);
        assert_near(sim.position(crates[0]) - start, wanted, 0.01);
        assert!(!sim.get::<Sleeping>(crates[0]).0, "what a belt carries is awake");
    }
}

pub fn a_ball_jumps_through_a_platform_from_below_and_lands_on_it() {
    for is_continuous in [false, true] {
        jump(is_continuous);
    }
}

fn jump(is_continuous: bool) {
    let mut sim = with_rules();
    let ball = sim.mesh(&shapes::ball(0.25, 2));
    let cube = sim.mesh(&shapes::cube(1.0));
    let platform = Transform::from_xyz(0.0, 2.0, 0.0).with_scale(Vec3::new(4.0, 0.2, 4.0));
    let platform = sim.spawn((cube, platform, OneWay));
    let jumper = sim.spawn((RigidBody::Dynamic, ball, Transform::from_xyz(0.0, 0.5, 0.0)));
    sim.set(jumper, LinearVelocity(Vec3::Y * 8.0));
    if is_continuous {
        sim.set(jumper, ContinuousCollision);
    }
    let mut highest = 0.0f32;
    for _ in 0..192 {
        sim.step(1);
        highest = highest.max(sim.position(jumper).y);
        if sim.velocity(jumper).y > 0.2 {
            assert!(!sim.touch(platform, jumper), "dropped contacts are not reported");
        }
    }
    // Without the platform it would rise to 0.5 + 8^2 / (2 g).
    assert!((highest - 3.76).abs() < 0.1, "{highest}");
    assert!((sim.position(jumper).y - 2.35).abs() < 0.01, "{}", sim.position(jumper));
    assert!(sim.touch(platform, jumper));
    assert_eq!(sim.started.len(), 1, "it started to touch when it landed");
}

pub fn friction_of_a_pair_is_what_the_hook_says() {
    let mut sim = with_rules();
    let cube = sim.mesh(&shapes::cube(1.0));
    let floor = Transform::from_xyz(0.0, -0.5, 0.0).with_scale(FLOOR);
    sim.spawn((cube.clone(), floor));
    let sliders = [0.0, 0.2, f32::NAN].map(|friction| {
        let z = if friction.is_nan() { 4.0 } else { 10.0 * friction - 2.0 };
        let body = sim.spawn((resting(&cube, Vec3::new(0.0, 0.5, z)), Slippery(friction)));
        sim.set(body, LinearVelocity(Vec3::X * 3.0));
        body
    });
    sim.step(32);
    let speeds = sliders.map(|body| sim.velocity(body).x);
    // It loses `mu g t`; a coefficient that is no number counts as none was set: 0.5.
    for (speed, wanted) in speeds
        .into_iter()
        .zip([3.0, 3.0 - 0.2 * 9.81 * 0.5, 3.0 - 0.5 * 9.81 * 0.5])
    {
        assert!((speed - wanted).abs() < 0.05, "{speeds:?}");
    }
}

pub fn friends_pass_through_each_other_and_foes_do_not() {
    let mut sim = with_rules();
    sim.world().insert_resource(Gravity(Vec3::ZERO));
    let cube = sim.mesh(&shapes::cube(1.0));
    let mut fly = |at: Vec3, v: Vec3, team| {
        let body = sim.spawn((resting(&cube, at), Team(team)));
        sim.set(body, LinearVelocity(v));
        body
    };
    let friends = [
        fly(Vec3::X * -2.0, Vec3::X * 2.0, 1),
        fly(Vec3::X * 2.0, Vec3::X * -2.0, 1),
    ];
    let foes = [
        fly(Vec3::new(-2.0, 5.0, 0.0), Vec3::X * 2.0, 1),
        fly(Vec3::new(2.0, 5.0, 0.0), Vec3::X * -2.0, 2),
    ];
    let bystander = sim.spawn(resting(&cube, Vec3::Y * -5.0));
    sim.step(128);
    assert_near(sim.position(friends[0]), Vec3::X * 2.0, 1e-3);
    assert!(sim.position(foes[0]).x < -0.4);
    let [a, b] = sorted(foes[0], foes[1]);
    assert!(
        sim.started
            .iter()
            .all(|start| [start.collider1, start.collider2] == [a, b])
    );
    assert!(!sim.started.is_empty());
    // Only who has the component is asked about.
    assert!(sim.app.world().get::<Asked>(bystander).is_none());
    let was_asked = |body| sim.app.world().get::<Asked>(body).is_some();
    assert!(was_asked(a) || was_asked(b));
}

/// A crate sleeps beside a ghost of its team. Far away a fast, thin plate needs several collision substeps.
pub fn a_sleeper_beside_a_ghost_sleeps_on() {
    let mut sim = with_rules();
    let cube = sim.mesh(&shapes::cube(1.0));
    let floor = Transform::from_xyz(0.0, -0.5, 0.0).with_scale(FLOOR);
    sim.spawn((cube.clone(), floor));
    sim.spawn((cube.clone(), Transform::from_xyz(0.5, 0.5, 0.0), Team(1)));
    let body = sim.spawn((resting(&cube, Vec3::Y * 0.5), Team(1)));
    for i in 0..2 {
        let plate = Transform::from_xyz(100.0 + 1.5 * i as f32, 0.5, 0.0).with_scale(Vec3::new(0.02, 1.0, 1.0));
        sim.spawn((
            RigidBody::Dynamic,
            cube.clone(),
            plate,
            AngularVelocity(Vec3::X * 10.0),
            LinearVelocity(Vec3::X * -3.0 * i as f32),
            GravityScale(0.0),
            SleepingDisabled,
        ));
    }
    sim.step(64);
    assert!(sim.report().collision_substeps > 1, "{:?}", sim.report());
    for _ in 0..8 {
        sim.step(1);
        assert!(sim.get::<Sleeping>(body).0);
    }
}

/// A member of its team flies through a crate that sleeps.
pub fn a_sleeper_sleeps_on_when_a_friend_passes_through() {
    let mut sim = with_rules();
    let cube = sim.mesh(&shapes::cube(1.0));
    let floor = Transform::from_xyz(0.0, -0.5, 0.0).with_scale(FLOOR);
    sim.spawn((cube.clone(), floor));
    let body = sim.spawn((resting(&cube, Vec3::Y * 0.5), Team(1)));
    let friend = sim.spawn((resting(&cube, Vec3::new(-20.0, 0.8, 0.0)), Team(1), GravityScale(0.0)));
    sim.set(friend, LinearVelocity(Vec3::X * 10.0));
    sim.step(64);
    assert!(sim.get::<Sleeping>(body).0);
    for _ in 0..128 {
        sim.step(1);
        assert!(sim.get::<Sleeping>(body).0, "the friend is at {}", sim.position(friend));
    }
    assert!(sim.position(friend).x > 5.0);
}

/// A crate sleeps on a floor of another team. When the floor changes sides, the crate wakes and falls; so it does on a
/// plane.
pub fn a_sleeper_wakes_when_the_filter_changes_its_mind() {
    for on_plane in [false, true] {
        let mut sim = with_rules();
        let cube = sim.mesh(&shapes::cube(1.0));
        let floor = if on_plane {
            sim.spawn((PlaneCollider::through(Vec3::ZERO, Vec3::Y), Team(1)))
        } else {
            let floor = Transform::from_xyz(0.0, -0.5, 0.0).with_scale(FLOOR);
            sim.spawn((cube.clone(), floor, Team(1)))
        };
        let body = sim.spawn((resting(&cube, Vec3::Y * 0.5), Team(2)));
        sim.step(128);
        assert!(sim.get::<Sleeping>(body).0 && sim.touch(floor, body));
        sim.set(floor, Team(2));
        sim.step(16);
        assert!(!sim.get::<Sleeping>(body).0);
        assert!(sim.position(body).y < 0.3, "{}", sim.position(body));
        assert!(!sim.touch(floor, body));
        sim.step(16);
        assert_eq!((sim.started.len(), sim.ended.len()), (1, 1));
    }
}
