//! Collisions between thousands of moving, concave triangle meshes, triangle by triangle, inside Bevy.

pub mod asset;
pub mod geometry;
pub mod projection;
pub mod queries;
