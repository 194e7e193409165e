//! Collision queries without a step.

mod check;
