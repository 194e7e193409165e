//! For those who know bevy_rapier: what has another name here, what works differently, and what there is not. Compared
//! with bevy_rapier3d 0.36, which is for the same Bevy.
//!
//! Stay with rapier if your game needs joints or convex shapes by the thousand: convex parts are cheaper than
//! meshes there. Use this plugin where concave meshes move and meet each other.
//! Or keep rapier, and give it the contacts of this crate between meshes: `crates/parry_faceoff`.
//!
//! # Names
//!
//! | bevy_rapier | here |
//! |---|---|
//! | `RapierPhysicsPlugin::<NoUserData>::default()` | [`FaceoffPlugins::default()`](crate::plugin::FaceoffPlugins) |
//! | `RigidBody::Dynamic`, `RigidBody::Fixed` | [`RigidBody::Dynamic`, `RigidBody::Static`](crate::types::body::RigidBody) |
//! | `RigidBody::KinematicPositionBased` | `RigidBody::Kinematic` without velocity: write its `Transform` |
//! | `RigidBody::KinematicVelocityBased` | `RigidBody::Kinematic` with a velocity |
//! | `Collider::trimesh(..)` | [`MeshCollider`](crate::plugin::components::MeshCollider) with a handle of a [`CollisionMesh`](crate::asset::CollisionMesh) |
//! | `Collider::ball`, `capsule_y`, `cuboid`, `cylinder`, `cone` | [`BallCollider`](crate::plugin::shapes::BallCollider), `CapsuleCollider` and others, with whole lengths instead of half ones |
//! | `Collider::convex_decomposition(..)` | the mesh itself |
//! | `AsyncCollider`, `AsyncSceneCollider` | `MeshColliderFrom`, feature `bevy_mesh`; `MeshColliderHierarchy`, feature `bevy_gltf` |
//! | `Collider::halfspace(..)` | [`PlaneCollider`](crate::plugin::components::PlaneCollider) |
//! | `Velocity { linvel, angvel }` | `LinearVelocity`, `AngularVelocity` |
//! | `ExternalForce`, `ExternalImpulse` | [`ExternalForces`](crate::types::body::ExternalForces) |
//! | `GravityScale` | the same |
//! | `RapierConfiguration::gravity` | the resource [`Gravity`](crate::plugin::settings::Gravity) |
//! | `AdditionalMassProperties`, `ColliderMassProperties` | `Mass`, `AngularInertia`, `CenterOfMass`; [`Density`](crate::plugin::components::Density) |
//! | `Friction`, `Restitution`, `CoefficientCombineRule` | `Friction`, `Restitution`, [`CombineRule`](crate::types::material::CombineRule) |
//! | `Damping { linear_damping, angular_damping }` | `LinearDamping`, `AngularDamping` |
//! | `LockedAxes` | the same |
//! | `CollisionGroups` | [`CollisionLayers`](crate::types::body::CollisionLayers) |
//! | `SolverGroups`, `BevyPhysicsHooks` | [`CollisionHooks`](crate::plugin::hooks::CollisionHooks) |
//! | `Sensor`, `ColliderDisabled`, `RigidBodyDisabled`, `CollidingEntities` | the same |
//! | `ActiveEvents::COLLISION_EVENTS`, `CollisionEvent::{Started, Stopped}` | messages [`CollisionStart`](crate::plugin::events::CollisionStart) and `CollisionEnd`, always written |
//! | `ActiveCollisionTypes` | none: see [`RigidBody`](crate::types::body::RigidBody) for the pairs that are tested |
//! | `ContactForceEvent` | [`Collision::impulse`](crate::plugin::collisions::Collision) of a pair, divided by the step |
//! | `Ccd` | [`ContinuousCollision`](crate::plugin::components::ContinuousCollision) |
//! | `Sleeping { .. }` | [`Sleeping`](crate::types::body::Sleeping), `SleepingDisabled`, `SolverSettings::{sleep_speed, sleep_time}` |
//! | `ReadRapierContext`, `cast_ray`, `cast_shape` | [`SpatialQuery`](crate::plugin::queries::SpatialQuery) |
//! | `QueryFilter` | [`SpatialQueryFilter`](crate::plugin::queries::SpatialQueryFilter) |
//! | `KinematicCharacterController` | [`Character`](crate::plugin::character::Character) |
//! | `TimestepMode` | `Time<Fixed>` and `Time<Physics>`: see [`clock`](crate::plugin::clock) |
//! | `TransformInterpolation` | the same, feature `interpolation` |
//! | `RapierDebugRenderPlugin`, `DebugRenderMode` | `FaceoffGizmosPlugin`, `FaceoffGizmos`, feature `debug_gizmos` |
//! | `RapierPickingPlugin` | `ColliderPickingPlugin`, feature `bevy_picking` |
//! | `ImpulseJoint`, `MultibodyJoint`; `Dominance`; several worlds; two dimensions | none |
//!
//! # What works differently
//!
//! * **The step runs in `FixedPostUpdate`.** bevy_rapier steps once a frame unless told otherwise. Write forces and
//!   velocities in `FixedUpdate`.
//! * **Scale of all kinds counts**, also unequal and negative, and may change while the game runs.
//! * **Mass comes from the volume of a closed mesh**, with a density of 1 by default.
//! * **Meshes are assets**, baked once at import. A body waits for its mesh.
//! * **`CollisionEnd` waits** 0.1 s: [`EventHysteresis`](crate::plugin::settings::EventHysteresis).
