//! Questions about placed meshes, without a step.

mod check;
