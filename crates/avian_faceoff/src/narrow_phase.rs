//! [`ExactNarrowPhase`]: who makes the contacts of a pair.

use crate::contacts::ExactContacts;
use crate::manifolds;
use crate::memory::PairMemories;
use crate::meshes::ExactCollider;
use crate::overlap;
use crate::pose::Pose;
use crate::precision::{double, double_rotation, single};
use avian3d::collision::collider::contact_query;
use avian3d::math::{AdjustPrecision, AsF32, Scalar, Vector};
use avian3d::prelude::*;
use bevy::ecs::system::lifetimeless::{Read, SQuery, SRes};
use bevy::prelude::*;
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::queries::{ContactWorker, MeshContact, PairMemory, Placed};
use std::cell::RefCell;

/// The collider type that Avian's narrow phase runs with. Each [`Collider`] requires it.
///
/// Avian asks it for contacts only: boxes, masses, spatial queries and joints stay those of the [`Collider`].
#[derive(Component, Reflect, Clone, Copy, Default, Debug)]
#[reflect(Component, Default, Debug)]
pub struct ExactNarrowPhase;

/// No plugin asks for it: the mass is that of the [`Collider`].
impl ComputeMassProperties3d for ExactNarrowPhase {
    fn mass(&self, _density: f32) -> f32 {
        0.0
    }

    fn unit_principal_angular_inertia(&self) -> Vec3 {
        Vec3::ZERO
    }

    fn center_of_mass(&self) -> Vec3 {
        Vec3::ZERO
    }
}

impl AnyCollider for ExactNarrowPhase {
    type Context = (
        SQuery<(Read<Collider>, Option<Read<ExactCollider>>)>,
        SRes<Assets<CollisionMesh>>,
        SRes<PairMemories>,
        SRes<ExactContacts>,
        SRes<PhysicsLengthUnit>,
    );

    /// No plugin asks for it: the box is that of the [`Collider`].
    fn aabb_with_context(
        &self,
        position: Vector,
        _: impl Into<Rotation>,
        _: AabbContext<Self::Context>,
    ) -> ColliderAabb {
        ColliderAabb::new(position, Vector::ZERO)
    }

    fn contact_manifolds_with_context(
        &self,
        _: &Self,
        position1: Vector,
        rotation1: impl Into<Rotation>,
        position2: Vector,
        rotation2: impl Into<Rotation>,
        prediction_distance: Scalar,
        manifolds: &mut Vec<ContactManifold>,
        context: ContactManifoldContext<Self::Context>,
    ) {
        let (colliders, meshes, memories, settings, unit) = &*context;
        let entities = [context.entity1, context.entity2];
        let Ok(pair) = colliders.get_many(entities) else {
            manifolds.clear();
            return;
        };
        let (positions, rotations) = ([position1, position2], [rotation1.into(), rotation2.into()]);
        let [mesh1, mesh2] = pair.map(|(_, exact)| exact.and_then(|exact| meshes.get(&exact.0)));
        let [(collider1, _), (collider2, _)] = pair;
        let (Some(mesh1), Some(mesh2)) = (mesh1, mesh2) else {
            let ([p1, p2], [r1, r2]) = (positions, rotations);
            contact_query::contact_manifolds(collider1, p1, r1, collider2, p2, r2, prediction_distance, manifolds);
            return;
        };
        let place = |i: usize, mesh, collider: &Collider| {
            // Avian mirrors no collider.
            let scale = collider.scale().abs().f32();
            let placed = Placed::new(mesh, double(positions[i]), double_rotation(rotations[i].0), scale);
            placed.inspect_err(|fault| error_once!("{}: the exact collider makes no contacts. {fault}", entities[i]))
        };
        let (Ok(a), Ok(b)) = (place(0, mesh1, collider1), place(1, mesh2, collider2)) else {
            manifolds.clear();
            return;
        };
        let first = Pose {
            position: position1,
            rotation: rotations[0].0,
        };
        let limit = MAX_REST_OFFSET * single(unit.0);
        let pair = Pair::new([a, b], first, single(prediction_distance), settings, limit);
        if !pair.may_touch() {
            manifolds.clear();
            return;
        }
        memories.lend(entities, first, |memory, last| {
            WORKER.with_borrow_mut(|worker| worker.contacts(&pair, memory, last, manifolds));
        });
    }
}

/// The largest rest offset at unit length, metres. Avian enlarges the box of a collider that has moved by as much, and
/// pairs whose boxes do not meet have no contacts.
const MAX_REST_OFFSET: f32 = 0.05;

/// Two exact meshes.
struct Pair<'a> {
    meshes: [Placed<'a>; 2],
    /// Pose of the first mesh.
    first: Pose,
    /// Diameter of the smaller bounding sphere, metres.
    diameter: f32,
    /// How far apart surfaces come to rest, metres.
    rest_offset: f32,
    /// The distance up to which surfaces have contacts, metres.
    margin: f32,
}

impl<'a> Pair<'a> {
    /// Surfaces come to rest at most `limit` apart.
    fn new(meshes: [Placed<'a>; 2], first: Pose, prediction: f32, settings: &ExactContacts, limit: f32) -> Self {
        let [a, b] = &meshes;
        let diameter = 2.0 * a.bounding_radius().min(b.bounding_radius());
        let offset = settings.rest_offset * diameter;
        let rest_offset = if offset.is_finite() {
            offset.max(0.0).min(limit)
        } else {
            0.0
        };
        Self {
            meshes,
            first,
            diameter,
            rest_offset,
            // Beyond the size of the smaller body the contacts of now say nothing about those after the step.
            margin: prediction.clamp(0.0, diameter) + rest_offset,
        }
    }

    /// Whether the bounding spheres are within the margin. The boxes of turned meshes overlap four times as often.
    fn may_touch(&self) -> bool {
        let [a, b] = &self.meshes;
        let reach = f64::from(a.bounding_radius()) + f64::from(b.bounding_radius()) + f64::from(self.margin);
        a.center_of_mass().distance_squared(b.center_of_mass()) <= reach * reach
    }
}

/// How far a contact point may move within a step and be found again by its place, as a part of the diameter.
const REACH: f32 = 0.05;

/// The memory of a thread.
#[derive(Default)]
struct Worker {
    contacts: ContactWorker,
    points: Vec<MeshContact>,
}

thread_local! {
    static WORKER: RefCell<Worker> = RefCell::default();
}

impl Worker {
    /// Replaces the manifolds of the last step, in which the first collider was at `last`.
    fn contacts(&mut self, pair: &Pair, memory: &mut PairMemory, last: &Pose, manifolds: &mut Vec<ContactManifold>) {
        let [a, b] = &pair.meshes;
        self.points.clear();
        self.contacts.manifold(a, b, pair.margin, memory, &mut self.points);
        let centers = (b.center_of_mass() - a.center_of_mass()).adjust_precision();
        overlap::resolve(&mut self.points, pair.diameter, manifolds, centers);
        let mut new = manifolds::group(&self.points, pair.first.position, pair.rest_offset);
        let reach = (REACH * pair.diameter + pair.margin).adjust_precision();
        let old = manifolds::carried(manifolds, last, &pair.first);
        manifolds::warm_start(&mut new, old, reach);
        *manifolds = new;
    }
}
