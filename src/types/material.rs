//! How surfaces rub and bounce.

#[cfg(feature = "bevy")]
use bevy::prelude::*;

/// Coulomb friction, the same for sticking and sliding. Default 0.5, of which two bodies take the mean.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "bevy",
    derive(Component, Reflect),
    reflect(Component, Default, Debug, PartialEq)
)]
pub struct Friction {
    /// Largest friction over normal force: the tangent of the slope on which a body just holds. A negative one counts as 0.
    pub coefficient: f32,
    /// How that of a pair follows from both bodies'.
    pub combine: CombineRule,
}

impl Default for Friction {
    fn default() -> Self {
        Self::new(0.5)
    }
}

impl Friction {
    /// A friction of `coefficient`, 0 or more, of which two bodies take the mean.
    pub fn new(coefficient: f32) -> Self {
        Self {
            coefficient,
            combine: CombineRule::Average,
        }
    }

    /// The same with another rule.
    pub fn with_combine(self, combine: CombineRule) -> Self {
        Self { combine, ..self }
    }
}

/// Bounciness: 0 does not bounce, 1 keeps all speed. Default 0. Bodies that meet slower than
/// [`SolverSettings::restitution_threshold`](crate::types::solver_settings::SolverSettings) do not bounce.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(
    feature = "bevy",
    derive(Component, Reflect),
    reflect(Component, Default, Debug, PartialEq)
)]
pub struct Restitution {
    /// Outgoing speed over incoming speed, 0 to 1; what is beyond counts as the nearest of the two.
    pub coefficient: f32,
    /// How that of a pair follows from both bodies'. With [`Response::Impulse`](crate::types::settings::Response) always their
    /// mean.
    pub combine: CombineRule,
}

impl Restitution {
    /// A restitution of `coefficient`, 0 to 1, of which two bodies take the mean.
    pub fn new(coefficient: f32) -> Self {
        Self {
            coefficient,
            combine: CombineRule::Average,
        }
    }

    /// The same with another rule.
    pub fn with_combine(self, combine: CombineRule) -> Self {
        Self { combine, ..self }
    }
}

/// How one coefficient of a pair follows from those of both bodies. If the bodies name different rules, the one that
/// stands later in this list holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "bevy", derive(Reflect), reflect(Default, Debug, PartialEq))]
pub enum CombineRule {
    /// Their mean.
    #[default]
    Average,
    /// The root of their product.
    GeometricMean,
    /// The smaller one.
    Min,
    /// Their product.
    Multiply,
    /// The larger one.
    Max,
}

impl CombineRule {
    /// The pair's coefficient; negative or NaN ones count as 0.
    pub fn combine(rules: [Self; 2], coefficients: [f32; 2]) -> f32 {
        // `max` returns the other operand for NaN.
        let [a, b] = coefficients.map(|c| c.max(0.0));
        match rules[0].max(rules[1]) {
            Self::Average => 0.5 * (a + b),
            Self::GeometricMean => (a * b).sqrt(),
            Self::Min => a.min(b),
            Self::Multiply => a * b,
            Self::Max => a.max(b),
        }
    }
}
