//! What words mean, what the limits are, and which shapes are built in.
//!
//! # Words
//!
//! | word | means |
//! |---|---|
//! | body | an entity with a [`RigidBody`]. It is *static*, *kinematic* (it moves, and nothing pushes it) or *dynamic* |
//! | collider | an entity with a [`MeshCollider`] or a [`PlaneCollider`]. A body has one or several; one without a body is static |
//! | compound | a body whose colliders are placed in it, as children |
//! | bake | to compute once what depends only on a mesh. The result is a [`CollisionMesh`], in a file `.faceoff` |
//! | recipe | a file `.bake.ron` that names a mesh and how to bake it |
//! | closed, open, room | a mesh that encloses something; one with an opening; a closed one whose faces look inward |
//! | shell | faces that are connected across edges. A mesh may have several |
//! | face table | for each direction the triangles that are seen from there, the *faces of collision*. Only approximate [`Culling`] needs it |
//! | support height | how far a mesh reaches in a direction, from its centre of mass |
//! | sphere pair | two colliders whose bounding spheres overlap. Only these can touch |
//! | face pair | two triangles, one of each collider, that intersect |
//! | touching pair | two colliders with a face pair, or one inside the other: a [`Collision`] |
//! | contact point | a place where two surfaces are near each other or overlap, with a normal and a *separation*, which is negative in an overlap |
//! | manifold | the contact points of a pair: [`Collisions::manifolds`] |
//! | patch | where two surfaces cross: what one closed curve of intersection bounds |
//! | step | one advance of the simulation, 64 times a second by default: [`FaceoffStep`] |
//! | stage | a part of a step: [`FaceoffSystems`] |
//! | collision substep | a part of a step that searches for contact points anew |
//! | substep | a part of a collision substep in which the solver moves bodies |
//! | pass | one run of the solver over all pairs of an island |
//! | speculative margin | how near surfaces must be to get contact points before they touch |
//! | warm start | the solver begins with the impulses of the last collision substep |
//! | island | bodies that contacts connect. It sleeps and wakes as one |
//! | sleep | bodies at rest are left out until something wakes them |
//! | dormant | asleep, with nothing awake near: a step does nothing for such a body |
//! | driven | of a kinematic body: it moves because its `Transform` is written, and not by a velocity |
//! | backend | what runs the stages: the CPU or a GPU. [`Backend`], [`ActiveBackend`] |
//! | readback | when results of a GPU reach components: [`Readback`]. Bodies are *resident* if they stay there |
//! | hook | a function of yours that decides about pairs or changes their contacts: [`CollisionHooks`] |
//! | recall | the share of the touching pairs that an approximate mode finds |
//!
//! # Limits
//!
//! | limit | value | beyond it |
//! |---|---|---|
//! | [`StepLimits::body_pairs`]: sphere pairs of a step on the CPU | 8,388,608, may be changed | pairs of the bodies that overlap the most others are left out; an error names one, and [`StepReport::crowded_bodies`] counts them |
//! | [`StepLimits::face_pairs`]: face pairs of a step on the CPU | 16,777,216, may be changed | the same. A single pair of bodies may have more |
//! | lists of a step on a GPU | what its buffers can hold | the step runs on the CPU |
//! | contact points of two meshes | 16 | the deepest are kept, then those farthest from each other |
//! | contact points of a mesh on a plane | 8 | the same |
//! | collision substeps of a step | 8: [`SolverSettings::max_collision_substeps`], at most 64 | fast or thin bodies may pass others: give them [`ContinuousCollision`] |
//! | substeps of a step | 8: [`SolverSettings::substeps`], at most 256 | a larger number is told in the log, and all settings of the solver count as their defaults |
//! | layers | 32 | |
//! | position, size, coordinates of a mesh | 1e9 m | the body or the mesh is refused: [`BodyFault`], [`MeshError`] |
//! | bounding radius | at least 1e-9 m | the body is refused |
//! | components of velocities | 1e9 m/s or rad/s | the body is refused |
//! | [`GravityScale`] | 1e6 | the body is refused |
//! | vertices, triangles of a mesh | what 32 bits can count | the mesh is refused |
//! | [`BakeSettings::weld_tolerance`], [`BakeSettings::shell_thickness`] | 0.01, 0.5 | the settings are refused |
//! | faces that are listed of a pair of which one is rounded | 16,384 | others are not listed; the contact is still the deepest |
//!
//! [`StepLimits::NONE`] lifts the first two: every step is exact, as long as there are memory and time.
//!
//! # Built-in shapes
//!
//! [`geometry::shapes`] makes closed meshes for tests and first programs. A game bakes its own, or takes Bevy's with
//! `MeshColliderFrom`, with the feature `bevy_mesh`.
//!
//! | shape | triangles | size |
//! |---|---|---|
//! | [`cube`] | 12 | its edge |
//! | [`ball`] | 20, times 4 for each subdivision | its radius |
//! | [`torus`] | 2 * `major` * `minor` | its two radii |
//! | [`torus_knot`] | 2 * `segments` * `minor` | a tube around a knot on a torus of radii 2 and 1 |
//! | [`torus_240`] | 240 | fits a sphere of diameter 1 |
//! | [`knot_1120`] | 1120 | the same |
//! | [`ball_320`] | 320 | the same |
//! | [`ring`] | 384 | the same; others fit through its hole, for chains |
//!
//! Balls, capsules, boxes, cylinders and cones for games are components: see
//! [`guide::meshes`](super::meshes#round-shapes). Planes have no mesh: [`PlaneCollider`] is a half-space without an
//! end. Queries also take balls, boxes and capsules: [`QueryShape`].
//!
//! [`ActiveBackend`]: crate::plugin::backend::ActiveBackend
//! [`Backend`]: crate::plugin::settings::Backend
//! [`BakeSettings::shell_thickness`]: crate::projection::BakeSettings::shell_thickness
//! [`BakeSettings::weld_tolerance`]: crate::projection::BakeSettings::weld_tolerance
//! [`BodyFault`]: crate::state::BodyFault
//! [`Collision`]: crate::plugin::collisions::Collision
//! [`CollisionHooks`]: crate::plugin::hooks::CollisionHooks
//! [`CollisionMesh`]: crate::asset::CollisionMesh
//! [`Collisions::manifolds`]: crate::plugin::collisions::Collisions::manifolds
//! [`ContinuousCollision`]: crate::plugin::components::ContinuousCollision
//! [`Culling`]: crate::types::settings::Culling
//! [`FaceoffStep`]: crate::plugin::FaceoffStep
//! [`FaceoffSystems`]: crate::plugin::FaceoffSystems
//! [`GravityScale`]: crate::plugin::components::GravityScale
//! [`MeshCollider`]: crate::plugin::components::MeshCollider
//! [`MeshError`]: crate::geometry::MeshError
//! [`PlaneCollider`]: crate::plugin::components::PlaneCollider
//! [`QueryShape`]: crate::queries::QueryShape
//! [`Readback`]: crate::plugin::settings::Readback
//! [`RigidBody`]: crate::types::body::RigidBody
//! [`SolverSettings::max_collision_substeps`]: crate::types::solver_settings::SolverSettings::max_collision_substeps
//! [`SolverSettings::substeps`]: crate::types::solver_settings::SolverSettings::substeps
//! [`StepLimits::NONE`]: crate::types::limits::StepLimits::NONE
//! [`StepLimits::body_pairs`]: crate::types::limits::StepLimits::body_pairs
//! [`StepLimits::face_pairs`]: crate::types::limits::StepLimits::face_pairs
//! [`StepReport::crowded_bodies`]: crate::plugin::collisions::StepReport::crowded_bodies
//! [`ball`]: crate::geometry::shapes::ball
//! [`ball_320`]: crate::geometry::shapes::ball_320
//! [`cube`]: crate::geometry::shapes::cube
//! [`geometry::shapes`]: crate::geometry::shapes
//! [`knot_1120`]: crate::geometry::shapes::knot_1120
//! [`ring`]: crate::geometry::shapes::ring
//! [`torus`]: crate::geometry::shapes::torus
//! [`torus_240`]: crate::geometry::shapes::torus_240
//! [`torus_knot`]: crate::geometry::shapes::torus_knot
