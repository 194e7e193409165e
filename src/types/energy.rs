//! The mechanical energy of bodies.

/// The mechanical energy of all dynamic bodies, joules. Kinematic and static bodies have none: what drives them does
/// the work.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "bevy", derive(bevy::reflect::Reflect))]
pub struct Energy {
    /// Energy of motion and rotation.
    pub kinetic: f64,
    /// Energy of height in the field of gravity, 0 at the origin of the world. Forces of the game do not count.
    pub potential: f64,
}

impl Energy {
    /// The sum of both.
    pub fn total(&self) -> f64 {
        self.kinetic + self.potential
    }
}
