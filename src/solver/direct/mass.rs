//! How the bodies of an island react to impulses.

use super::super::motion::{Mass, Velocity};
use super::blocks::{Block, N, Vector};
use glam::{DMat3, DVec3};

/// How a body reacts to impulses, in world axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct BodyMass {
    /// 1 for each unknown that impulses change, 0 for others.
    pub free: Vector,
    pub mass: Block,
    pub inverse: Block,
}

impl BodyMass {
    pub fn new(mass: &Mass) -> Self {
        let inertia = DMat3::from_cols_array(&mass.inverse_inertia.to_cols_array().map(f64::from));
        let mut inverse = [[0.0; N]; N];
        for i in 0..3 {
            inverse[i][i] = f64::from(mass.inverse_mass[i]);
            for k in 0..3 {
                inverse[3 + i][3 + k] = 0.5 * (inertia.col(k)[i] + inertia.col(i)[k]);
            }
        }
        // An unknown that impulses do not change has a row of the identity, and no coefficients in points.
        let free = std::array::from_fn(|i| f64::from(u8::from(inverse[i][i] > 0.0)));
        let regular = |i: usize, k: usize| if i == k && free[i] == 0.0 { 1.0 } else { inverse[i][k] };
        let column = |k: usize| DVec3::new(regular(3, k), regular(4, k), regular(5, k));
        let inertia = DMat3::from_cols(column(3), column(4), column(5)).inverse();
        let mut own = [[0.0; N]; N];
        for i in 0..3 {
            own[i][i] = 1.0 / regular(i, i);
            for k in 0..3 {
                own[3 + i][3 + k] = inertia.col(k)[i];
            }
        }
        Self {
            free,
            mass: own,
            inverse,
        }
    }
}

/// The linear and the angular velocity.
pub(super) fn vector(velocity: &Velocity) -> Vector {
    let ([x, y, z], [p, q, r]) = (velocity.linear.to_array(), velocity.angular.to_array());
    [x, y, z, p, q, r].map(f64::from)
}
