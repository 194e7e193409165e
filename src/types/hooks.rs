//! [`ActiveCollisionHooks`]: which decisions about a collider a game makes itself.

#[cfg(feature = "bevy")]
use bevy::prelude::*;
use serde::{Deserialize, Serialize};

/// Which hooks are called for pairs with this collider or plane. One of the two is enough to ask for a hook. A collider
/// without this component has that of its body. Default: none.
///
/// In an app the hooks are a [`CollisionHooks`](crate::plugin::hooks::CollisionHooks).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(
    feature = "bevy",
    derive(Component, Reflect),
    reflect(Component, Default, Debug, PartialEq, Serialize, Deserialize)
)]
#[serde(default, deny_unknown_fields)]
pub struct ActiveCollisionHooks {
    /// Whether pairs are filtered before they are tested.
    pub filter_pairs: bool,
    /// Whether contacts are modified before they are solved.
    pub modify_contacts: bool,
}

impl ActiveCollisionHooks {
    /// No hook.
    pub const NONE: Self = Self {
        filter_pairs: false,
        modify_contacts: false,
    };
    /// Pairs are filtered.
    pub const FILTER_PAIRS: Self = Self {
        filter_pairs: true,
        modify_contacts: false,
    };
    /// Contacts are modified.
    pub const MODIFY_CONTACTS: Self = Self {
        filter_pairs: false,
        modify_contacts: true,
    };
    /// Both.
    pub const ALL: Self = Self {
        filter_pairs: true,
        modify_contacts: true,
    };
}
