//! Collision queries: contact points and overlap tests of placed meshes, without a simulation, an app or a thread pool.
//!
//! ```
//! use bevy_faceoff::asset::CollisionMesh;
//! use bevy_faceoff::geometry::shapes;
//! use bevy_faceoff::queries::{ContactWorker, PairMemory, Placed};
//! use glam::{DQuat, DVec3, Vec3};
//!
//! // Once for each mesh: milliseconds.
//! let knot = CollisionMesh::new(&shapes::knot_1120());
//!
//! // Once for each thread, and for each pair of bodies.
//! let mut worker = ContactWorker::new();
//! let mut memory = PairMemory::default();
//!
//! // In each step.
//! let a = Placed::new(&knot, DVec3::ZERO, DQuat::IDENTITY, Vec3::ONE)?;
//! let b = Placed::new(&knot, DVec3::X * 0.4, DQuat::from_rotation_y(0.5), Vec3::ONE)?;
//! let mut points = Vec::new();
//! worker.manifold(&a, &b, 0.01, &mut memory, &mut points);
//! for point in &points {
//!     let at = a.translation() + point.anchors[0];
//!     println!("{at}: {} m apart along {}", point.separation, point.normal);
//!     println!("{:?} touches {:?}", point.features[0], point.features[1]);
//! }
//! assert!(points.iter().any(|point| point.separation < 0.0));
//! # Ok::<(), bevy_faceoff::queries::BodyFault>(())
//! ```
//!
//! * [`Placed`] is a mesh with a pose, and gives its bounding box and mass. A
//!   [`CollisionMesh`](crate::asset::CollisionMesh) is cheap to clone: clones share their data.
//! * [`ContactWorker`] finds all contact points of two placed meshes, or the reduced manifold that a solver needs, each
//!   point with the faces and features that touch.
//! * [`Placed::cast_ray`] finds the first face that a [`Ray`] hits; others find all of them, or whether there is one.
//! * [`check`](check::check) and [`touching`] find the touching pairs of many placements. They run on rayon's thread
//!   pool.
//!
//! Lengths are metres, masses kilograms, angles radians.

mod bounds;
pub mod check;
mod contacts;
mod overlap;
mod placed;
mod point;
mod ray;
mod shape;

pub use crate::state::fault::BodyFault;
pub use crate::types::feature_id::{FeatureId, FeatureKind};
pub use check::{
    Check, CheckOptions, Placement, PlacementError, TouchingPair, check, check_with, touching, touching_with,
};
#[cfg(feature = "gpu")]
pub use check::{CheckError, check_on_gpu};
pub use contacts::{ContactWorker, MeshContact, PairMemory};
pub use placed::Placed;
pub use point::PointHit;
pub use ray::{Ray, RayHit};
pub use shape::QueryShape;
