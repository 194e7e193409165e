//! Reads planes.

use super::component_warnings::{ComponentWarning, ComponentWarnings};
use super::order::{self, InOrder, Keyed};
use crate::plugin::components::*;
use crate::state::Plane;
use crate::state::fault::BodyFault;
use crate::types::body::*;
use crate::types::hooks::ActiveCollisionHooks;
use crate::types::material::{Friction, Restitution};
use bevy::ecs::query::QueryData;
use bevy::math::DAffine3;
use bevy::prelude::*;

/// The components of a plane.
#[derive(QueryData)]
pub(crate) struct PlaneComponents {
    pub entity: Entity,
    key: Option<&'static StableKey>,
    plane: &'static PlaneCollider,
    transform: Option<&'static Transform>,
    parent: Option<&'static ChildOf>,
    restitution: Option<&'static Restitution>,
    friction: Option<&'static Friction>,
    layers: Option<&'static CollisionLayers>,
    hooks: Option<&'static ActiveCollisionHooks>,
    is_body: Has<MeshCollider>,
    is_sensor: Has<Sensor>,
    kind: Option<&'static RigidBody>,
}

/// Planes that are in the world.
pub(crate) type IsPlane = Without<ColliderDisabled>;

/// A plane of a step.
pub(crate) struct KeyedPlane {
    pub id: Keyed,
    pub plane: Plane,
}

impl InOrder for KeyedPlane {
    fn id(&self) -> Keyed {
        self.id
    }

    fn id_mut(&mut self) -> &mut Keyed {
        &mut self.id
    }
}

/// Reads planes in their order. `to_world` gives the transformation from the coordinates of an entity to the world.
/// `has_hooks` says whether the app has hooks.
pub(super) fn read(
    query: &Query<PlaneComponents, IsPlane>,
    to_world: impl Fn(Entity) -> DAffine3,
    has_hooks: bool,
    planes: &mut Vec<KeyedPlane>,
    faults: &mut Vec<(Entity, BodyFault)>,
    warnings: &mut ComponentWarnings,
) {
    planes.clear();
    for plane in query {
        plane.note(has_hooks, warnings);
        let is_at_home = plane.parent.is_none() && plane.transform.is_none_or(|own| *own == Transform::IDENTITY);
        let to_world = (!is_at_home).then(|| to_world(plane.entity));
        match plane.half_space(to_world) {
            Ok(half_space) => planes.push(KeyedPlane {
                id: Keyed::new(plane.entity, plane.key.copied()),
                plane: half_space,
            }),
            Err(fault) => faults.push((plane.entity, fault)),
        }
    }
    order::sort(planes, |id| warnings.add_same_key(id));
}

impl PlaneComponentsItem<'_, '_> {
    /// Unit normal and distance in the world.
    fn surface(&self, to_world: Option<DAffine3>) -> Result<(Vec3, f32), BodyFault> {
        let PlaneCollider { normal, distance } = *self.plane;
        // In double precision the length of a finite vector neither overflows nor underflows.
        let unit = normal.as_dvec3().try_normalize();
        let unit = unit.ok_or(BodyFault::PlaneNormal(normal))?;
        let (unit, distance) = match to_world {
            None => (unit, distance),
            Some(to_world) => {
                // Unequal scale turns the normal of a plane otherwise than a vector along it.
                let turned = to_world.matrix3.inverse().transpose() * unit;
                let turned = turned.try_normalize().ok_or(BodyFault::PlaneNormal(normal))?;
                let point = to_world.transform_point3(unit * f64::from(distance));
                (turned, turned.dot(point) as f32)
            }
        };
        if !distance.is_finite() {
            return Err(BodyFault::PlaneDistance(distance));
        }
        Ok((unit.as_vec3(), distance))
    }

    /// Records components without effect. `has_hooks` says whether the app has hooks.
    pub fn note(&self, has_hooks: bool, warnings: &mut ComponentWarnings) {
        warnings.check_hooks(self.entity, self.hooks, has_hooks);
        warnings.check_restitution(self.entity, self.restitution.map(|r| r.coefficient));
        warnings.check(self.entity, "Friction", self.friction.map(|f| f.coefficient));
        if self.kind.is_some_and(|&kind| kind != RigidBody::Static) && !self.is_body {
            warnings.add(self.entity, ComponentWarning::PlaneDoesNotMove);
        }
    }

    /// `to_world` leads from the coordinates of the entity to the world.
    pub fn half_space(&self, to_world: Option<DAffine3>) -> Result<Plane, BodyFault> {
        if self.is_body {
            return Err(BodyFault::PlaneOnBody);
        }
        let restitution = self.restitution.copied().unwrap_or_default();
        let friction = self.friction.copied().unwrap_or_default();
        let (normal, distance) = self.surface(to_world)?;
        let numbers = [
            ("Restitution", restitution.coefficient),
            ("Friction", friction.coefficient),
        ];
        if let Some((name, _)) = numbers.into_iter().find(|(_, number)| !number.is_finite()) {
            return Err(BodyFault::NonFinite(name));
        }
        Ok(Plane {
            normal,
            distance,
            restitution: restitution.coefficient.clamp(0.0, 1.0),
            restitution_combine: restitution.combine,
            friction,
            sensor: self.is_sensor,
            layers: self.layers.copied().unwrap_or_default(),
            hooks: self.hooks.copied().unwrap_or_default(),
        })
    }
}
