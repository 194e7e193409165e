//! Characters: capsules that walk, climb steps, slide along walls and ride on platforms.
//!
//! | to | see |
//! |---|---|
//! | spawn a character, and tell it where to go | [`Character`] |
//! | ask whether it stands, and on what | [`CharacterGround`] |
//!
//! A character is moved in [`FaceoffStep`], after the bodies. So it follows the physics clock, and stands on platforms
//! where they are drawn. In each step it
//!
//! 1. is carried along by its ground: a point of the ground is remembered in the axes of its collider, so lifts,
//!    turning platforms and rolling logs all carry. It is not carried into walls. Ground that is placed elsewhere does
//!    not take it along ([`Teleport`](crate::plugin::components::Teleport), or a written `Transform` of a dynamic
//!    body), and a character that the game places farther away than its radius leaves its ground.
//! 2. is pushed out of anything that it overlaps.
//! 3. moves with its velocity, and with gravity while it is in the air. Where it meets a surface it goes on along that
//!    surface. On the ground it keeps its horizontal speed on slopes, and steps onto what is low enough.
//! 4. looks for the ground. On the ground it follows stairs and slopes down.
//!
//! All of it is casts of the capsule ([`SpatialQuery::cast_shape`](crate::plugin::queries::SpatialQuery::cast_shape)),
//! which are exact on the triangles. The capsule keeps the distance [`Character::skin`] from surfaces, so it does not
//! catch on the edges between the faces of a floor.

mod capsule;
mod placed;
mod step;
mod walk;

use crate::plugin::clock;
use crate::plugin::queries::{SpatialQueryFilter, SpatialQueryPlugin, run_casters, update_after_step};
use crate::plugin::schedule::{FaceoffStep, FaceoffSystems};
use bevy::ecs::entity::MapEntities;
use bevy::math::{DQuat, DVec3};
use bevy::prelude::*;
use serde::{Deserialize, Serialize};
use std::f32::consts::FRAC_PI_4;

/// A capsule that is moved by its velocity and stopped by colliders and planes. By default it is 1.8 metres high, with
/// a radius of 0.3 metres.
///
/// Its `Transform` is the centre of the capsule. The step writes the translation; the rotation is the game's, and turns
/// the capsule.
///
/// ```
/// use bevy::prelude::*;
/// use bevy_faceoff::prelude::*;
///
/// fn spawn(mut commands: Commands) {
///     commands.spawn((Character::new(0.3, 0.6), Transform::from_xyz(0.0, 1.0, 0.0)));
/// }
///
/// /// A system for `FixedUpdate`: walks along x, and jumps whenever it stands.
/// fn walk(mut characters: Query<(&mut Character, &CharacterGround)>) {
///     for (mut character, ground) in &mut characters {
///         character.velocity.x = 4.0;
///         if let Some(contact) = ground.contact() {
///             println!("jumps from face {:?} of {}", contact.face, contact.collider);
///             character.velocity.y = 5.0;
///         }
///     }
/// }
/// # bevy::ecs::system::assert_is_system(spawn);
/// # bevy::ecs::system::assert_is_system(walk);
/// ```
///
/// * It is stopped by everything that its filter admits, except sensors, its own entity and the colliders of its own
///   body.
/// * It does not push bodies itself, and they do not see it. Give it a `RigidBody::Kinematic` and a
///   [`MeshCollider`](crate::plugin::components::MeshCollider) for that. These follow it in the next step. To push
///   dynamic bodies, make the mesh wider than radius plus skin, or leave the layers of these bodies out of the filter.
/// * [`GravityScale`](crate::plugin::components::GravityScale) works on it; 0 lets it fly.
/// * Under a parent that moves it is moved by that too, so do not spawn it below a platform.
/// * [`RigidBodyDisabled`](crate::plugin::components::RigidBodyDisabled) stops it. It stands still where queries find
///   nothing ([`SpatialQuery::check`](crate::plugin::queries::SpatialQuery::check)), and if its numbers are not valid;
///   then a warning names it.
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, Debug, PartialEq)]
#[require(Transform, CharacterGround)]
pub struct Character {
    /// Metres; more than 0.
    pub radius: f32,
    /// Half the length of the segment about which the capsule is, along the local y axis. Metres; 0 makes it a ball.
    pub half_length: f32,
    /// Away from the ground. Default y.
    pub up: Dir3,
    /// The velocity that the game wants, m/s. After the step it is the possible velocity, without the part into walls.
    ///
    /// On the ground it is relative to the ground. After the step it is horizontal, also on slopes. To jump, set a part
    /// along `up`. In the air it is relative to the world, and gravity changes it. When the character leaves the
    /// ground, the velocity of the ground is added to its own. When it lands on ground that moves, it keeps its
    /// velocity in the world until the game sets another one.
    pub velocity: Vec3,
    /// The steepest slope on which it stands and walks, radians. Default 45 degrees. It slides down from steeper ones.
    pub max_slope: f32,
    /// The highest step that it climbs, metres. Default 0.3.
    pub step_height: f32,
    /// How far below the character the ground may be if it stood on the ground before, metres: the character follows
    /// the ground instead of flying off at steps and edges. Default 0.3.
    pub snap_distance: f32,
    /// The distance that the character keeps from surfaces, metres. Default 0.01. At least a thousandth of the radius,
    /// at most half of it.
    pub skin: f32,
    /// What stops it. Sensors never do.
    #[entities]
    pub filter: SpatialQueryFilter,
}

impl Default for Character {
    fn default() -> Self {
        Self::new(0.3, 0.6)
    }
}

impl Character {
    /// One at rest, with defaults.
    pub fn new(radius: f32, half_length: f32) -> Self {
        Self {
            radius,
            half_length,
            up: Dir3::Y,
            velocity: Vec3::ZERO,
            max_slope: FRAC_PI_4,
            step_height: 0.3,
            snap_distance: 0.3,
            skin: 0.01,
            filter: SpatialQueryFilter::default(),
        }
    }

    /// This character with this filter.
    pub fn with_filter(self, filter: SpatialQueryFilter) -> Self {
        Self { filter, ..self }
    }
}

/// The ground that a [`Character`] stands on; `None` in the air. The step writes it. It is saved in scenes, so that a
/// loaded character goes on with its platform.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Deref)]
#[reflect(Component, Default, Debug, PartialEq)]
pub struct CharacterGround(#[entities] pub(crate) Option<GroundContact>);

impl CharacterGround {
    /// The ground, if it stands on any.
    pub fn contact(&self) -> Option<&GroundContact> {
        self.0.as_ref()
    }

    /// Whether it stands.
    pub fn is_grounded(&self) -> bool {
        self.0.is_some()
    }
}

/// Where a [`Character`] stands.
#[derive(Clone, Copy, Debug, MapEntities, PartialEq, Reflect)]
#[reflect(Debug, PartialEq)]
pub struct GroundContact {
    /// The collider or plane.
    #[entities]
    pub collider: Entity,
    /// The body of the collider; without one the collider itself.
    #[entities]
    pub body: Entity,
    /// The face, an index of the source mesh. `None` on a plane.
    pub face: Option<u32>,
    /// The point of the ground below the capsule, in the world.
    pub point: Vec3,
    /// Unit normal of the ground. On the edge of a step, the normal of the face beside the edge.
    pub normal: Vec3,
    /// How `point` has moved in the last step, m/s. 0 in the step in which the character comes to this ground.
    pub velocity: Vec3,
    /// How the ground has turned in the last step, rad/s: to turn a character along with its platform.
    pub angular_velocity: Vec3,
    /// The `Transform` of the character, metres.
    pub(crate) place: Vec3,
    /// The point in the axes of the collider, and the collider's rotation.
    pub(crate) anchor: Anchor,
}

/// A point of a collider.
#[derive(Clone, Copy, Debug, Default, PartialEq, Reflect, Serialize, Deserialize)]
#[reflect(Default, Debug, PartialEq)]
pub(crate) struct Anchor {
    /// The point in the axes of the collider.
    pub(crate) point: DVec3,
    /// Rotation of the collider in the world.
    pub(crate) rotation: DQuat,
    /// Whether the velocity of the ground is known.
    pub(crate) is_tracked: bool,
}

/// Moves characters. Part of [`FaceoffPlugins`](crate::plugin::FaceoffPlugins); needs [`SpatialQueryPlugin`].
pub struct CharacterPlugin;

impl Plugin for CharacterPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<Character>()
            .register_type::<CharacterGround>()
            .register_type::<GroundContact>();
        if !app.is_plugin_added::<SpatialQueryPlugin>() {
            info!("characters do not move: CharacterPlugin needs SpatialQueryPlugin before it");
            return;
        }
        // Rays and shapes of casters on characters start where these are after the step.
        let run = run.after(update_after_step).before(run_casters).before(clock::end);
        let run = run.run_if(any_with_component::<Character>).ambiguous_with_all();
        let leave = placed::leave_placed_ground.before(FaceoffSystems::Collect);
        app.add_systems(FaceoffStep, (leave.ambiguous_with_all(), run));
    }
}

/// Moves all characters. The system is created with the first character, because it makes the app run queries.
fn run(world: &mut World) {
    if let Err(error) = world.run_system_cached(step::move_characters) {
        error!("{error}");
    }
}
