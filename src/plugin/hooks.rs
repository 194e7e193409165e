//! [`CollisionHooks`]: a game decides which pairs are tested, and changes contacts before they are solved.

use super::schedule::FaceoffSystems;
use super::sync::Step;
use super::sync::entity_hooks::EntityHooks;
pub use crate::state::ContactSurface;
use crate::state::ManifoldPoint;
use crate::step::hooks::{NoHooks, PairContacts};
use crate::types::stage::Stage;
use bevy::ecs::system::{ReadOnlySystemParam, StaticSystemParam, SystemParamItem};
use bevy::prelude::*;
use std::any::type_name;
use std::marker::PhantomData;

/// Decides about pairs of colliders. Implement it for a system parameter that reads the world, and add that to the app
/// with a [`CollisionHooksPlugin`]. It is called for pairs with
/// [`ActiveCollisionHooks`](crate::types::hooks::ActiveCollisionHooks), in every collision substep.
///
/// Order within a pair: a static collider comes first, otherwise the smaller one in the order of
/// [`Collisions`](crate::plugin::collisions::Collisions). A plane comes second. Commands are applied after the stage
/// that calls the hook.
///
/// * **Filter**: a pair that is left out is not tested, does not touch and is not reported. A sleeping body wakes when
///   the answer about a pair near it changes.
/// * **Modify**: the contact points of a pair, its friction and restitution, and the velocity of its surface. It is
///   called for pairs that are awake. A sleeping body keeps its contacts, so wake it (`Sleeping(false)`) when your rule
///   changes.
/// * Hooks run on the CPU. Where the stages run on a GPU, steps run on the CPU while anything has
///   `ActiveCollisionHooks`.
///
/// A conveyor belt:
///
/// ```
/// use bevy::ecs::system::SystemParam;
/// use bevy::prelude::*;
/// use bevy_faceoff::prelude::*;
///
/// /// The velocity of a belt in m/s.
/// #[derive(Component)]
/// #[require(ActiveCollisionHooks = ActiveCollisionHooks::MODIFY_CONTACTS)]
/// struct Belt(Vec3);
///
/// #[derive(SystemParam)]
/// struct Belts<'w, 's> {
///     belts: Query<'w, 's, &'static Belt>,
/// }
///
/// impl CollisionHooks for Belts<'_, '_> {
///     fn modify_contacts(&self, contacts: &mut ContactPair, _: &mut Commands) -> bool {
///         // The velocity of the second surface relative to the first.
///         for (side, sign) in [(contacts.collider1, -1.0), (contacts.collider2, 1.0)] {
///             if let Ok(belt) = self.belts.get(side) {
///                 contacts.surface.tangent_velocity += sign * belt.0;
///             }
///         }
///         true
///     }
/// }
///
/// fn main() {
///     App::new()
///         .add_plugins((MinimalPlugins, FaceoffHeadlessPlugins::default()))
///         .add_plugins(CollisionHooksPlugin::<Belts>::default());
/// }
/// ```
pub trait CollisionHooks: ReadOnlySystemParam + Send + Sync {
    /// Whether a pair is tested. Default: yes.
    fn filter_pairs(&self, _collider1: Entity, _collider2: Entity, _commands: &mut Commands) -> bool {
        true
    }

    /// Changes the contacts of a pair. Returns false to drop them: the pair neither pushes nor is reported. Default:
    /// they are unchanged.
    fn modify_contacts(&self, _contacts: &mut ContactPair, _commands: &mut Commands) -> bool {
        true
    }
}

/// The contacts of a pair before they are solved.
#[derive(Debug)]
pub struct ContactPair<'a> {
    /// The colliders.
    pub collider1: Entity,
    /// A collider or a plane.
    pub collider2: Entity,
    /// The bodies of the colliders; without a body the collider itself.
    pub body1: Entity,
    /// See `body1`.
    pub body2: Entity,
    /// The contact points. The normals point from the first collider to the second.
    pub points: &'a mut [ManifoldPoint],
    /// Friction, restitution and velocity of the surface.
    pub surface: &'a mut ContactSurface,
}

/// Adds [`CollisionHooks`] to the app: one type. Add it after [`FaceoffPlugins`](super::groups::FaceoffPlugins).
pub struct CollisionHooksPlugin<H>(PhantomData<fn() -> H>);

impl<H> Default for CollisionHooksPlugin<H> {
    fn default() -> Self {
        Self(PhantomData)
    }
}

impl<H> Plugin for CollisionHooksPlugin<H>
where
    H: CollisionHooks + 'static,
    for<'w, 's> SystemParamItem<'w, 's, H>: CollisionHooks,
{
    fn build(&self, app: &mut App) {
        if !app.world().contains_resource::<Step>() {
            error!("CollisionHooksPlugin has no effect: add FaceoffPlugins before it");
            return;
        }
        let mut step = app.world_mut().resource_mut::<Step>();
        if let Some(other) = step.hooks.replace(type_name::<H>()) {
            error!(
                "the CollisionHooks {} have no effect: the app has {other} already. Make one type of both",
                type_name::<H>()
            );
            step.hooks = Some(other);
            return;
        }
        app.edit_schedule(super::schedule::FaceoffStep, |schedule| {
            for stage in Stage::ALL {
                let run = move |step: ResMut<Step>, hooks: StaticSystemParam<H>, commands: Commands| {
                    let hooks = &*hooks;
                    run_stage(stage, step, &mut Asked { hooks, commands });
                };
                schedule.add_systems(run.in_set(FaceoffSystems::from(stage)));
            }
        });
    }
}

/// The hooks of a system.
struct Asked<'a, 'w, 's, H> {
    hooks: &'a H,
    commands: Commands<'w, 's>,
}

/// Runs a stage in an app without hooks.
pub(crate) fn run_without_hooks(stage: Stage) -> impl FnMut(ResMut<Step>) {
    move |step: ResMut<Step>| {
        if step.hooks.is_none() {
            run_stage(stage, step, &mut NoHooks);
        }
    }
}

fn run_stage(stage: Stage, mut step: ResMut<Step>, hooks: &mut dyn EntityHooks) {
    step.run(stage, hooks);
    if !step.engine.runs() {
        // The device is lost. The next step starts on another device, from the components.
        step.forget();
    }
}

impl<H: CollisionHooks> EntityHooks for Asked<'_, '_, '_, H> {
    fn filter_pair(&mut self, [collider1, collider2]: [Entity; 2]) -> bool {
        self.hooks.filter_pairs(collider1, collider2, &mut self.commands)
    }

    fn modify_contacts(
        &mut self,
        [collider1, collider2]: [Entity; 2],
        [body1, body2]: [Entity; 2],
        contacts: &mut PairContacts,
    ) -> bool {
        let mut contacts = ContactPair {
            collider1,
            collider2,
            body1,
            body2,
            points: contacts.points,
            surface: contacts.surface,
        };
        self.hooks.modify_contacts(&mut contacts, &mut self.commands)
    }
}
