//! Support heights: how far a mesh reaches in any direction, as a rigorous upper bound.
//!
//! The height of a point set in direction `u` is `h(u) = max over its points v of v . u`. It is convex and positively
//! homogeneous, so for `u = sum(l_i * u_i)` with `l_i >= 0`: `h(u) <= sum(l_i * h(u_i))`. Inside the triangle spanned by
//! three baked directions, interpolating their heights is therefore an upper bound with nothing added.
//!
//! The interpolated height is linear in `u`, so it is `p . u` for one point `p` per triangle: the common point of the
//! three planes `p . u_i = h(u_i)`. These *virtual support points* are computed beforehand, and a query only finds the
//! triangle. The directions are the points with integer coordinates on the octahedron `|x| + |y| + |z| = 8`: straight
//! lines on its faces become great circles, so the flat triangle that holds `u` is the spherical one exactly, and finding
//! it takes a division and a few roundings.

use glam::{DMat3, DVec3, Vec3};
use std::sync::OnceLock;

/// Steps along an edge of the octahedron.
pub(crate) const STEPS: usize = 8;
/// Directions: the octahedron's points with integer coordinates.
const DIRECTIONS: usize = 4 * STEPS * STEPS + 2;
/// Triangles per octant.
const PER_OCTANT: usize = STEPS * STEPS;

/// Added to every height, as a share of the points' largest distance from the origin. Rounding `p`, evaluating `p . u`
/// in `f32`, and choosing a neighbouring triangle because `u` was rounded together stay below a third of it.
const PADDING: f64 = 2.0e-6;
/// Added as well, so that the padding does not vanish where `f32` has no digits left.
const SMALLEST_PADDING: f64 = 1.0e-36;

/// Support heights of a point set in a few hundred baked directions.
#[derive(Clone, Debug, PartialEq)]
pub struct SupportHeights {
    heights: Vec<f32>,
    /// Per octant and triangle the virtual support point; see [`triangle_of`].
    points: Vec<Vec3>,
}

/// The baked directions and the triangles between them.
struct Lattice {
    /// Unit vectors.
    directions: Vec<DVec3>,
    /// Three directions each.
    triangles: Vec<[usize; 3]>,
    /// Per triangle the matrix that takes three heights to the virtual support point.
    solvers: Vec<DMat3>,
}

fn lattice() -> &'static Lattice {
    static LATTICE: OnceLock<Lattice> = OnceLock::new();
    LATTICE.get_or_init(Lattice::new)
}

impl Lattice {
    fn new() -> Self {
        const N: i32 = STEPS as i32;
        let mut index = vec![usize::MAX; (2 * STEPS + 1).pow(3)];
        let slot = |[x, y, z]: [i32; 3]| (((x + N) * (2 * N + 1) + y + N) * (2 * N + 1) + z + N) as usize;
        let mut directions = Vec::with_capacity(DIRECTIONS);
        for x in -N..=N {
            for y in -(N - x.abs())..=N - x.abs() {
                let z = N - x.abs() - y.abs();
                for z in if z == 0 { vec![0] } else { vec![-z, z] } {
                    index[slot([x, y, z])] = directions.len();
                    directions.push(DVec3::new(x.into(), y.into(), z.into()).normalize());
                }
            }
        }
        let mut triangles = Vec::with_capacity(8 * PER_OCTANT);
        for octant in 0..8 {
            let at = |i: i32, j: i32| {
                let sign = |bit: i32, x: i32| if octant >> bit & 1 == 1 { -x } else { x };
                index[slot([sign(0, i), sign(1, j), sign(2, N - i - j)])]
            };
            for i in 0..N {
                for j in 0..N - i {
                    triangles.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
                    if i + j < N - 1 {
                        triangles.push([at(i + 1, j + 1), at(i, j + 1), at(i + 1, j)]);
                    }
                }
            }
        }
        let solvers = triangles
            .iter()
            .map(|t| {
                DMat3::from_cols_array_2d(&t.map(|d| directions[d].to_array()))
                    .transpose()
                    .inverse()
            })
            .collect();
        Self {
            directions,
            triangles,
            solvers,
        }
    }
}

/// The triangle whose cone holds `u`: octant, then row `i` of `2 * (STEPS - i) - 1` triangles, pointing up and down in turn.
///
/// On a border either side will do, since the heights agree there; next to it rounding may choose the wrong one, which
/// the padding covers.
#[inline]
fn triangle_of(u: Vec3) -> usize {
    const N: f32 = STEPS as f32;
    let (x, y, z) = (u.x.abs(), u.y.abs(), u.z.abs());
    let mut scale = N / (x + y + z);
    let (mut x, mut y) = (x, y);
    // The sum has overflowed, or is so small that its reciprocal would.
    if !(scale > 1.0e-37 && scale < 1.0e37) {
        (x, y, scale) = rescaled(u);
    }
    let (x, y) = (x * scale, y * scale);
    let i = (x as i32).min(STEPS as i32 - 1);
    let j = (y as i32).min(STEPS as i32 - 1 - i);
    let down = x - i as f32 + (y - j as f32) > 1.0 && i + j < STEPS as i32 - 1;
    let octant = (u.x.to_bits() >> 31 | (u.y.to_bits() >> 31) << 1 | (u.z.to_bits() >> 31) << 2) as usize;
    octant * PER_OCTANT + (i * (2 * STEPS as i32 - i) + 2 * j) as usize + usize::from(down)
}

/// Absolute x and y with a scale that fits, for vectors whose components' sum is not an ordinary number. Zero and NaN
/// get a scale of 0.
#[cold]
fn rescaled(u: Vec3) -> (f32, f32, f32) {
    let u = u.as_dvec3().abs();
    let sum = u.x + u.y + u.z;
    if sum > 0.0 && sum.is_finite() {
        let u = u / sum;
        (u.x as f32, u.y as f32, STEPS as f32)
    } else {
        (0.0, 0.0, 0.0)
    }
}

impl SupportHeights {
    /// Bakes the heights of `points`, measured from the origin. Without points they are those of the origin.
    pub fn of(points: impl Iterator<Item = Vec3>) -> Self {
        let directions = &lattice().directions;
        let mut heights = vec![f64::NEG_INFINITY; DIRECTIONS];
        let mut radius = 0.0_f64;
        for p in points {
            let p = p.as_dvec3();
            radius = radius.max(p.length());
            for (height, d) in heights.iter_mut().zip(directions) {
                *height = height.max(d.dot(p));
            }
        }
        let padding = radius * PADDING + SMALLEST_PADDING;
        let heights = heights
            .into_iter()
            .map(|h| round_up(if h == f64::NEG_INFINITY { padding } else { h + padding }))
            .collect();
        Self::with(heights)
    }

    fn with(heights: Vec<f32>) -> Self {
        let lattice = lattice();
        let points = lattice
            .triangles
            .iter()
            .zip(&lattice.solvers)
            .map(|(t, solver)| (*solver * DVec3::from_array(t.map(|d| f64::from(heights[d])))).as_vec3())
            .collect();
        Self { heights, points }
    }

    /// The stored heights, one per baked direction: upper bounds of `v . d` for unit vectors `d`, in the points' units.
    pub fn heights(&self) -> &[f32] {
        &self.heights
    }

    /// The virtual support points, 64 triangles an octant; see [`SupportHeights::support`].
    pub fn points(&self) -> &[Vec3] {
        &self.points
    }

    /// Heights read from a file; `None` if there are not exactly as many as directions, or one is not finite.
    pub fn from_heights(heights: Vec<f32>) -> Option<Self> {
        if heights.len() != DIRECTIONS || !heights.iter().all(|h| h.is_finite()) {
            return None;
        }
        let baked = Self::with(heights);
        // Heights near the end of f32's range could put a virtual point beyond it.
        baked.points.iter().all(|p| p.is_finite()).then_some(baked)
    }

    /// A point `p` with `p . u >= max over the baked points of v . u`. `u` need not have unit length.
    ///
    /// `p` is where the planes at the baked heights of the three directions around `u` meet, and `p . u` is the
    /// interpolated height. It stands in for a support point in Gilbert's iteration: every bound found with it is valid,
    /// but other planes may cut `p` off, so the iteration need not converge to the polyhedron's true distance.
    ///
    /// The bound holds for every finite `u`, and also for `p . u` and `v . u` evaluated in `f32`, as long as the
    /// products are not so small or large that `f32` loses digits. For zero and NaN `p` is the point of some triangle.
    #[inline]
    pub fn support(&self, u: Vec3) -> Vec3 {
        self.points[triangle_of(u)]
    }

    /// Bytes that the heights occupy in memory.
    pub fn memory_bytes(&self) -> usize {
        size_of::<Self>() + self.heights.capacity() * size_of::<f32>() + self.points.capacity() * size_of::<Vec3>()
    }
}

/// The smallest `f32` that is not below `x`.
fn round_up(x: f64) -> f32 {
    let rounded = x as f32;
    if f64::from(rounded) < x {
        rounded.next_up()
    } else {
        rounded
    }
}
