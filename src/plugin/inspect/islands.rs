//! The islands of bodies that sleep and wake together.

use super::poses::WorldPoses;
use crate::geometry::union_find::UnionFind;
use crate::plugin::collisions::Collisions;
use crate::sleep::cpu::TOUCH;
use crate::types::body::RigidBody;
use crate::types::solver_settings::SolverSettings;
use bevy::ecs::entity::EntityHashMap;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;

/// Finds islands in the published results of a step, whether it ran on the CPU or on a GPU. The sleep stage keeps no
/// islands: it finds them anew in every collision substep.
#[derive(SystemParam)]
pub(crate) struct IslandFinder<'w, 's> {
    collisions: Option<Res<'w, Collisions>>,
    settings: Option<Res<'w, SolverSettings>>,
    kinds: Query<'w, 's, &'static RigidBody>,
}

/// Sets of dynamic bodies that touch each other.
#[derive(Debug, Default)]
pub(crate) struct Islands {
    /// The smallest entity of the island of each dynamic body.
    pub root_of: EntityHashMap<Entity>,
    /// Pairs of bodies that touch and so are in one island.
    pub links: Vec<[Entity; 2]>,
}

impl Islands {
    /// The number of islands, and how many bodies the largest has. A body that touches no other is an island.
    pub fn count(&self) -> (usize, usize) {
        let mut sizes = EntityHashMap::<usize>::default();
        for root in self.root_of.values() {
            *sizes.entry(*root).or_default() += 1;
        }
        (sizes.len(), sizes.values().copied().max().unwrap_or(0))
    }
}

impl IslandFinder<'_, '_> {
    /// The islands after the last published step.
    pub fn find(&self, poses: &WorldPoses) -> Islands {
        let (Some(collisions), Some(settings)) = (&self.collisions, &self.settings) else {
            return Islands::default();
        };
        let is_dynamic = |body: Entity| self.kinds.get(body) == Ok(&RigidBody::Dynamic);
        let mut bodies: Vec<Entity> = collisions.rows.bodies.iter().copied().collect();
        bodies.retain(|&body| is_dynamic(body));
        bodies.sort_unstable();
        bodies.dedup();
        let number = |body: Entity| bodies.binary_search(&body).ok();

        let mut sets = UnionFind::new(bodies.len());
        let mut links = Vec::new();
        for (one, other, points) in collisions.manifolds() {
            let [Some(a), Some(b)] = [one, other].map(|collider| collisions.body_of(collider)) else {
                continue;
            };
            let ([Some(i), Some(j)], false) = ([a, b].map(number), a == b) else {
                continue;
            };
            // The rule of the sleep stage.
            let [Some(r), Some(s)] = [one, other].map(|collider| Some(poses.collider(collider)?.radius())) else {
                continue;
            };
            let distance = TOUCH * settings.rest_offset * 2.0 * r.min(s);
            if points.iter().any(|point| point.gap() <= distance) {
                sets.join(i as u32, j as u32);
                links.push([a, b]);
            }
        }
        let root_of = bodies.iter().enumerate();
        let root_of = root_of.map(|(i, &body)| (body, bodies[sets.root(i as u32) as usize]));
        Islands {
            root_of: root_of.collect(),
            links,
        }
    }
}
