//! Steps with contacts, without an app: bodies at rest, hanging chains, falling and colliding bodies.

mod blades;
mod bounce;
mod bullets;
mod chain;
mod cloud;
mod coins;
mod compounds;
mod elastic;
mod fly_past;
mod groups;
mod hammers;
mod incline;
mod instruction_sets;
mod meshes;
mod motion;
mod planes;
mod pour;
mod rest;
mod rims;
mod rolling;
mod same_bits;
mod small_games;
mod spin;
mod taut;
mod thread;
