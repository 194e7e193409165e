//! What to do about warnings, errors and surprises.
//!
//! Add Bevy's `LogPlugin` first. It is part of `DefaultPlugins`, but not of `MinimalPlugins`. The log tells the cause
//! of most surprises below.
//!
//! # A body is rejected
//!
//! A body, collider or plane that is left out of the step is named once, in the log and by
//! [`BodyRejected`](crate::plugin::events::BodyRejected). It takes part again when its components are valid.
//!
//! | [`BodyFault`](crate::state::BodyFault) | cause | what to do |
//! |---|---|---|
//! | `NonFinitePose`, `NonFinite` | a division by zero, often a direction normalised at length 0 | `normalize_or_zero` |
//! | `Infinite` | infinite mass or density | `RigidBody::Static`, or `Kinematic` if it moves by itself |
//! | `ZeroRotation` | a quaternion of zeros | `Quat::IDENTITY` |
//! | `ZeroScale` | a scale with a zero, often an animation that begins there. Only a flat mesh may have one, across its plane | begin at 0.001, or disable the collider |
//! | `TooFar`, `TooFast` | what fell out of the world | a floor, or despawn it below some height |
//! | `Mass`, `Inertia` | a dynamic body whose mass or density is zero, or any with a negative one; an inertia that no body has | a positive number; `AngularInertia::principal` |
//! | `GravityScale` | beyond a million | a smaller one |
//! | `PlaneNormal`, `PlaneDistance` | a normal without direction, a distance that is no number or beyond 1e9 m | `PlaneCollider::through` |
//! | `Sheared` | the mesh under an unequal scale becomes flat, or too large | scale the mesh instead |
//! | `MeshMissing` | a handle that nothing loads, `Handle::default()` | keep the handle that `load` or `add` returned |
//! | `MeshFailed` | the file cannot be read; an error of the asset server says why | fix the file |
//! | `PlaneOnBody` | both a mesh and a plane: the body takes part, the plane is ignored | the plane on an entity of its own |
//!
//! # Nothing collides
//!
//! | surprise | cause |
//! |---|---|
//! | bodies stand still, also in the air | no step runs: `ActiveBackend` says why; with `Latent` kernels are still compiled until `BackendReady` |
//! | a body falls through the floor | the floor has a `Mesh3d` and no `MeshCollider`; or its mesh is not loaded yet; or, with `Response::Impulse`, it is an open mesh whose faces look down: turn them |
//! | two colliders never touch | both are static or kinematic, or belong to one body, or their `CollisionLayers` do not meet |
//! | a file loads as a mesh to draw, not to collide | `load::<CollisionMesh>(..)` by type, or a recipe: `(mesh: "knot.obj")` in `knot.bake.ron` |
//! | with `AssetMode::Processed` a mesh does not load | only recipes and `.faceoff` files do |
//! | a fast body passes a wall | `ContinuousCollision` on the body |
//! | a sensor misses a fast body | `ContinuousCollision` on the body, with `Response::Contacts` |
//!
//! # Something moves strangely
//!
//! | surprise | cause | what to do |
//! |---|---|---|
//! | a body is too heavy or too light | its mesh is open, so its mass is an estimate, or that of a shell; a warning says which. Or solids lie inside a solid | close it, raise `weld_tolerance`, set `shell_thickness`, or set `Mass` |
//! | a body turns about a strange point | the same | the same, or `CenterOfMass` |
//! | things inside a room are thrown out | the room is a closed mesh whose faces look outward, or disagree and were turned | turn its faces: the same mesh inverted is a room |
//! | things in a bottle are pushed out | its opening takes less than a fiftieth of its area, so it counts as closed | give the glass an inside: a wall has two surfaces |
//! | a body that appears in another one jumps | overlapping bodies are pushed apart at up to 3 m/s, deep ones at 1 m/s | spawn it apart, or lower `SolverSettings::max_depenetration_speed` |
//! | far from the origin, slow bodies stop or lose their way | a pose is a `Transform`, and its translation has single precision: steps of 1 mm from 8 km on, of 6 cm from 524 km on. What moves by less than half of that in a step does not move: at 64 Hz less than 3 cm/s at 8 km, 2 m/s at 524 km | move the world with the camera, so that what matters is within a few kilometres |
//! | motion stutters | frames and steps have different rates | the feature `interpolation`, and `TransformInterpolation` on the body or `InterpolationPlugin::interpolate_all()` |
//! | a lift does not carry | its `Transform` is written in `Update`, or with `Teleport` | write it in `FixedUpdate` |
//! | a platform pushes but does not carry | a `PlaneCollider` has no velocity | a kinematic body with a mesh |
//! | a pile never sleeps | a `SleepingDisabled` body, or one that is written in every step, touches it | `set_if_neq` |
//! | a collision ends late | [`EventHysteresis`](crate::plugin::settings::EventHysteresis) | `EventHysteresis(0.0)` |
//! | two runs differ | bodies were spawned in another order, or one ran on a GPU | the same order, `Backend::Cpu` |
//!
//! # It is slow
//!
//! | surprise | cause | what to do |
//! |---|---|---|
//! | every step takes long though little touches | `StepReport::collision_substeps` is above 1: a thin or small body is fast among others | a thicker mesh, or a smaller `max_collision_substeps` |
//! | the log says that steps run on the CPU | colliders or planes with `ActiveCollisionHooks`, which a GPU does not have | remove them, or accept it |
//! | the log says that the CPU waits for the GPU during a step | a body with `ContinuousCollision`, which the CPU stops | remove it when the body is slow, or accept it |
//! | the log says that bodies overlap too many others | thousands of bodies in one place | spawn them apart |
//! | the log says that two bodies overlap and do not come apart | they were spawned in each other, a kinematic or a far heavier body presses one into the other, or a fast one got inside | spawn them apart; leave room between what moves; keep masses within 100,000 to 1; [`ContinuousCollision`](crate::plugin::components::ContinuousCollision) |
//! | `Collision::faces` is `None` | nobody asked for lists of faces | [`FaceLists(true)`](crate::plugin::settings::FaceLists) |
//! | the first step takes seconds | kernels are compiled, or a face table is baked | `Readback::Latent`; bake ahead of time |
//! | a debug build is slow | | `[profile.dev.package."*"] opt-level = 3` in your `Cargo.toml` |
//!
//! # The device fails
//!
//! [`BackendFailed`](crate::plugin::backend::BackendFailed) says what happened. A device that is lost is opened again;
//! one without memory is not, and the CPU goes on. An app whose stages share the renderer's device ends when that is
//! lost, unless it has a handler: [`backend`](crate::plugin::backend).
