//! The response that gives each pair one contact and one impulse.

mod impulses;
