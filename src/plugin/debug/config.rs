//! Which gizmos are drawn.

use crate::plugin::inspect::poses::ColliderState;
use bevy::prelude::*;

/// Which gizmos are drawn, and their colours. `None` hides a kind of gizmo. Change it at any time, through
/// `GizmoConfigStore`.
#[derive(GizmoConfigGroup, Reflect, Clone, Debug, PartialEq)]
pub struct FaceoffGizmos {
    /// The edges of every collider's mesh, each once. Default `None`.
    pub wireframes: Option<Color>,
    /// The axis-aligned box of every collider in the tree that spatial queries search. It is larger than the mesh where
    /// the mesh is turned. The broad phase of the step tests [`bounding_spheres`](Self::bounding_spheres) instead.
    /// Default `None`.
    pub boxes: Option<Color>,
    /// The bounding sphere of every collider, as the broad phase tests it, without the margin for motion. Default
    /// `None`.
    pub bounding_spheres: Option<Color>,
    /// The colour of wireframes, boxes and spheres of bodies asleep. `None` draws them like awake ones. Default dark
    /// blue.
    pub sleeping: Option<Color>,
    /// The colour of wireframes, boxes and spheres of sensors. `None` draws them like other colliders. Default violet.
    pub sensors: Option<Color>,
    /// The colour of wireframes, boxes and spheres of colliders that take no part in the step: disabled, rejected, or
    /// sheared while their sheared copy is baked. `None` hides them. Default grey.
    pub left_out: Option<Color>,
    /// A grid on every [`PlaneCollider`](crate::plugin::components::PlaneCollider) about the place of its entity, and
    /// its normal. Default `None`.
    pub planes: Option<Color>,
    /// Edge length of these grids, metres. Default 10.
    pub plane_size: f32,
    /// A cross at every body's centre of mass. Default `None`.
    pub centers_of_mass: Option<Color>,
    /// An arrow along every body's linear velocity, from its centre of mass. Default `None`.
    ///
    /// It is the component [`LinearVelocity`](crate::types::body::LinearVelocity). A kinematic body that is moved by
    /// its `Transform` has none.
    pub linear_velocities: Option<Color>,
    /// An arrow along the axis of every body's angular velocity, from its centre of mass. Default `None`.
    pub angular_velocities: Option<Color>,
    /// Length of these arrows, metres for each m/s or rad/s. Default 0.25.
    pub velocity_scale: f32,
    /// Islands, the sets of bodies that sleep and wake together: lines between the centres of mass of dynamic bodies
    /// that touch. Each island has its own hue, with the saturation, lightness and alpha of this colour. Wireframes,
    /// boxes and spheres of dynamic bodies, awake or asleep, take the colour of their island. Default `None`.
    ///
    /// They are found in [`Collisions`](crate::plugin::collisions::Collisions), wherever the stages run. With
    /// [`Readback::Resident`](crate::plugin::settings::Readback::Resident), which does not read them back, and without
    /// [`Response::Contacts`](crate::types::settings::Response::Contacts), in which alone bodies sleep, there are none.
    pub islands: Option<Color>,
    /// An arrow for every touching pair, along the contact normal from the first body to the second. Default orange.
    pub contacts: Option<Color>,
    /// Length of these arrows in metres. Default 0.5.
    pub contact_length: f32,
    /// A cross at every contact point of touching pairs. Default `None`.
    pub contact_points: Option<Color>,
    /// The impulse at every contact point: a line along the normal, on which the second body is pushed. Default `None`.
    pub impulses: Option<Color>,
    /// Length of these lines, metres for each newton second. Default 1.
    pub impulse_scale: f32,
    /// The segments along which faces intersect. While they are drawn they turn
    /// [`FaceLists`](crate::plugin::settings::FaceLists) on. Default yellow.
    pub intersections: Option<Color>,
    /// The edges of the faces that [`ShowFacesTowards`](super::ShowFacesTowards) selects. Default green.
    pub faces: Option<Color>,
    /// The ray of every enabled [`RayCaster`](crate::plugin::queries::RayCaster), up to its last hit if it wants no
    /// more; the first 1000 m of an infinite one. Default `None`.
    pub rays: Option<Color>,
    /// The shape of every [`ShapeCaster`](crate::plugin::queries::ShapeCaster) that is enabled, at the start and where
    /// it touches something, and the way between. Default `None`.
    pub shapes: Option<Color>,
    /// A cross and the normal where the rays and shapes of casters hit something. Default `None`.
    pub hits: Option<Color>,
    /// The capsule of every [`Character`](crate::plugin::character::Character), and the normal of the ground below it.
    /// Default `None`.
    pub characters: Option<Color>,
    /// Half the length of the lines of all crosses, metres. Default 0.05.
    pub marker_size: f32,
}

impl Default for FaceoffGizmos {
    fn default() -> Self {
        let all = Self::all();
        Self {
            contacts: all.contacts,
            intersections: all.intersections,
            faces: all.faces,
            ..Self::none()
        }
    }
}

impl FaceoffGizmos {
    /// Every kind of gizmo, in different colours.
    pub fn all() -> Self {
        Self {
            wireframes: Some(Color::srgb(0.95, 0.95, 0.95)),
            boxes: Some(Color::srgb(0.2, 0.9, 0.9)),
            bounding_spheres: Some(Color::srgba(1.0, 1.0, 1.0, 0.3)),
            sleeping: Some(Color::srgb(0.1, 0.15, 0.45)),
            sensors: Some(Color::srgb(0.8, 0.4, 1.0)),
            left_out: Some(Color::srgba(0.3, 0.3, 0.3, 0.6)),
            planes: Some(Color::srgba(1.0, 1.0, 1.0, 0.4)),
            plane_size: 10.0,
            centers_of_mass: Some(Color::srgb(1.0, 0.2, 0.6)),
            linear_velocities: Some(Color::srgb(0.1, 1.0, 0.2)),
            angular_velocities: Some(Color::srgb(1.0, 0.2, 1.0)),
            velocity_scale: 0.25,
            islands: Some(Color::srgb(1.0, 0.25, 0.25)),
            contacts: Some(Color::srgb(1.0, 0.4, 0.0)),
            contact_length: 0.5,
            contact_points: Some(Color::srgb(1.0, 0.1, 0.1)),
            impulses: Some(Color::srgb(1.0, 0.7, 0.3)),
            impulse_scale: 1.0,
            intersections: Some(Color::srgb(1.0, 0.9, 0.1)),
            faces: Some(Color::srgb(0.2, 0.9, 0.3)),
            rays: Some(Color::srgb(0.3, 0.6, 1.0)),
            shapes: Some(Color::srgb(0.3, 0.6, 1.0)),
            hits: Some(Color::srgb(1.0, 0.3, 0.3)),
            characters: Some(Color::srgb(0.6, 1.0, 0.6)),
            marker_size: 0.05,
        }
    }

    /// No gizmos. Lengths and the colours of states are as in [`FaceoffGizmos::all`].
    pub fn none() -> Self {
        Self {
            wireframes: None,
            boxes: None,
            bounding_spheres: None,
            planes: None,
            centers_of_mass: None,
            linear_velocities: None,
            angular_velocities: None,
            islands: None,
            contacts: None,
            contact_points: None,
            impulses: None,
            intersections: None,
            faces: None,
            rays: None,
            shapes: None,
            hits: None,
            characters: None,
            ..Self::all()
        }
    }

    /// The colour of a collider in this state. `None` hides it.
    pub(super) fn color_of(&self, awake: Color, state: ColliderState) -> Option<Color> {
        match state {
            ColliderState::Awake => Some(awake),
            ColliderState::Asleep => Some(self.sleeping.unwrap_or(awake)),
            ColliderState::Sensor => Some(self.sensors.unwrap_or(awake)),
            ColliderState::LeftOut => self.left_out,
        }
    }

    /// The colour of the island with this root.
    pub(super) fn color_of_island(color: Color, root: Entity) -> Color {
        // Multiples of the golden angle are far from each other.
        let hue = (f64::from(root.index_u32()) * 137.508) % 360.0;
        Hsla::from(color).with_hue(hue as f32).into()
    }
}
