//! What the panel shows, read from the world.

use crate::plugin::backend::ActiveBackend;
use crate::plugin::clock::{Physics, PhysicsTime};
use crate::plugin::collisions::{Collisions, StepReport};
use crate::plugin::inspect::islands::IslandFinder;
use crate::plugin::inspect::poses::WorldPoses;
use crate::plugin::sync::Step;
use crate::types::settings::Response;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;

/// The parts of the world that the panel tells of.
#[derive(SystemParam)]
pub(super) struct Source<'w, 's> {
    pub report: Option<Res<'w, StepReport>>,
    pub active: Option<Res<'w, ActiveBackend>>,
    step: Option<Res<'w, Step>>,
    collisions: Option<Res<'w, Collisions>>,
    response: Option<Res<'w, Response>>,
    physics: Option<Res<'w, Time<Physics>>>,
    game: Option<Res<'w, Time<Virtual>>>,
    finder: IslandFinder<'w, 's>,
    poses: WorldPoses<'w, 's>,
}

/// Clocks and counts that are not in [`StepReport`].
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Figures {
    /// Whether the physics clock or the game's clock is paused.
    pub paused: bool,
    pub game_paused: bool,
    /// Speed of the physics clock relative to fixed time.
    pub speed: f32,
    /// Number of islands, and how many bodies the largest has; `None` if they are not known.
    pub islands: Option<(usize, usize)>,
    /// Number of pairs with contact points; `None` if it is not known.
    pub manifolds: Option<usize>,
    /// Number of pairs of colliders and planes that touch; `None` if it is not known.
    pub plane_pairs: Option<usize>,
}

impl Source<'_, '_> {
    pub fn figures(&self) -> Figures {
        let is_read_back = self.step.as_ref().is_some_and(|step| !step.is_resident());
        let collisions = self.collisions.as_ref().filter(|_| is_read_back);
        let has_islands = self.response.as_ref().is_some_and(|r| **r == Response::Contacts);
        Figures {
            paused: self.physics.as_ref().is_some_and(|time| time.is_paused()),
            game_paused: self.game.as_ref().is_some_and(|time| time.is_paused()),
            speed: self.physics.as_ref().map_or(1.0, |time| time.relative_speed()),
            islands: collisions
                .filter(|_| has_islands)
                .map(|_| self.finder.find(&self.poses).count()),
            manifolds: collisions.map(|collisions| collisions.manifold_count()),
            plane_pairs: collisions.map(|collisions| collisions.plane_pairs()),
        }
    }
}
