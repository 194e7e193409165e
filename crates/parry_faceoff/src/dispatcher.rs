//! [`ExactDispatcher`]: who answers which query about two shapes.

use crate::convert::{narrow, rotation, to_parry, translation};
use crate::manifolds;
use crate::memory;
use crate::mesh::ExactMesh;
use crate::parry::math::{Pose, Real, Vector};
use crate::parry::query::details::{NormalConstraints, ShapeCastOptions};
use crate::parry::query::{
    ClosestPoints, Contact, ContactManifold, ContactManifoldsWorkspace, DefaultQueryDispatcher, NonlinearRigidMotion,
    PersistentQueryDispatcher, QueryDispatcher, ShapeCastHit, Unsupported,
};
#[cfg(feature = "rapier")]
use crate::parry::query::{ShapeDistance, ShapeIntersection};
use crate::parry::shape::{Shape, ShapeType};
use bevy_faceoff::queries::{ContactWorker, MeshContact, PairMemory, Placed};
use glam::{DQuat, DVec3};
use std::cell::RefCell;

#[cfg(not(feature = "rapier"))]
type ShapeIntersection = bool;
#[cfg(not(feature = "rapier"))]
type ShapeDistance = Real;

/// How far a contact point may move in a step and keep its impulse, as a part of the smaller mesh's radius.
const REACH: Real = 0.1;

/// Answers queries about two [`ExactMesh`]es exactly, and leaves all others to [`DefaultQueryDispatcher`].
///
/// | query about two exact meshes | answer |
/// |---|---|
/// | contact manifolds, `contact` | exact, of any depth, also where one is inside the other |
/// | `intersection_test` | exact; inside a solid mesh counts |
/// | `distance`, `closest_points` | exact if they touch, else that of the [surfaces](ExactMesh::surface) |
/// | shape casts | those of the surfaces |
///
/// For two exact meshes that touch, `intersection_test` and `distance` name no triangles: the numbers of the subshapes
/// are 0. Contact manifolds and `contact` give the numbers of the triangles.
///
/// Equal poses give the same bits, on any number of threads.
#[derive(Clone, Copy, Debug, Default)]
pub struct ExactDispatcher;

#[derive(Default)]
struct Scratch {
    worker: ContactWorker,
    points: Vec<MeshContact>,
}

thread_local! {
    /// Each thread keeps the memory of its searches. It changes no result.
    static SCRATCH: RefCell<Scratch> = RefCell::default();
}

/// Both meshes, if both are exact.
fn exact(shapes: [&dyn Shape; 2]) -> Option<[&ExactMesh; 2]> {
    let [a, b] = shapes.map(|shape| shape.as_shape::<ExactMesh>());
    Some([a?, b?])
}

/// A shape that parry knows: of an exact mesh its surface.
fn known(shape: &dyn Shape) -> &dyn Shape {
    match shape.as_shape::<ExactMesh>() {
        Some(exact) => exact.surface(),
        None => shape,
    }
}

/// Both meshes in the axes of the first. `None` if they are too far apart to touch, or the pose is not finite.
fn place<'a>([a, b]: [&'a ExactMesh; 2], pos12: &Pose) -> Option<[Placed<'a>; 2]> {
    Some([a.placed(&Pose::IDENTITY)?, b.placed(pos12)?])
}

/// Calls `use_points` with the reduced contact points, the deepest first.
fn with_points<R>(
    [a, b]: &[Placed; 2],
    prediction: Real,
    memory: &mut PairMemory,
    use_points: impl FnOnce(&[MeshContact]) -> R,
) -> R {
    SCRATCH.with_borrow_mut(|Scratch { worker, points }| {
        points.clear();
        worker.manifold(a, b, prediction, memory, points);
        use_points(points)
    })
}

fn touch([a, b]: [&ExactMesh; 2], pos12: &Pose) -> bool {
    let a = a.placed(&Pose::IDENTITY);
    a.is_some_and(|a| a.overlaps(&b.asked(), translation(pos12), rotation(pos12)))
}

impl<M, C> PersistentQueryDispatcher<M, C> for ExactDispatcher
where
    M: Default + Clone + Send + Sync,
    C: Default + Copy + Send + Sync,
{
    fn contact_manifolds(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        prediction: Real,
        manifolds: &mut Vec<ContactManifold<M, C>>,
        workspace: &mut Option<ContactManifoldsWorkspace>,
    ) -> Result<(), Unsupported> {
        let Some(meshes) = exact([g1, g2]) else {
            // With these grids parry finds no contacts of its own triangle meshes, but it finds those of other
            // composite shapes.
            let is_grid = |shape: &dyn Shape| matches!(shape.shape_type(), ShapeType::HeightField | ShapeType::Voxels);
            let [g1, g2] = if is_grid(g1) || is_grid(g2) {
                [g1, g2]
            } else {
                [known(g1), known(g2)]
            };
            return DefaultQueryDispatcher.contact_manifolds(pos12, g1, g2, prediction, manifolds, workspace);
        };
        let memory = memory::of(workspace);
        let Some(placed) = place(meshes, pos12) else {
            manifolds.clear();
            return Ok(());
        };
        let reach = REACH
            * meshes
                .map(|mesh| mesh.bounding_sphere().1)
                .into_iter()
                .fold(Real::INFINITY, Real::min);
        with_points(&placed, prediction, memory, |points| {
            manifolds::replace(points, pos12, reach, manifolds);
        });
        Ok(())
    }

    fn contact_manifold_convex_convex(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        normal_constraints1: Option<&dyn NormalConstraints>,
        normal_constraints2: Option<&dyn NormalConstraints>,
        prediction: Real,
        manifold: &mut ContactManifold<M, C>,
    ) -> Result<(), Unsupported> {
        DefaultQueryDispatcher.contact_manifold_convex_convex(
            pos12,
            g1,
            g2,
            normal_constraints1,
            normal_constraints2,
            prediction,
            manifold,
        )
    }
}

impl QueryDispatcher for ExactDispatcher {
    fn intersection_test(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
    ) -> Result<ShapeIntersection, Unsupported> {
        match exact([g1, g2]) {
            Some(meshes) => Ok(intersection(touch(meshes, pos12))),
            None => DefaultQueryDispatcher.intersection_test(pos12, known(g1), known(g2)),
        }
    }

    fn distance(&self, pos12: &Pose, g1: &dyn Shape, g2: &dyn Shape) -> Result<ShapeDistance, Unsupported> {
        match exact([g1, g2]) {
            Some(meshes) if touch(meshes, pos12) => Ok(no_distance()),
            _ => DefaultQueryDispatcher.distance(pos12, known(g1), known(g2)),
        }
    }

    fn contact(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        prediction: Real,
    ) -> Result<Option<Contact>, Unsupported> {
        let Some(meshes) = exact([g1, g2]) else {
            return DefaultQueryDispatcher.contact(pos12, known(g1), known(g2), prediction);
        };
        let back = rotation(pos12).normalize().inverse();
        let deepest = place(meshes, pos12).and_then(|placed| {
            with_points(&placed, prediction, &mut PairMemory::default(), |points| {
                points.first().copied()
            })
        });
        Ok(deepest.map(|point| in_own_axes(&point, back)))
    }

    fn closest_points(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        max_dist: Real,
    ) -> Result<ClosestPoints, Unsupported> {
        match exact([g1, g2]) {
            Some(meshes) if touch(meshes, pos12) => Ok(ClosestPoints::Intersecting),
            _ => DefaultQueryDispatcher.closest_points(pos12, known(g1), known(g2), max_dist),
        }
    }

    fn cast_shapes(
        &self,
        pos12: &Pose,
        local_vel12: Vector,
        g1: &dyn Shape,
        g2: &dyn Shape,
        options: ShapeCastOptions,
    ) -> Result<Option<ShapeCastHit>, Unsupported> {
        DefaultQueryDispatcher.cast_shapes(pos12, local_vel12, known(g1), known(g2), options)
    }

    fn cast_shapes_nonlinear(
        &self,
        motion1: &NonlinearRigidMotion,
        g1: &dyn Shape,
        motion2: &NonlinearRigidMotion,
        g2: &dyn Shape,
        start_time: Real,
        end_time: Real,
        stop_at_penetration: bool,
    ) -> Result<Option<ShapeCastHit>, Unsupported> {
        DefaultQueryDispatcher.cast_shapes_nonlinear(
            motion1,
            known(g1),
            motion2,
            known(g2),
            start_time,
            end_time,
            stop_at_penetration,
        )
    }
}

/// The point in parry's form: on each mesh, in the mesh's own axes.
fn in_own_axes(point: &MeshContact, back: DQuat) -> Contact {
    let turned = |v: DVec3| narrow(back * v);
    let normals = [to_parry(point.normal), turned(-point.normal.as_dvec3())];
    let [point1, point2] = [narrow(point.anchors[0]), turned(point.anchors[1])];
    let contact = Contact::new(point1, point2, normals[0], normals[1], point.separation);
    #[cfg(feature = "rapier")]
    let contact = contact.with_subshapes(point.faces[0], point.faces[1]);
    contact
}

#[cfg(feature = "rapier")]
fn intersection(intersecting: bool) -> ShapeIntersection {
    ShapeIntersection::new(intersecting)
}

#[cfg(not(feature = "rapier"))]
fn intersection(intersecting: bool) -> ShapeIntersection {
    intersecting
}

#[cfg(feature = "rapier")]
fn no_distance() -> ShapeDistance {
    ShapeDistance::new(0.0)
}

#[cfg(not(feature = "rapier"))]
fn no_distance() -> ShapeDistance {
    0.0
}
