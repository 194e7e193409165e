//! Kinematic bodies that move by their `Transform`: in each step they go from their last pose to the written one.

use super::Step;
use super::components::BodyComponentsItem;
use super::hierarchy::Posed;
use super::oddities::Oddity;
use crate::plugin::components::Teleport;
use crate::state::Departure;
use crate::types::body::RigidBody;
use crate::types::settings::Response;
use bevy::ecs::entity::EntityHashMap;
use bevy::prelude::*;

/// A body that moves farther than this many of its diameters in one step causes a warning.
const LONG_WAY: f32 = 4.0;

/// The kinematic bodies without velocities. At the end of a step they are where their `Transform`s say.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct DrivenBodies {
    /// The pose of each in the world at the end of the last step.
    poses: EntityHashMap<(Vec3, Quat)>,
    /// Where those begin that move in this step.
    departures: Vec<(Entity, (Vec3, Quat))>,
}

impl DrivenBodies {
    /// Takes those of the last step, to be replaced by those of this one.
    pub fn take(&mut self) -> Self {
        std::mem::take(self)
    }

    /// Reads a body; `before` are those of the last step.
    pub fn read(&mut self, before: &Self, body: &BodyComponentsItem, posed: &Posed, response: Response) {
        let is_driven = body.kind == Some(&RigidBody::Kinematic) && body.has_no_velocity();
        // What pushes nothing is better tested where it is put.
        if !is_driven || body.surface.is_sensor() || response != Response::Contacts {
            return;
        }
        let pose = (posed.position, posed.rotation);
        self.poses.insert(body.entity, pose);
        if let Some(&start) = before.poses.get(&body.entity)
            && start != pose
            && !body.teleports
        {
            self.departures.push((body.entity, start));
        }
    }

    /// Whether the `Transform` of a body says where it is.
    pub fn contains(&self, entity: Entity) -> bool {
        self.poses.contains_key(&entity)
    }
}

impl Step {
    /// The number of a body in the arrays.
    fn number_of(&self, body: Entity) -> Option<usize> {
        let assembly = self.assemblies.binary_search_by_key(&body, |assembly| assembly.body);
        match assembly {
            Ok(at) => {
                let compound = self.assemblies[at].compound?;
                Some(self.state.input.bodies.compounds[compound as usize].number as usize)
            }
            Err(_) => self.collected.entities.binary_search(&body).ok(),
        }
    }

    /// Forgets driven bodies that are left out of this step, and notes those that move very far in it.
    pub fn check_driven(&mut self) {
        let mut poses = std::mem::take(&mut self.driven.poses);
        poses.retain(|&entity, _| self.number_of(entity).is_some());
        self.driven.poses = poses;
        for &(entity, (start, _)) in &self.driven.departures {
            let Some(i) = self.number_of(entity) else { continue };
            let bodies = &self.state.input.bodies;
            let way = bodies.body_motion(i).position.distance(start);
            let diameter = 2.0 * bodies.radius[i];
            if way > LONG_WAY * diameter {
                self.oddities.add(entity, Oddity::LongWay(way));
            }
        }
    }

    /// Moves driven bodies back to where their way begins, and gives them the velocities of the way. Where components are
    /// behind the device, only `known` bodies: those whose components hold their current state.
    pub fn depart(&mut self, known: impl Fn(&Self, Entity) -> bool) {
        let departures: Vec<_> = (self.driven.departures.iter())
            .filter(|&&(entity, _)| known(self, entity))
            .filter_map(|&(entity, (position, rotation))| {
                let body = self.number_of(entity)?;
                Some(Departure {
                    body,
                    position,
                    rotation,
                })
            })
            .collect();
        let dt = self.state.input.config.dt;
        self.state.input.bodies.depart(&departures, dt);
    }
}

/// Removes the markers [`Teleport`], which the step has read.
pub(crate) fn use_up_teleports(step: Res<Step>, teleported: Query<Entity, With<Teleport>>, mut commands: Commands) {
    if !step.engine.runs() {
        return;
    }
    for entity in &teleported {
        commands.entity(entity).remove::<Teleport>();
    }
}
