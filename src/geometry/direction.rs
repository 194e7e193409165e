//! Directions of projection, their two angles, and their index in a table.
//!
//! To project a mesh along a direction `d` given in its own axes, it is rotated about y by `b` and then about x by `a`.
//! It is drawn on the xy plane with its height along z. The rotation `R = Rx(a) * Ry(b)` takes `d = (-cos a * sin b,
//! sin a, cos a * cos b)` to `+z`, so `b = atan2(-d.x, d.z)` and `a = asin(d.y)`. Aly & Elawady 2010 use an `acos` (eq.
//! 4), which loses the sign. The formulas here keep it. Baking and lookup use the same formulas.
//!
//! If both `a` and `b` run through 360 degrees, each direction occurs twice: `(a, b)` and `(180 - a, b + 180)` see the
//! same side, with the image upside down. A [`DirectionGrid`] therefore restricts `a` to -90..=90, and has a single
//! direction at each pole, where `b` only rotates the image.

use glam::{DMat3, DVec3, Vec3};

/// The two projection angles of a direction, in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Angles {
    /// The angle about x; -pi/2..=pi/2 in the result of [`Angles::of`].
    pub a: f32,
    /// The angle about y; -pi..=pi in the result of [`Angles::of`].
    pub b: f32,
}

impl Angles {
    /// The angles of `direction`, which need not have unit length. The zero vector counts as `+z`.
    pub fn of(direction: Vec3) -> Self {
        let (a, b) = radians(direction);
        Self {
            a: a as f32,
            b: b as f32,
        }
    }

    /// The unit vector that the rotation by these angles takes to `+z`.
    pub fn direction(self) -> Vec3 {
        let (a, b) = (f64::from(self.a).sin_cos(), f64::from(self.b).sin_cos());
        rotation_from(a, b).row(2).as_vec3()
    }
}

/// The rotation `Rx(a) * Ry(b)` that takes `direction` to `+z`. Its rows are the x, y and height axes of the image.
///
/// `direction` need not have unit length. Zero and NaN count as `+z`.
pub fn rotation(direction: Vec3) -> DMat3 {
    let d = direction.as_dvec3().normalize_or(DVec3::Z);
    let flat = d.x.hypot(d.z);
    // At the poles b is arbitrary; 0 keeps the image upright.
    let (sb, cb) = if flat > 0.0 {
        (-d.x / flat, d.z / flat)
    } else {
        (0.0, 1.0)
    };
    rotation_from((d.y, flat), (sb, cb))
}

/// `Rx(a) * Ry(b)` from the sine and cosine of each angle.
fn rotation_from((sa, ca): (f64, f64), (sb, cb): (f64, f64)) -> DMat3 {
    DMat3::from_cols(
        DVec3::new(cb, sa * sb, -ca * sb),
        DVec3::new(0.0, ca, sa),
        DVec3::new(sb, -sa * cb, ca * cb),
    )
}

/// The angles `(a, b)`. `a` uses `atan2` instead of `asin`, which is accurate near the poles and for any length.
fn radians(direction: Vec3) -> (f64, f64) {
    let d = direction.as_dvec3();
    (d.y.atan2((d.x * d.x + d.z * d.z).sqrt()), (-d.x).atan2(d.z))
}

/// All distinct directions whose angles are multiples of a step in whole degrees, with dense indices.
///
/// Index 0 is the pole `-y`. Then come the rows `a = -90 + step, ..., 90 - step` with columns `b = 0, step, ...`. The
/// last index is the pole `+y`. A step of one degree gives 64,442 directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DirectionGrid {
    step: u32,
}

impl DirectionGrid {
    /// A grid of `step` degrees; `None` unless `step` divides 90.
    pub fn new(step: u32) -> Option<Self> {
        (step != 0 && 90 % step == 0).then_some(Self { step })
    }

    /// The step in degrees.
    pub fn step(self) -> u32 {
        self.step
    }

    /// The number of steps in a full turn: the side of the table as the paper addresses it, 360 at one degree.
    pub fn turn(self) -> u32 {
        360 / self.step
    }

    /// The number of distinct directions.
    pub fn len(self) -> u32 {
        (self.turn() / 2 - 1) * self.turn() + 2
    }

    /// Always `false`.
    pub fn is_empty(self) -> bool {
        false
    }

    /// The index of the direction with angles `a_step * step` and `b_step * step` degrees, both modulo a full turn.
    pub fn index_at(self, a_step: u32, b_step: u32) -> u32 {
        let turn = self.turn();
        let (a, b) = (a_step % turn, b_step % turn);
        let quarter = turn / 4;
        // a + 90 degrees: 0..=half is the stored half. The other half has the same directions with the image upside
        // down.
        let row = (a + quarter) % turn;
        if row <= turn / 2 {
            self.index_in_half(row, b)
        } else {
            self.index_in_half(turn - row, (b + turn / 2) % turn)
        }
    }

    /// The index for `row` steps of `a` from -90 degrees, 0..=turn/2.
    fn index_in_half(self, row: u32, column: u32) -> u32 {
        if row == 0 {
            0
        } else if row == self.turn() / 2 {
            self.len() - 1
        } else {
            1 + (row - 1) * self.turn() + column
        }
    }

    /// The index of the grid direction nearest to `direction`. Each angle is rounded separately.
    ///
    /// `direction` need not have unit length. The zero vector counts as `+z`. NaN gives an unspecified valid index.
    pub fn index_of(self, direction: Vec3) -> u32 {
        let (a, b) = radians(direction);
        let per_step = f64::from(self.step).to_radians().recip();
        let quarter = (self.turn() / 4) as i32;
        let row = ((a * per_step).round() as i32 + quarter).clamp(0, 2 * quarter);
        let column = ((b * per_step).round() as i32).rem_euclid(4 * quarter);
        self.index_in_half(row as u32, column as u32)
    }

    /// The angles of direction `index` in whole degrees: `a` in -90..=90, `b` in 0..360.
    pub fn degrees(self, index: u32) -> (i32, i32) {
        if index == 0 {
            (-90, 0)
        } else if index >= self.len() - 1 {
            (90, 0)
        } else {
            let (row, column) = ((index - 1) / self.turn() + 1, (index - 1) % self.turn());
            ((row * self.step) as i32 - 90, (column * self.step) as i32)
        }
    }

    /// The unit vector of direction `index`.
    pub fn direction(self, index: u32) -> Vec3 {
        self.rotation(index).row(2).as_vec3()
    }

    /// [`rotation`] for direction `index`. It is exact where an angle is a multiple of 90 degrees, so that axis-aligned
    /// faces are seen exactly edge-on.
    pub fn rotation(self, index: u32) -> DMat3 {
        let (a, b) = self.degrees(index);
        rotation_from(sin_cos_degrees(a), sin_cos_degrees(b))
    }
}

/// Sine and cosine of whole degrees, exactly symmetric between the octants of a turn.
fn sin_cos_degrees(degrees: i32) -> (f64, f64) {
    let degrees = degrees.rem_euclid(360);
    let within = degrees % 90;
    let (s, c) = if within <= 45 {
        f64::from(within).to_radians().sin_cos()
    } else {
        let (c, s) = f64::from(90 - within).to_radians().sin_cos();
        (s, c)
    };
    match degrees / 90 {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    }
}
