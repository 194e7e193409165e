//! Compared with Avian 0.7 and bevy_rapier 0.36, which are for the same Bevy, row by row.
//!
//! **In short.** Take Avian or bevy_rapier if your game needs joints, exact round and convex shapes by the thousand, two
//! dimensions, double precision, or an engine that many games have used for years. They are ahead in all of these. Take this plugin
//! where concave meshes move and meet each other, and where it matters which faces touch.
//!
//! Read in the sources of avian3d 0.7.0 with parry3d 0.27.0, and of bevy_rapier3d 0.36.0, which uses rapier3d
//! 0.35.0-glamx0.2 and parry3d 0.30.2-glamx0.2-b. Paths that begin with the name of a crate are those of its package; "no" means
//! that its sources and documentation have nothing of the kind. The last column names a test or a program of this
//! repository that shows the row. [`from_avian`](super::from_avian) and [`from_bevy_rapier`](super::from_bevy_rapier) have the names of things.
//!
//! # Shapes and contacts
//!
//! | | here | Avian | bevy_rapier | shown by |
//! |---|---|---|---|---|
//! | a moving concave mesh against another | contact points of the pair as a whole, at most 16 | a manifold for each pair of triangles: `parry3d/src/query/contact_manifolds/contact_manifolds_composite_shape_composite_shape.rs` | the same, joined into fewer before they are solved: `rapier3d/src/geometry/contact_clustering.rs` | `tests/dynamics/chain.rs`, `examples/chain.rs` |
//! | every intersecting pair of faces, with segments | yes, tested against an oracle | no: contacts have ids of features, `avian3d/src/collision/contact_types/mod.rs` | no: the two triangles of each manifold, `bevy_rapier3d/src/plugin/narrow_phase.rs` | `tests/triangle_test/exact.rs` |
//! | a body wholly inside a closed mesh touches it | yes, and is pushed out | no: triangles are surfaces | no: the same | `tests/plugin/reports.rs`, `tests/gpu/manifolds/inside.rs` |
//! | rooms: closed meshes that look inward | yes | surfaces are rooms anyway | the same | `tests/plugin/bakes.rs` |
//! | balls, boxes, capsules, convex hulls, height fields, voxels as exact shapes | **no**: meshes and half-spaces | yes: `avian3d/src/collision/collider/parry/mod.rs` | yes: `bevy_rapier3d/src/geometry/collider_impl.rs` | `tests/dynamics/planes.rs` |
//! | fine meshes roll as the smooth surface | yes | not needed: exact shapes | not needed: exact shapes | `tests/dynamics/incline.rs`, `tests/small_games/balls.rs` |
//! | convex decomposition | not needed | yes: `Collider::convex_decomposition` | yes: `Collider::convex_decomposition` | `tests/dynamics/meshes.rs` |
//! | shapes of your own | **no** | yes: `AnyCollider`, `avian3d/src/collision/collider/mod.rs` | yes: any `Shape` of parry in `Collider::raw` | |
//! | bodies of several colliders | yes | yes | yes | `tests/plugin/compounds.rs` |
//! | scale: unequal, negative, sheared | yes | a component; meshes take any along their axes: `Collider::set_scale` | the same: `ColliderScale`, `bevy_rapier3d/src/geometry/collider.rs` | `tests/plugin/kinds.rs`, `tests/plugin/compounds.rs` |
//! | layers | yes | yes: `avian3d/src/collision/collider/layers.rs` | yes: `CollisionGroups` | `tests/plugin/kinds.rs` |
//! | hooks that filter pairs and change contacts | yes, on the CPU | yes: `avian3d/src/collision/hooks.rs` | yes: `bevy_rapier3d/src/pipeline/physics_hooks.rs` | `tests/plugin/hooks.rs` |
//! | sensors | yes | yes | yes | `tests/plugin/sensors.rs` |
//! | events when a collision starts and ends | messages and observers | messages and observers: `avian3d/src/collision/collision_events.rs` | messages: `bevy_rapier3d/src/pipeline/events.rs` | `tests/plugin/reports.rs` |
//! | the impulse at each contact | yes | yes: `avian3d/src/collision/contact_types/mod.rs` | yes, and events above a threshold: `ContactForceEventThreshold` | `tests/plugin/contacts.rs` |
//!
//! # Motion
//!
//! | | here | Avian | bevy_rapier | shown by |
//! |---|---|---|---|---|
//! | joints | **no** | five kinds, with motors: `avian3d/src/dynamics/joints/mod.rs` | seven kinds, with motors and multibodies: `bevy_rapier3d/src/dynamics/joint.rs` | |
//! | forces, damping, locked axes, speed limits | yes | yes | yes, without limits of speed | `tests/plugin/contacts.rs` |
//! | dominance | **no** | yes: `avian3d/src/dynamics/rigid_body/mod.rs` | yes: `bevy_rapier3d/src/dynamics/rigid_body.rs` | |
//! | friction and restitution by formula | yes | yes | yes | `tests/solver/friction.rs`, `tests/dynamics/bounce.rs`, `tests/dynamics/spin.rs` |
//! | heavy on light, towers of small cubes | yes: solved until converged | a fixed number of substeps: `SubstepCount` | a fixed number of iterations, more for a body: `AdditionalSolverIterations` | `tests/small_games/heavy_on_light.rs`, `tests/small_games/dice_tower.rs` |
//! | a kinematic body moved by its `Transform` pushes and carries | yes | no: it pushes by its velocity components | yes: `RigidBody::KinematicPositionBased` | `tests/plugin/driven.rs` |
//! | continuous collision detection | yes, by triangles, on the CPU; sensors too | speculative contacts for all, `SweptCcd` for some: `avian3d/src/dynamics/ccd/mod.rs` | `Ccd` and `SoftCcd`: `bevy_rapier3d/src/dynamics/rigid_body.rs` | `tests/dynamics/bullets.rs`, `tests/ccd/bullets.rs` |
//! | sleep | by island | by island: `avian3d/src/dynamics/rigid_body/sleeping.rs` | by island: `rapier3d/src/dynamics/island_manager` | `tests/sleep/islands.rs` |
//! | a character | a component that walks, climbs steps and rides | parts to build one: `avian3d/src/character_controller/move_and_slide.rs`; whole ones in other crates | a component: `bevy_rapier3d/src/control/character_controller.rs` | `tests/plugin/character.rs`, `examples/character.rs` |
//! | vehicles | **no** | no | in rapier, without a component: `rapier3d/src/control/ray_cast_vehicle_controller.rs` | |
//! | a solver of your own | contact points without response | a plugin can be replaced: `avian3d/src/dynamics/solver/plugin.rs` | no | `tests/plugin/contacts.rs` |
//!
//! # Questions to the world
//!
//! | | here | Avian | bevy_rapier | shown by |
//! |---|---|---|---|---|
//! | rays, shape casts, nearest points, overlaps | yes | yes: `avian3d/src/spatial_query/system_param.rs` | yes: `bevy_rapier3d/src/plugin/context/systemparams/rapier_context_systemparam.rs` | `tests/plugin/spatial_queries.rs`, `examples/rays.rs` |
//! | the face that a ray hits | yes, as numbered in the file | no: `RayHitData` in `avian3d/src/spatial_query/ray_caster.rs` | yes: `RayIntersection::feature` in `bevy_rapier3d/src/geometry/mod.rs` | `tests/plugin/spatial_queries.rs` |
//! | casters as components | yes | yes: `RayCaster`, `ShapeCaster` | no | `tests/plugin/spatial_queries.rs` |
//! | pointer events | yes | yes: `avian3d/src/picking/mod.rs` | yes: `bevy_rapier3d/src/picking_backend/mod.rs` | `tests/bevy_features/picking.rs` |
//! | without an app | yes, and without Bevy | of two colliders: `avian3d/src/collision/collider/parry/contact_query.rs` | in rapier and parry, without Bevy | `tests/core/rays.rs`, `tests/core/contacts.rs`, `tests/queries/check.rs` |
//!
//! # Data
//!
//! | | here | Avian | bevy_rapier | shown by |
//! |---|---|---|---|---|
//! | a glTF scene as colliders | yes | yes: `avian3d/src/collision/collider/constructor.rs` | yes: `AsyncSceneCollider` in `bevy_rapier3d/src/geometry/collider.rs` | `tests/bevy_features/prefab/body.rs`, `examples/prefab.rs` |
//! | settings written in Blender | yes | no; by name in code | no; by name in code | `tests/bevy_features/prefab/settings.rs` |
//! | colliders are assets: shared, baked at import, replaced while the app runs | yes | no: `Collider` is a component | no: the same | `tests/loading/processor.rs`, `tests/loading/hot_reload.rs`, `examples/bake_assets.rs` |
//! | components in saved scenes | all, by reflection | all but `Collider`, which `ColliderConstructor` stands in for: `avian3d/src/collision/collider/parry/mod.rs` | most, not `Collider`: `bevy_rapier3d/src/geometry/collider.rs` | `tests/plugin/registration.rs` |
//! | defects of meshes are named, and repaired | yes | some triangles are dropped, by `TrimeshFlags`: `parry3d/src/shape/trimesh.rs` | the same | `tests/geometry/repair.rs`, `tests/asset/hostile.rs` |
//! | a body with a NaN | is left out and named; the others go on | not checked | not checked | `tests/plugin/bad_bodies.rs` |
//!
//! # Time and repetition
//!
//! | | here | Avian | bevy_rapier | shown by |
//! |---|---|---|---|---|
//! | pause, slow motion, one step by hand | `Time<Physics>` | `Time<Physics>`: `avian3d/src/schedule/time.rs` | `physics_pipeline_active`, `TimestepMode`: `bevy_rapier3d/src/plugin/configuration.rs` | `tests/plugin/clock.rs` |
//! | smooth motion between steps | interpolation | interpolation and extrapolation: `avian3d/src/interpolation.rs` | interpolation: `TimestepMode::Interpolated` | `tests/bevy_features/interpolation.rs`, `tests/bevy_render.rs` |
//! | the same bits again, on any number of threads | yes | tested across platforms in two dimensions: `avian3d/src/tests/determinism_2d.rs` | promised: `rapier3d/src/lib.rs` | `tests/dynamics/same_bits.rs`, `tests/plugin/clock.rs` |
//! | the same bits on another kind of machine | **no** | yes, feature `enhanced-determinism` | yes, feature `enhanced-determinism` | |
//! | save and restore the state in memory, with the solver's memory | `Snapshot` | components and the resource `ContactGraph` can be cloned: `avian3d/src/collision/contact_types/contact_graph.rs` | in rapier; the plugin's contexts have serde, but for their maps from entities: `bevy_rapier3d/src/plugin/context/mod.rs` | `tests/plugin/contacts.rs`, `benches/snapshot.rs` |
//!
//! # Where it runs, and how you look at it
//!
//! | | here | Avian | bevy_rapier | shown by |
//! |---|---|---|---|---|
//! | on a GPU | all stages, tested on a software driver; not measured on a real card | no | no | `tests/gpu/parity/steps.rs`, `tests/bevy_render.rs` |
//! | on all cores | yes | in part: feature `parallel` | yes: feature `parallel` | `tests/plugin/clock.rs` |
//! | without a window or a GPU | yes | yes | yes | `examples/headless.rs` |
//! | without Bevy | yes | no | rapier is such a library | `tests/core/step.rs` |
//! | two dimensions | **no** | avian2d | bevy_rapier2d | |
//! | double precision | **no**: positions are single; where it decides, faces are tested in double | yes, feature `f64` | rapier3d-f64, without a plugin | `tests/triangle_test/fine.rs` |
//! | several worlds in one app | **no** | no | yes: `bevy_rapier3d/examples/multi_contexts3.rs` | |
//! | gizmos | yes | yes, also of colliders, boxes and joints: `avian3d/src/debug_render/mod.rs` | yes, also of colliders and joints: `bevy_rapier3d/src/render/mod.rs` | `tests/bevy_features/debug_gizmos.rs`, `examples/debug_faces.rs` |
//! | times of the stages | `StepReport` and Bevy's diagnostics | Bevy's diagnostics and a panel: `avian3d/src/diagnostics/ui.rs` | counters of rapier: `rapier3d/src/counters/mod.rs` | `tests/plugin/groups.rs` |
//! | a command line for meshes and scenes | yes | no | no | `tests/cli/simulate.rs`, `tests/cli/check.rs` |
//!
//! # Speed
//!
//! `benches/peers` runs avian3d, rapier3d and parry3d on the same scenes, and [BENCHMARKS.md] has the figures. Concave meshes
//! are faster here and sink into each other less. Convex parts are faster there: knots in a bin take three to seven times
//! as long here as with convex parts in rapier3d, and a stack of cubes nine times. Those figures are of
//! rapier3d 0.36.1, which is newer than the one in bevy_rapier 0.36.
//!
//! [BENCHMARKS.md]: https://docs.rs/crate/bevy_faceoff/latest/source/BENCHMARKS.md
