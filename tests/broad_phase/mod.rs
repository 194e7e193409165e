//! The broad phase.

mod grid;
