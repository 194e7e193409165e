//! Which settings suit which program, a first program with a window, and what works with which response.
//!
//! The defaults suit a game with bodies that fall, slide, stack and roll, but for one: [`Backend::Auto`] takes the GPU
//! if there is one. With a few to some hundred bodies [`Backend::Cpu`] is faster, so set it there. Change other
//! settings if your program is one of these.
//!
//! # A few bodies that matter
//!
//! A marble run, a vehicle made of parts, a puzzle of interlocking pieces. Run the stages on the CPU, and draw between
//! steps:
//!
//! ```
//! use bevy::prelude::*;
//! use bevy_faceoff::prelude::*;
//!
//! # let mut app = App::new();
//! # app.add_plugins((MinimalPlugins, AssetPlugin::default()));
//! let step = StepPlugin { backend: Backend::Cpu, ..default() };
//! app.add_plugins(FaceoffPlugins { step });
//! // With the feature `interpolation`:
//! // app.add_plugins(FaceoffPlugins { step }.set(InterpolationPlugin::interpolate_all()));
//!
//! fn shoot(mut commands: Commands, bullet: Res<Bullet>) {
//!     commands.spawn((
//!         RigidBody::Dynamic,
//!         bullet.0.clone(),
//!         Transform::from_xyz(0.0, 1.0, 0.0),
//!         LinearVelocity(Vec3::NEG_Z * 300.0),
//!         // It would pass a thin wall within one step.
//!         ContinuousCollision,
//!     ));
//! }
//!
//! #[derive(Resource)]
//! struct Bullet(MeshCollider);
//! ```
//!
//! # A game in a window
//!
//! The example `first_game` is complete: `cargo run --release --features window --example first_game`. In a game of
//! your own, put this into `Cargo.toml`:
//!
//! ```toml
//! [dependencies]
//! bevy = "0.19.1"
//! bevy_faceoff = { path = "../bevy_faceoff", features = ["bevy_mesh", "interpolation"] } # the path of your checkout
//!
//! # Steps are slow without optimisation, also while you develop.
//! [profile.dev.package."*"]
//! opt-level = 3
//! ```
//!
//! With thousands of bodies add the feature `bevy_render` and leave out `backend: Backend::Cpu`: then the stages run on
//! the GPU, on the device of Bevy's renderer.
//!
#![doc = concat!("```text\n", include_str!("../../examples/first_game.rs"), "```")]
//!
//! `FaceoffPlugins` comes after `DefaultPlugins`. Each body has a `Mesh3d` to draw. With the feature `bevy_mesh`,
//! `MeshColliderFrom(mesh)` makes the collider from that mesh: also from Bevy's `Cuboid` or `Capsule3d`. If you draw
//! more often than bodies move, 64 times a second by default, add the feature `interpolation`, and
//! `TransformInterpolation` to each body or `FaceoffPlugins::default().set(InterpolationPlugin::interpolate_all())`.
//!
//! # Where to put systems
//!
//! The step runs in `FixedPostUpdate`, in the system set [`FaceoffStep`], 64 times a second by default. A frame may
//! have no step, one or several.
//!
//! | a system that | schedule |
//! |---|---|
//! | sets forces, velocities, [`Character::velocity`] or the `Transform` of a lift | `FixedUpdate`: the step that follows uses them |
//! | reads [`Collisions`], [`CharacterGround`], hits of casters, or poses and velocities after each step | `FixedLast` |
//! | reads messages such as [`CollisionStart`] | `FixedLast` for those of the step just done, `Update` for those of all steps of the frame |
//! | runs immediately before or after the step | `FixedPostUpdate`, with `.before(FaceoffStep)` or `.after(FaceoffStep)` |
//! | is a solver of your own, or uses results within the step | [`FaceoffStep`] as a schedule, in the set [`FaceoffSystems::Respond`] |
//! | spawns bodies, moves a camera, shows figures | `Update`, or any other |
//!
//! Observers of [`CollisionStart`] and `CollisionEnd` run at the end of the step. With [`Readback::Latent`] all results
//! come two steps later.
//!
//! # What works with which response
//!
//! | | [`Contacts`](crate::types::settings::Response::Contacts) | [`Impulse`](crate::types::settings::Response::Impulse) | [`None`](crate::types::settings::Response::None) |
//! |---|---|---|---|
//! | velocities, `Gravity`, `GravityScale` | yes | yes | yes |
//! | `Collisions`, messages, events, `Sensor`, `CollisionLayers` | yes | yes | yes |
//! | `SpatialQuery`, casters, `Character` | yes | yes | yes |
//! | bodies stop at colliders and planes | yes | they bounce; only planes push overlapping bodies out | no |
//! | bodies come to rest, and sleep | yes | no | no |
//! | `Friction` | yes | no | no |
//! | `Restitution` | yes, by its `CombineRule` | the mean of the two | no |
//! | `Mass`, `Density`, `AngularInertia` | yes | yes | no |
//! | `ExternalForces`, damping, speed limits, `LockedAxes` | yes | no | no |
//! | `ContinuousCollision`, also for sensors | yes | no | no |
//! | a kinematic body pushes | yes | by its velocity; a written `Transform` places it | no |
//! | contact points: `Collision::points`, `Collisions::manifolds` | yes, with impulses | no | yes, with impulses of 0 |
//! | `CollisionHooks::filter_pairs` | yes | yes | yes |
//! | `CollisionHooks::modify_contacts` | yes | no | yes, for the points that are reported |
//!
//! # Hundreds of bodies in piles
//!
//! Rubble, coins, a shaken box. Time goes to contacts between bodies that are awake.
//!
//! * Let them sleep. [`SleepingDisabled`] keeps a body awake, and with it all that it touches.
//! * On the CPU, where more than 64 bodies sleep, those with nothing awake near are dormant and cost a step nothing:
//!   [`StepReport::dormant`] counts them. What rests on a kinematic body, bodies of several colliders, bodies under
//!   other entities, and all bodies of a world with collision hooks are not among them.
//! * Give small bodies coarse meshes. The mesh that is drawn may be a finer one.
//! * Let rubble not collide with what does not matter: [`CollisionLayers`](crate::types::body::CollisionLayers).
//! * Look at [`StepReport`](crate::plugin::collisions::StepReport) before you change anything else. If
//!   `collision_substeps` is above 1 while the pile lies still, something thin or fast is among it.
//!
//! # Swarms of thousands that only bounce
//!
//! Asteroids, debris, a crowd of drones. One impulse per pair is enough, and nothing rests on anything:
//!
//! ```
//! use bevy::prelude::*;
//! use bevy_faceoff::prelude::*;
//!
//! # let mut app = App::new();
//! # app.add_plugins((MinimalPlugins, AssetPlugin::default()));
//! app.add_plugins(FaceoffPlugins::default())
//!     .insert_resource(Response::Impulse)
//!     .insert_resource(Gravity(Vec3::ZERO));
//! ```
//!
//! On a GPU choose [`Readback::Resident`](crate::plugin::settings::Readback) if nothing but drawing needs the
//! poses, and draw from `plugin::poses`: the example `swarm` does. Then nothing but counts is read back. With the other
//! two leave [`FaceLists`](crate::plugin::settings::FaceLists) off unless something looks at faces.
//!
//! With contacts a GPU pays from thousands of touching pairs on. With a few hundred bodies or fewer choose
//! [`Backend::Cpu`]: a step on a GPU waits for a hundred short dispatches and more.
//!
//! # Servers, and games that must repeat
//!
//! No window, no GPU, the same result whenever the same thing happens:
//!
//! ```
//! use bevy::log::LogPlugin;
//! use bevy::prelude::*;
//! use bevy_faceoff::prelude::*;
//!
//! # let mut app = App::new();
//! app.add_plugins((
//!     MinimalPlugins,
//!     // Tells why a body is rejected, and where the stages run. Once per process.
//!     LogPlugin::default(),
//!     FaceoffHeadlessPlugins {
//!         step: StepPlugin {
//!             backend: Backend::Cpu,
//!             // Several matches share the machine.
//!             threads: 1,
//!             ..default()
//!         },
//!         ..default()
//!     },
//! ));
//! ```
//!
//! # The same bits
//!
//! Lockstep, rollback and replays need two runs that stay equal to the last bit: bodies that collide make the smallest
//! difference grow. [`Snapshot`] takes the state and restores it, and the example `rollback` repeats 8 steps in every
//! step.
//!
//! **On one machine** two runs are equal if all of this is the same:
//!
//! * The executable, and [`Backend::Cpu`]. Results of a GPU are not those of the CPU.
//! * The order of bodies. Give every collider and plane a [`StableKey`]: then entities do not matter, nor in which
//!   order bodies are spawned. Without keys the entities must be the same.
//! * Meshes, components, settings, and what systems write, before the same step.
//! * The length of the steps. Bevy's fixed timestep is constant; `run_schedule(FaceoffStep)` has the same length.
//!
//! What does not matter: the number of threads, the frame rate, the instruction set that is chosen at run time (such as
//! AVX2), and whether a [`Snapshot`] was restored in between. The tests compare the bits in all these cases.
//!
//! **On two machines** all of this holds as well, and further:
//!
//! * The same target, for example `x86_64-unknown-linux-gnu`, and the same compiler with the same options. `-C
//!   target-cpu` and `-C target-feature` change how vectors are computed, and so does another architecture.
//! * The same library of mathematical functions. A step calls `exp` (damping, choice of contact points) and, for
//!   rotations, `sin`, `cos` and the arc functions of Rust's standard library. The library takes them from the
//!   operating system. On Linux that is glibc, and the results of its versions may differ in the last bit. A statically
//!   linked program, for example for `x86_64-unknown-linux-musl`, contains these functions. The rest of a step uses
//!   basic operations and square roots, which IEEE 754 defines to the bit.
//! * The same meshes, to the bit. Bake them once and ship the `.faceoff` files: a bake calls such functions more often.
//!
//! The tests run on one machine at a time, so equality between machines follows from these reasons and is not tested.
//! Compare a hash of the poses now and then, and send a [`Snapshot`] when they differ.
//!
//! **On a GPU** two runs with [`Readback::Lockstep`] give the same bits if the GPU, the driver and the build are the
//! same. Another GPU or driver gives other bits. With [`Readback::Latent`] and [`Readback::Resident`] the bits may
//! differ from those of `Lockstep` after an impact: a step has only one collision substep if the speeds of
//! [`LATENCY`](crate::plugin::settings::LATENCY) steps before do not need more.
//!
//! A [`SpatialQuery`](crate::plugin::queries::SpatialQuery) finds the same, except where two hits have exactly the same
//! distance: which of them comes first depends on how bodies were spawned.
//!
//! # In a browser
//!
//! Build for `wasm32-unknown-unknown`, with the feature `web` of Bevy. All stages run on the page's thread:
//! [`Backend::Auto`](crate::plugin::settings::Backend) chooses the CPU, because a step cannot wait for a GPU there.
//!
//! * Bake meshes ahead of time, with `faceoff bake` or Bevy's asset processor. The page stands still during a bake.
//! * A step has one core, and the instructions of WebAssembly: expect a fraction of the bodies of a desktop.
//!
//! `.ci/web` in the repository runs an example of the library in Node.js. It has not been tried in a browser.
//!
//! # Tests
//!
//! An app on a clock of its own runs one step per update, as fast as it can:
//!
//! ```
//! use bevy::prelude::*;
//! use bevy::time::TimeUpdateStrategy;
//! use bevy_faceoff::{geometry::shapes, prelude::*};
//!
//! let mut app = App::new();
//! app.add_plugins((MinimalPlugins, FaceoffHeadlessPlugins::default()));
//! let step = app.world().resource::<Time<Fixed>>().timestep();
//! app.insert_resource(TimeUpdateStrategy::ManualDuration(step));
//! let mut meshes = app.world_mut().resource_mut::<Assets<CollisionMesh>>();
//! let cube = MeshCollider(meshes.add(CollisionMesh::new(&shapes::cube(1.0))));
//! let floor = app.world_mut().spawn(PlaneCollider::through(Vec3::ZERO, Vec3::Y)).id();
//! let cube = app.world_mut().spawn((RigidBody::Dynamic, cube, Transform::from_xyz(0.0, 2.0, 0.0))).id();
//! app.finish();
//! app.cleanup();
//! for _ in 0..64 {
//!     app.update();
//! }
//! assert!(app.world().resource::<Collisions>().get(cube, floor).is_some());
//! ```
//!
//! # Tools, and a solver of your own
//!
//! * Whether parts of a machine interfere: [`queries::check`](crate::queries), without an app.
//! * Contact points for a solver of your own: [`Response::None`](crate::types::settings::Response), and
//!   [`Collisions::manifolds`](crate::plugin::collisions::Collisions::manifolds) after each step. There is a program in
//!   [`how_it_works`](super::how_it_works#a-solver-of-your-own).
//! * A library of meshes: `faceoff bake`, or Bevy's asset processor.
//!
//! # More accurate, or cheaper
//!
//! | to | change |
//! |---|---|
//! | hold tall stacks of very unequal masses | [`SolverSettings::substeps`], 8 by default |
//! | let fast small bodies cost less, and pass thin ones now and then | [`SolverSettings::max_collision_substeps`] = 1, and [`ContinuousCollision`] on those that matter |
//! | test fewer triangles and miss some collisions | [`Culling`](crate::types::settings::Culling) |
//! | simulate less often | `Time::<Fixed>::from_hz(32.0)`; contacts then push less smoothly |
//!
//! [`FaceoffStep`]: crate::plugin::FaceoffStep
//! [`FaceoffSystems::Respond`]: crate::plugin::FaceoffSystems::Respond
//! [`Character::velocity`]: crate::plugin::character::Character::velocity
//! [`CharacterGround`]: crate::plugin::character::CharacterGround
//! [`Collisions`]: crate::plugin::collisions::Collisions
//! [`CollisionStart`]: crate::plugin::events::CollisionStart
//! [`Backend::Auto`]: crate::plugin::settings::Backend::Auto
//! [`Backend::Cpu`]: crate::plugin::settings::Backend::Cpu
//! [`Readback::Latent`]: crate::plugin::settings::Readback::Latent
//! [`Readback::Lockstep`]: crate::plugin::settings::Readback::Lockstep
//! [`Readback::Resident`]: crate::plugin::settings::Readback::Resident
//! [`Snapshot`]: crate::plugin::snapshot::Snapshot
//! [`StableKey`]: crate::plugin::components::StableKey
//! [`SleepingDisabled`]: crate::plugin::components::SleepingDisabled
//! [`StepReport::dormant`]: crate::plugin::collisions::StepReport::dormant
//! [`ContinuousCollision`]: crate::plugin::components::ContinuousCollision
//! [`SolverSettings::substeps`]: crate::types::solver_settings::SolverSettings::substeps
//! [`SolverSettings::max_collision_substeps`]: crate::types::solver_settings::SolverSettings::max_collision_substeps
