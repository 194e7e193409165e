//! [`ExactNarrowPhase`]: who makes the contacts of a pair.

use crate::contacts::ExactContacts;
use crate::manifolds;
use crate::memory::PairMemories;
use crate::meshes::ExactCollider;
use crate::overlap;
use crate::precision::{double, double_rotation, single};
use avian3d::collision::collider::contact_query;
use avian3d::math::{AdjustPrecision, AsF32, Scalar, Vector};
use avian3d::prelude::*;
use bevy::ecs::system::lifetimeless::{Read, SQuery, SRes};
use bevy::prelude::*;
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::queries::{BodyFault, ContactWorker, MeshContact, PairMemory, Placed};
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
        let (colliders, meshes, memories, settings) = &*context;
        let entities = [context.entity1, context.entity2];
        let Ok(pair) = colliders.get_many(entities) else {
            manifolds.clear();
            return;
        };
        let (positions, rotations) = ([position1, position2], [rotation1.into(), rotation2.into()]);
        let [mesh1, mesh2] = pair.map(|(_, exact)| exact.and_then(|exact| meshes.get(&exact.0)));
        let [(collider1, _), (collider2, _)] = pair;
        let (Some(mesh1), Some(mesh2)) = (mesh1, mesh2) else {
            contact_query::contact_manifolds(
                collider1,
                position1,
                rotations[0],
                collider2,
                position2,
                rotations[1],
                prediction_distance,
                manifolds,
            );
            return;
        };
        let place = |i: usize, mesh, collider: &Collider| {
            let rotation = double_rotation(rotations[i].0);
            // As Avian does, which mirrors no collider.
            place(mesh, positions[i], rotation, collider.scale().abs()).inspect_err(|fault| {
                error_once!("{}: the exact collider makes no contacts. {fault}", entities[i]);
            })
        };
        let (Ok(a), Ok(b)) = (place(0, mesh1, collider1), place(1, mesh2, collider2)) else {
            manifolds.clear();
            return;
        };
        let pair = Pair {
            meshes: [a, b],
            diameter: 2.0 * a.bounding_radius().min(b.bounding_radius()),
            first: position1,
        };
        let prediction = single(prediction_distance);
        WORKER.with_borrow_mut(|worker| {
            if pair.may_touch(pair.margin(prediction, settings)) {
                memories.lend(entities, |memory| {
                    worker.contacts(&pair, prediction, settings, memory, manifolds)
                });
            } else {
                manifolds.clear();
            }
        });
    }
}

fn place(
    mesh: &CollisionMesh,
    position: Vector,
    rotation: bevy::math::DQuat,
    scale: Vector,
) -> Result<Placed<'_>, BodyFault> {
    Placed::new(mesh, double(position), rotation, scale.f32())
}

/// Two exact meshes.
struct Pair<'a> {
    meshes: [Placed<'a>; 2],
    /// Of the smaller bounding sphere, metres.
    diameter: f32,
    /// Position of the first one's origin.
    first: Vector,
}

impl Pair<'_> {
    fn rest_offset(&self, settings: &ExactContacts) -> f32 {
        let offset = settings.rest_offset * self.diameter;
        if offset.is_finite() { offset.max(0.0) } else { 0.0 }
    }

    /// The distance up to which surfaces have contacts, metres. Beyond the size of the smaller body the contacts of now
    /// say nothing about those after the step.
    fn margin(&self, prediction: f32, settings: &ExactContacts) -> f32 {
        prediction.clamp(0.0, self.diameter) + self.rest_offset(settings)
    }

    /// Whether the bounding spheres are within `margin`. The boxes of turned meshes overlap four times as often.
    fn may_touch(&self, margin: f32) -> bool {
        let [a, b] = &self.meshes;
        let reach = f64::from(a.bounding_radius()) + f64::from(b.bounding_radius()) + f64::from(margin);
        a.center_of_mass().distance_squared(b.center_of_mass()) <= reach * reach
    }
}

/// How far a contact point moves within a step at most, to be found again by its place, as a part of the diameter.
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
    /// Replaces the manifolds of the last step.
    fn contacts(
        &mut self,
        pair: &Pair,
        prediction: f32,
        settings: &ExactContacts,
        memory: &mut PairMemory,
        manifolds: &mut Vec<ContactManifold>,
    ) {
        let [a, b] = &pair.meshes;
        self.points.clear();
        let margin = pair.margin(prediction, settings);
        self.contacts.manifold(a, b, margin, memory, &mut self.points);
        let old = std::mem::take(manifolds);
        let centers = (b.center_of_mass() - a.center_of_mass()).adjust_precision();
        overlap::resolve(&mut self.points, pair.diameter, &old, centers);
        manifolds::push(&self.points, pair.first, pair.rest_offset(settings), manifolds);
        let reach = (REACH * pair.diameter + margin).adjust_precision();
        manifolds::warm_start(manifolds, &old, reach);
    }
}
