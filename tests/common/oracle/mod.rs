//! The oracle: finds which triangles of which bodies touch, by brute force with exact predicates.
//!
//! It shares nothing with the product: poses, boxes, triangle tests, connectivity and containment are all implemented a
//! second time, on `f64`, in the most direct way that is fast enough. `tests/triangle_test/oracle_itself.rs` tests the
//! oracle.

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
