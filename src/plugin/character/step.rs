//! The system that moves characters.

use super::capsule::{Capsule, Floor, SHORTEST};
use super::{Anchor, Character, CharacterGround, GroundContact};
use crate::plugin::clock::Physics;
use crate::plugin::components::{GravityScale, RigidBodyDisabled};
use crate::plugin::queries::SpatialQuery;
use crate::plugin::settings::Gravity;
use crate::plugin::sync::hierarchy::{self, decompose, parent_in, world_above};
use crate::plugin::sync::named;
use bevy::ecs::entity::EntityHashSet;
use bevy::ecs::system::SystemParam;
use bevy::math::DAffine3;
use bevy::prelude::*;

/// A velocity along `up` that is not a jump, m/s.
const NO_JUMP: f32 = 1.0e-3;
/// A character that falls onto an edge stands on it if the part of the contact's normal along `up` is at least this.
const MIN_EDGE_LANDING: f32 = 0.5;

/// Where entities are in the world.
#[derive(SystemParam)]
pub(super) struct WorldTransforms<'w, 's> {
    entities: Query<'w, 's, ()>,
    all: Query<'w, 's, &'static mut Transform>,
    parents: Query<'w, 's, &'static ChildOf>,
}

impl WorldTransforms<'_, '_> {
    fn above(&self, entity: Entity) -> DAffine3 {
        world_above(entity, parent_in(&self.parents), |entity| self.transform_of(entity))
    }

    fn to_world(&self, entity: Entity) -> Option<DAffine3> {
        let to_world = || hierarchy::to_world(entity, parent_in(&self.parents), |entity| self.transform_of(entity));
        self.entities.contains(entity).then(to_world)
    }

    fn transform_of(&self, entity: Entity) -> Option<Transform> {
        self.all.get(entity).ok().copied()
    }
}

/// Moves all characters by one step.
pub(super) fn move_characters(
    world: SpatialQuery,
    time: Res<Time<Physics>>,
    gravity: Res<Gravity>,
    mut characters: Query<
        (
            Entity,
            &mut Character,
            &mut CharacterGround,
            Option<&GravityScale>,
            Option<&Name>,
        ),
        Without<RigidBodyDisabled>,
    >,
    mut transforms: WorldTransforms,
    mut warned: Local<EntityHashSet>,
) {
    let dt = time.delta_secs();
    if dt <= 0.0 || world.check().is_err() {
        return;
    }
    warned.retain(|entity| characters.contains(*entity));
    for (entity, mut character, mut ground, scale, name) in &mut characters {
        let Some(to_world) = transforms.to_world(entity) else {
            continue;
        };
        if let Err(fault) = character.check(&to_world) {
            if warned.insert(entity) {
                warn!("{} is not moved: {fault}", named(entity, name));
            }
            continue;
        }
        warned.remove(&entity);
        let gravity = gravity.0 * scale.map_or(1.0, |scale| scale.0);
        let mut step = Step {
            world: &world,
            entity,
            character: character.clone(),
            dt,
            start: to_world.translation.as_vec3(),
            rotation: decompose(&to_world.matrix3).0.as_quat(),
        };
        let above = transforms.above(entity);
        let mut place = transforms.transform_of(entity).unwrap_or_default().translation;
        let is_here = |contact: &GroundContact| {
            let way = above.transform_vector3((place - contact.place).as_dvec3());
            way.length() <= f64::from(character.radius)
        };
        let (position, found) = step.run(ground.0.filter(is_here), gravity, &transforms);
        if position != step.start {
            let translation = above.inverse().transform_point3(position.as_dvec3()).as_vec3();
            if let Ok(mut transform) = transforms.all.get_mut(entity)
                && translation.is_finite()
            {
                place = translation;
                transform.translation = translation;
            }
        }
        if step.character.velocity.is_finite() {
            character.set_if_neq(step.character);
        }
        ground.set_if_neq(CharacterGround(found.map(|contact| GroundContact { place, ..contact })));
    }
}

impl Character {
    /// # Errors
    /// What is wrong with it.
    fn check(&self, to_world: &DAffine3) -> Result<(), String> {
        let is_length = |length: f32| length >= 0.0 && length.is_finite();
        if !(is_length(self.radius) && self.radius > 0.0) {
            return Err(format!("its radius is {}; set more than 0", self.radius));
        }
        if !is_length(self.half_length) {
            return Err(format!("its half_length is {}; set 0 or more", self.half_length));
        }
        if !self.velocity.is_finite() {
            return Err(format!("its velocity is {}", self.velocity));
        }
        if !(self.skin.is_finite() && self.max_slope.is_finite()) {
            return Err(format!("its skin is {}, its max_slope {}", self.skin, self.max_slope));
        }
        if !self.up.is_normalized() {
            return Err(format!("its up is {}; set a unit vector", *self.up));
        }
        if !to_world.is_finite() {
            return Err("its Transform is not finite".into());
        }
        Ok(())
    }
}

/// One step of one character.
struct Step<'a, 'w, 's> {
    world: &'a SpatialQuery<'w, 's>,
    entity: Entity,
    character: Character,
    dt: f32,
    start: Vec3,
    rotation: Quat,
}

impl Step<'_, '_, '_> {
    /// Returns where it is then, and on what it stands. Changes the velocity of the character.
    fn run(
        &mut self,
        ground: Option<GroundContact>,
        gravity: Vec3,
        transforms: &WorldTransforms,
    ) -> (Vec3, Option<GroundContact>) {
        let up = *self.character.up;
        let filter = self.character.filter.clone().without([self.entity]).without_sensors();
        let mut capsule = Capsule::new(self.world, &self.character, filter, self.start, self.rotation);
        let ground = ground.and_then(|ground| self.carry(&mut capsule, ground, transforms));
        capsule.push_out();

        let mut velocity = self.character.velocity;
        if let Some(ground) = &ground
            && velocity.dot(up) <= NO_JUMP
        {
            velocity -= up * velocity.dot(up);
            capsule.walk(velocity * self.dt, ground.normal, &mut velocity);
            let snap = self.character.snap_distance.max(0.0).max(2.0 * capsule.skin);
            if let Some(floor) = capsule.floor(capsule.position, snap, 0.0) {
                if floor.body != ground.body {
                    velocity += ground.velocity - up * ground.velocity.dot(up);
                }
                self.character.velocity = velocity;
                return self.stand(&capsule, floor, Some(ground), transforms);
            }
            // Off an edge.
            self.character.velocity = velocity + ground.velocity;
            return (capsule.position, None);
        }
        velocity += ground.map_or(Vec3::ZERO, |ground| ground.velocity) + gravity * self.dt;
        let rises = velocity.dot(up) > NO_JUMP;
        let lands = capsule.slide(velocity * self.dt, &mut velocity) || !rises;
        self.character.velocity = velocity;
        let floor = if lands {
            capsule.floor(capsule.position, 2.0 * capsule.skin, MIN_EDGE_LANDING)
        } else {
            None
        };
        match floor {
            Some(floor) => {
                self.character.velocity -= up * velocity.dot(up);
                self.stand(&capsule, floor, None, transforms)
            }
            None => (capsule.position, None),
        }
    }

    /// Moves the capsule along with the ground. Returns the ground as it is now, if it is still there.
    fn carry(
        &mut self,
        capsule: &mut Capsule,
        ground: GroundContact,
        transforms: &WorldTransforms,
    ) -> Option<GroundContact> {
        let to_world = transforms.to_world(ground.collider)?;
        let (rotation, _) = decompose(&to_world.matrix3);
        let point = to_world.transform_point3(ground.anchor.point).as_vec3();
        let way = point - ground.point;
        if !way.is_finite() {
            return None;
        }
        let turn = (rotation * ground.anchor.rotation.inverse()).to_scaled_axis().as_vec3();
        let mut moved = GroundContact {
            point,
            velocity: Vec3::ZERO,
            angular_velocity: Vec3::ZERO,
            ..ground
        };
        if way.length() > SHORTEST || turn.length() > SHORTEST {
            moved.velocity = way / self.dt;
            moved.angular_velocity = turn / self.dt;
            moved.normal = Quat::from_scaled_axis(turn) * ground.normal;
            if !capsule.is_floor(moved.normal) {
                moved.normal = capsule.up;
            }
            // The ground has moved already, maybe into the capsule.
            let all = capsule.filter.clone();
            capsule.filter = all.clone().without([ground.body, ground.collider]);
            let mut ignored = way;
            capsule.slide(way, &mut ignored);
            capsule.filter = all;
        }
        if !ground.anchor.is_tracked {
            // The landing character has a velocity relative to the world.
            let up = *self.character.up;
            self.character.velocity -= moved.velocity - up * moved.velocity.dot(up);
        }
        moved.anchor.is_tracked = true;
        Some(moved)
    }

    /// The character stands on a floor. `before` is the ground before, as it is now.
    fn stand(
        &self,
        capsule: &Capsule,
        floor: Floor,
        before: Option<&GroundContact>,
        transforms: &WorldTransforms,
    ) -> (Vec3, Option<GroundContact>) {
        let Some(to_world) = transforms.to_world(floor.collider) else {
            return (floor.position, None);
        };
        let same = before.filter(|before| before.body == floor.body);
        let contact = GroundContact {
            collider: floor.collider,
            body: floor.body,
            face: floor.face,
            point: floor.point,
            normal: floor.normal,
            velocity: same.map_or(Vec3::ZERO, |before| before.velocity),
            angular_velocity: same.map_or(Vec3::ZERO, |before| before.angular_velocity),
            place: Vec3::ZERO,
            anchor: Anchor {
                point: to_world.inverse().transform_point3(floor.point.as_dvec3()),
                rotation: decompose(&to_world.matrix3).0,
                is_tracked: same.is_some(),
            },
        };
        // Who stands still does not move by rounding.
        let stays = (floor.position - capsule.position).length() < 0.01 * capsule.skin;
        let position = if stays { capsule.position } else { floor.position };
        (position, Some(contact))
    }
}
