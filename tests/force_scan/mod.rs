//! The response with one contact and one impulse per pair.

mod impulses;
