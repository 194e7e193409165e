//! Guides: what there is, how to choose settings, how it works, what changes for those who come from another engine,
//! and what to do about surprises.
//!
//! | you want to | read |
//! |---|---|
//! | look up what to use for what | [`what_to_use`] |
//! | know how bodies, clocks, sensors and events behave | [`what_to_expect`] |
//! | set the plugin up for your kind of game, server or tool; a first program with a window; where to put systems | [`choose_settings`] |
//! | load and bake meshes; what an open mesh or a room does | [`meshes`] |
//! | give colliders to a scene from Blender, write bodies in `bsn!`, or save a world and load it again | [`scenes`] |
//! | find what a ray hits, or what is near | [`spatial_queries`] |
//! | run on a GPU | [`gpu`] |
//! | decide between this, Avian and bevy_rapier | [`comparison`] |
//! | move a game from Avian | [`from_avian`] |
//! | move a game from bevy_rapier | [`from_bevy_rapier`] |
//! | understand a warning, an error or a surprise | [`troubleshooting`] |
//! | look up a word, a limit or a built-in shape | [`glossary`] |
//! | know what it does, in pictures | [`how_it_works`] |
//!
//! `examples/README.md` lists the examples, which are programs to start from. `docs/COMMAND_LINE.md` is about the
//! command line.
//!
//! # What it does
//!
//! * **Concave against concave, exactly.** There are no convex hulls, no decomposition and no distance fields. The
//!   exact mode finds every intersecting face pair. Each run of CI compares 45,000 touching pairs with an independent
//!   oracle, and one run compared a million. None may be missing.
//! * **Contacts for concave meshes**, with friction: stacks stand, rings interlock, a nut travels down its bolt.
//!   Momentum, friction, rolling and free rotation are tested against formulas.
//! * **Baked at import**, as Bevy assets: clusters, support heights, mass, and on request the *face table* of Aly &
//!   Elawady's height projection (EDERC 2010).
//! * **Ordered stages** in every fixed step: BroadPhase, Angles, TriangleTest, Manifolds, ForceScan, Integrate.
//!   [`how_it_works`] explains them with pictures.
//! * **On the GPU or the CPU.** All stages run as wgpu compute kernels or on all cores, and a game need not wait for
//!   the GPU: [`gpu`].
//! * **Without a window.** Tests, tools and servers run the same stages without a window or a GPU.
//! * **Without an engine.** Without the feature `bevy` the crate is a library on plain arrays.

pub mod choose_settings;
pub mod comparison;
pub mod from_avian;
pub mod from_bevy_rapier;
pub mod glossary;
pub mod gpu;
pub mod how_it_works;
pub mod meshes;
pub mod scenes;
pub mod spatial_queries;
pub mod troubleshooting;
pub mod what_to_expect;
pub mod what_to_use;
