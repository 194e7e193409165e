//! Bodies in scenes: written in `bsn!`, made in Blender as a glTF file, or saved to a file and loaded again.
//!
//! # Bodies in `bsn!`
//!
//! Bevy's scene notation needs Bevy's feature `bevy_scene`, which is on by default. A mesh is named by its path; fields
//! that are left out have their defaults:
//!
//! ```ignore
//! use bevy::prelude::*;
//! use bevy_faceoff::prelude::*;
//!
//! /// One body of two colliders.
//! fn hammer() -> impl Scene {
//!     bsn! {
//!         #Hammer
//!         RigidBody::Dynamic
//!         Transform::from_xyz(0.0, 2.0, 0.0)
//!         Friction { coefficient: 0.8, combine: CombineRule::Max }
//!         CollisionLayers { memberships: 2 }
//!         Children [
//!             (
//!                 MeshCollider("cube.bake.ron")
//!                 Transform { scale: { Vec3::new(0.1, 1.0, 0.1) } }
//!                 Density(0.7)
//!             ),
//!             (
//!                 MeshCollider("cube.bake.ron")
//!                 Transform { translation: Vec3 { y: 0.6 }, scale: { Vec3::new(0.5, 0.2, 0.2) } }
//!                 Density(7.8)
//!             ),
//!         ]
//!     }
//! }
//!
//! fn spawn(mut commands: Commands) {
//!     commands.spawn_scene(bsn! { PlaneCollider Friction::new(0.7) });
//!     commands.spawn_scene(hammer());
//!     // A second hammer at another place, thrown.
//!     commands.spawn_scene(bsn! {
//!         hammer()
//!         Transform::from_xyz(3.0, 2.0, 0.0)
//!         LinearVelocity(Vec3 { x: 5.0 })
//!     });
//! }
//! # bevy::ecs::system::assert_is_system(spawn);
//! ```
//!
//! `MeshColliderFrom` takes the path of a Bevy mesh, such as `"cart.glb#Mesh0/Primitive0"`, and `ShowFacesTowards` the
//! name of an entity of the scene, `#Target`. A `ShapeCaster` cannot be written in `bsn!`, because it may hold a
//! handle: insert it afterwards.
//!
//! # A scene from Blender
//!
//! With the feature `bevy_gltf` a glTF scene goes in as it is:
//!
//! ```rust,ignore
//! use bevy::prelude::*;
//! use bevy_faceoff::prelude::*;
//!
//! fn spawn_cart(mut commands: Commands, assets: Res<AssetServer>) {
//!     commands.spawn((
//!         WorldAssetRoot(assets.load("cart.glb#Scene0")),
//!         MeshColliderHierarchy::default().without_collider_for_name("Curtain"),
//!         RigidBody::Dynamic, // one body; without it the scene is static
//!     ));
//! }
//! ```
//!
//! Each mesh that Bevy has loaded becomes a collider, with its node's place, rotation and scale. It is baked in the
//! background, once, however often the scene is spawned; then all colliders appear together, and
//! `MeshColliderHierarchyReady` is triggered.
//!
//! Settings come from the code, by the names of nodes and meshes, and from Blender: give an object, its mesh or a
//! material *custom properties*, and export them with the file.
//!
//! | property | value |
//! |---|---|
//! | `faceoff` | `"none"` or `false`, `"collider"` or `true`, or `"sensor"` |
//! | `faceoff_density`, `faceoff_friction`, `faceoff_restitution` | a number |
//! | `faceoff_layers`, `faceoff_filters` | a layer from 0 to 31, or a list of them |
//! | `faceoff_body`, of an object only | `"dynamic"`, `"kinematic"` or `"static"`: a body of its own, with all that is below it |
//! | `faceoff_rounding` | the radius of round edges: see [`meshes`](super::meshes#round-shapes) |
//! | `faceoff_mass`, with `faceoff_body` | kilograms |
//!
//! The log and the event name everything that cannot be read, with its node and file.
//!
//! A mesh may also be baked ahead of time: for the mesh `Gear` of `cart.glb` the file `cart_Gear.faceoff` in the same
//! folder is used if it exists, or else the recipe `cart_Gear.bake.ron`. Keep the recipe beside the baked file: then a
//! mesh that has changed since is noticed, and baked anew. The documentation of `plugin::prefab` has the details, and
//! the example `prefab` is a program.
//!
//! # Saved scenes
//!
//! All components and settings are registered for reflection, so Bevy's `DynamicWorld` saves and loads them, with
//! Bevy's feature `bevy_world_serialization`. Here with the crates `ron` and `serde`:
//!
//! ```ignore
//! use bevy::ecs::entity::EntityHashMap;
//! use bevy::prelude::*;
//! use bevy::world_serialization::serde::WorldDeserializer;
//! use bevy_faceoff::prelude::*;
//! use serde::de::DeserializeSeed;
//!
//! /// All bodies, colliders and planes, and gravity, as the text of a file.
//! fn save(world: &mut World) -> Result<String> {
//!     let mut entities = world.query_filtered::<Entity, Or<(With<RigidBody>, With<MeshCollider>, With<PlaneCollider>)>>();
//!     let entities: Vec<Entity> = entities.iter(world).collect();
//!     let registry = world.resource::<AppTypeRegistry>().read();
//!     let scene = DynamicWorldBuilder::from_world(world, &registry)
//!         .extract_entities(entities.into_iter())
//!         .deny_all_resources()
//!         .allow_resource::<Gravity>()
//!         .extract_resources()
//!         .build();
//!     Ok(scene.serialize(&registry)?)
//! }
//!
//! /// Adds the entities of the file to the world. Bevy's `DynamicWorldRoot` does the same with a file of the asset folder.
//! fn load(world: &mut World, text: &str) -> Result<EntityHashMap<Entity>> {
//!     let server = world.resource::<AssetServer>().clone();
//!     let registry = world.resource::<AppTypeRegistry>().clone();
//!     let reader = WorldDeserializer {
//!         type_registry: &registry.read(),
//!         load_from_path: &mut &server,
//!     };
//!     let scene = reader.deserialize(&mut ron::Deserializer::from_str(text)?)?;
//!     let mut entities = EntityHashMap::default();
//!     scene.write_to_world(world, &mut entities)?;
//!     Ok(entities)
//! }
//!
//! # use bevy::world_serialization::WorldSerializationPlugin;
//! # let mut app = App::new();
//! # app.add_plugins((MinimalPlugins, FaceoffHeadlessPlugins::default(), WorldSerializationPlugin));
//! # app.world_mut().spawn((RigidBody::Dynamic, Name::new("box"), LinearVelocity(Vec3::X)));
//! # let text = save(app.world_mut()).unwrap();
//! # let entities = load(app.world_mut(), &text).unwrap();
//! # assert_eq!(entities.len(), 1);
//! ```
//!
//! * **Meshes** are saved by their path. A mesh that was added with `Assets::add` has no path and is not saved: Bevy
//!   warns when it saves the scene, and the loaded body is rejected until its collider gets a mesh. Colliders that
//!   `MeshColliderFrom` and `MeshColliderHierarchy` made are made again when the scene is loaded.
//! * **Entities** in filters and of parents are those of the new world. Save what is named together with what names it.
//! * **Lists that the step writes** (`CollidingEntities`, `RayHits`, `ShapeHits`) are saved empty. The first step fills
//!   them.
//! * **Until meshes are loaded** their bodies do not move, but others do, and may fall through what is not there yet.
//!   Load the meshes first, or pause [`Time<Physics>`](crate::plugin::clock).
//! * **What the solver remembers** is not part of a scene: impulses from step to step, and how long bodies have been at
//!   rest. A pile that lies still stays where it is, and two apps that load the same scene go on alike to the bit.
//! * **To go on exactly as before**, save a [`Snapshot`](crate::plugin::snapshot::Snapshot) beside the scene, and give
//!   each collider and plane a [`StableKey`](crate::plugin::components::StableKey).
//!
//! Components without handles and entities also have serde's `Serialize` and `Deserialize`, for formats of your own.
