//! Sleep.

mod islands;
