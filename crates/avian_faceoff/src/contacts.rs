//! [`ExactContacts`]: how contacts between exact meshes are made.

use bevy::prelude::*;

/// How contacts between exact meshes are made. Settings of Avian hold for all other pairs.
#[derive(Resource, Reflect, Clone, Copy, Default, Debug, PartialEq)]
#[reflect(Resource, Default, Debug, PartialEq)]
pub struct ExactContacts {
    /// How far apart surfaces come to rest, as a part of the diameter of the smaller mesh's bounding sphere. The
    /// default is 0: off.
    ///
    /// More than 5 cm count as 5 cm, or as 5 % of another [`PhysicsLengthUnit`](avian3d::prelude::PhysicsLengthUnit):
    /// Avian drops pairs that are farther apart.
    ///
    /// Avian's contacts are soft: at rest bodies sink into each other a little, more in a high pile. This keeps them
    /// apart by as much. 0.005 hides the overlap in chains and piles.
    pub rest_offset: f32,
}
