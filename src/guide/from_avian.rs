//! For those who know Avian: what has another name here, what works differently, and what there is not. Compared with
//! avian3d 0.7, which is for the same Bevy.
//!
//! Stay with Avian if your game needs joints, many kinds of exact round shapes, or two dimensions. Its colliders of
//! triangles are surfaces that are tested triangle by triangle. Use this plugin where concave meshes move and meet each
//! other. Or keep Avian, and give it the contacts of this crate between meshes: `crates/avian_faceoff`.
//!
//! # Names
//!
//! | Avian | here |
//! |---|---|
//! | `PhysicsPlugins::default()` | [`FaceoffPlugins::default()`](crate::plugin::FaceoffPlugins) |
//! | `RigidBody::{Dynamic, Kinematic, Static}` | [the same](crate::types::body::RigidBody) |
//! | `Collider::trimesh_from_mesh(..)` | [`MeshCollider`](crate::plugin::components::MeshCollider) with a handle of a [`CollisionMesh`](crate::asset::CollisionMesh) |
//! | `ColliderConstructor::TrimeshFromMesh` | `MeshColliderFrom(mesh)`, feature `bevy_mesh` |
//! | `ColliderConstructorHierarchy` | `MeshColliderHierarchy`, feature `bevy_gltf` |
//! | `Collider::half_space(normal)` | [`PlaneCollider`](crate::plugin::components::PlaneCollider) |
//! | `Collider::sphere`, `cuboid`, `capsule`, `compound` | [`BallCollider`](crate::plugin::shapes::BallCollider), `CuboidCollider`, `CapsuleCollider`; children with colliders |
//! | `Position`, `Rotation` | `Transform` |
//! | `LinearVelocity`, `AngularVelocity`, `Gravity`, `GravityScale` | the same |
//! | `ConstantForce`, `Forces::apply_force` | [`ExternalForces`](crate::types::body::ExternalForces)`::force`, which acts until you change it |
//! | `Forces::apply_linear_impulse` | `ExternalForces::impulse`, or `add_impulse_at` |
//! | `Mass`, `AngularInertia`, `CenterOfMass` | the same; `AngularInertia` is a matrix |
//! | `ColliderDensity` | [`Density`](crate::plugin::components::Density), 1 by default |
//! | `Friction { dynamic_coefficient, static_coefficient, .. }` | [`Friction`](crate::types::material::Friction)`::new(coefficient)`: both are one |
//! | `Restitution`, `CoefficientCombine` | `Restitution`, [`CombineRule`](crate::types::material::CombineRule) |
//! | `LinearDamping`, `AngularDamping`, `MaxLinearSpeed`, `MaxAngularSpeed`, `LockedAxes` | the same |
//! | `CollisionLayers`, `LayerMask` | `CollisionLayers`, with plain bits |
//! | `Sensor`, `ColliderDisabled`, `RigidBodyDisabled` | the same |
//! | `CollisionStart`, `CollisionEnd`, `CollisionEventsEnabled`, `CollidingEntities` | the same; messages are always written |
//! | `Collisions` (a system parameter) | [`Collisions`](crate::plugin::collisions::Collisions), a resource |
//! | `CollisionHooks`, `ActiveCollisionHooks` | the same, added by a `CollisionHooksPlugin` |
//! | `SweptCcd` | [`ContinuousCollision`](crate::plugin::components::ContinuousCollision) |
//! | `SpatialQuery`, `RayCaster`, `ShapeCaster`, `SpatialQueryFilter` | the same; a hit also names the face |
//! | `MoveAndSlide` | [`Character`](crate::plugin::character::Character), which walks, climbs steps and rides |
//! | `Sleeping` (a marker), `SleepingDisabled` | [`Sleeping`](crate::types::body::Sleeping)`(bool)`, `SleepingDisabled` |
//! | `Time<Physics>` | the same, and `step_once` |
//! | `PhysicsSchedule`, `PhysicsSystems` | [`FaceoffStep`](crate::plugin::FaceoffStep), [`FaceoffSystems`](crate::plugin::FaceoffSystems) |
//! | `PhysicsInterpolationPlugin`, `TransformInterpolation` | `InterpolationPlugin`, `TransformInterpolation`, feature `interpolation` |
//! | `PhysicsDebugPlugin`, `PhysicsGizmos` | `FaceoffGizmosPlugin`, `FaceoffGizmos`, feature `debug_gizmos` |
//! | `PhysicsDiagnosticsUiPlugin` | `FaceoffPanelPlugin`, feature `debug_panel` |
//! | `PhysicsPickingPlugin` | `ColliderPickingPlugin`, feature `bevy_picking` |
//! | `FixedJoint`, `RevoluteJoint` and other joints; `Dominance`; `f64`; two dimensions | none |
//!
//! # What works differently
//!
//! * **A closed mesh is solid.** A body wholly inside it touches it, and its mass is that of its volume. What an open
//!   mesh weighs is told in a warning.
//! * **Meshes are assets.** They are baked once, at import, and may come late: a body waits for its mesh. `Collider` is
//!   a component that is ready at once.
//! * **A kinematic body moved by its `Transform` has a velocity**: it pushes and carries. With
//!   [`Teleport`](crate::plugin::components::Teleport) it does not.
//! * **`CollisionEnd` waits** 0.1 s, so that rolling and bouncing do not start and end a collision again and again:
//!   [`EventHysteresis`](crate::plugin::settings::EventHysteresis).
//! * **Wrong components do not panic.** The body is left out, and [`BodyRejected`](crate::plugin::events::BodyRejected)
//!   says why.
