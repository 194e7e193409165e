//! Gizmos of characters.

use super::outlines::{Drawn, draw_hit};
use crate::plugin::character::{Character, CharacterGround};
use crate::plugin::inspect::poses::WorldPoses;
use crate::plugin::sync::hierarchy::decompose;
use bevy::prelude::*;

pub(super) fn draw_characters(
    mut gizmos: Drawn,
    characters: Query<(Entity, &Character, &CharacterGround)>,
    poses: WorldPoses,
) {
    let Some(color) = gizmos.config_ext.characters.filter(|_| gizmos.config.enabled) else {
        return;
    };
    for (entity, character, ground) in &characters {
        let to_world = poses.to_world(entity);
        if !to_world.is_finite() {
            continue;
        }
        let (rotation, _) = decompose(&to_world.matrix3);
        let pose = Isometry3d::new(to_world.translation.as_vec3(), rotation.as_quat());
        let &Character {
            radius, half_length, ..
        } = character;
        gizmos.primitive_3d(&Capsule3d { radius, half_length }, pose, color);
        if let Some(contact) = **ground {
            draw_hit(&mut gizmos, contact.point, contact.normal, color);
        }
    }
}
