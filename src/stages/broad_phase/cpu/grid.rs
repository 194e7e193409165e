//! The grid: bodies by level, and on each by bucket.
//!
//! Cells are grouped into blocks of 8 x 4 x 4. A block is hashed to a run of 128 buckets, one for each of its cells: cells
//! near each other never share a bucket, so that nobody is seen twice, and neighbours along x are neighbours in memory.

use super::counting_sort::CountingSort;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::ops::Range;

/// Bodies that a thread takes at least.
const FEW: usize = 2048;

/// Size of a level's cells in radii of its largest body. Larger cells hold more bodies, smaller ones are more to look up.
/// Measured: 4 is as fast as 3 for equal sizes and a tenth slower for sizes 1:100, 2 is slower for both.
const CELL_IN_RADII: f64 = 3.0;

/// Bits of a cell's place in its block, along each axis.
const BITS: [u32; 3] = [3, 2, 2];
/// Cells in a block.
const BLOCK: u32 = 1 << (BITS[0] + BITS[1] + BITS[2]);

/// More than rounding can add to a distance that the sphere test accepts.
const SLACK: f64 = 1.0 + 2.0e-6;

/// Levels there can be, one for each two exponents of a number. With one for each, sizes 1:100 took a third longer: a body
/// looks into every coarser level.
const LEVELS: usize = 128;

/// Bodies in the grid's order.
#[derive(Default)]
pub struct Grid {
    /// Those that hold bodies, the finest first.
    pub levels: Vec<Level>,
    /// Centre and radius of each body.
    pub spheres: Vec<[f32; 4]>,
    /// Its number among all.
    pub ids: Vec<u32>,
    buckets: CountingSort,
    /// Bucket of each body, by number.
    keys: Vec<u32>,
}

/// Bodies whose radii differ by less than a factor of four.
#[derive(Clone, Copy, Debug)]
pub struct Level {
    /// The largest radius, metres.
    pub radius: f32,
    /// Where its bodies are.
    pub first: u32,
    /// And where they end.
    pub end: u32,
    cells_per_meter: f64,
    first_bucket: u32,
    /// Number of blocks, a power of two, less one.
    mask: u32,
}

/// The level of a radius: half its exponent.
fn level_of(radius: f32) -> usize {
    (radius.to_bits() >> 24) as usize & (LEVELS - 1)
}

/// How many bodies each level holds, and the largest radius there.
type Census = [(u32, f32); LEVELS];

fn census(radii: &[f32]) -> Census {
    let count = |radii: &[f32]| {
        let mut census = [(0, 0.0f32); LEVELS];
        for &radius in radii {
            let (count, largest) = &mut census[level_of(radius)];
            *count += 1;
            *largest = largest.max(radius);
        }
        census
    };
    radii.par_chunks(1 << 14).map(count).reduce(
        || [(0, 0.0); LEVELS],
        |mut one, other| {
            for ((count, largest), (more, radius)) in one.iter_mut().zip(other) {
                *count += more;
                *largest = largest.max(radius);
            }
            one
        },
    )
}

impl Level {
    fn cell(&self, at: DVec3) -> [i64; 3] {
        (at * self.cells_per_meter).to_array().map(floor)
    }

    /// The cells in which centres may lie of bodies of this level that overlap a sphere: the first and the last along each
    /// axis.
    pub fn reach(&self, [x, y, z, radius]: [f32; 4]) -> [[i64; 3]; 2] {
        let center = Vec3::new(x, y, z).as_dvec3();
        let reach = DVec3::splat((f64::from(radius) + f64::from(self.radius)) * SLACK);
        [self.cell(center - reach), self.cell(center + reach)]
    }

    /// The bucket of the first cell in a row of a block.
    fn row(&self, [block_x, y, z]: [i64; 3]) -> u32 {
        let [block_y, block_z] = [y >> BITS[1], z >> BITS[2]];
        // Odd numbers without a pattern; the high bits of the product depend on all of the block's.
        let mixed = (block_x.wrapping_mul(0x1f83_d9ab_fb41_bd6b))
            .wrapping_add(block_y.wrapping_mul(0x5be0_cd19_137e_2179))
            .wrapping_add(block_z.wrapping_mul(0x3c6e_f372_fe94_f82b));
        let mixed = (mixed ^ mixed >> 29).wrapping_mul(0x510e_527f_ade6_82d1);
        let block = (mixed >> 32) as u32 & self.mask;
        let in_block = (z as u32 & ((1 << BITS[2]) - 1)) << BITS[1] | y as u32 & ((1 << BITS[1]) - 1);
        self.first_bucket + block * BLOCK + (in_block << BITS[0])
    }
}

/// Rounds down. Without SSE 4.1 `f64::floor` is a call.
fn floor(x: f64) -> i64 {
    let whole = x as i64;
    whole - i64::from(whole as f64 > x)
}

/// The last cell of a row in its block.
const ROW: u32 = (1 << BITS[0]) - 1;

impl Grid {
    /// Fills it.
    pub fn fill(&mut self, centers: &[Vec3], radii: &[f32]) {
        self.levels.clear();
        // The number of each level in `levels`.
        let mut numbers = [0; LEVELS];
        let [mut buckets, mut bodies] = [0; 2];
        for (exponent, &(count, radius)) in census(radii).iter().enumerate() {
            if count == 0 {
                continue;
            }
            // Twice as many cells as bodies, or a few more.
            let blocks = (2 * count).div_ceil(BLOCK).next_power_of_two();
            numbers[exponent] = self.levels.len();
            self.levels.push(Level {
                radius,
                first: bodies,
                end: bodies + count,
                // Cells of bodies without size may be of any size.
                cells_per_meter: 1.0 / (CELL_IN_RADII * f64::from(radius)).max(1.0e-12),
                first_bucket: buckets,
                mask: blocks - 1,
            });
            buckets += blocks * BLOCK;
            bodies += count;
        }
        let levels = &self.levels;
        self.keys.clear();
        self.keys.par_extend(
            (centers, radii)
                .into_par_iter()
                .with_min_len(FEW)
                .map(|(center, &radius)| {
                    let level = &levels[numbers[level_of(radius)]];
                    let [x, y, z] = level.cell(center.as_dvec3());
                    level.row([x >> BITS[0], y, z]) + (x as u32 & ROW)
                }),
        );
        self.buckets.sort(buckets as usize, &self.keys);
        self.ids.clear();
        self.ids.par_extend(self.buckets.order().with_min_len(FEW));
        self.spheres.clear();
        self.spheres.par_extend(self.ids.par_iter().with_min_len(FEW).map(|&i| {
            let [x, y, z] = centers[i as usize].to_array();
            [x, y, z, radii[i as usize]]
        }));
    }

    /// Calls `run` with bodies of the level, numbered in the grid's order, until every one in these cells was among them; some
    /// others are too.
    #[inline(always)]
    pub fn visit(&self, level: &Level, [low, high]: [[i64; 3]; 2], mut run: impl FnMut(Range<usize>)) {
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                for block in low[0] >> BITS[0]..=high[0] >> BITS[0] {
                    let row = level.row([block, y, z]);
                    let first = if block == low[0] >> BITS[0] {
                        low[0] as u32 & ROW
                    } else {
                        0
                    };
                    let last = if block == high[0] >> BITS[0] {
                        high[0] as u32 & ROW
                    } else {
                        ROW
                    };
                    let bodies = self.buckets.range(row + first, row + last);
                    if !bodies.is_empty() {
                        run(bodies);
                    }
                }
            }
        }
    }
}
