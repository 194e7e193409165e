//! What scenes and inspectors need of the type registry.

mod declared;

use crate::app::Sim;
use bevy::asset::{HandleTemplate, ReflectAsset, ReflectHandle};
use bevy::ecs::entity::{EntityHashMap, MapEntities};
use bevy::ecs::reflect::ReflectMapEntities;
use bevy::prelude::*;
use bevy::reflect::TypeRegistration;
use bevy::reflect::serde::{TypedReflectDeserializer, TypedReflectSerializer};
use bevy::reflect::tuple_struct::TupleStruct;
use bevy_faceoff::prelude::*;
use serde::Serialize;
use serde::de::{DeserializeOwned, DeserializeSeed};
use std::any::TypeId;
use std::path::Path;

/// Public types that are not registered, and why.
const EXEMPT: &[(&str, &str)] = &[("SpatialIndex", "its module is private: only SpatialQuery reads it")];

/// Every public component, resource, event and message in the sources is registered as what it is.
#[test]
fn every_public_type_of_the_world_is_registered() {
    let mut sim = Sim::with_plugin(other_plugins);
    let registry = sim.world().resource::<AppTypeRegistry>().read();

    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut declared = Vec::new();
    for folder in ["plugin", "types"] {
        let folder = source.join(folder);
        declared.extend(declared::read(&folder.join("mod.rs"), &folder));
    }
    declared.retain(declared::Declared::is_in_world);
    assert!(declared.len() > 40, "only {} types are found", declared.len());

    let mut missing = Vec::new();
    for declared in &declared {
        let exempt = EXEMPT.iter().any(|(name, _)| *name == declared.name);
        let registration = registry.get_with_short_type_path(&declared.name);
        match registration {
            None if exempt => {}
            None => missing.push(format!(
                "{}: not registered, or another type has this name",
                declared.name
            )),
            Some(_) if exempt => missing.push(format!("{}: registered, but exempt", declared.name)),
            Some(registration) => missing.extend(missing_data(declared, registration)),
        }
    }
    for (name, _) in EXEMPT {
        if !declared.iter().any(|declared| declared.name == *name) {
            missing.push(format!("{name}: exempt, but not in the sources"));
        }
    }
    assert!(missing.is_empty(), "{}", missing.join("\n"));
}

/// Plugins of ours that are in no group.
fn other_plugins(_app: &mut App) {
    #[cfg(feature = "debug_gizmos")]
    _app.add_plugins(bevy_faceoff::plugin::debug::FaceoffGizmosPlugin);
    #[cfg(feature = "debug_panel")]
    _app.add_plugins(bevy_faceoff::plugin::panel::FaceoffPanelPlugin::default());
    #[cfg(feature = "bevy_picking")]
    _app.add_plugins(bevy_faceoff::plugin::picking::ColliderPickingPlugin);
}

/// What a type derives but its registration lacks.
fn missing_data(declared: &declared::Declared, registration: &TypeRegistration) -> Vec<String> {
    let derives = |name: &str| declared.derives.contains(name);
    let wanted = [
        (
            "ReflectComponent",
            derives("Component"),
            registration.contains::<ReflectComponent>(),
        ),
        (
            "ReflectResource",
            derives("Resource"),
            registration.contains::<ReflectResource>(),
        ),
        (
            "ReflectEvent",
            derives("Event") || derives("EntityEvent"),
            registration.contains::<ReflectEvent>(),
        ),
        (
            "ReflectMessage",
            derives("Message"),
            registration.contains::<ReflectMessage>(),
        ),
        (
            "ReflectDefault",
            declared.has_default,
            registration.contains::<ReflectDefault>(),
        ),
        (
            "ReflectSerialize",
            derives("Serialize"),
            registration.contains::<ReflectSerialize>(),
        ),
        (
            "ReflectDeserialize",
            derives("Deserialize"),
            registration.contains::<ReflectDeserialize>(),
        ),
        (
            "Default or FromTemplate, which bsn! needs",
            derives("Component"),
            declared.has_default || derives("FromTemplate"),
        ),
        (
            "VariantDefaults, which bsn! needs",
            derives("Component") && declared.is_enum,
            derives("VariantDefaults"),
        ),
    ];
    let missing = wanted.iter().filter(|(_, wanted, there)| *wanted && !there);
    missing
        .map(|(data, ..)| format!("{}: without {data}", declared.name))
        .collect()
}

/// Components without references have serde, for files and networks that do without reflection.
#[test]
fn what_has_serde_goes_there_and_back() {
    fn same<T: Serialize + DeserializeOwned + PartialEq + std::fmt::Debug>(value: T) {
        let text = ron::to_string(&value).unwrap();
        assert_eq!(ron::from_str::<T>(&text).unwrap(), value, "{text}");
    }
    same(RigidBody::Kinematic);
    same(LinearVelocity(Vec3::new(0.1, -0.0, 1.0e-40)));
    same(Friction::new(0.3).with_combine(CombineRule::Max));
    same(LockedAxes::ROTATION | LockedAxes::TRANSLATION_X);
    same(MaxLinearSpeed::default());
    same(AngularInertia::principal(Vec3::new(1.0, 2.0, 3.0)));
    same(PlaneCollider::through(Vec3::X, Vec3::Y));
    same(Sensor);
    same(BodyCulling(Culling::FrontFacing));
    same(SolverSettings {
        substeps: 3,
        ..default()
    });
    same(StepLimits::NONE);
    same(Gravity::default());
    assert_eq!(
        ron::from_str("(coefficient: 0.2)"),
        Ok(Friction::new(0.2)),
        "what is left out is the default"
    );
    assert!(ron::from_str::<Friction>("(coeficient: 0.2)").is_err());
}

/// No file and no inspector sets bits that are no axes.
#[test]
fn locked_axes_have_no_other_bits() {
    assert_eq!(ron::from_str("255"), Ok(LockedAxes::from_bits(63)));
    let mut axes = LockedAxes::NONE;
    let reflected: &mut dyn Reflect = &mut axes;
    assert!(reflected.reflect_mut().as_opaque().is_ok(), "its bits have no setter");
    let mut sim = Sim::new();
    let registry = sim.world().resource::<AppTypeRegistry>().read();
    let registration = registry.get(TypeId::of::<LockedAxes>()).unwrap();
    let mut reader = ron::Deserializer::from_str("200").unwrap();
    let loaded = TypedReflectDeserializer::new(registration, &registry).deserialize(&mut reader);
    let loaded = LockedAxes::from_reflect(&*loaded.unwrap());
    assert_eq!(loaded, Some(LockedAxes::from_bits(200 & 63)));
}

/// Scenes of bodies keep their poses, names and hierarchy in apps without other plugins.
#[test]
fn what_bodies_need_of_bevy_is_registered() {
    let mut sim = Sim::new();
    let registry = sim.world().resource::<AppTypeRegistry>().read();
    for id in [
        TypeId::of::<Transform>(),
        TypeId::of::<GlobalTransform>(),
        TypeId::of::<ChildOf>(),
        TypeId::of::<Children>(),
        TypeId::of::<Name>(),
    ] {
        assert!(registry.get_type_data::<ReflectComponent>(id).is_some());
    }
}

/// Entities in components and messages are those of the new world once a scene is loaded.
#[test]
fn entities_are_mapped() {
    let mut sim = Sim::new();
    let [old, new] = [(); 2].map(|()| sim.world().spawn_empty().id());
    let mut map = EntityHashMap::from_iter([(old, new)]);

    let mut filter = SpatialQueryFilter::excluding([old]);
    filter.map_entities(&mut map);
    assert_eq!(filter, SpatialQueryFilter::excluding([new]));

    let mut caster = RayCaster::new(Vec3::ZERO, Dir3::X);
    caster.filter = SpatialQueryFilter::excluding([old]);
    Component::map_entities(&mut caster, &mut map);
    assert_eq!(caster.filter, SpatialQueryFilter::excluding([new]));

    let mut caster = ShapeCaster::new(CasterShape::Ball { radius: 1.0 }, Vec3::ZERO, Dir3::X);
    caster.filter = SpatialQueryFilter::excluding([old]);
    Component::map_entities(&mut caster, &mut map);
    assert_eq!(caster.filter, SpatialQueryFilter::excluding([new]));

    let touch = |entity| CollisionStart {
        target: entity,
        collider1: entity,
        collider2: entity,
        body1: entity,
        body2: entity,
    };
    let registry = sim.world().resource::<AppTypeRegistry>().read();
    let data = registry.get_type_data::<ReflectMapEntities>(TypeId::of::<CollisionStart>());
    let mut start = touch(old);
    data.expect("it is registered").map_entities(&mut start, &mut map);
    assert_eq!(start, touch(new));

    #[cfg(feature = "bevy_gltf")]
    {
        use bevy_faceoff::plugin::prefab::{PrefabError, PrefabFault, PropertyError};
        let data = registry.get_type_data::<ReflectMapEntities>(TypeId::of::<MeshColliderHierarchyReady>());
        let mut ready = MeshColliderHierarchyReady {
            entity: old,
            colliders: vec![old],
            errors: vec![PrefabError {
                entity: old,
                node: String::new(),
                file: None,
                fault: PrefabFault::Property(PropertyError::Unknown(String::new())),
            }],
        };
        data.expect("it is registered").map_entities(&mut ready, &mut map);
        assert_eq!([ready.entity, ready.colliders[0], ready.errors[0].entity], [new; 3]);
    }
}

/// A scene keeps that a body is drawn smoothly.
#[cfg(feature = "interpolation")]
#[test]
fn interpolation_is_registered() {
    use bevy_faceoff::plugin::interpolation::{NoTransformEasing, TransformInterpolation};
    let mut sim = Sim::new();
    let registry = sim.world().resource::<AppTypeRegistry>().read();
    for id in [
        TypeId::of::<TransformInterpolation>(),
        TypeId::of::<NoTransformEasing>(),
    ] {
        assert!(registry.get_type_data::<ReflectComponent>(id).is_some());
    }
}

/// What the step writes is not saved: a loaded scene begins without it.
#[test]
fn what_the_step_writes_is_not_saved() {
    let mut sim = Sim::new();
    let entity = sim.world().spawn_empty().id();
    let mut colliding = CollidingEntities::default();
    let list = TupleStruct::field_mut(&mut colliding, 0).and_then(|field| field.try_downcast_mut::<Vec<Entity>>());
    list.expect("it is a list").push(entity);

    let registry = sim.world().resource::<AppTypeRegistry>().read();
    let saved = ron::to_string(&TypedReflectSerializer::new(&colliding, &registry)).unwrap();
    let registration = registry.get(TypeId::of::<CollidingEntities>()).unwrap();
    let mut reader = ron::Deserializer::from_str(&saved).unwrap();
    let loaded = TypedReflectDeserializer::new(registration, &registry).deserialize(&mut reader);
    let loaded = CollidingEntities::from_reflect(&*loaded.unwrap());
    assert_eq!(loaded, Some(CollidingEntities::default()), "{saved}");
}

/// Handles of meshes are saved in scenes by their path, and made of a path.
#[test]
fn handles_of_meshes_are_registered() {
    let mut sim = Sim::new();
    let registry = sim.world().resource::<AppTypeRegistry>().read();
    let mesh = TypeId::of::<CollisionMesh>();
    assert!(registry.get_type_data::<ReflectAsset>(mesh).is_some());
    let handle = registry.get_type_data::<ReflectHandle>(TypeId::of::<Handle<CollisionMesh>>());
    assert_eq!(handle.map(ReflectHandle::asset_type_id), Some(mesh));
    assert!(registry.get(TypeId::of::<HandleTemplate<CollisionMesh>>()).is_some());
}

/// The numbers of default components are usable.
#[test]
fn defaults_are_valid() {
    let mut sim = Sim::new();
    let cube = sim.mesh(&bevy_faceoff::geometry::shapes::cube(1.0));
    sim.spawn((
        RigidBody::default(),
        cube,
        (Mass::default(), Density::default(), AngularInertia::default()),
        (MaxLinearSpeed::default(), MaxAngularSpeed::default()),
        (LinearVelocity(Vec3::X), GravityScale::default()),
    ));
    let character = sim.spawn(Character::default());
    sim.spawn((RayCaster::default(), ShapeCaster::default()));
    sim.world().insert_resource(Gravity::default());
    sim.step(2);
    assert!(sim.rejected.is_empty());
    assert!(sim.position(character).y < 0.0, "it falls");
    assert_eq!(Character::default().radius, 0.3);
}

/// The default plane is the ground.
#[test]
fn the_default_plane_is_the_ground() {
    assert_eq!(PlaneCollider::default(), PlaneCollider::through(Vec3::ZERO, Vec3::Y));
    assert_eq!(PlaneCollider::default().normal, Vec3::Y);
}
