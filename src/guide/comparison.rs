//! Compared with Avian 0.7 and bevy_rapier 0.36, which are for the same Bevy, row by row.
//!
//! **In short.** Take Avian or bevy_rapier if your game needs joints, exact round and convex shapes by the thousand,
//! two dimensions, or an engine that many games have used for years. They are ahead in all of these; Avian has double
//! precision too. Take this plugin where concave meshes move and meet each other, and where it matters which faces
//! touch.
//!
//! What the tables say about the other two was read in the sources of avian3d 0.7.0 with parry3d 0.27.0, and of
//! bevy_rapier3d 0.36.0, which uses rapier3d 0.35.0-glamx0.2 and parry3d 0.30.2-glamx0.2-b. Links lead to the place in
//! these sources. "no" means that neither sources nor documentation have it. The last column names what shows the row
//! in this repository: a file of `tests` without its ending, or a program, as `--example chain`; its command is in
//! `examples/README.md`. [`from_avian`](super::from_avian) and [`from_bevy_rapier`](super::from_bevy_rapier) have the
//! names of things.
//!
//! # Shapes and contacts
//!
//! | | here | Avian | bevy_rapier | shown by |
//! |---|---|---|---|---|
//! | a moving concave mesh against another | contact points of the pair as a whole, at most 16 | a manifold for each pair of triangles: [parry][parry3d parry] | the same, joined into fewer before they are solved: [contact clustering][rapier3d contact_clustering] | `dynamics/chain`, `--example chain` |
//! | every intersecting face pair, with segments | yes, tested against an oracle | no: contacts have ids of features, [contact types][avian3d contact_types] | no: the two triangles of each manifold, [narrow phase][bevy_rapier3d narrow_phase] | `triangle_test/exact` |
//! | a body wholly inside a closed mesh touches it | yes, and is pushed out | no: triangles are surfaces | no: the same | `plugin/reports`, `gpu/manifolds/inside` |
//! | rooms: closed meshes that look inward | yes | surfaces are rooms anyway | the same | `plugin/bakes` |
//! | balls, capsules, rounded boxes as exact shapes | yes | yes: [parry][avian3d parry] | yes: [collider impl][bevy_rapier3d collider_impl] | `round/rolling` |
//! | convex hulls, height fields, voxels as shapes of their own | **no**: meshes and planes | yes: [parry][avian3d parry] | yes: [collider impl][bevy_rapier3d collider_impl] | `dynamics/planes` |
//! | fine meshes roll as the smooth surface | yes | not needed: exact shapes | not needed: exact shapes | `dynamics/incline`, `small_games/balls` |
//! | convex decomposition | not needed | yes: [parry][avian3d parry] | yes: [collider impl][bevy_rapier3d collider_impl] | `dynamics/meshes` |
//! | shapes of your own | **no** | yes: `AnyCollider`, [collider][avian3d collider] | yes: any `Shape` of parry in `Collider::raw` | |
//! | bodies of several colliders | yes | yes | yes | `plugin/compounds` |
//! | scale: unequal, negative, sheared | yes | unequal and negative, not sheared: `set_scale` | the same: [collider][bevy_rapier3d collider] | `plugin/kinds`, `plugin/compounds` |
//! | layers | yes | yes: [layers][avian3d layers] | yes: `CollisionGroups` | `plugin/kinds` |
//! | hooks that filter pairs and change contacts | yes, on the CPU | yes: [hooks][avian3d hooks] | yes: [physics hooks][bevy_rapier3d physics_hooks] | `plugin/hooks` |
//! | sensors | yes | yes | yes | `plugin/sensors` |
//! | events when a collision starts and ends | messages and observers | messages and observers: [collision events][avian3d collision_events] | messages: [events][bevy_rapier3d events] | `plugin/reports` |
//! | the impulse at each contact | yes | yes: [contact types][avian3d contact_types] | yes, and a `ContactForceEvent`: [events][bevy_rapier3d events] | `plugin/contacts` |
//!
//! # Motion
//!
//! | | here | Avian | bevy_rapier | shown by |
//! |---|---|---|---|---|
//! | joints | **no** | five kinds, with motors: [joints][avian3d joints] | seven kinds, with motors and multibodies: [joint][bevy_rapier3d joint] | |
//! | forces, damping, locked axes, speed limits | yes | yes | yes, without limits of speed | `plugin/contacts` |
//! | dominance | **no** | yes: [rigid body][avian3d rigid_body] | yes: [rigid body][bevy_rapier3d rigid_body] | |
//! | friction and restitution by formula | yes | yes | yes | `solver/friction`, `dynamics/bounce`, `dynamics/spin` |
//! | heavy on light, towers of small cubes | yes: solved until converged, at most `SolverSettings::max_iterations` passes, and fewer for large islands | a fixed number of substeps: `SubstepCount` | a fixed number of iterations, more for chosen bodies | `small_games/heavy_on_light`, `small_games/dice_tower` |
//! | a kinematic body moved by its `Transform` pushes and carries | yes | no: it pushes by its velocity components | yes: `KinematicPositionBased` | `plugin/driven`, `--example door` |
//! | continuous collision detection | yes, by triangles, on the CPU also in steps on a GPU; sensors too | speculative contacts for all, `SweptCcd` for some: [ccd][avian3d ccd] | `Ccd` and `SoftCcd`: [rigid body][bevy_rapier3d rigid_body] | `dynamics/bullets`, `ccd/bullets`, `gpu/apps/fast_bodies` |
//! | sleep | by island | by island: [sleeping][avian3d sleeping] | by island: [island manager][rapier3d island_manager] | `sleep/islands` |
//! | a character | a component that walks, climbs steps and rides | parts to build one: [move and slide][avian3d move_and_slide]; whole ones in other crates | a component: [character controller][bevy_rapier3d character_controller] | `plugin/character`, `--example character` |
//! | vehicles | **no** | no | in rapier, without a component: [ray cast vehicle controller][rapier3d ray_cast_vehicle_controller] | |
//! | a solver of your own | contact points without response | a plugin can be replaced: [plugin][avian3d plugin] | no | `plugin/contacts`, `--example custom_response` |
//!
//! # Spatial queries
//!
//! | | here | Avian | bevy_rapier | shown by |
//! |---|---|---|---|---|
//! | rays, shape casts, nearest points, overlaps | yes | yes: [system param][avian3d system_param] | yes: [system parameters][bevy_rapier3d system parameters] | `plugin/spatial_queries`, `--example rays` |
//! | the face that a ray hits | yes, as numbered in the file | no: `RayHitData` in [ray caster][avian3d ray_caster] | yes: `feature`, in [geometry][bevy_rapier3d geometry] | `plugin/spatial_queries` |
//! | casters as components | yes | yes: `RayCaster`, `ShapeCaster` | no | `plugin/spatial_queries` |
//! | pointer events | yes | yes: [picking][avian3d picking] | yes: [picking backend][bevy_rapier3d picking_backend] | `bevy_features/picking` |
//! | without an app | yes, and without Bevy | of two colliders: [contact query][avian3d contact_query] | in rapier and parry, without Bevy | `core/rays`, `core/contacts`, `queries/check` |
//!
//! # Data
//!
//! | | here | Avian | bevy_rapier | shown by |
//! |---|---|---|---|---|
//! | a glTF scene as colliders | yes | yes: [constructor][avian3d constructor] | yes: `AsyncSceneCollider` in [collider][bevy_rapier3d collider] | `bevy_features/prefab/body`, `--example prefab` |
//! | settings written in Blender | yes | no; by name in code | no; by name in code | `bevy_features/prefab/settings` |
//! | colliders are assets: shared, baked at import, replaced while the app runs | yes | no: `Collider` is a component | no: the same | `loading/processor`, `loading/hot_reload`, `--example bake_assets`, `--example baked_asset` |
//! | components in saved scenes | all, by reflection | all but `Collider`, which `ColliderConstructor` stands in for: [parry][avian3d parry] | most, not `Collider`: [collider][bevy_rapier3d collider] | `plugin/registration`, `bevy_features/saved_scenes` |
//! | bodies in `bsn!` | yes, with meshes by path | not mentioned | not mentioned | `plugin/bsn`, `bevy_features/bsn` |
//! | defects of meshes are named, and repaired | yes | some triangles are dropped, by `TrimeshFlags`: [trimesh][parry3d trimesh] | the same | `geometry/repair`, `asset/hostile` |
//! | a body with a NaN | is left out and named; the others go on | not checked | not checked | `plugin/bad_bodies` |
//!
//! # Time and repetition
//!
//! | | here | Avian | bevy_rapier | shown by |
//! |---|---|---|---|---|
//! | pause, slow motion, one step by hand | `Time<Physics>` | `Time<Physics>`: [time][avian3d time] | `physics_pipeline_active`, `TimestepMode`: [configuration][bevy_rapier3d configuration] | `plugin/clock` |
//! | smooth motion between steps | interpolation | interpolation and extrapolation: [interpolation][avian3d interpolation] | interpolation: `TimestepMode::Interpolated` | `bevy_features/interpolation`, `bevy_render` |
//! | the same bits again, on any number of threads | yes | tested across platforms in two dimensions: [determinism 2d][avian3d determinism_2d] | promised: [lib.rs][rapier3d lib.rs] | `dynamics/same_bits`, `plugin/clock` |
//! | the same bits on another kind of machine | **no** | yes, feature `enhanced-determinism` | yes, feature `enhanced-determinism` | |
//! | save and restore the state in memory, with the solver's memory | `Snapshot` | components and the resource `ContactGraph` can be cloned: [contact graph][avian3d contact_graph] | in rapier; the plugin's contexts have serde, but for their maps from entities: [context][bevy_rapier3d context] | `plugin/contacts`, `--bench snapshot` |
//! | the state as bytes, saved or sent | `Snapshot`, with serde | components: feature `serialize` | feature `serde-serialize`: [context][bevy_rapier3d context] | `plugin/snapshots`, `--example rollback` |
//! | the same bits, whatever the order in which bodies are spawned | by a stable key on each body | not mentioned | not mentioned | `plugin/stable_keys` |
//!
//! # Where it runs, and how you look at it
//!
//! | | here | Avian | bevy_rapier | shown by |
//! |---|---|---|---|---|
//! | on a GPU | all stages; tested on a software driver and on one GPU, an NVIDIA H200 | no | no | `gpu/parity/steps`, `bevy_render` |
//! | on all cores | yes | in part: feature `parallel` | yes: feature `parallel` | `plugin/clock` |
//! | without a window or a GPU | yes | yes | yes | `--example headless` |
//! | in a browser | built for it, and run in Node.js on one thread; not tried in a browser | written for it: [optimization][avian3d optimization] | rapier is for it too: the category `wasm` in [Cargo.toml][rapier3d Cargo.toml] | `.ci/web` |
//! | without Bevy | yes | no | rapier is such a library | `core/step` |
//! | two dimensions | **no** | avian2d | bevy_rapier2d | |
//! | double precision | **no**: positions are single; where it decides, faces are tested in double | yes, feature `f64` | rapier3d-f64, without a plugin | `triangle_test/fine` |
//! | several worlds in one app | **no** | no | yes: [multi contexts3][bevy_rapier3d multi_contexts3] | |
//! | gizmos | colliders, contacts, motion, islands, casts | colliders, contacts, islands, casts, boxes, joints: [debug render][avian3d debug_render] | colliders, contacts, joints: [render][bevy_rapier3d render] | `bevy_features/debug_gizmos`, `--example debug_faces` |
//! | times of the stages | `StepReport`, Bevy's diagnostics and a panel | Bevy's diagnostics and a panel: [ui][avian3d ui] | counters of rapier: [counters][rapier3d counters] | `plugin/groups`, `bevy_features/debug_panel` |
//! | a command line for meshes and scenes | yes | no | no | `cli/simulate`, `cli/check` |
//!
//! # Learning, and releases
//!
//! | | here | Avian | bevy_rapier | shown by |
//! |---|---|---|---|---|
//! | used by many games, for years | **no**: not released yet | yes | yes | |
//! | guides | these, whose programs are compiled and run | in its documentation: [lib.rs][avian3d lib.rs] | a site of its own, rapier.rs | `layers/guide` |
//! | programs to start from | in `examples`, each also without a window | 22 in three dimensions: [examples][avian3d examples] | 21 in three dimensions: [examples][bevy_rapier3d examples] | `--example hello`, `--example pour`, `--example tori_in_a_box`, `--example asteroids`, `--example falling_knots` |
//! | a table of versions, a changelog | yes, and a policy on versions of Rust and Bevy | a table: [README][avian3d README] | in its repository | `CONTRIBUTING.md`, `docs/RELEASING.md`, `CHANGELOG.md`, `layers/versions` |
//!
//! # Speed
//!
//! `benches/peers` runs avian3d, rapier3d and parry3d on the same scenes, and [BENCHMARKS.md] has the figures. Concave
//! meshes are faster here and sink into each other less. Convex parts are faster there: knots in a bin take 2.3 to 3.5
//! times as long here as with convex parts in rapier3d, and a stack of cubes seven times. These figures are of rapier3d
//! 0.36.1, which is newer than the one in bevy_rapier 0.36.
//!
//! [BENCHMARKS.md]: https://docs.rs/crate/bevy_faceoff/latest/source/BENCHMARKS.md
//! [avian3d README]: https://docs.rs/crate/avian3d/0.7.0/source/README.md
//! [avian3d ccd]: https://docs.rs/crate/avian3d/0.7.0/source/src/dynamics/ccd/mod.rs
//! [avian3d collider]: https://docs.rs/crate/avian3d/0.7.0/source/src/collision/collider/mod.rs
//! [avian3d collision_events]: https://docs.rs/crate/avian3d/0.7.0/source/src/collision/collision_events.rs
//! [avian3d constructor]: https://docs.rs/crate/avian3d/0.7.0/source/src/collision/collider/constructor.rs
//! [avian3d contact_graph]: https://docs.rs/crate/avian3d/0.7.0/source/src/collision/contact_types/contact_graph.rs
//! [avian3d contact_query]: https://docs.rs/crate/avian3d/0.7.0/source/src/collision/collider/parry/contact_query.rs
//! [avian3d contact_types]: https://docs.rs/crate/avian3d/0.7.0/source/src/collision/contact_types/mod.rs
//! [avian3d debug_render]: https://docs.rs/crate/avian3d/0.7.0/source/src/debug_render/mod.rs
//! [avian3d determinism_2d]: https://docs.rs/crate/avian3d/0.7.0/source/src/tests/determinism_2d.rs
//! [avian3d examples]: https://docs.rs/crate/avian3d/0.7.0/source/examples/
//! [avian3d hooks]: https://docs.rs/crate/avian3d/0.7.0/source/src/collision/hooks.rs
//! [avian3d interpolation]: https://docs.rs/crate/avian3d/0.7.0/source/src/interpolation.rs
//! [avian3d joints]: https://docs.rs/crate/avian3d/0.7.0/source/src/dynamics/joints/mod.rs
//! [avian3d layers]: https://docs.rs/crate/avian3d/0.7.0/source/src/collision/collider/layers.rs
//! [avian3d lib.rs]: https://docs.rs/crate/avian3d/0.7.0/source/src/lib.rs
//! [avian3d move_and_slide]: https://docs.rs/crate/avian3d/0.7.0/source/src/character_controller/move_and_slide.rs
//! [avian3d optimization]: https://docs.rs/crate/avian3d/0.7.0/source/src/collider_tree/optimization.rs
//! [avian3d parry]: https://docs.rs/crate/avian3d/0.7.0/source/src/collision/collider/parry/mod.rs
//! [avian3d picking]: https://docs.rs/crate/avian3d/0.7.0/source/src/picking/mod.rs
//! [avian3d plugin]: https://docs.rs/crate/avian3d/0.7.0/source/src/dynamics/solver/plugin.rs
//! [avian3d ray_caster]: https://docs.rs/crate/avian3d/0.7.0/source/src/spatial_query/ray_caster.rs
//! [avian3d rigid_body]: https://docs.rs/crate/avian3d/0.7.0/source/src/dynamics/rigid_body/mod.rs
//! [avian3d sleeping]: https://docs.rs/crate/avian3d/0.7.0/source/src/dynamics/rigid_body/sleeping.rs
//! [avian3d system_param]: https://docs.rs/crate/avian3d/0.7.0/source/src/spatial_query/system_param.rs
//! [avian3d time]: https://docs.rs/crate/avian3d/0.7.0/source/src/schedule/time.rs
//! [avian3d ui]: https://docs.rs/crate/avian3d/0.7.0/source/src/diagnostics/ui.rs
//! [bevy_rapier3d character_controller]: https://docs.rs/crate/bevy_rapier3d/0.36.0/source/src/control/character_controller.rs
//! [bevy_rapier3d collider]: https://docs.rs/crate/bevy_rapier3d/0.36.0/source/src/geometry/collider.rs
//! [bevy_rapier3d collider_impl]: https://docs.rs/crate/bevy_rapier3d/0.36.0/source/src/geometry/collider_impl.rs
//! [bevy_rapier3d configuration]: https://docs.rs/crate/bevy_rapier3d/0.36.0/source/src/plugin/configuration.rs
//! [bevy_rapier3d context]: https://docs.rs/crate/bevy_rapier3d/0.36.0/source/src/plugin/context/mod.rs
//! [bevy_rapier3d events]: https://docs.rs/crate/bevy_rapier3d/0.36.0/source/src/pipeline/events.rs
//! [bevy_rapier3d examples]: https://docs.rs/crate/bevy_rapier3d/0.36.0/source/examples/
//! [bevy_rapier3d geometry]: https://docs.rs/crate/bevy_rapier3d/0.36.0/source/src/geometry/mod.rs
//! [bevy_rapier3d joint]: https://docs.rs/crate/bevy_rapier3d/0.36.0/source/src/dynamics/joint.rs
//! [bevy_rapier3d multi_contexts3]: https://docs.rs/crate/bevy_rapier3d/0.36.0/source/examples/multi_contexts3.rs
//! [bevy_rapier3d narrow_phase]: https://docs.rs/crate/bevy_rapier3d/0.36.0/source/src/plugin/narrow_phase.rs
//! [bevy_rapier3d physics_hooks]: https://docs.rs/crate/bevy_rapier3d/0.36.0/source/src/pipeline/physics_hooks.rs
//! [bevy_rapier3d picking_backend]: https://docs.rs/crate/bevy_rapier3d/0.36.0/source/src/picking_backend/mod.rs
//! [bevy_rapier3d render]: https://docs.rs/crate/bevy_rapier3d/0.36.0/source/src/render/mod.rs
//! [bevy_rapier3d rigid_body]: https://docs.rs/crate/bevy_rapier3d/0.36.0/source/src/dynamics/rigid_body.rs
//! [bevy_rapier3d system parameters]: https://docs.rs/crate/bevy_rapier3d/0.36.0/source/src/plugin/context/systemparams/rapier_context_systemparam.rs
//! [parry3d parry]: https://docs.rs/crate/parry3d/0.30.2-glamx0.2-b/source/src/query/contact_manifolds/contact_manifolds_composite_shape_composite_shape.rs
//! [parry3d trimesh]: https://docs.rs/crate/parry3d/0.30.2-glamx0.2-b/source/src/shape/trimesh.rs
//! [rapier3d Cargo.toml]: https://docs.rs/crate/rapier3d/0.35.0-glamx0.2/source/Cargo.toml.orig
//! [rapier3d contact_clustering]: https://docs.rs/crate/rapier3d/0.35.0-glamx0.2/source/src/geometry/contact_clustering.rs
//! [rapier3d counters]: https://docs.rs/crate/rapier3d/0.35.0-glamx0.2/source/src/counters/mod.rs
//! [rapier3d island_manager]: https://docs.rs/crate/rapier3d/0.35.0-glamx0.2/source/src/dynamics/island_manager/
//! [rapier3d lib.rs]: https://docs.rs/crate/rapier3d/0.35.0-glamx0.2/source/src/lib.rs
//! [rapier3d ray_cast_vehicle_controller]: https://docs.rs/crate/rapier3d/0.35.0-glamx0.2/source/src/control/ray_cast_vehicle_controller.rs
