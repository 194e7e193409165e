//! The bake: faces of collision by height projection, their table, and support heights.

mod face_table;
mod faces;
mod heights;
mod meshes;
mod oracle;
