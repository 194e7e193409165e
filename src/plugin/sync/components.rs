//! What the step reads of colliders and bodies.

use super::component_warnings::ComponentWarnings;
use super::hierarchy::Posed;
use crate::plugin::components::*;
use crate::state::{Body, BodyParams};
use crate::types::body::*;
use crate::types::hooks::ActiveCollisionHooks;
use crate::types::material::{Friction, Restitution};
use crate::types::settings::Culling;
use bevy::ecs::query::QueryData;
use bevy::prelude::*;

/// The components of a collider, a body, or both.
#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct BodyComponents {
    pub entity: Entity,
    pub key: Option<&'static StableKey>,
    pub collider: Option<&'static MeshCollider>,
    pub collider_disabled: Has<ColliderDisabled>,
    pub body_disabled: Has<RigidBodyDisabled>,
    pub teleports: Has<Teleport>,
    pub driven: Option<&'static DrivenVelocity>,
    pub surface: SurfaceComponents,
    pub transform: &'static Transform,
    pub parent: Option<&'static ChildOf>,
    pub kind: Option<&'static RigidBody>,
    linear_velocity: Option<&'static LinearVelocity>,
    angular_velocity: Option<&'static AngularVelocity>,
    mass: Option<&'static Mass>,
    inertia: Option<&'static AngularInertia>,
    params: HandlingComponents,
    gravity_scale: Option<&'static GravityScale>,
    /// Overrides the centre of mass.
    pub center: Option<&'static CenterOfMass>,
    pub computed_center: Option<&'static mut ComputedCenterOfMass>,
}

/// The components of a collider that its body's replace if it has none.
#[derive(QueryData)]
pub(crate) struct SurfaceComponents {
    density: Option<&'static Density>,
    restitution: Option<&'static Restitution>,
    friction: Option<&'static Friction>,
    layers: Option<&'static CollisionLayers>,
    culling: Option<&'static BodyCulling>,
    hooks: Option<&'static ActiveCollisionHooks>,
    sensor: Has<Sensor>,
}

/// The values of a collider that its body's replace if it has none.
#[derive(Clone, Copy, Default)]
pub(crate) struct Surface {
    pub density: Option<f32>,
    restitution: Option<Restitution>,
    friction: Option<Friction>,
    layers: Option<CollisionLayers>,
    pub culling: Option<Culling>,
    hooks: Option<ActiveCollisionHooks>,
    sensor: bool,
}

/// The components of a body that the contact solver reads.
#[derive(QueryData)]
pub(crate) struct HandlingComponents {
    linear_damping: Option<&'static LinearDamping>,
    angular_damping: Option<&'static AngularDamping>,
    max_linear_speed: Option<&'static MaxLinearSpeed>,
    max_angular_speed: Option<&'static MaxAngularSpeed>,
    locked_axes: Option<&'static LockedAxes>,
    forces: Option<&'static ExternalForces>,
    sleeping: Option<&'static Sleeping>,
    never_sleeps: Has<SleepingDisabled>,
    continuous: Has<ContinuousCollision>,
}

impl BodyComponentsItem<'_, '_> {
    /// Records components without effect. `has_hooks` says whether the app has hooks.
    pub fn note(&self, has_hooks: bool, warnings: &mut ComponentWarnings) {
        let (entity, params) = (self.entity, &self.params);
        self.surface.note(entity, has_hooks, warnings);
        warnings.check(entity, "LinearDamping", params.linear_damping.map(|d| d.0));
        warnings.check(entity, "AngularDamping", params.angular_damping.map(|d| d.0));
        warnings.check_limit(entity, "MaxLinearSpeed", params.max_linear_speed.map(|m| m.0));
        warnings.check_limit(entity, "MaxAngularSpeed", params.max_angular_speed.map(|m| m.0));
    }

    /// The linear and the angular velocity that its components hold.
    pub fn velocities(&self) -> [Vec3; 2] {
        velocities(self.linear_velocity, self.angular_velocity)
    }

    /// The body at this pose and with these velocities, without a mesh.
    pub fn body(&self, posed: &Posed, [linear, angular]: [Vec3; 2]) -> Body {
        let mut body = Body::at_rest(0, posed.position, posed.rotation, Vec3::ONE);
        body.kind = self.kind.copied().unwrap_or(RigidBody::Static);
        (body.linear_velocity, body.angular_velocity) = (linear, angular);
        body.mass = self.mass.map(|m| m.0);
        body.inertia = self.inertia.map(|i| i.0);
        body.gravity_scale = self.gravity_scale.map_or(1.0, |g| g.0);
        body.params = self.params.read();
        body
    }
}

impl SurfaceComponentsItem<'_, '_> {
    /// Records components without effect. `has_hooks` says whether the app has hooks.
    pub fn note(&self, entity: Entity, has_hooks: bool, warnings: &mut ComponentWarnings) {
        warnings.check_hooks(entity, self.hooks, has_hooks);
        warnings.check_restitution(entity, self.restitution.map(|r| r.coefficient));
        warnings.check(entity, "Friction", self.friction.map(|f| f.coefficient));
    }

    pub fn is_sensor(&self) -> bool {
        self.sensor
    }

    pub fn read(&self) -> Surface {
        Surface {
            density: self.density.map(|d| d.0),
            restitution: self.restitution.copied(),
            friction: self.friction.copied(),
            layers: self.layers.copied(),
            culling: self.culling.map(|c| c.0),
            hooks: self.hooks.copied(),
            sensor: self.sensor,
        }
    }
}

impl Surface {
    /// The values of a collider, completed by its body's.
    pub fn or(self, body: &Self) -> Self {
        Self {
            density: self.density.or(body.density),
            restitution: self.restitution.or(body.restitution),
            friction: self.friction.or(body.friction),
            layers: self.layers.or(body.layers),
            culling: self.culling.or(body.culling),
            hooks: self.hooks.or(body.hooks),
            sensor: self.sensor,
        }
    }

    /// Sets the values of a collider.
    pub fn apply(&self, collider: &mut Body, culling: Culling) {
        let restitution = self.restitution.unwrap_or_default();
        collider.density = self.density.unwrap_or(1.0);
        collider.restitution = self.restitution.map_or(0.0, |r| r.coefficient);
        collider.params.restitution_combine = restitution.combine;
        collider.params.friction = self.friction.unwrap_or_default();
        collider.layers = self.layers.unwrap_or_default();
        collider.params.hooks = self.hooks.unwrap_or_default();
        collider.sensor = self.sensor;
        collider.culling = culling;
    }
}

impl HandlingComponentsItem<'_, '_> {
    fn read(&self) -> BodyParams {
        BodyParams {
            linear_damping: self.linear_damping.map_or(0.0, |d| d.0),
            angular_damping: self.angular_damping.map_or(0.0, |d| d.0),
            max_linear_speed: self.max_linear_speed.map_or(f32::INFINITY, |m| m.0),
            max_angular_speed: self.max_angular_speed.map_or(f32::INFINITY, |m| m.0),
            locked_axes: self.locked_axes.copied().unwrap_or_default(),
            forces: self.forces.copied().unwrap_or_default(),
            can_sleep: !self.never_sleeps,
            continuous: self.continuous,
            woken: self.sleeping.is_some_and(|sleeping| !sleeping.0),
            ..BodyParams::default()
        }
    }
}

/// The linear and the angular velocity that components hold.
pub(crate) fn velocities(linear: Option<&LinearVelocity>, angular: Option<&AngularVelocity>) -> [Vec3; 2] {
    [linear.map_or(Vec3::ZERO, |v| v.0), angular.map_or(Vec3::ZERO, |w| w.0)]
}
