//! [`Capsule`]: the casts of a character.

use super::Character;
use crate::plugin::queries::{QueryShape, RayHitData, ShapeHitData, SpatialQuery, SpatialQueryFilter};
use bevy::prelude::*;

/// Shortest distance that counts as a motion, metres.
pub(super) const SHORTEST: f32 = 1.0e-6;
/// How often it is pushed out of overlaps in a step.
const MAX_PUSHES: usize = 8;

/// The capsule of a character among what stops it.
pub(super) struct Capsule<'a, 'w, 's> {
    pub world: &'a SpatialQuery<'w, 's>,
    pub filter: SpatialQueryFilter,
    /// Where its centre is.
    pub position: Vec3,
    pub rotation: Quat,
    pub radius: f32,
    pub half_length: f32,
    pub up: Vec3,
    pub skin: f32,
    /// The part along `up` that the normal of a floor has at least.
    pub min_floor: f32,
    pub step_height: f32,
}

/// Where a capsule stands.
pub(super) struct Floor {
    /// Centre of the standing capsule.
    pub position: Vec3,
    pub collider: Entity,
    pub body: Entity,
    pub face: Option<u32>,
    pub point: Vec3,
    /// Normal of the ground, which is not steeper than the capsule can walk on.
    pub normal: Vec3,
}

impl<'a, 'w, 's> Capsule<'a, 'w, 's> {
    /// The capsule of a character. Everything that `filter` admits is in its way.
    pub fn new(
        world: &'a SpatialQuery<'w, 's>,
        character: &Character,
        filter: SpatialQueryFilter,
        position: Vec3,
        rotation: Quat,
    ) -> Self {
        let radius = character.radius;
        Self {
            world,
            filter,
            position,
            rotation,
            radius,
            half_length: character.half_length,
            up: *character.up,
            skin: character.skin.max(1.0e-3 * radius).min(0.5 * radius),
            min_floor: character.max_slope.cos().max(0.01),
            step_height: character.step_height.max(0.0),
        }
    }

    pub fn is_floor(&self, normal: Vec3) -> bool {
        // The normals of a slope of just this angle are rounded.
        normal.dot(self.up) >= self.min_floor - 1.0e-4
    }

    fn half_axis(&self) -> Vec3 {
        self.rotation * (Vec3::Y * self.half_length)
    }

    /// From the centre to the lowest point.
    fn depth(&self) -> f32 {
        self.half_axis().dot(self.up).abs() + self.radius
    }

    fn cast(&self, from: Vec3, way: Dir3, distance: f32) -> Option<ShapeHitData> {
        let shape = QueryShape::Capsule {
            radius: self.radius.into(),
            half_length: self.half_length.into(),
        };
        self.world
            .cast_shape(&shape, from, self.rotation, way, distance, &self.filter)
    }

    /// How far the capsule can go, up to `length` metres, until a surface is at the distance of the skin, and the hit
    /// there.
    pub fn advance(&self, from: Vec3, way: Dir3, length: f32) -> (f32, Option<ShapeHitData>) {
        // Far enough to see an almost parallel surface in time: the skin shrinks by a tenth at most.
        let Some(hit) = self.cast(from, way, 11.0 * length + 4.0 * self.skin) else {
            return (length, None);
        };
        let facing = -way.dot(hit.normal);
        let room = hit.distance - self.skin / facing.max(1.0e-3);
        if room >= length {
            (length, None)
        } else {
            (room.max(0.0), Some(hit))
        }
    }

    /// Moves the capsule out of what it overlaps, as far as there is room.
    pub fn push_out(&mut self) {
        for _ in 0..MAX_PUSHES {
            let ends = [self.position - self.half_axis(), self.position + self.half_axis()];
            // A little less than the skin, so that rounding moves nothing.
            let most = self.radius + 0.5 * self.skin;
            let Some(hit) = self.world.closest_to_segment(ends, most, &self.filter) else {
                return;
            };
            self.position += hit.normal * (self.radius + self.skin - hit.distance as f32);
        }
    }

    /// The floor that the capsule meets on its way down from `from`, within `distance` metres. At edges whose contact
    /// normal is too steep for a floor, the face beside the edge decides, if the part of the contact normal along `up`
    /// is `min_edge` or more.
    pub fn floor(&self, from: Vec3, distance: f32, min_edge: f32) -> Option<Floor> {
        let down = Dir3::new(-self.up).ok()?;
        let hit = self.cast(from, down, distance + 5.0 * self.skin)?;
        let rise = hit.normal.dot(self.up);
        let fall = (hit.distance - self.skin / rise.max(0.2)).max(-self.skin);
        if hit.distance == 0.0 || fall > distance {
            return self.floor_under(from);
        }
        let normal = if self.is_floor(hit.normal) {
            Some(hit.normal)
        } else if rise >= min_edge {
            self.tread(&hit)
                .filter(|_| self.radius * (1.0 - rise) <= self.step_height)
        } else {
            None
        };
        let Some(normal) = normal else {
            return self.floor_under(from);
        };
        Some(Floor {
            position: from - self.up * fall,
            collider: hit.collider,
            body: hit.body,
            face: hit.face,
            point: hit.point,
            normal,
        })
    }

    /// The floor right below the capsule's centre, if the capsule almost touches it. The capsule may lean against a
    /// steep surface first.
    fn floor_under(&self, from: Vec3) -> Option<Floor> {
        let hit = self.ray_down(from, self.depth() + 3.0 * self.skin)?;
        self.is_floor(hit.normal).then_some(Floor {
            position: from,
            collider: hit.collider,
            body: hit.body,
            face: hit.face,
            point: hit.point,
            normal: hit.normal,
        })
    }

    /// The normal of the floor beside an edge, on the side away from the capsule.
    fn tread(&self, hit: &ShapeHitData) -> Option<Vec3> {
        let out = (hit.normal - self.up * hit.normal.dot(self.up)).normalize_or_zero();
        let origin = hit.point + self.skin * (2.0 * self.up - out);
        let hit = self.ray_down(origin, 4.0 * self.skin)?;
        self.is_floor(hit.normal).then_some(hit.normal)
    }

    fn ray_down(&self, from: Vec3, distance: f32) -> Option<RayHitData> {
        let down = Dir3::new(-self.up).ok()?;
        self.world.cast_ray(from, down, distance, &self.filter)
    }

    /// Steps onto something low, to go on by the remaining horizontal displacement `rest`. Returns the floor, and the
    /// fraction of `rest` that was possible.
    pub fn step_up(&self, rest: Vec3) -> Option<(Floor, f32)> {
        if self.step_height <= self.skin {
            return None;
        }
        let feet = self.position.dot(self.up) - self.depth();
        let (rise, _) = self.advance(self.position, Dir3::new(self.up).ok()?, self.step_height);
        let raised = self.position + self.up * rise;
        let (way, length) = Dir3::new_and_length(rest).ok()?;
        let (forward, _) = self.advance(raised, way, length);
        if forward <= 0.01 * length {
            return None;
        }
        let floor = self.floor(raised + way * forward, rise + self.skin, 0.0)?;
        let is_low = floor.point.dot(self.up) - feet <= self.step_height;
        is_low.then_some((floor, forward / length))
    }
}
