//! Brute force and meshes of the tests of continuous collision detection.

#![allow(dead_code)]

#[path = "../ccd/oracle.rs"]
pub mod oracle;
#[path = "../ccd/shapes.rs"]
pub mod shapes;
