//! Contact points between meshes: where they are, which way they push, and how deep, against formulas and against a
//! search over all ways out with exact predicates.

mod bad;
mod concave;
mod convex;
mod many;
mod reduce;
mod same;
mod scene;
