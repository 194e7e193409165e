//! What to expect of a simulation: response, cost of fast bodies, clocks, determinism, sensors, events and hierarchy.
//!
//! # Defaults
//!
//! A body has a density of 1 kg/m^3 ([`Density(600.0)`](crate::plugin::components::Density) is wood) and a friction of
//! 0.5, and does not bounce. Bodies move in `FixedPostUpdate`, 64 times a second by default.
//!
//! # Response
//!
//! [`Response::Contacts`], the default, computes contact points between all surfaces that are near each other, and
//! solves them over 8 substeps a step. Bodies at rest are at most 0.05 % of their diameter apart, so they have contact
//! points, and hardly intersect. Bodies that overlap when they appear are pushed apart at up to 3 m/s. If they are deep
//! in each other, it is at up to 1 m/s. They sleep once they are apart.
//!
//! Contacts are solved until they have converged, or for at most [`SolverSettings::max_iterations`] passes; large
//! piles get fewer passes. So a heavy body rests on a light one, and towers of small cubes stand. On the CPU, chains
//! and other sparse groups whose passes do not converge are solved directly: a chain of a hundred links holds a
//! thousand times the mass of one. On a GPU they get shorter substeps instead, and may stretch. Chains without friction
//! may come apart under loads.
//!
//! [`Response::Impulse`] gives one impulse per touching pair instead, for swarms that only bounce.
//! [`choose_settings`](super::choose_settings#what-works-with-which-response) tells what works with which response.
//!
//! # Cost of fast bodies
//!
//! A step is divided into up to 8 collision substeps if bodies that can meet move relative to each other by more than
//! a quarter of the thickness of the thinnest one. So small, thin or fast bodies are expensive while they are near
//! others. Common motion costs nothing: a formation in flight is as cheap as one at rest.
//!
//! Only bodies that can meet in the step have more collision substeps. If a bullet hits a plate, the step of these two
//! is divided, and that of a pile elsewhere is not. A fast or thin body that can meet nothing in the step has one
//! collision substep. On a GPU each collision substep takes the same dispatches, however few bodies take part in it.
//!
//! # Clocks
//!
//! | clock | sets |
//! |---|---|
//! | [`Time<Physics>`](crate::plugin::clock) | bodies and characters alone: pause, speed |
//! | `Time<Virtual>` | the whole game, including the steps: pause, speed |
//! | `Time<Fixed>` | the length of a step |
//!
//! `run_schedule(FaceoffStep)` runs a step at once, even while a clock is paused: for tests, tools and rollback. Its
//! length is that of `Time<Fixed>`. In a test call `app.finish()` before the first such step.
//!
//! # Determinism
//!
//! On the same machine the same build gives the same results to the bit, on any number of threads, if the bodies are
//! spawned in the same order, or if each collider and plane has a [`StableKey`]. Pairs and points are processed in the
//! order of keys, or else of spawning.
//!
//! In another order, on the CPU instead of a GPU, or on another GPU, results differ in the last bit, and scenes in
//! which bodies collide then diverge. [`choose_settings`](super::choose_settings#the-same-bits) tells what two
//! machines need for the same bits.
//!
//! # Sensors
//!
//! A [`Sensor`] touches the colliders that it overlaps or contains at the beginning of a step, asleep or not. At least
//! one of the two must be dynamic or kinematic: a static sensor does not detect static colliders, a moving one does.
//! To detect bodies that pass within one step, add [`ContinuousCollision`] to the fast body. A
//! [`PlaneCollider`](crate::plugin::components::PlaneCollider) with a [`Sensor`] detects what is below it: a lake, or
//! a depth that nobody survives.
//!
//! # Events
//!
//! [`CollisionStart`] is sent at once. [`CollisionEnd`] is sent when two colliders have not touched for 0.1 s, so that
//! a bouncing or rolling body does not start and end a collision in every other step. With
//! [`EventHysteresis(0.0)`](crate::plugin::settings::EventHysteresis) an end is sent in the first step without a
//! touch. [`Collisions`](crate::plugin::collisions::Collisions) has no such delay: it holds the pairs that touched in
//! the last step.
//!
//! # Bodies in the hierarchy
//!
//! The shape of a body is that of all [`MeshCollider`](crate::plugin::components::MeshCollider)s on its entity and on
//! its descendants, down to the next [`RigidBody`](crate::types::body::RigidBody). A collider without a `RigidBody`
//! above it is static. Mass, centre of mass and inertia add up. Colliders of one body never collide with each other.
//! `Collision`, [`CollisionStart`] and [`CollisionEnd`] name two colliders and their bodies.
//!
//! If a child is moved, added, removed, disabled or given another parent, this takes effect in the next step, and
//! bodies that slept on it wake. Every [`CollisionStart`] still has its [`CollisionEnd`]. Where an unequal scale above
//! a turned collider shears its mesh, a copy with the shear is baked in the background.
//!
//! A body may itself be under other entities. While these move, a dynamic body keeps its pose in the world, and a
//! kinematic or static one follows them.
//!
//! # Bodies moved by the game
//!
//! A lift or a door is a kinematic body without velocity: write its `Transform` in `FixedUpdate`. In the next step it
//! goes there, pushes what is in its way and carries what stands on it. With the marker
//! [`Teleport`](crate::plugin::components::Teleport) it is placed without pushing. A dynamic body whose `Transform` is
//! written is placed, and keeps its velocity.
//!
//! # Invalid components
//!
//! A body or collider with invalid components, for example a NaN in its `Transform`, is left out of the step and
//! reported once: by an error in the log and a [`BodyRejected`](crate::plugin::events::BodyRejected) message. It takes
//! part again when its components are valid; other bodies are not affected. Each
//! [`BodyFault`](crate::state::BodyFault) says what to do. Settings without effect, for example negative damping or a
//! `RigidBody` without a collider, cause a warning in the log.
//!
//! [`CollisionEnd`]: crate::plugin::events::CollisionEnd
//! [`CollisionStart`]: crate::plugin::events::CollisionStart
//! [`ContinuousCollision`]: crate::plugin::components::ContinuousCollision
//! [`Response::Contacts`]: crate::types::settings::Response::Contacts
//! [`Response::Impulse`]: crate::types::settings::Response::Impulse
//! [`Sensor`]: crate::plugin::components::Sensor
//! [`SolverSettings::max_iterations`]: crate::types::solver_settings::SolverSettings::max_iterations
//! [`StableKey`]: crate::plugin::components::StableKey
