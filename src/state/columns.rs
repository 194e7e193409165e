//! The arrays of [`Bodies`] that have an entry for each collider, as one list.

use super::bodies::{Bodies, Frame};
use super::body::BodyParams;
use crate::types::body::{CollisionLayers, RigidBody};
use crate::types::settings::Culling;
use glam::{Mat3, Quat, Vec3};

/// The arrays that have an entry for each collider.
macro_rules! columns {
    ($($name:ident: $type:ty,)*) => {
        /// What the arrays have of one collider.
        pub(super) struct Row {
            $(pub $name: $type,)*
        }

        impl Bodies {
            #[inline]
            pub(super) fn push_row(&mut self, row: Row) {
                $(self.$name.push(row.$name);)*
            }

            #[cfg(feature = "bevy")]
            #[inline]
            pub(super) fn set_row(&mut self, i: usize, row: Row) {
                $(self.$name[i] = row.$name;)*
            }

            /// Removes all colliders from this number on.
            pub(super) fn truncate_rows(&mut self, count: usize) {
                $(self.$name.truncate(count);)*
            }
        }
    };
}

columns! {
    body: u32,
    mesh: u32,
    kind: RigidBody,
    position: Vec3,
    rotation: Quat,
    scale: Vec3,
    linear_velocity: Vec3,
    angular_velocity: Vec3,
    frame: Frame,
    center: Vec3,
    radius: f32,
    rounding: f32,
    unpadded_radius: f32,
    thickness: f32,
    speculative_radius: f32,
    travel_time: f32,
    inverse_mass: f32,
    own_inverse_mass: f32,
    local_inverse_inertia: Mat3,
    inverse_inertia: Mat3,
    restitution: f32,
    gravity_scale: f32,
    layers: CollisionLayers,
    sensor: bool,
    culling: Culling,
    params: BodyParams,
}
