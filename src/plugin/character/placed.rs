//! What was placed anew: ground that does not take a character along, and characters that leave their ground.

use super::{Character, CharacterGround};
use crate::plugin::components::{DrivenVelocity, RigidBodyDisabled, Teleport};
use crate::plugin::sync::Step;
use crate::plugin::sync::components::velocities;
use crate::plugin::sync::publish::WrittenTransforms;
use crate::types::body::{AngularVelocity, LinearVelocity, RigidBody};
use bevy::ecs::query::QueryData;
use bevy::prelude::*;

/// What tells how a body moves.
#[derive(QueryData)]
pub(super) struct MotionComponents {
    kind: &'static RigidBody,
    linear: Option<&'static LinearVelocity>,
    angular: Option<&'static AngularVelocity>,
    driven: Option<&'static DrivenVelocity>,
    teleports: Has<Teleport>,
}

/// Before the step, characters leave ground that is placed in it, and disabled characters leave their ground.
pub(super) fn leave_placed_ground(
    step: Res<Step>,
    mut characters: Query<(&mut CharacterGround, Has<RigidBodyDisabled>), With<Character>>,
    bodies: Query<MotionComponents>,
    written: WrittenTransforms,
) {
    let is_written = |body| {
        step.written_at
            .is_some_and(|written_at| written.contains(body, written_at))
    };
    for (mut ground, is_disabled) in &mut characters {
        let Some(contact) = ground.0 else { continue };
        let body = contact.body;
        let is_placed = bodies
            .get(body)
            .is_ok_and(|motion| motion.teleports || (!motion.is_driven() && is_written(body)));
        if is_disabled || is_placed {
            *ground = CharacterGround::default();
        }
    }
}

impl MotionComponentsItem<'_, '_> {
    /// Whether it moves along if its `Transform` is written.
    fn is_driven(&self) -> bool {
        match self.kind {
            RigidBody::Static => true,
            RigidBody::Dynamic => false,
            RigidBody::Kinematic => {
                let seen = velocities(self.linear, self.angular);
                let own = self.driven.map_or(seen, |driven| driven.without(seen));
                own == [Vec3::ZERO; 2]
            }
        }
    }
}
