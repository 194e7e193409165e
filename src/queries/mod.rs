//! Collision queries of placed meshes, without a simulation, an app or a thread pool: rays, nearest points, overlaps,
//! casts and contact points.
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
//! A placed mesh can also be asked what a ray hits, and how far a shape can move:
//!
//! ```
//! use bevy_faceoff::asset::CollisionMesh;
//! use bevy_faceoff::geometry::shapes;
//! use bevy_faceoff::queries::{CastScratch, Placed, QueryShape, Ray};
//! use glam::{DQuat, DVec3, Vec3};
//!
//! let cube = CollisionMesh::new(&shapes::cube(2.0));
//! let cube = Placed::new(&cube, DVec3::ZERO, DQuat::IDENTITY, Vec3::ONE)?;
//! let start = DVec3::new(0.2, 5.0, 0.1);
//! let hit = cube.cast_ray(&Ray::new(start, DVec3::NEG_Y)).unwrap();
//! assert!((hit.distance - 4.0).abs() < 1e-9);
//! println!("face {} at {}", hit.face, hit.barycentric);
//!
//! let ball = QueryShape::Ball { radius: 0.5 };
//! let mut scratch = CastScratch::default();
//! let hit = cube.cast(&ball, start, DQuat::IDENTITY, DVec3::NEG_Y, f64::INFINITY, &mut scratch).unwrap();
//! assert!((hit.distance - 3.5).abs() < 1e-9);
//! assert!(cube.overlaps(&ball, start + DVec3::NEG_Y * 3.6, DQuat::IDENTITY));
//! # Ok::<(), bevy_faceoff::queries::BodyFault>(())
//! ```
//!
//! * [`Placed`] is a mesh with a pose, and gives its bounding box and mass. A
//!   [`CollisionMesh`](crate::asset::CollisionMesh) is cheap to clone: clones share their data.
//! * [`ContactWorker`] finds all contact points of two placed meshes, or the reduced manifold that a solver needs, each
//!   point with the faces and features that touch.
//! * [`Placed::cast_ray`] finds the first face that a [`Ray`] hits, [`Placed::ray_hits`] all of them, and
//!   [`Placed::hits_ray`] whether there is one.
//! * [`Placed::closest_point`] finds the nearest point of the surface, and whether a point is inside.
//! * [`Placed::closest_to_segment`] finds how a capsule comes out of an overlap.
//! * [`Placed::overlaps`] tells whether a [`QueryShape`] touches the mesh: a mesh, ball, box or capsule.
//!   [`Placed::cast`] finds where it first touches if it moves along a line.
//! * [`Scene`] asks many placed meshes and planes at once.
//! * [`check`](check::check) and [`touching`] find the touching pairs of many placements. They run on rayon's thread
//!   pool.
//!
//! Lengths are metres, masses kilograms, angles radians.

mod cast;
pub mod check;
mod contacts;
mod overlap;
mod placed;
mod point;
mod ray;
mod rounded;
mod scene;
mod segment;
mod shape;

pub use crate::state::fault::BodyFault;
pub use crate::types::feature_id::{FeatureId, FeatureKind};
pub use cast::{CastHit, CastScratch};
pub use check::{
    Check, CheckOptions, Placement, PlacementError, TouchingPair, check, check_with, touching, touching_with,
};
#[cfg(feature = "gpu")]
pub use check::{CheckError, check_on_gpu};
pub use contacts::{ContactWorker, MeshContact, PairMemory};
pub use placed::Placed;
pub use point::PointHit;
pub use ray::{Ray, RayHit};
pub use scene::{Scene, SceneCastHit, ScenePointHit, SceneRayHit, SceneSegmentHit};
pub use segment::SegmentHit;
pub use shape::QueryShape;
