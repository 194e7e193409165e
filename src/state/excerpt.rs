//! A few of the bodies of a step, by themselves.

use super::bodies::Bodies;
use super::compound::{Compound, CompoundPart};

impl Bodies {
    /// Only these colliders, which are ascending, renumbered in the same order. The first collider of each body must be
    /// among them.
    pub(crate) fn excerpt(&self, colliders: &[u32]) -> Self {
        let number_of = |collider: u32| colliders.binary_search(&collider).ok().map(|number| number as u32);
        let mut numbers = vec![None; self.compounds.len()];
        let mut compounds: Vec<Compound> = Vec::new();
        for (compound, number) in self.compounds.iter().zip(&mut numbers) {
            if let Some(first) = number_of(compound.number) {
                *number = Some(compounds.len() as u32);
                compounds.push(Compound {
                    number: first,
                    ..*compound
                });
            }
        }
        let parts = colliders.iter().filter_map(|&collider| {
            let part = self.part(collider)?;
            Some(CompoundPart {
                collider: number_of(collider)?,
                compound: numbers[part.compound as usize]?,
                ..*part
            })
        });
        let parts: Vec<CompoundPart> = parts.collect();
        let body = |&collider: &u32| number_of(self.body_of(collider)).unwrap_or_default();
        let mut excerpt = Self {
            body: colliders.iter().map(body).collect(),
            mesh: picked(&self.mesh, colliders),
            kind: picked(&self.kind, colliders),
            position: picked(&self.position, colliders),
            rotation: picked(&self.rotation, colliders),
            scale: picked(&self.scale, colliders),
            linear_velocity: picked(&self.linear_velocity, colliders),
            angular_velocity: picked(&self.angular_velocity, colliders),
            frame: picked(&self.frame, colliders),
            center: picked(&self.center, colliders),
            radius: picked(&self.radius, colliders),
            rounding: picked(&self.rounding, colliders),
            unpadded_radius: picked(&self.unpadded_radius, colliders),
            thickness: picked(&self.thickness, colliders),
            speculative_radius: picked(&self.speculative_radius, colliders),
            travel_time: picked(&self.travel_time, colliders),
            inverse_mass: picked(&self.inverse_mass, colliders),
            own_inverse_mass: picked(&self.own_inverse_mass, colliders),
            local_inverse_inertia: picked(&self.local_inverse_inertia, colliders),
            inverse_inertia: picked(&self.inverse_inertia, colliders),
            restitution: picked(&self.restitution, colliders),
            gravity_scale: picked(&self.gravity_scale, colliders),
            layers: picked(&self.layers, colliders),
            sensor: picked(&self.sensor, colliders),
            culling: picked(&self.culling, colliders),
            params: picked(&self.params, colliders),
            compounds,
            parts,
            ..Self::default()
        };
        excerpt.end_joins();
        excerpt
    }
}

fn picked<T: Copy>(list: &[T], numbers: &[u32]) -> Vec<T> {
    numbers.iter().map(|&number| list[number as usize]).collect()
}
