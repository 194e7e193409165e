//! Materials: friction, restitution, and how the values of two bodies combine.

#[cfg(feature = "bevy")]
use bevy::prelude::*;
use serde::{Deserialize, Serialize};

/// Coulomb friction of a body or plane. Static and dynamic friction are the same. Default 0.5, combined by the mean.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(
    feature = "bevy",
    derive(Component, Reflect),
    reflect(Component, Default, Debug, PartialEq, Serialize, Deserialize)
)]
#[serde(default, deny_unknown_fields)]
pub struct Friction {
    /// Ratio of the largest friction force to the normal force; the tangent of the steepest slope on which a body stays
    /// at rest. Negative values count as 0.
    pub coefficient: f32,
    /// How the coefficients of two bodies combine.
    pub combine: CombineRule,
}

impl Default for Friction {
    fn default() -> Self {
        Self::new(0.5)
    }
}

impl Friction {
    /// Friction with a `coefficient` of 0 or more, combined by the mean.
    pub fn new(coefficient: f32) -> Self {
        Self {
            coefficient,
            combine: CombineRule::Average,
        }
    }

    /// A copy with another combine rule.
    pub fn with_combine(self, combine: CombineRule) -> Self {
        Self { combine, ..self }
    }
}

/// Restitution of a body or plane: 0 does not bounce, 1 keeps all speed. Default 0, combined by the mean.
///
/// Bodies do not bounce if they meet more slowly than
/// [`SolverSettings::restitution_threshold`](crate::types::solver_settings::SolverSettings::restitution_threshold).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(
    feature = "bevy",
    derive(Component, Reflect),
    reflect(Component, Default, Debug, PartialEq, Serialize, Deserialize)
)]
#[serde(default, deny_unknown_fields)]
pub struct Restitution {
    /// Ratio of outgoing to incoming normal speed, from 0 to 1. Other values are clamped to this range.
    pub coefficient: f32,
    /// How the coefficients of two bodies combine. [`Response::Impulse`](crate::types::settings::Response::Impulse)
    /// always takes the mean.
    pub combine: CombineRule,
}

impl Restitution {
    /// Restitution with a `coefficient` from 0 to 1, combined by the mean.
    pub fn new(coefficient: f32) -> Self {
        Self {
            coefficient,
            combine: CombineRule::Average,
        }
    }

    /// A copy with another combine rule.
    pub fn with_combine(self, combine: CombineRule) -> Self {
        Self { combine, ..self }
    }
}

/// How the coefficients of two bodies combine into the coefficient of the pair.
///
/// If the bodies have different rules, the later one in this list applies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(
    feature = "bevy",
    derive(Reflect),
    reflect(Default, Debug, PartialEq, Serialize, Deserialize)
)]
pub enum CombineRule {
    /// The arithmetic mean.
    #[default]
    Average,
    /// The square root of the product.
    GeometricMean,
    /// The smaller coefficient.
    Min,
    /// The product.
    Multiply,
    /// The larger coefficient.
    Max,
}

impl CombineRule {
    /// The coefficient of the pair, which is finite. Negative coefficients and NaN count as 0.
    pub fn combine(rules: [Self; 2], coefficients: [f32; 2]) -> f32 {
        // `max` returns the other operand for NaN.
        let [a, b] = coefficients.map(|c| c.max(0.0));
        let combined = match rules[0].max(rules[1]) {
            Self::Average => 0.5 * (a + b),
            Self::GeometricMean => (a * b).sqrt(),
            Self::Min => a.min(b),
            Self::Multiply => a * b,
            Self::Max => a.max(b),
        };
        // An infinite coefficient would give NaN where nothing presses: infinity times 0.
        combined.min(f32::MAX)
    }
}
