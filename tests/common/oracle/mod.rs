//! The oracle: which triangles of which bodies touch, decided by brute force with exact predicates.
//!
//! It shares nothing with the product: poses, boxes, triangle tests, connectivity and containment are all written a
//! second time, on `f64`, in the most direct way that is fast enough. `tests/oracle_itself.rs` tests the oracle.

// Every test binary compiles this module and uses a part of it.
#![allow(dead_code)]

pub mod body;
pub mod brute;
pub mod compare;
pub mod data;
pub mod generators;
pub mod inside;
pub mod lattice;
pub mod margin;
pub mod parallel;
pub mod product;
pub mod regimes;
pub mod rng;
pub mod shapes;
pub mod tritri;
