//! How it works: from a mesh file to bodies that rest on each other.
//!
//! You need none of this to use the plugin. Read it if you want to know what a setting changes, why something is fast
//! or slow, or where to add a stage of your own.
//!
//! The method is that of H. A. Aly and T. A. E. Elawady, "A New Narrow Phase Collision Detection Algorithm Using Height
//! Projection" (EDERC 2010): what depends only on a mesh is computed once, at import, by looking at the mesh from many
//! directions. Here it is made exact, and a contact solver is added.
//!
#![doc = include_str!("pictures/pipeline.svg")]
//!
//! The names of the six stages are those of [`FaceoffSystems`](crate::plugin::FaceoffSystems), of the times in
//! [`StepReport`](crate::plugin::collisions::StepReport), and of the folders in the sources.
//!
//! # The bake
//!
//! ## Height projection
//!
//! A mesh is drawn along a direction as a square image. The value of a pixel is a height: how far the mesh reaches
//! towards the viewer there, measured from its lowest point. Where triangles overlap, the highest one wins.
//!
#![doc = include_str!("pictures/projection.svg")]
//!
//! [`HeightImage`](crate::projection::HeightImage) draws such an image, and so does `faceoff image`. This is the one
//! above:
//!
//! ```
//! use bevy_faceoff::geometry::shapes;
//! use bevy_faceoff::projection::HeightImage;
//! use glam::Vec3;
//!
//! let torus = shapes::torus_240();
//! // A direction in the mesh's own axes, towards the viewer: 75 degrees from the axis of the torus.
//! let angle = 75f32.to_radians();
//! let image = HeightImage::draw(&torus, Vec3::new(0.0, -angle.sin(), angle.cos()), 28);
//! let covered = image.faces.iter().filter(|&&face| face != HeightImage::NONE).count();
//! assert_eq!(covered, 250);
//! ```
//!
//! ## Faces of collision
//!
//! The triangles that are still visible in the image are the *faces of collision* of its direction. A body that comes
//! from there can first be touched by them, and hardly by the others.
//!
#![doc = include_str!("pictures/faces.svg")]
//!
//! A [`FaceTable`](crate::projection::FaceTable) holds them for all directions, one degree apart by default. Directions
//! that see the same triangles share one list. The table takes seconds to bake, so it is made only if
//! [`BakeSettings::faces`](crate::projection::BakeSettings::faces) asks for it.
//!
//! ```
//! use bevy_faceoff::geometry::shapes;
//! use bevy_faceoff::projection::{BakeSettings, FaceTable, Progress, bake_pool};
//! use glam::Vec3;
//!
//! let torus = shapes::torus_240();
//! let settings = BakeSettings { faces: true, degrees: 15, ..Default::default() };
//! let table = FaceTable::bake(&torus, &settings, bake_pool(), &Progress::default())?;
//! let angle = 75f32.to_radians();
//! let seen = table.group(Vec3::new(0.0, -angle.sin(), angle.cos()));
//! assert_eq!(seen.len(), 98);
//! # Ok::<(), bevy_faceoff::projection::Cancelled>(())
//! ```
//!
//! Faces of collision miss what is hidden along the line between two centres: 91 % of the pairs of tori that are linked
//! through their holes. So they are a setting, [`Culling::FacesOfCollision`](crate::types::settings::Culling), and
//! not the default. Its documentation has the measured recall.
//!
//! ## Support heights
//!
//! The *support height* of a mesh in a direction is its largest height: how far it reaches that way from its centre of
//! mass. It is baked for 258 directions. In between it is interpolated within the triangle of three baked directions.
//! Support heights are convex, so this is never too small. Two bodies whose heights towards each other do not add up to
//! the distance of their centres do not touch:
//!
#![doc = include_str!("pictures/support.svg")]
//!
//! ## The rest of the bake
//!
//! * **Clusters.** Triangles are sorted so that each run of eight is compact in space, each run of 64 too, and so on.
//!   This order is a tree without pointers: each node has a box, and eight children, which are compared at once.
//! * **Features.** Each vertex and each edge has one triangle that owns it, so that no contact point is found twice.
//!   Edges know the normals of their faces, and whether they are convex.
//! * **Closed or open.** Vertices are welded, the winding of faces is made consistent, and small openings are closed by
//!   caps. This decides what is inside, and to which side faces push:
//!   [`meshes`](super::meshes#closed-open-inverted) has a table.
//! * **Mass, thickness, bounding sphere.**
//!
//! # The step
//!
//! [`FaceoffStep`](crate::plugin::FaceoffStep) runs in `FixedPostUpdate`. It reads components into plain arrays, runs
//! the stages, and writes the results back. With [`Response::Contacts`](crate::types::settings::Response) it is divided
//! into 1 to 8 *collision substeps*, and contact points are searched for in each of them. There are as many as it takes
//! that within one of them no two surfaces move relative to each other by more than a quarter of the thickness of the
//! thinnest body, but never more than 8. Only bodies that can meet in the step count. Each group of such bodies has its
//! own number of collision substeps. A body that has completed its step waits for the others and keeps its contact
//! points. On the CPU pairs that overlap deeply keep their contact points until they have moved twice as far.
//!
//! ## BroadPhase: a grid
//!
//! Which bounding spheres overlap? A hashed grid answers, with a level of cells for each factor of four in the radii
//! (of two on a GPU). A body looks in its own level and the coarser ones, so one huge body does not make the cells of
//! all others large. Static bodies have a grid of their own on the CPU, which is sorted again only when one of them
//! changes. If a step has several collision substeps, the CPU searches once, with spheres that are large enough for the
//! motion of the whole step. It searches again only if a body leaves its sphere.
//!
//! For contacts, spheres are enlarged so that two of them overlap if the surfaces are within the *speculative margin*:
//! one percent of the smaller body's size, plus a part for motion. That part is one and a half times the distance by
//! which the surfaces may approach each other until the next search, but at most twice the thickness of the thinner
//! body. Rotation counts where the other body may touch: the support heights of the other tell how far from the axis
//! that is.
//!
//! ## Angles: support axes
//!
//! Most of these pairs do not touch. A *support axis* is a direction along which the support heights of both bodies are
//! compared: if they leave a gap, the pair is dropped. The first axis is the line between the centres, which the paper
//! uses to look up faces. Up to seven more come from Gilbert's iteration on the support heights. Of the pairs of tori
//! that do not touch nine of ten are dropped here. No pair that touches is dropped.
//!
//! With an approximate [`Culling`](crate::types::settings::Culling) the direction from centre to centre also selects
//! the triangles of each body that take part in the next stage.
//!
//! ## TriangleTest: which faces intersect
//!
//! The trees of both meshes are descended together. Only boxes that meet are opened, so the cost follows the size of
//! the contact and not of the meshes. Meshes with few clusters skip the descent: their clusters are culled one by one
//! against the other body, which is faster. The picture shows two curves of 64 pieces in place of two meshes:
//!
#![doc = include_str!("pictures/descent.svg")]
//!
//! Triangles whose boxes meet must also cross each other's planes. For what is left the interval test of Möller (1997)
//! runs on eight pairs at once, in single precision and with a bound on each error. It answers only what is certain.
//! The CPU decides the rest in double precision. Coordinates are relative to the clusters, so that rounding errors are
//! small compared with the triangles. **Single precision may only reject or confirm what is clear; so nothing is
//! missed.** A GPU has no fast double precision: there the rest counts as touching unless a separating plane is found.
//!
//! The result is what [`Collisions`](crate::plugin::collisions::Collisions) reports: pairs and, with
//! [`FaceLists`](crate::plugin::settings::FaceLists), their intersecting faces and the segment in which each two cross.
//! If no faces intersect, one body may still be inside the other: one vertex of each connected part of a mesh is tested
//! against the closed mesh of the other body.
//!
//! ## Manifolds: contact points
//!
//! The search for contact points descends the same trees, for triangles closer than the speculative margin. Most points
//! are of two kinds:
//!
//! * a vertex over a face, if none of the vertex's edges leads below the face;
//! * an edge across an edge, both convex, if their common normal lies between the normals of the faces at each edge.
//!
//! Where surfaces already cross, the segments are joined into closed *contours*. The area vector of a contour is the
//! direction in which the overlapping volume changes fastest, so it is the normal of the patch that the contour bounds.
//! Near a patch a vertex or an edge counts only if its normal agrees with that of the patch. A patch gets points from
//! rays along its normal instead if no vertex or edge overlaps there, or if the bodies overlap in its middle more
//! deeply than vertices and edges are searched for. A body that is wholly inside another is pushed out the shortest
//! way.
//!
#![doc = include_str!("pictures/manifold.svg")]
//!
//! At most 16 points of a pair are kept: the deepest, then repeatedly the one that is farthest from those kept, in
//! place and normal. A body on a plane has at most 8. The two cubes in the middle of the picture have four:
//!
//! ```
//! use bevy_faceoff::asset::CollisionMesh;
//! use bevy_faceoff::geometry::shapes;
//! use bevy_faceoff::queries::{ContactWorker, FeatureKind, PairMemory, Placed};
//! use glam::{DQuat, DVec3, Vec3};
//!
//! let cube = CollisionMesh::new(&shapes::cube(1.0));
//! let lower = Placed::new(&cube, DVec3::ZERO, DQuat::IDENTITY, Vec3::ONE)?;
//! // A millimetre above it, shifted and turned by 20 degrees.
//! let turned = DQuat::from_rotation_z(20f64.to_radians());
//! let upper = Placed::new(&cube, DVec3::new(0.5, 0.5, 1.001), turned, Vec3::ONE)?;
//! let mut points = Vec::new();
//! ContactWorker::new().manifold(&lower, &upper, 0.01, &mut PairMemory::default(), &mut points);
//! assert_eq!(points.len(), 4);
//! let edges = |kind| kind == FeatureKind::Edge;
//! let edge_pairs = points.iter().filter(|point| point.features.iter().all(|f| edges(f.kind())));
//! assert_eq!(edge_pairs.count(), 2);
//! assert!(points.iter().all(|point| (point.separation - 0.001).abs() < 1e-6 && point.normal.z > 0.999));
//! # Ok::<(), bevy_faceoff::queries::BodyFault>(())
//! ```
//!
//! In the simulation, finely tessellated round surfaces touch where the smooth surface through their vertices does, so
//! balls and wheels roll on without bumps. It lies up to a hundredth of its radius of curvature outside of the facets.
//! Rounded meshes touch where their cores are as near as both roundings: at every place where one core is nearest to
//! the other, with the way between the nearest points as the normal. So a ball has one point on anything flat.
//!
//! On the CPU a pair keeps its candidates from step to step, found with some slack, until the bodies have moved
//! farther.
//!
//! ## ForceScan: wake, solve, sleep
//!
//! Contacts are soft constraints on velocities, solved over small substeps (Catto, "Solver2D", 2024). Bodies that
//! contacts connect form an *island*, and islands are independent.
//!
#![doc = include_str!("pictures/solver.svg")]
//!
//! * **Warm start.** The impulses of the last collision substep are the first guess. Points are matched by place and
//!   normal.
//! * **Bias passes** push overlapping bodies apart, **relax passes** then remove the velocity that this added. A pass
//!   is projected Gauss-Seidel over the pairs of an island, with an extrapolation between passes, until the velocities
//!   have converged. Large islands get fewer passes. On the CPU, a sparse island whose passes do not converge, such as
//!   a taut chain or a heavy body on a light one, is solved directly, and its contact springs are as stiff as its loads
//!   ask for. Other islands under heavy loads get more substeps, with fewer passes each on a GPU.
//!   Pairs are coloured, and pairs of one colour have no moving body in common, so that several are solved at once.
//! * **Friction** stays within Coulomb's cone. In a flat patch it acts over the area and not at the corners.
//! * **Impacts** are resolved in the substep in which they happen, for all contacts of the island at once.
//! * A pair that overlaps deeply when it first meets is pushed apart along the line of centres.
//! * **Sleep.** An island whose bodies have all gone nowhere for half a second falls asleep: it costs next to nothing,
//!   and keeps its contact points. Slow motion that goes on does not count as rest. A velocity, a force, an awake body
//!   that comes near, or a support that goes wakes the whole island.
//!
//! [`SolverSettings`](crate::types::solver_settings::SolverSettings) has the numbers. With
//! [`Response::Impulse`](crate::types::settings::Response) this stage follows the paper's flow of data instead, which
//! gave it its name: one impulse for each touching pair, sorted by body and summed by a segmented scan.
//!
//! ## Integrate
//!
//! Bodies get the poses and velocities that the solver found. Those with
//! [`ContinuousCollision`](crate::plugin::components::ContinuousCollision) are stopped where they first touch another
//! body, by conservative advancement over both trees, down to triangles. With the other responses the motion is
//! semi-implicit Euler: first the velocities, then with them the poses.
//!
//! # CPU and GPU
//!
//! | | CPU | GPU |
//! |---|---|---|
//! | order of the stages | one list, which both run | the same list |
//! | work is shared out | over pairs, and over islands, on a thread pool; small stages on one thread; the solver computes eight pairs of an island in one vector | a workgroup for each pair; for each island one, which colours its pairs and solves those of a colour at once |
//! | lists | grow | have a capacity: if one overflows, a flag turns the step and those after it into no-ops; the host makes the list longer and submits them again |
//! | undecided triangles | double precision: touch up to 1e-14 of the bodies' size apart, the rounding of corners | count as touching, up to some millionths of the bodies' size apart |
//! | results | the same bits for any number of threads | the same bits in each run on the same GPU |
//! | collision substeps | each group of bodies that can meet has its own number | the same, but if more than 64 groups have several, or if their number times that of all bodies exceeds 4 million, all may have the largest number |
//! | pairs at rest | keep the features of the nearest pose of a fine grid, and their points are computed anew | are searched in each step |
//! | not there | | [hooks](crate::plugin::hooks): their steps run on the CPU |
//!
//! A step on a GPU is one submission, for any number of collision substeps. The GPU counts how many the step needs, but
//! their commands are recorded before that, for a number that the last steps suggest. If it is too large, the last ones
//! do nothing. If it is too small, the step does nothing and is submitted again, as if a list were too short. With
//! [`ContinuousCollision`](crate::plugin::components::ContinuousCollision) the CPU takes part in each collision
//! substep: when the contacts are solved, it reads which bodies may meet the fast ones, and stops these in double
//! precision. Then the GPU goes on. Bodies, the solver's memory and sleep states stay on the GPU.
//! [`Readback`](crate::plugin::settings::Readback) tells when the results reach components. A step in which all bodies
//! sleep, and whose input is that of the step before, is not submitted at all: its results are those of that step. A
//! kinematic body never sleeps, so this needs a world without one.
//!
//! # A solver of your own
//!
//! Set [`Response::None`](crate::types::settings::Response) and read
//! [`Collisions::manifolds`](crate::plugin::collisions::Collisions::manifolds). Write velocities in a system
//! in [`FaceoffSystems::Respond`](crate::plugin::FaceoffSystems): they move the bodies in the next step, and gravity is
//! added in that step. So this one counts gravity in:
//!
//! ```
//! use bevy::prelude::*;
//! use bevy_faceoff::prelude::*;
//!
//! # let mut app = App::new();
//! # app.add_plugins((MinimalPlugins, FaceoffHeadlessPlugins::default()));
//! app.insert_resource(Response::None)
//!     .add_systems(FaceoffStep, hold.in_set(FaceoffSystems::Respond));
//!
//! /// Stops bodies at planes.
//! fn hold(
//!     collisions: Res<Collisions>,
//!     gravity: Res<Gravity>,
//!     time: Res<Time>,
//!     planes: Query<(), With<PlaneCollider>>,
//!     mut bodies: Query<&mut LinearVelocity>,
//! ) {
//!     let fall = gravity.0 * time.delta_secs();
//!     for collision in collisions.iter().filter(|collision| planes.contains(collision.collider2)) {
//!         let Ok(mut velocity) = bodies.get_mut(collision.body1) else { continue };
//!         // The normal leads from the first collider to the second.
//!         let normal = collision.contact.normal;
//!         let approach = (velocity.0 + fall).dot(normal).max(0.0);
//!         velocity.0 -= approach * normal;
//!     }
//! }
//! #
//! # let cube = CollisionMesh::new(&bevy_faceoff::geometry::shapes::cube(1.0));
//! # let cube = MeshCollider(app.world_mut().resource_mut::<Assets<CollisionMesh>>().add(cube));
//! # app.world_mut().spawn(PlaneCollider::through(Vec3::ZERO, Vec3::Y));
//! # let cube = app.world_mut().spawn((RigidBody::Dynamic, cube, Transform::from_xyz(0.0, 1.0, 0.0))).id();
//! # app.finish();
//! # for _ in 0..128 {
//! #     app.world_mut().run_schedule(FaceoffStep);
//! # }
//! # let height = app.world().get::<Transform>(cube).unwrap().translation.y;
//! # assert!((0.4..0.51).contains(&height), "{height}");
//! ```
//!
//! # Where it is in the sources
//!
//! `src/step/mod.rs` describes the whole step, and `src/step/order.rs` is the same as a list. A stage is a folder:
//! `mod.rs` says what it does, `cpu.rs` does it, `gpu.rs` names its kernels in `shaders`.
//! `docs/ARCHITECTURE.md` has the map of the code.
