//! Bodies in Bevy's scene notation, `bsn!`.

use crate::app::Sim;
use bevy::asset::LoadState;
use bevy::ecs::system::RunSystemOnce;
use bevy::prelude::*;
use bevy::scene::ScenePlugin;
use bevy_faceoff::prelude::*;
use std::time::{Duration, Instant};

/// An app in which these meshes are loaded.
fn sim() -> (Sim, [MeshCollider; 2]) {
    let mut sim = Sim::with_plugin(ScenePlugin);
    let server = sim.world().resource::<AssetServer>().clone();
    let meshes = ["cube.bake.ron", "torus.bake.ron"].map(|path| MeshCollider(server.load(path)));
    let start = Instant::now();
    while !meshes
        .iter()
        .all(|mesh| matches!(server.load_state(&mesh.0), LoadState::Loaded))
    {
        assert!(start.elapsed() < Duration::from_secs(60), "the meshes are not loaded");
        std::thread::sleep(Duration::from_millis(1));
        sim.app.update();
    }
    sim.world().insert_resource(Gravity::default());
    (sim, meshes)
}

fn ground() -> impl Scene {
    bsn! {
        #Ground
        PlaneCollider::through(Vec3::ZERO, Vec3::Y)
        Friction { coefficient: 0.9, combine: CombineRule::Max }
    }
}

/// A body of two colliders.
fn hammer() -> impl Scene {
    bsn! {
        #Hammer
        RigidBody::Dynamic
        Transform::from_xyz(0.0, 1.5, 0.0)
        LinearVelocity(Vec3 { x: 0.5 })
        AngularVelocity({ Vec3::new(0.0, 1.0, 2.0) })
        Friction::new(0.8)
        Restitution { coefficient: 0.25 }
        CollisionLayers { memberships: 2 }
        Children [
            (
                #Handle
                MeshCollider("cube.bake.ron")
                Transform { scale: {Vec3::new(0.1, 1.0, 0.1)} }
                Density(0.7)
            ),
            (
                #Head
                MeshCollider("torus.bake.ron")
                Transform { translation: Vec3 { y: 0.6 }, scale: {Vec3::splat(0.3)} }
                Density(7.8)
            ),
        ]
    }
}

/// The hammer as components.
fn hammer_in_rust([cube, torus]: &[MeshCollider; 2]) -> impl Bundle + use<> {
    (
        RigidBody::Dynamic,
        Transform::from_xyz(0.0, 1.5, 0.0),
        LinearVelocity(Vec3::X * 0.5),
        AngularVelocity(Vec3::new(0.0, 1.0, 2.0)),
        Friction::new(0.8),
        Restitution::new(0.25),
        CollisionLayers {
            memberships: 2,
            ..default()
        },
        children![
            (
                cube.clone(),
                Transform::from_scale(Vec3::new(0.1, 1.0, 0.1)),
                Density(0.7),
            ),
            (
                torus.clone(),
                Transform::from_xyz(0.0, 0.6, 0.0).with_scale(Vec3::splat(0.3)),
                Density(7.8),
            ),
        ],
    )
}

#[test]
fn a_body_in_bsn_moves_like_the_same_components() {
    let (mut sim, _) = self::sim();
    sim.world().spawn_scene(ground()).unwrap();
    let in_bsn = sim.world().spawn_scene(hammer()).unwrap().id();

    let (mut twin, meshes) = self::sim();
    twin.spawn((
        PlaneCollider::default(),
        Friction::new(0.9).with_combine(CombineRule::Max),
    ));
    let in_rust = twin.spawn(hammer_in_rust(&meshes));

    sim.step(100);
    twin.step(100);
    let transform: Transform = sim.get(in_bsn);
    assert_eq!(transform, twin.get(in_rust));
    assert_eq!(sim.velocity(in_bsn), twin.velocity(in_rust));
    assert!(
        !sim.collisions().is_empty() && transform.translation.y < 1.0,
        "it lies on the ground: {transform:?}"
    );
    assert!(sim.rejected.is_empty());
}

/// All but `ShapeCaster`, which may hold a handle.
#[test]
fn components_can_be_written() {
    let (mut sim, [cube, _]) = self::sim();
    let entity = sim
        .world()
        .spawn_scene(bsn! {
            RigidBody::Kinematic
            MeshCollider("cube.bake.ron")
            Mass(2.0)
            AngularInertia::principal(Vec3::ONE)
            CenterOfMass(Vec3 { x: 0.25 })
            GravityScale(0.5)
            LinearDamping(0.1)
            AngularDamping(0.2)
            MaxLinearSpeed(3.0)
            MaxAngularSpeed
            LockedAxes::ROTATION
            ExternalForces { force: Vec3 { y: 1.0 } }
            Sleeping
            SleepingDisabled
            ContinuousCollision
            ActiveCollisionHooks { filter_pairs: true }
            Sensor
            ColliderDisabled
            RigidBodyDisabled
            Teleport
            BodyCulling({ Culling::FrontFacing })
            CollidingEntities
            CollisionEventsEnabled
            Character { radius: 0.4, filter: SpatialQueryFilter { sensors: false } }
            RayCaster { max_distance: 3.0 }
        })
        .unwrap()
        .id();
    assert_eq!(sim.get::<RigidBody>(entity), RigidBody::Kinematic);
    assert_eq!(sim.get::<MeshCollider>(entity), cube);
    assert_eq!(sim.get::<Mass>(entity), Mass(2.0));
    assert_eq!(sim.get::<CenterOfMass>(entity), CenterOfMass(Vec3::X * 0.25));
    assert_eq!(sim.get::<LockedAxes>(entity), LockedAxes::ROTATION);
    assert_eq!(sim.get::<MaxAngularSpeed>(entity), MaxAngularSpeed::default());
    assert_eq!(
        sim.get::<ActiveCollisionHooks>(entity),
        ActiveCollisionHooks::FILTER_PAIRS
    );
    assert_eq!(sim.get::<BodyCulling>(entity), BodyCulling(Culling::FrontFacing));
    let character: Character = sim.get(entity);
    assert_eq!([character.radius, character.half_length], [0.4, 0.6]);
    assert!(!character.filter.sensors && character.filter.layers == u32::MAX);
    let ray: RayCaster = sim.get(entity);
    assert!(ray.enabled && ray.max_distance == 3.0);
}

/// Scenes build on each other, and a variant of the kind of body can be chosen later.
#[test]
fn a_scene_is_changed_by_another() {
    let (mut sim, _) = self::sim();
    let fixed = bsn! {
        hammer()
        RigidBody::Static
        Friction { combine: CombineRule::Min }
    };
    let fixed = sim.world().spawn_scene(fixed).unwrap().id();
    assert_eq!(sim.get::<RigidBody>(fixed), RigidBody::Static);
    assert_eq!(
        sim.get::<Friction>(fixed),
        Friction::new(0.8).with_combine(CombineRule::Min)
    );
    sim.step(10);
    assert_eq!(sim.position(fixed), Vec3::Y * 1.5);
}

/// A mesh that no path names is reported, and the body takes part once it has one.
#[test]
fn a_collider_without_a_path_is_rejected_until_it_has_a_mesh() {
    let (mut sim, [cube, _]) = self::sim();
    let scene = bsn! {
        RigidBody
        MeshCollider
    };
    let body = sim.world().spawn_scene(scene).unwrap().id();
    sim.step(3);
    let rejected: Vec<_> = sim.rejected.iter().map(|r| (r.entity, r.fault)).collect();
    assert_eq!(rejected, [(body, BodyFault::MeshMissing)]);
    assert_eq!(sim.velocity(body), Vec3::ZERO);
    sim.set(body, cube);
    sim.step(3);
    assert!(sim.velocity(body).y < 0.0);
}

/// Commands spawn scenes too.
#[test]
fn commands_spawn_bodies() {
    let (mut sim, _) = self::sim();
    let spawn = |mut commands: Commands| {
        commands.spawn_scene(hammer());
    };
    sim.world().run_system_once(spawn).unwrap();
    sim.step(3);
    let mut bodies = sim.world().query::<(&RigidBody, &LinearVelocity)>();
    let (_, velocity) = bodies.single(sim.world()).unwrap();
    assert!(velocity.y < 0.0);
}
