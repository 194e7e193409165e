//! Worlds that are saved with Bevy's `DynamicWorld` and go on in another app.

use crate::app::Sim;
use crate::asset_app::{update_until, write};
use crate::prefab;
use bevy::asset::LoadState;
use bevy::ecs::entity::{EntityHashMap, MapEntities};
use bevy::prelude::*;
use bevy::world_serialization::serde::WorldDeserializer;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;
use serde::de::DeserializeSeed;
use serde_json::json;
use std::collections::BTreeMap;

const MESHES: [&str; 3] = ["cube.bake.ron", "torus.bake.ron", "ring.bake.ron"];

/// An app in which the meshes are loaded, with so many entities before those of the scene.
fn sim(others: usize) -> (Sim, [MeshCollider; 3]) {
    let mut sim = Sim::new();
    let server = sim.world().resource::<AssetServer>().clone();
    let meshes = MESHES.map(|path| MeshCollider(server.load(path)));
    update_until(&mut sim.app, |_| {
        let is_loaded = |mesh: &MeshCollider| matches!(server.load_state(&mesh.0), LoadState::Loaded);
        meshes.iter().all(is_loaded)
    });
    for _ in 0..others {
        sim.world().spawn_empty();
    }
    (sim, meshes)
}

/// All that has a name, and the settings, as RON.
fn save(sim: &mut Sim) -> String {
    saved(sim).1
}

fn saved(sim: &mut Sim) -> (DynamicWorld, String) {
    let world = sim.world();
    let named: Vec<Entity> = world.query_filtered::<Entity, With<Name>>().iter(world).collect();
    let registry = world.resource::<AppTypeRegistry>().read();
    let saved = DynamicWorldBuilder::from_world(world, &registry)
        .deny_all_resources()
        .allow_resource::<Gravity>()
        .allow_resource::<EventHysteresis>()
        .allow_resource::<Response>()
        .allow_resource::<Culling>()
        .allow_resource::<SolverSettings>()
        .allow_resource::<StepLimits>()
        .allow_resource::<Backend>()
        .allow_resource::<ActiveBackend>()
        .allow_resource::<Collisions>()
        .allow_resource::<StepReport>()
        .allow_resource::<Time<Physics>>()
        .extract_resources()
        .extract_entities(named.into_iter())
        .build();
    let text = saved.serialize(&registry).unwrap();
    (saved, text)
}

fn load(sim: &mut Sim, text: &str) -> EntityHashMap<Entity> {
    let server = sim.world().resource::<AssetServer>().clone();
    let registry = sim.world().resource::<AppTypeRegistry>().clone();
    let reader = WorldDeserializer {
        type_registry: &registry.read(),
        load_from_path: &mut &server,
    };
    let scene = reader.deserialize(&mut ron::Deserializer::from_str(text).unwrap());
    let mut entities = EntityHashMap::default();
    scene.unwrap().write_to_world(sim.world(), &mut entities).unwrap();
    entities
}

/// The bits of the pose and the velocities of everything that has a name, and what characters stand on.
type State = BTreeMap<String, (Vec<u32>, Option<GroundContact>)>;

fn state(sim: &mut Sim) -> State {
    let world = sim.world();
    let mut all = world.query::<(
        &Name,
        &Transform,
        Option<&LinearVelocity>,
        Option<&AngularVelocity>,
        Option<&Character>,
        Option<&CharacterGround>,
    )>();
    let mut state = State::new();
    for (name, transform, linear, angular, character, ground) in all.iter(world) {
        let vectors = [
            transform.translation,
            linear.map_or(Vec3::ZERO, |v| v.0),
            angular.map_or(Vec3::ZERO, |w| w.0),
            character.map_or(Vec3::ZERO, |character| character.velocity),
        ];
        let numbers = vectors
            .into_iter()
            .flat_map(|vector| vector.to_array())
            .chain(transform.rotation.to_array());
        let bits = numbers.map(f32::to_bits).collect();
        state.insert(name.to_string(), (bits, ground.and_then(|ground| **ground)));
    }
    state
}

/// The state without the numbers of entities.
fn without_entities(mut state: State) -> State {
    for (_, ground) in state.values_mut() {
        if let Some(ground) = ground {
            (ground.collider, ground.body) = (Entity::PLACEHOLDER, Entity::PLACEHOLDER);
        }
    }
    state
}

fn named(sim: &mut Sim, name: &str) -> Entity {
    prefab::entity(sim, name)
}

/// Moves the lift by its `Transform`, and the character along the floor, for some steps.
fn run(sim: &mut Sim, steps: usize) {
    let [lift, walker] = ["lift", "walker"].map(|name| named(sim, name));
    for _ in 0..steps {
        let mut transform: Transform = sim.get(lift);
        transform.translation.y += 0.004;
        sim.set(lift, transform);
        sim.world().get_mut::<Character>(walker).unwrap().velocity.x = 0.2;
        sim.step(1);
    }
}

/// Tori and rings in a heap on the ground, a body of two colliders, a body below another entity, a sensor, casters, and
/// a character on a lift.
fn spawn_all(sim: &mut Sim, [cube, torus, ring]: &[MeshCollider; 3]) {
    sim.world().insert_resource(Gravity(Vec3::NEG_Y * 5.0));
    sim.world().insert_resource(SolverSettings {
        substeps: 10,
        sleep_time: 60.0,
        ..default()
    });
    sim.spawn((
        Name::new("ground"),
        PlaneCollider::default(),
        Friction::new(0.7).with_combine(CombineRule::Max),
    ));
    for i in 0..6 {
        let mesh = if i % 2 == 0 { torus } else { ring };
        let turned = Quat::from_euler(EulerRot::XYZ, 0.3 * i as f32, 0.7, 0.2);
        let place = Vec3::new(0.15 * i as f32, 0.6 + 0.7 * i as f32, 0.1 * i as f32);
        sim.spawn((
            Name::new(format!("heap {i}")),
            RigidBody::Dynamic,
            mesh.clone(),
            Transform::from_translation(place).with_rotation(turned),
            (Restitution::new(0.1), LinearDamping(0.05), CollisionEventsEnabled),
            CollidingEntities::default(),
        ));
    }
    sim.spawn((
        Name::new("hammer"),
        RigidBody::Dynamic,
        Transform::from_xyz(5.0, 1.2, 0.0),
        AngularVelocity(Vec3::Z),
        children![
            (
                Name::new("handle"),
                cube.clone(),
                Transform::from_scale(Vec3::new(0.1, 1.0, 0.1)),
                Density(0.7),
            ),
            (
                Name::new("head"),
                cube.clone(),
                Transform::from_xyz(0.0, 0.6, 0.0).with_scale(Vec3::new(0.5, 0.2, 0.2)),
                Density(7.8),
            ),
        ],
    ));
    sim.spawn((
        Name::new("rack"),
        Transform::from_xyz(10.0, 1.0, 0.0).with_rotation(Quat::from_rotation_z(0.4)),
        Visibility::default(),
        children![(
            Name::new("hung"),
            RigidBody::Dynamic,
            cube.clone(),
            Transform::from_xyz(0.5, 0.5, 0.0),
            LockedAxes::ROTATION_X | LockedAxes::TRANSLATION_Z,
        )],
    ));
    sim.spawn((
        Name::new("zone"),
        cube.clone(),
        Sensor,
        Transform::from_xyz(0.0, 0.5, 0.0).with_scale(Vec3::splat(3.0)),
        CollidingEntities::default(),
    ));
    let lift = sim.spawn((
        Name::new("lift"),
        RigidBody::Kinematic,
        cube.clone(),
        Transform::from_xyz(-8.0, 0.5, 0.0).with_scale(Vec3::new(3.0, 0.2, 3.0)),
    ));
    let character = Character::default().with_filter(SpatialQueryFilter::excluding([lift]));
    sim.spawn((Name::new("ghost"), character, Transform::from_xyz(-8.0, 3.0, 0.0)));
    sim.spawn((
        Name::new("walker"),
        Character::default(),
        Transform::from_xyz(-8.5, 1.6, 0.0),
        RayCaster::new(Vec3::ZERO, Dir3::NEG_Y).with_filter(SpatialQueryFilter::excluding([lift])),
        ShapeCaster::new(
            CasterShape::Mesh {
                mesh: torus.0.clone(),
                scale: Vec3::splat(0.2),
            },
            Vec3::ZERO,
            Dir3::NEG_Y,
        ),
    ));
}

fn spawned() -> Sim {
    let (mut sim, meshes) = sim(0);
    spawn_all(&mut sim, &meshes);
    sim
}

#[test]
fn two_apps_go_on_alike_from_a_saved_scene() {
    let mut first = spawned();
    run(&mut first, 100);
    assert!(first.collisions().iter().count() > 4, "it is a heap");
    let text = save(&mut first);
    let before = state(&mut first);

    let [mut one, mut other] = [3, 40].map(|others| {
        let (mut sim, _meshes) = sim(others);
        load(&mut sim, &text);
        assert_eq!(without_entities(state(&mut sim)), without_entities(before.clone()));
        run(&mut sim, 100);
        assert!(sim.rejected.is_empty(), "{:?}", sim.rejected);
        sim
    });
    assert_ne!(
        named(&mut one, "lift"),
        named(&mut other, "lift"),
        "their entities have other numbers"
    );
    assert_eq!(without_entities(state(&mut one)), without_entities(state(&mut other)));
}

/// With keys, which the scene contains, and with the memory of the solver, which the snapshot contains.
#[test]
fn a_scene_with_its_snapshot_goes_on_to_the_bit() {
    let mut first = spawned();
    first.world().resource_mut::<SolverSettings>().sleep_time = 0.5;
    let world = first.world();
    let mut colliders = world.query_filtered::<Entity, Or<(With<MeshCollider>, With<PlaneCollider>)>>();
    let colliders: Vec<Entity> = colliders.iter(world).collect();
    // Against the order of entities.
    for (key, collider) in (0..).zip(colliders.into_iter().rev()) {
        first.set(collider, StableKey(key));
    }
    run(&mut first, 150);
    assert!(first.collisions().iter().count() > 4, "it is a heap");
    let text = save(&mut first);
    let snapshot = ron::to_string(&Snapshot::take(first.world())).unwrap();
    let before = without_entities(state(&mut first));

    let (mut second, _meshes) = sim(40);
    let mut entities = load(&mut second, &text);
    let mut snapshot: Snapshot = ron::from_str(&snapshot).unwrap();
    snapshot.map_entities(&mut entities);
    assert_eq!(snapshot.restore(second.world()), []);
    assert_eq!(without_entities(state(&mut second)), before);
    let mut asleep = 0;
    for step in 0..100 {
        run(&mut first, 1);
        run(&mut second, 1);
        assert_eq!(
            without_entities(state(&mut second)),
            without_entities(state(&mut first)),
            "step {step}"
        );
        let count = |sim: &mut Sim| sim.report().sleeping;
        assert_eq!(count(&mut second), count(&mut first), "step {step}");
        asleep = asleep.max(count(&mut first));
    }
    assert_ne!(without_entities(state(&mut first)), before);
    assert!(asleep > 0, "some fall asleep");
    assert!(second.rejected.is_empty(), "{:?}", second.rejected);
}

#[test]
fn a_loaded_character_goes_on_with_its_platform() {
    let mut first = spawned();
    run(&mut first, 60);
    let text = save(&mut first);
    let (mut sim, _meshes) = sim(9);
    load(&mut sim, &text);
    for _ in 0..30 {
        run(&mut first, 1);
        run(&mut sim, 1);
        let [here, there] = [&mut first, &mut sim].map(|sim| {
            let walker = named(sim, "walker");
            (
                sim.position(walker),
                sim.get::<CharacterGround>(walker).expect("it stands"),
            )
        });
        assert_eq!(here.0, there.0);
        assert_eq!((here.1.velocity, here.1.point), (there.1.velocity, there.1.point));
        assert!(here.1.velocity.y > 0.2, "the lift carries it");
        assert_eq!(there.1.body, named(&mut sim, "lift"));
    }
}

/// What is saved of a loaded scene is what was loaded.
#[test]
fn nothing_is_lost() {
    let mut first = spawned();
    run(&mut first, 20);
    let (scene, text) = saved(&mut first);
    let (mut sim, _meshes) = sim(5);
    let entities = load(&mut sim, &text);

    let (again, _) = saved(&mut sim);
    assert_eq!(again.entities.len(), scene.entities.len());
    let mut compared = 0;
    for saved in &scene.entities {
        let loaded = again
            .entities
            .iter()
            .find(|loaded| loaded.entity == entities[&saved.entity]);
        let loaded = &loaded.unwrap().components;
        for component in &saved.components {
            let path = component.reflect_type_path();
            let twin = loaded.iter().find(|loaded| loaded.reflect_type_path() == path);
            let twin = twin.unwrap_or_else(|| panic!("{path} is lost"));
            // These hold entities, or lists that are not saved.
            let names_entities = [
                "ChildOf",
                "Children",
                "Character",
                "CharacterGround",
                "Colliding",
                "Caster",
                "Hits",
            ];
            if !names_entities.iter().any(|name| path.contains(name)) {
                assert_eq!(component.reflect_partial_eq(&**twin), Some(true), "{path}: {twin:?}");
                compared += 1;
            }
        }
    }
    assert!(compared > 100, "{compared}");
    for saved in &scene.resources {
        let path = saved.reflect_type_path();
        let loaded = again.resources.iter().find(|loaded| loaded.reflect_type_path() == path);
        let loaded = loaded.unwrap_or_else(|| panic!("{path} is lost"));
        if !["Collisions", "StepReport"].iter().any(|name| path.contains(name)) {
            assert_eq!(saved.reflect_partial_eq(&**loaded), Some(true), "{path}");
        }
    }
    assert_eq!(sim.world().resource::<Gravity>().0, Vec3::NEG_Y * 5.0);
    assert_eq!(sim.world().resource::<SolverSettings>().substeps, 10);

    let lift = named(&mut sim, "lift");
    let ghost = named(&mut sim, "ghost");
    assert_eq!(
        sim.get::<Character>(ghost).filter,
        SpatialQueryFilter::excluding([lift])
    );
    let walker = named(&mut sim, "walker");
    assert_eq!(
        sim.get::<RayCaster>(walker).filter,
        SpatialQueryFilter::excluding([lift])
    );
    let ShapeCaster { shape, .. } = sim.get(walker);
    let CasterShape::Mesh { mesh, .. } = shape else {
        panic!("{shape:?}");
    };
    assert_eq!(mesh.path().unwrap().to_string(), "torus.bake.ron");
}

/// Colliders that were made of Bevy's meshes are made again: files cannot name them.
#[test]
fn colliders_of_bevy_meshes_are_made_again() {
    let folder = tempfile::tempdir().unwrap();
    let file = prefab::nodes(&[("Cube", &shapes::cube(1.0), json!({}))])
        .for_bevy()
        .glb();
    write(folder.path(), "cube.glb", file);
    let mesh = |sim: &mut Sim| -> Handle<Mesh> {
        let server = sim.world().resource::<AssetServer>();
        server.load("cube.glb#Mesh0/Primitive0")
    };
    let has_colliders = |app: &App| {
        let meshes = app.world().resource::<Assets<CollisionMesh>>();
        let mut colliders = app.world().try_query::<(&Name, &MeshCollider)>().unwrap();
        colliders
            .iter(app.world())
            .filter(|(_, collider)| meshes.contains(&collider.0))
            .count()
            == 2
    };

    let mut first = prefab::sim(folder.path());
    let handle = mesh(&mut first);
    first.spawn((Name::new("single"), RigidBody::Static, MeshColliderFrom(handle.clone())));
    let friction = ColliderSettings {
        friction: Some(Friction::new(0.9)),
        bake: Some(BakeSettings {
            weld_tolerance: 0.001,
            ..default()
        }),
        ..default()
    };
    let hierarchy = MeshColliderHierarchy::default().with_collider_for_name("node", friction);
    first.spawn((
        Name::new("root"),
        Transform::from_xyz(0.0, 9.0, 0.0),
        hierarchy.clone(),
        children![(Name::new("node"), Transform::default(), Mesh3d(handle))],
    ));
    update_until(&mut first.app, |app| has_colliders(app));
    let text = save(&mut first);

    let mut sim = prefab::sim(folder.path());
    load(&mut sim, &text);
    update_until(&mut sim.app, |app| has_colliders(app));
    let [root, node] = ["root", "node"].map(|name| named(&mut sim, name));
    assert_eq!(sim.get::<MeshColliderHierarchy>(root), hierarchy);
    assert_eq!(sim.get::<Friction>(node), Friction::new(0.9));
    assert_eq!(prefab::collision_mesh(&sim, node).settings.weld_tolerance, 0.001);
}

/// A mesh that was never set keeps the colliders of a whole hierarchy back no longer than until it is seen.
#[test]
fn a_hierarchy_does_not_wait_for_no_mesh() {
    let folder = tempfile::tempdir().unwrap();
    let mut sim = prefab::sim(folder.path());
    let cube = sim.world().resource_mut::<Assets<Mesh>>().add(Cuboid::default());
    let root = sim.spawn((
        MeshColliderHierarchy::default(),
        children![
            (Name::new("empty"), Mesh3d::default()),
            (Name::new("cube"), Mesh3d(cube)),
        ],
    ));
    let ready = prefab::ready(&mut sim, root);
    let [empty, cube] = ["empty", "cube"].map(|name| named(&mut sim, name));
    assert_eq!(ready.colliders, [cube]);
    assert_eq!(
        prefab::faults(&ready.errors),
        [(
            "empty".to_string(),
            "\"empty\": it has no collider: it names no mesh: its handle is Handle::default()".to_string()
        )]
    );
    assert!(!prefab::has::<MeshCollider>(&sim, empty));
}
