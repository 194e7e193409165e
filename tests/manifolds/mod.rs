//! Contact points of meshes: positions, normals and depths, against analytic results and against a search over all
//! separating directions with exact predicates.

mod bad;
mod concave;
mod convex;
mod many;
mod reduce;
mod same;
mod scene;
