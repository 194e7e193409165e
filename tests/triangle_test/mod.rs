//! Intersecting triangles, against brute force in exact arithmetic.

mod apart;
mod data;
mod exact;
mod fine;
mod known;
mod oracle_itself;
mod properties;
