//! What to use for what: a table of everything that there is.
//!
//! `use bevy_faceoff::prelude::*` imports most of it. What needs a feature says so.
//!
//! # Bodies and colliders
//!
//! | to | use |
//! |---|---|
//! | spawn a body | [`RigidBody`], [`MeshCollider`], `Transform` (with scale, also non-uniform) |
//! | make a body of several shapes | a [`RigidBody`] with [`MeshCollider`]s on its children; [`Density`], [`Friction`], [`Restitution`], [`CollisionLayers`] and [`Sensor`] for each |
//! | make colliders for a whole glTF scene | `MeshColliderHierarchy` beside its `WorldAssetRoot`, with the feature `bevy_gltf`; `MeshColliderHierarchyReady` |
//! | make a collider from one of Bevy's meshes | `MeshColliderFrom`, with the feature `bevy_mesh` |
//! | bound the world | [`PlaneCollider`], on an entity of its own and without a [`RigidBody`]; its normal points away from the solid side |
//! | choose its material | [`Density`], [`Mass`], [`AngularInertia`], [`CenterOfMass`], [`Friction`], [`Restitution`]; the latter two with a [`CombineRule`] |
//! | collide as a ball, capsule, box, cylinder or cone | [`BallCollider`], `CapsuleCollider`, `CuboidCollider`, `CylinderCollider`, `ConeCollider`: see [`meshes`](super::meshes#round-shapes) |
//! | choose which bodies collide | [`CollisionLayers`], [`Sensor`] |
//! | decide about pairs yourself; one-way platforms, conveyor belts | [`CollisionHooks`] in a [`CollisionHooksPlugin`], with [`ActiveCollisionHooks`] on colliders |
//! | take a collider or body out for a while | [`ColliderDisabled`], [`RigidBodyDisabled`], or Bevy's `Disabled` |
//!
//! # Motion
//!
//! | to | use |
//! |---|---|
//! | set a body in motion | [`LinearVelocity`], [`AngularVelocity`], [`Gravity`], [`GravityScale`], [`ExternalForces`] (forces and impulses) |
//! | push it at a point | [`ExternalForces::add_impulse_at`] and [`ExternalForces::add_force_at`], with [`ComputedCenterOfMass::in_world`] as the centre |
//! | damp or limit its motion | [`LinearDamping`], [`AngularDamping`], [`MaxLinearSpeed`], [`MaxAngularSpeed`], [`LockedAxes`] |
//! | let it sleep, or not | [`Sleeping`] shows whether it sleeps; set it to false to wake the body; [`SleepingDisabled`] |
//! | stop a fast body at thin walls, and let sensors detect it | [`ContinuousCollision`] |
//! | move a lift or a door | write the `Transform` of a kinematic body in `FixedUpdate`; [`Teleport`] places it instead |
//! | walk, climb steps, ride on platforms | [`Character`]: a capsule moved by its `velocity`; [`CharacterGround`] tells on what it stands |
//! | choose the response | [`Response`] for the world; [`SolverSettings`] for accuracy and cost |
//! | solve contacts yourself | `Response::None` and [`Collisions::manifolds`]: points, normals, separations. Write velocities in a system of [`FaceoffStep`] in the set [`FaceoffSystems::Respond`]; gravity is added in the step |
//!
//! # Results
//!
//! | to | use |
//! |---|---|
//! | read results | [`Collisions`]: all touching pairs, with points in the world and the impulse at each; [`CollidingEntities`], which you insert yourself; [`CollisionStart`] and [`CollisionEnd`] as messages or, with [`CollisionEventsEnabled`], as observed events |
//! | know which faces touch, and where | [`FaceLists`]`(true)`, then [`Collision::faces`] |
//! | choose when a collision ends | [`EventHysteresis`], 0.1 s by default |
//! | test fewer triangles, approximately | [`Culling`] for the world, [`BodyCulling`] for a body; exact by default |
//! | see whether energy is made or lost | [`MeasureEnergy`]`(true)`; read [`StepReport::energy`] |
//! | measure | [`StepReport`], with the work of a GPU in [`StepReport::gpu`]; or Bevy diagnostics under `faceoff/..` |
//!
//! # Queries
//!
//! | to | use |
//! |---|---|
//! | find what a ray hits, what is near, what a shape overlaps or runs into | [`SpatialQuery`] in a system, with a [`SpatialQueryFilter`]; [`RayCaster`] and [`ShapeCaster`] on entities |
//! | get pointer events on colliders | `plugin::picking::ColliderPickingPlugin`, with the feature `bevy_picking` |
//! | query without a simulation | [`queries`]: `check`, or `Check` step by step with progress; `touching`, which only says which pairs touch; [`ContactWorker`] for the contact points of one pair; `CollisionMesh::faces_towards` |
//! | query many placed meshes without an app | [`queries::Scene`] |
//! | query one placed mesh | [`queries::Placed`]: `cast_ray`, `ray_hits`, `hits_ray`; `closest_point`; `overlaps` and `cast` with a [`QueryShape`]: a mesh, ball, box or capsule |
//!
//! # Time and state
//!
//! | to | use |
//! |---|---|
//! | pause, step, change speed | [`Time<Physics>`](crate::plugin::clock): `pause`, `unpause`, `step_once`, `set_relative_speed(0.25)`; or `world.run_schedule(FaceoffStep)` |
//! | draw smooth motion at any frame rate | `TransformInterpolation` on a body, with the feature `interpolation` |
//! | save and restore the state, also in a file | [`Snapshot::take`], [`Snapshot::restore`]; a [`Snapshot`] has serde and maps entities |
//! | get the same results whatever the entities are | a [`StableKey`] on each collider and plane |
//! | write bodies in `bsn!`, save and load scenes | the guide [`scenes`](super::scenes) |
//!
//! # Where it runs
//!
//! | to | use |
//! |---|---|
//! | choose where the stages run | `StepPlugin { backend: Backend::Cpu, .. }` in `FaceoffPlugins`; read [`ActiveBackend`] |
//! | run several apps on one GPU device, whose kernels are compiled once | `StepPlugin { device: plugin::gpu(first.world()).cloned(), .. }`, once the first app is finished |
//! | choose where compiled kernels of a GPU are kept | `StepPlugin { kernel_cache: KernelCache::Folder(..), .. }`, or `KernelCache::Off`; Vulkan only |
//! | not wait for a GPU | `StepPlugin { readback: Readback::Latent, .. }` |
//! | draw without reading back from the GPU | `StepPlugin { readback: Readback::Resident, .. }`, with `plugin::poses`; `plugin::drawn_part` and `Poses::WGSL` to blend the poses of two steps |
//!
//! # On the screen
//!
//! | to | use |
//! |---|---|
//! | see wireframes, boxes, velocities, islands, contacts, casts, characters, faces of collision | `plugin::debug::FaceoffGizmosPlugin`, with the feature `debug_gizmos` |
//! | see times, counts and rejected bodies | `plugin::panel::FaceoffPanelPlugin`, with the feature `debug_panel` |
//!
//! [`ActiveBackend`]: crate::plugin::backend::ActiveBackend
//! [`ActiveCollisionHooks`]: crate::types::hooks::ActiveCollisionHooks
//! [`AngularDamping`]: crate::plugin::components::AngularDamping
//! [`AngularInertia`]: crate::plugin::components::AngularInertia
//! [`AngularVelocity`]: crate::types::body::AngularVelocity
//! [`BodyCulling`]: crate::plugin::components::BodyCulling
//! [`CenterOfMass`]: crate::types::body::CenterOfMass
//! [`Character`]: crate::plugin::character::Character
//! [`CharacterGround`]: crate::plugin::character::CharacterGround
//! [`ColliderDisabled`]: crate::plugin::components::ColliderDisabled
//! [`CollidingEntities`]: crate::plugin::components::CollidingEntities
//! [`Collision::faces`]: crate::plugin::collisions::Collision::faces
//! [`CollisionEnd`]: crate::plugin::events::CollisionEnd
//! [`CollisionEventsEnabled`]: crate::plugin::components::CollisionEventsEnabled
//! [`CollisionHooks`]: crate::plugin::hooks::CollisionHooks
//! [`CollisionHooksPlugin`]: crate::plugin::hooks::CollisionHooksPlugin
//! [`BallCollider`]: crate::plugin::shapes::BallCollider
//! [`CollisionLayers`]: crate::types::body::CollisionLayers
//! [`CollisionStart`]: crate::plugin::events::CollisionStart
//! [`Collisions`]: crate::plugin::collisions::Collisions
//! [`Collisions::manifolds`]: crate::plugin::collisions::Collisions::manifolds
//! [`CombineRule`]: crate::types::material::CombineRule
//! [`ComputedCenterOfMass::in_world`]: crate::types::body::ComputedCenterOfMass::in_world
//! [`ContactWorker`]: crate::queries::ContactWorker
//! [`ContinuousCollision`]: crate::plugin::components::ContinuousCollision
//! [`Culling`]: crate::types::settings::Culling
//! [`Density`]: crate::plugin::components::Density
//! [`EventHysteresis`]: crate::plugin::settings::EventHysteresis
//! [`ExternalForces`]: crate::types::body::ExternalForces
//! [`ExternalForces::add_force_at`]: crate::types::body::ExternalForces::add_force_at
//! [`ExternalForces::add_impulse_at`]: crate::types::body::ExternalForces::add_impulse_at
//! [`FaceLists`]: crate::plugin::settings::FaceLists
//! [`FaceoffStep`]: crate::plugin::FaceoffStep
//! [`FaceoffSystems::Respond`]: crate::plugin::FaceoffSystems::Respond
//! [`Friction`]: crate::types::material::Friction
//! [`Gravity`]: crate::plugin::settings::Gravity
//! [`GravityScale`]: crate::plugin::components::GravityScale
//! [`LinearDamping`]: crate::plugin::components::LinearDamping
//! [`LinearVelocity`]: crate::types::body::LinearVelocity
//! [`LockedAxes`]: crate::types::body::LockedAxes
//! [`Mass`]: crate::plugin::components::Mass
//! [`MaxAngularSpeed`]: crate::plugin::components::MaxAngularSpeed
//! [`MaxLinearSpeed`]: crate::plugin::components::MaxLinearSpeed
//! [`MeshCollider`]: crate::plugin::components::MeshCollider
//! [`PlaneCollider`]: crate::plugin::components::PlaneCollider
//! [`QueryShape`]: crate::queries::QueryShape
//! [`RayCaster`]: crate::plugin::queries::RayCaster
//! [`Response`]: crate::types::settings::Response
//! [`Restitution`]: crate::types::material::Restitution
//! [`RigidBody`]: crate::types::body::RigidBody
//! [`RigidBodyDisabled`]: crate::plugin::components::RigidBodyDisabled
//! [`Sensor`]: crate::plugin::components::Sensor
//! [`ShapeCaster`]: crate::plugin::queries::ShapeCaster
//! [`Sleeping`]: crate::types::body::Sleeping
//! [`SleepingDisabled`]: crate::plugin::components::SleepingDisabled
//! [`Snapshot`]: crate::plugin::snapshot::Snapshot
//! [`Snapshot::restore`]: crate::plugin::snapshot::Snapshot::restore
//! [`Snapshot::take`]: crate::plugin::snapshot::Snapshot::take
//! [`SolverSettings`]: crate::types::solver_settings::SolverSettings
//! [`SpatialQuery`]: crate::plugin::queries::SpatialQuery
//! [`SpatialQueryFilter`]: crate::plugin::queries::SpatialQueryFilter
//! [`StableKey`]: crate::plugin::components::StableKey
//! [`StepReport`]: crate::plugin::collisions::StepReport
//! [`MeasureEnergy`]: crate::plugin::settings::MeasureEnergy
//! [`StepReport::energy`]: crate::plugin::collisions::StepReport::energy
//! [`StepReport::gpu`]: crate::plugin::collisions::StepReport::gpu
//! [`Teleport`]: crate::plugin::components::Teleport
//! [`queries`]: crate::queries
//! [`queries::Placed`]: crate::queries::Placed
//! [`queries::Scene`]: crate::queries::Scene
