//! Scenes of Avian's examples, with exact meshes where bodies have colliders.

use crate::world::{Contacts, HZ, World};
use avian_faceoff::prelude::*;
use avian3d::math::{AdjustPrecision, AsF32, Scalar, Vector};
use avian3d::prelude::*;
use bevy::ecs::system::SystemParam;
use bevy::ecs::system::lifetimeless::Read;
use bevy::prelude::*;
use bevy_faceoff::testing::scenes::{Body, Shape};

fn weightless() -> World {
    let mut world = World::new(Contacts::Exact);
    world.app.insert_resource(Gravity(Vector::ZERO));
    world
}

/// A body that turns about z, and a cube for a joint.
fn anchor_and_cube(world: &mut World, at: Vec3) -> [Entity; 2] {
    let spin = AngularVelocity((Vec3::Z * 1.5).adjust_precision());
    let anchor = world
        .app
        .world_mut()
        .spawn((RigidBody::Kinematic, spin, Transform::default()))
        .id();
    world.shape(anchor, Shape::Cube);
    let cube = world.add(&Body::new(Shape::Cube, at, Quat::IDENTITY));
    [anchor, cube]
}

#[test]
fn fixed_joint() {
    let mut world = weightless();
    world.app.insert_resource(SubstepCount(50));
    let [anchor, cube] = anchor_and_cube(&mut world, Vec3::X * 1.5);
    let arm = Vec3::X * 1.5;
    world
        .app
        .world_mut()
        .spawn(FixedJoint::new(anchor, cube).with_local_anchor1(arm.adjust_precision()));
    world.begin();
    for _ in 0..4 * HZ {
        world.step();
        let wanted = world.position(anchor) + world.rotation(anchor) * arm;
        assert!(world.position(cube).distance(wanted) < 0.02, "{}", world.position(cube));
        assert!(world.rotation(cube).angle_between(world.rotation(anchor)) < 0.05);
    }
}

#[test]
fn revolute_joint() {
    let mut world = World::new(Contacts::Exact);
    world.app.insert_resource(SubstepCount(50));
    let [anchor, cube] = anchor_and_cube(&mut world, Vec3::NEG_Y * 2.0);
    let arm = Vec3::Y * 2.0;
    let joint = RevoluteJoint::new(anchor, cube)
        .with_local_anchor2(arm.adjust_precision())
        .with_angle_limits(-1.0, 1.0);
    world.app.world_mut().spawn(joint);
    world.begin();
    let mut most: f32 = 0.0;
    for _ in 0..4 * HZ {
        world.step();
        let hinge = world.position(cube) + world.rotation(cube) * arm;
        assert!(hinge.length() < 0.05, "the joint has stretched by {} m", hinge.length());
        let axis = world.rotation(cube) * Vec3::Z;
        assert!(axis.dot(Vec3::Z) > 0.999, "the axis has turned to {axis}");
        most = most.max(world.rotation(cube).angle_between(world.rotation(anchor)));
    }
    assert!((0.8..1.1).contains(&most), "the largest angle is {most}");
}

#[test]
fn spherical_joints_make_a_chain() {
    let mut world = World::new(Contacts::Exact);
    world.app.insert_resource(SubstepCount(40));
    let (count, radius) = (20, 0.06);
    let anchor = |y: f32| (Vec3::Y * 1.1 * y).adjust_precision();
    let mut before = world
        .app
        .world_mut()
        .spawn((RigidBody::Kinematic, Transform::default()))
        .id();
    world.bodies.push(before);
    for i in 1..count {
        let mut ball = Body::new(Shape::Ball, Vec3::NEG_Y * (2.2 * radius * i as f32), Quat::IDENTITY);
        ball.scale = Vec3::splat(2.0 * radius);
        let ball = world.add(&ball);
        let joint = SphericalJoint::new(before, ball)
            .with_local_anchor1(anchor(-radius))
            .with_local_anchor2(anchor(radius));
        world.app.world_mut().spawn(joint.with_point_compliance(0.00001));
        before = ball;
    }
    world.begin();
    let push = LinearVelocity(Vec3::X.adjust_precision());
    world.app.world_mut().entity_mut(before).insert(push);
    for _ in 0..3 * HZ {
        world.step();
        for pair in world.bodies.windows(2) {
            let apart = world.position(pair[0]).distance(world.position(pair[1]));
            assert!(apart < 1.1 * 2.2 * radius, "neighbours are {apart} m apart");
        }
    }
}

#[derive(Component)]
#[require(ActiveCollisionHooks::MODIFY_CONTACTS)]
struct ConveyorBelt(Vec3);

#[derive(SystemParam)]
struct ConveyorHooks<'w, 's> {
    belts: Query<'w, 's, (Read<ConveyorBelt>, Read<GlobalTransform>)>,
}

impl CollisionHooks for ConveyorHooks<'_, '_> {
    fn modify_contacts(&self, contacts: &mut ContactPair, _: &mut Commands) -> bool {
        let first = self.belts.get(contacts.collider1).map(|belt| (belt, -1.0));
        let Ok(((belt, pose), sign)) = first.or_else(|_| self.belts.get(contacts.collider2).map(|belt| (belt, 1.0)))
        else {
            return true;
        };
        for manifold in &mut contacts.manifolds {
            manifold.tangent_velocity = (pose.rotation() * belt.0 * sign).adjust_precision();
        }
        true
    }
}

#[test]
fn conveyor_belt() {
    let plugins = PhysicsPlugins::default()
        .with_collision_hooks::<ConveyorHooks>()
        .with_exact_meshes();
    let mut world = World::with(Contacts::Exact, plugins);
    let mut belt = Body::new(Shape::Cube, Vec3::NEG_Y * 0.5, Quat::IDENTITY);
    (belt.fixed, belt.scale) = (true, Vec3::new(20.0, 1.0, 4.0));
    belt.friction = bevy_faceoff::types::material::Friction::new(1.0);
    world.add_with(&belt, ConveyorBelt(Vec3::X * 3.0));
    let cube = world.add(&Body::new(Shape::Cube, Vec3::new(-8.0, 0.5, 0.0), Quat::IDENTITY));
    // One of Avian's own shapes rides beside it.
    let mut spawn = |collider: Collider, at: Vec3| {
        world
            .app
            .world_mut()
            .spawn((
                RigidBody::Dynamic,
                collider,
                Transform::from_translation(at),
                SleepingDisabled,
            ))
            .id()
    };
    let cuboid = spawn(Collider::cuboid(1.0, 1.0, 1.0), Vec3::new(-8.0, 0.5, 1.5));
    world.begin();
    world.steps(4 * HZ);
    for body in [cube, cuboid] {
        let speed = world.velocity(body);
        assert!(speed.distance(Vec3::X * 3.0) < 0.1, "it moves at {speed}");
        assert!(world.position(body).x > 0.0);
    }
}

#[derive(Component)]
#[require(ActiveCollisionHooks::MODIFY_CONTACTS)]
struct OneWayPlatform;

#[derive(SystemParam)]
struct PlatformHooks<'w, 's> {
    platforms: Query<'w, 's, Entity, With<OneWayPlatform>>,
}

impl CollisionHooks for PlatformHooks<'_, '_> {
    /// Contacts hold only what lies on the platform.
    fn modify_contacts(&self, contacts: &mut ContactPair, _: &mut Commands) -> bool {
        let up = match (
            self.platforms.contains(contacts.collider1),
            self.platforms.contains(contacts.collider2),
        ) {
            (true, _) => 1.0,
            (_, true) => -1.0,
            _ => return true,
        };
        let on_top = |manifold: &ContactManifold| {
            let depth = manifold.find_deepest_contact().map_or(0.0, |point| point.penetration);
            up * manifold.normal.y > 0.7 && depth < 0.1
        };
        contacts.manifolds.retain(on_top);
        !contacts.manifolds.is_empty()
    }
}

#[test]
fn one_way_platform() {
    let plugins = PhysicsPlugins::default()
        .with_collision_hooks::<PlatformHooks>()
        .with_exact_meshes();
    let mut world = World::with(Contacts::Exact, plugins);
    let mut platform = Body::new(Shape::Cube, Vec3::Y * 2.0, Quat::IDENTITY);
    (platform.fixed, platform.scale) = (true, Vec3::new(4.0, 0.2, 4.0));
    world.add_with(&platform, OneWayPlatform);
    // It jumps from below through the platform.
    let mut cube = Body::new(Shape::Cube, Vec3::ZERO, Quat::IDENTITY);
    (cube.scale, cube.velocity) = (Vec3::splat(0.5), Vec3::Y * 8.5);
    let cube = world.add(&cube);
    world.begin();
    let mut highest: f32 = 0.0;
    for _ in 0..4 * HZ {
        world.step();
        highest = highest.max(world.position(cube).y);
    }
    assert!(highest > 3.0, "it gets to {highest} m only");
    let height = world.position(cube).y;
    assert!((height - 2.35).abs() < 0.02, "it lies at {height} m");
}

#[derive(Component)]
struct Player;

/// Walks along x, as in Avian's example.
fn move_and_slide(
    mut player: Query<(Entity, &mut Transform, &Collider), With<Player>>,
    slide: MoveAndSlide,
    time: Res<Time>,
) {
    for (entity, mut transform, collider) in &mut player {
        let output = slide.move_and_slide(
            collider,
            transform.translation.adjust_precision(),
            transform.rotation.adjust_precision(),
            Vec3::new(2.0, 0.0, 0.5).adjust_precision(),
            time.delta(),
            &MoveAndSlideConfig::default(),
            &SpatialQueryFilter::from_excluded_entities([entity]),
            |_| MoveAndSlideHitResponse::Accept,
        );
        transform.translation = output.position.f32();
    }
}

#[test]
fn a_character_slides_along_a_mesh() {
    let mut world = weightless();
    let mut wall = Body::new(Shape::Cube, Vec3::X * 3.0, Quat::IDENTITY);
    (wall.fixed, wall.scale) = (true, Vec3::new(1.0, 4.0, 20.0));
    world.add(&wall);
    let radius: Scalar = 0.5;
    let player = (
        Player,
        RigidBody::Kinematic,
        CustomPositionIntegration,
        Collider::sphere(radius),
        Transform::default(),
    );
    let player = world.app.world_mut().spawn(player).id();
    world.app.add_systems(FixedUpdate, move_and_slide);
    world.begin();
    world.steps(4 * HZ);
    let at = world.position(player);
    // The wall's face is at 2.5.
    assert!((at.x - 2.0).abs() < 0.05, "it stops at {at}");
    assert!(at.z > 1.5, "it slides to {at}");
}
