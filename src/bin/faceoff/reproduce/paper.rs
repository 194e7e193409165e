//! What Aly & Elawady 2010 printed.

/// A row of their table 1: broad and narrow phase on a GeForce 8800 GTX.
pub struct Printed {
    pub bodies: usize,
    pub pairs: u32,
    pub knot_ms: f64,
    pub torus_ms: f64,
}

const fn row(bodies: usize, pairs: u32, knot_ms: f64, torus_ms: f64) -> Printed {
    Printed {
        bodies,
        pairs,
        knot_ms,
        torus_ms,
    }
}

/// Table 1 of H. A. Aly, T. A. E. Elawady, "A New Narrow Phase Collision Detection Algorithm Using Height Projection",
/// EDERC 2010.
pub const TABLE_1: [Printed; 22] = [
    row(100, 70, 53.16, 31.56),
    row(200, 160, 113.6, 64.92),
    row(300, 254, 194.1, 100.6),
    row(400, 338, 234.4, 138.76),
    row(500, 412, 280.91, 156.81),
    row(600, 496, 343.2, 188.44),
    row(700, 570, 395.43, 220.65),
    row(800, 704, 435.76, 257.74),
    row(900, 800, 475.99, 293.76),
    row(1000, 870, 516.43, 322.66),
    row(1100, 952, 556.8, 349.79),
    row(1200, 1040, 593.98, 377.82),
    row(1300, 1088, 627.1, 389.85),
    row(1400, 1196, 648.8, 446.86),
    row(1500, 1240, 679.23, 469.87),
    row(1600, 1300, 701.42, 485.22),
    row(1700, 1370, 749.9, 504.32),
    row(1800, 1405, 788.2, 521.78),
    row(1900, 1486, 823.86, 537.8),
    row(2000, 1530, 854.3, 561.17),
    row(2100, 1614, 894.3, 585.38),
    row(2200, 1653, 936.45, 603.2),
];

/// The most bodies in their figure 7.
pub const FIGURE_7_BODIES: usize = 3000;

/// Collided pairs in their figure 7.
pub const FIGURE_7_PAIRS: usize = 30;
