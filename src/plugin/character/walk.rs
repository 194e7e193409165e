//! How a character moves along what it meets.

use super::capsule::{Capsule, SHORTEST};
use bevy::prelude::*;

/// The casts of a way, at most.
const MAX_CASTS: usize = 8;

impl Capsule<'_, '_, '_> {
    /// Moves by `way` through the air and along surfaces that it meets. Removes the part of `velocity` into them.
    /// Returns whether one of them was a floor.
    pub fn slide(&mut self, way: Vec3, velocity: &mut Vec3) -> bool {
        let (mut rest, mut planes) = (way, Vec::new());
        for _ in 0..MAX_CASTS {
            let Some((way, length)) = direction(rest) else { break };
            let (room, hit) = self.advance(self.position, way, length);
            self.position += way * room;
            let Some(hit) = hit else { break };
            planes.push(hit.normal);
            rest = self.clip(rest * (1.0 - room / length), &planes);
            *velocity = self.clip(*velocity, &planes);
        }
        planes.iter().any(|plane| self.is_floor(*plane))
    }

    /// Moves by the horizontal `way` on the ground with this normal. Floors turn the motion up or down and keep its
    /// horizontal length. Steps are climbed. All else is a wall, which removes the part of `velocity` into it.
    pub fn walk(&mut self, way: Vec3, ground: Vec3, velocity: &mut Vec3) {
        let (mut rest, mut floors, mut walls) = (way, vec![ground], Vec::new());
        for _ in 0..MAX_CASTS {
            let (ground, along) = self.along_floors(rest, &floors);
            let Some((way, length)) = direction(along) else { return };
            let (room, hit) = self.advance(self.position, way, length);
            self.position += way * room;
            rest *= 1.0 - room / length;
            let Some(hit) = hit else { return };
            if self.is_floor(hit.normal) {
                floors.push(hit.normal);
            } else if let Some((floor, fraction)) = self.step_up(rest) {
                self.position = floor.position;
                rest *= 1.0 - fraction;
                floors = vec![floor.normal];
            } else {
                // Horizontal: a way along the ground that has no part into this goes past the surface.
                let wall = hit.normal - ground * (hit.normal.dot(self.up) / ground.dot(self.up));
                walls.push(wall.normalize_or_zero());
                rest = self.clip(rest, &walls);
                *velocity = self.clip(*velocity, &walls);
            }
        }
    }

    /// A horizontal way turned along the floor that lifts it most, and the normal of that.
    fn along_floors(&self, way: Vec3, floors: &[Vec3]) -> (Vec3, Vec3) {
        let rise = |normal: &Vec3| -way.dot(*normal) / normal.dot(self.up);
        let steepest = floors.iter().max_by(|a, b| rise(a).total_cmp(&rise(b)));
        let ground = steepest.copied().unwrap_or(self.up);
        (ground, way + self.up * rise(&ground))
    }

    /// The part of a vector that goes into none of some planes: along one of them, or along the edge of two.
    fn clip(&self, vector: Vec3, planes: &[Vec3]) -> Vec3 {
        let limit = -1.0e-5 * vector.length();
        let is_free = |vector: Vec3| planes.iter().all(|plane| vector.dot(*plane) >= limit);
        if is_free(vector) {
            return vector;
        }
        for plane in planes.iter().rev() {
            let clipped = self.clip_one(vector, *plane);
            if is_free(clipped) {
                return clipped;
            }
        }
        for (i, one) in planes.iter().enumerate().rev() {
            for other in &planes[..i] {
                let Some(edge) = one.cross(*other).try_normalize() else {
                    continue;
                };
                let clipped = edge * vector.dot(edge);
                let climbs = clipped.dot(self.up) > vector.dot(self.up).max(0.0) - limit;
                if !climbs && is_free(clipped) {
                    return clipped;
                }
            }
        }
        Vec3::ZERO
    }

    /// The part of a vector that does not go into a plane. A motion into a steep slope does not climb it. A floor stops
    /// a fall and keeps the horizontal part, so that a character that lands on a slope does not slide off.
    fn clip_one(&self, mut vector: Vec3, plane: Vec3) -> Vec3 {
        let rise = plane.dot(self.up);
        if self.is_floor(plane) {
            let over = vector.dot(plane).min(0.0) / rise;
            return vector - self.up * over;
        }
        if rise > 0.0 {
            let wall = (plane - self.up * rise).normalize_or_zero();
            vector -= wall * vector.dot(wall).min(0.0);
        }
        vector - plane * vector.dot(plane).min(0.0)
    }
}

fn direction(way: Vec3) -> Option<(Dir3, f32)> {
    Dir3::new_and_length(way).ok().filter(|(_, length)| *length > SHORTEST)
}
