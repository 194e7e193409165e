//! Support heights: a rigorous upper bound on the extent of a mesh in any direction.
//!
//! The support height of a point set in direction `u` is `h(u) = max over its points v of v . u`. It is convex and
//! positively homogeneous, so `h(u) <= sum(l_i * h(u_i))` for `u = sum(l_i * u_i)` with `l_i >= 0`. Within the triangle
//! of three baked directions, interpolation of their heights therefore gives an upper bound without any margin.
//!
//! The interpolated height is linear in `u`: it is `p . u` for one point `p` per triangle, the common point of the
//! three planes `p . u_i = h(u_i)`. These *virtual support points* are precomputed, so a query only has to find the
//! triangle.
//!
//! The directions are the points with integer coordinates on the octahedron `|x| + |y| + |z| = 8`. Straight lines on
//! its faces project to great circles, so the flat triangle that contains `u` is exactly the spherical one. Finding it
//! takes one division and a few roundings.

use glam::{DMat3, DVec3, Vec3};
use std::sync::OnceLock;

/// Steps along an edge of the octahedron.
pub(crate) const STEPS: usize = 8;
/// The number of directions: the points of the octahedron with integer coordinates.
const DIRECTIONS: usize = 4 * STEPS * STEPS + 2;
/// Triangles per octant.
const PER_OCTANT: usize = STEPS * STEPS;

/// Added to each height, relative to the largest distance of a point from the origin. The errors from rounding `p`,
/// from evaluating `p . u` in `f32`, and from choosing a neighbouring triangle because `u` was rounded add up to less
/// than a third of it.
const PADDING: f64 = 2.0e-6;
/// Added to each height as well, so that the padding does not underflow for tiny meshes.
const MIN_PADDING: f64 = 1.0e-36;

/// The support heights of a point set in a few hundred baked directions; an upper bound in all other directions.
#[derive(Clone, Debug, PartialEq)]
pub struct SupportHeights {
    heights: Vec<f32>,
    /// The virtual support point of each triangle, by octant; see [`triangle_of`].
    points: Vec<Vec3>,
}

/// The baked directions and the triangles between them.
struct Lattice {
    /// Unit vectors.
    directions: Vec<DVec3>,
    /// Three directions each.
    triangles: Vec<[usize; 3]>,
    /// For each triangle, the matrix that maps its three heights to the virtual support point.
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

/// The index of the triangle whose cone contains `u`. Triangles are ordered by octant, then by row: row `i` has
/// `2 * (STEPS - i) - 1` triangles that alternately point up and down.
///
/// On a border both triangles are right, because their heights agree there. Near a border rounding may choose the wrong
/// one; the padding covers that.
#[inline]
fn triangle_of(u: Vec3) -> usize {
    const N: f32 = STEPS as f32;
    let (x, y, z) = (u.x.abs(), u.y.abs(), u.z.abs());
    let mut scale = N / (x + y + z);
    let (mut x, mut y) = (x, y);
    // The sum overflowed, or its reciprocal would overflow.
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

/// Absolute x and y, and a scale for them, for vectors whose sum of components overflows or underflows. Zero and NaN
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
    /// Bakes the support heights of `points`, relative to the origin. Without points the heights are those of the
    /// origin alone.
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
        let padding = radius * PADDING + MIN_PADDING;
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

    /// The stored heights, one per baked direction: upper bounds of `v . d` for the unit vectors `d`, in the unit of
    /// the points.
    pub fn heights(&self) -> &[f32] {
        &self.heights
    }

    /// The virtual support points, 64 per octant; see [`SupportHeights::support`].
    pub fn points(&self) -> &[Vec3] {
        &self.points
    }

    /// Support heights from stored [`SupportHeights::heights`]; `None` if their number is wrong or a value is not
    /// finite.
    pub fn from_heights(heights: Vec<f32>) -> Option<Self> {
        if heights.len() != DIRECTIONS || !heights.iter().all(|h| h.is_finite()) {
            return None;
        }
        let baked = Self::with(heights);
        // Heights near the limit of f32 can make a virtual support point overflow.
        baked.points.iter().all(|p| p.is_finite()).then_some(baked)
    }

    /// The virtual support point for `u`: a point `p` with `p . u >= v . u` for all baked points `v`. `u` need not have
    /// unit length.
    ///
    /// `p` is the intersection of the planes at the baked heights of the three directions around `u`, and `p . u` is
    /// the interpolated height. It replaces a support point in Gilbert's iteration. All bounds found with it are valid,
    /// but `p` may be outside other planes of the polyhedron, so the iteration need not converge to the true distance.
    ///
    /// The bound holds for every finite `u`. It also holds if `p . u` and `v . u` are evaluated in `f32`, unless the
    /// products overflow or underflow. For zero and NaN `p` belongs to an unspecified triangle.
    #[inline]
    pub fn support(&self, u: Vec3) -> Vec3 {
        self.points[triangle_of(u)]
    }

    /// The size in memory, in bytes.
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
