//! Spatial queries: what a ray hits, what is near, what a shape overlaps or runs into.
//!
//! ```rust
//! use bevy::prelude::*;
//! use bevy_faceoff::prelude::*;
//!
//! fn look_down(player: Single<(Entity, &Transform), With<Name>>, world: SpatialQuery) {
//!     let (player, transform) = *player;
//!     let filter = SpatialQueryFilter::excluding([player]).without_sensors();
//!     if let Some(hit) = world.cast_ray(transform.translation, Dir3::NEG_Y, 100.0, &filter) {
//!         println!("{} m above face {:?} of {}", hit.distance, hit.face, hit.collider);
//!     }
//! }
//! ```
//!
//! [`SpatialQuery`](crate::plugin::queries::SpatialQuery) is exact on the triangles of colliders and on planes,
//! wherever the stages run:
//!
//! * It casts rays, and finds the first hit, all hits, any hit, or the first that a predicate accepts.
//! * It casts shapes: a ball, box, capsule or mesh.
//! * It finds nearest points and overlaps.
//!
//! A hit names the collider, its body, and the face as an index of the mesh *file*, with the weights of the face's
//! corners. With them you can look up what is painted there.
//!
//! Queries use the poses that components have after the last step. If systems have moved or spawned colliders since
//! then, run [`update_spatial_queries`](crate::plugin::queries::update_spatial_queries) before the system that
//! queries. With [`Readback::Resident`](crate::plugin::settings::Readback::Resident) poses stay on the GPU: use those
//! of a [`Snapshot`](crate::plugin::snapshot::Snapshot), with `update_spatial_queries_from(world, snapshot.bodies())`.
//!
//! The first query after a step builds a tree over all bodies.
//!
//! [`RayCaster`](crate::plugin::queries::RayCaster) and [`ShapeCaster`](crate::plugin::queries::ShapeCaster) are casts
//! as components. [`queries`](crate::queries) has queries without an app. The example `rays` shows what 180 rays hit.
