//! Sleep islands.

mod islands;
