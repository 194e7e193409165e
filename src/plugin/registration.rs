//! Types that scenes and inspectors know by reflection.

use crate::plugin::backend::{ActiveBackend, BackendFailed, BackendReady};
use crate::plugin::clock::Physics;
use crate::plugin::collisions::{Collisions, StepReport};
use crate::plugin::components::*;
use crate::plugin::events::{BodyRejected, CollisionEnd, CollisionStart};
use crate::plugin::settings::{Backend, EventHysteresis, FaceLists, Gravity, MeasureEnergy};
use crate::types::body::*;
use crate::types::hooks::ActiveCollisionHooks;
use crate::types::limits::StepLimits;
use crate::types::material::{Friction, Restitution};
use crate::types::settings::{Culling, Response};
use crate::types::solver_settings::SolverSettings;
use bevy::prelude::*;

/// Registers the components, settings, messages and events of bodies and of the step.
pub(super) fn register(app: &mut App) {
    register_hierarchy(app);
    app.register_type::<RigidBody>()
        .register_type::<MeshCollider>()
        .register_type::<PlaneCollider>()
        .register_type::<LinearVelocity>()
        .register_type::<AngularVelocity>()
        .register_type::<CenterOfMass>()
        .register_type::<ComputedCenterOfMass>()
        .register_type::<ColliderDisabled>()
        .register_type::<RigidBodyDisabled>()
        .register_type::<Teleport>()
        .register_type::<DrivenVelocity>()
        .register_type::<Mass>()
        .register_type::<Density>()
        .register_type::<AngularInertia>()
        .register_type::<Restitution>()
        .register_type::<Friction>()
        .register_type::<GravityScale>()
        .register_type::<LinearDamping>()
        .register_type::<AngularDamping>()
        .register_type::<MaxLinearSpeed>()
        .register_type::<MaxAngularSpeed>()
        .register_type::<LockedAxes>()
        .register_type::<ExternalForces>()
        .register_type::<Sleeping>()
        .register_type::<SleepingDisabled>()
        .register_type::<ContinuousCollision>()
        .register_type::<ActiveCollisionHooks>()
        .register_type::<CollisionLayers>()
        .register_type::<StableKey>()
        .register_type::<Sensor>()
        .register_type::<BodyCulling>()
        .register_type::<CollidingEntities>()
        .register_type::<CollisionEventsEnabled>()
        .register_type::<Culling>()
        .register_type::<EventHysteresis>()
        .register_type::<FaceLists>()
        .register_type::<MeasureEnergy>()
        .register_type::<Gravity>()
        .register_type::<Response>()
        .register_type::<SolverSettings>()
        .register_type::<StepLimits>()
        .register_type::<Backend>()
        .register_type::<ActiveBackend>()
        .register_type::<Collisions>()
        .register_type::<StepReport>()
        .register_type::<CollisionStart>()
        .register_type::<CollisionEnd>()
        .register_type::<BodyRejected>()
        .register_type::<BackendReady>()
        .register_type::<BackendFailed>()
        .register_type::<Time<Physics>>();
}

/// Registers Bevy's components that place and name bodies. Bevy registers them itself with its feature
/// `reflect_auto_register`, which is on by default. Servers and tests may be built without, and scenes of bodies would
/// lose them.
pub(super) fn register_hierarchy(app: &mut App) {
    app.register_type::<Transform>()
        .register_type::<GlobalTransform>()
        .register_type::<ChildOf>()
        .register_type::<Children>()
        .register_type::<Name>();
}
