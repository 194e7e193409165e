//! Continuous collision detection: stops fast bodies at their first impact, so that they do not tunnel through thin
//! ones.
//!
//! [`time_of_impact`](time_of_impact()) computes the time of impact of one pair, triangle by triangle: a bullet flies
//! through the hole of a ring. [`find_impacts`] does so for all bodies with continuous collision detection and computes
//! where they end. [`first_touch`] computes where a pair first touches on its path, for sensors. `stage` does all of
//! this within a step.
//!
//! The method is conservative advancement (Mirtich 1996): two bodies cannot touch before the time that is their
//! distance divided by an upper bound for the speed at which their points approach. As in Zhang, Lee and Kim (2006)
//! that speed is measured along the direction of the distance. As in Tang, Kim and Manocha, "C2A: Controlled
//! conservative advancement for continuous collision detection of polygonal models" (2009), parts of the bodies have
//! bounds of their own. Here even each pair of nodes advances at its own pace; see `search`.
//!
//! | file | contents |
//! |---|---|
//! | `stage` | continuous collision detection as part of a step |
//! | `impacts` | the impacts of all bodies in a collision substep |
//! | `first_contact` | where pairs first touch whose speculative points were dropped |
//! | `body_sweeps` | how bodies move after impacts |
//! | `sensors` | bodies that touch sensors on their paths |
//! | `time_of_impact` | the time of impact of one pair |
//! | `search` | conservative advancement over the bounding volume trees of two meshes |
//! | `cast` | the same search for a mesh that moves along a line without turning, exact to rounding |
//! | `spheres` | when the bounding spheres of two moving bodies overlap |
//! | `sweep` | the motion of a body |
//! | `relative` | relative pose and motion of two bodies at one time |
//! | `nodes` | safe times for boxes |
//! | `triangles` | safe times for triangles in single precision |
//! | `triangle_pair` | the safe time for one pair of triangles in double precision |

mod body_sweeps;
mod cast;
pub(crate) mod first_contact;
mod impacts;
mod nodes;
mod relative;
mod search;
mod sensors;
mod spheres;
pub(crate) mod stage;
mod sweep;
mod time_of_impact;
mod triangle_pair;
mod triangles;

pub(crate) use cast::{Moving, cast, cast_rounded};
pub use impacts::{Impact, ImpactScratch, find_impacts};
pub use search::Scratch;
pub use sensors::{SensorScratch, find_sensor_touches};
pub use sweep::{Pose, Sweep};
pub use time_of_impact::{first_touch, time_of_impact};
