//! A hashed grid: bodies sorted by level, and within a level by bucket.
//!
//! Cells are grouped into blocks of 8 x 4 x 4. A block is hashed to a run of 128 buckets, one for each of its cells.
//! Cells near each other therefore never share a bucket, so no body is found twice, and neighbouring cells along x are
//! neighbours in memory.

use super::counting_sort::CountingSort;
use crate::parallel::loops;
use crate::simd::lanes::{SimdBase, SimdFrom, bitmask, f32x8, splat};
use crate::simd::level::baseline;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::ops::Range;

/// Minimum number of bodies per thread.
const MIN_BODIES: usize = 2048;

/// Smallest cell size of a level in radii of its largest body. Larger cells hold more bodies, smaller ones need more
/// lookups. Measured: 3 is as fast, 2 is a tenth slower.
const CELL_SIZE_IN_RADII: f64 = 4.0;

/// The cell size of a level doubles, or halves again, if the mean number of bodies in a body's cell, itself included,
/// leaves this range. Where bodies are sparse, larger cells mean fewer lookups. Doubling the size finds up to eight
/// times as many bodies per cell, and by chance alone half a body shares the bucket.
const OCCUPANCY: [f32; 2] = [1.75, 10.0];
/// Above this mean occupancy the cell size returns to the smallest at once.
const MAX_OCCUPANCY: f32 = 64.0;
/// Largest number of doublings.
const MAX_DOUBLINGS: u8 = 20;
/// Number of blocks per level that are sampled to measure the occupancy.
const SAMPLED_BLOCKS: u32 = 64;

/// Spheres per SIMD test.
const LANES: usize = 8;

/// Bits of a cell's position within its block, along each axis.
const BLOCK_BITS: [u32; 3] = [3, 2, 2];
/// Cells per block.
const BLOCK_CELLS: u32 = 1 << (BLOCK_BITS[0] + BLOCK_BITS[1] + BLOCK_BITS[2]);

/// Factor on the squared sum of the radii in the sphere test, for rounding.
pub(crate) const SPHERE_SLACK: f32 = 1.0 + 1.0e-6;
/// Factor that exceeds the rounding error of a distance that the sphere test accepts.
const ROUNDING: f64 = 1.0 + 2.0e-6;

/// Maximum number of levels: one for every two exponents of a float. With a level for each exponent, sizes of 1:100
/// took a third longer, because a body searches every coarser level.
const LEVEL_COUNT: usize = 128;

/// Some of the bodies, in grid order: by level, then by bucket.
#[derive(Default)]
pub struct Grid {
    /// Levels that hold bodies, the finest first.
    pub levels: Vec<Level>,
    /// Centre and radius of each body, padded at the end for SIMD loads.
    spheres: [Vec<f32>; 4],
    /// Index of each body.
    pub ids: Vec<u32>,
    buckets: CountingSort,
    /// Bucket of each body, in input order.
    keys: Vec<u32>,
    /// Number of doublings of each level's cell size.
    doublings: Vec<u8>,
    /// Whether the cells of some level are so full that the bodies should be sorted again.
    overfull: bool,
    /// Whether its order follows from the bodies alone.
    is_canonical: bool,
}

/// A level: bodies whose radii differ by less than a factor of four.
#[derive(Clone, Copy, Debug)]
pub struct Level {
    /// Index of the level; ascends with the radii.
    pub number: usize,
    /// Whether its cells have been enlarged.
    pub is_coarsened: bool,
    /// Largest radius, metres.
    pub radius: f32,
    /// Start of its bodies.
    pub first: u32,
    /// End of its bodies.
    pub end: u32,
    cells_per_meter: f64,
    first_bucket: u32,
    /// Number of blocks, a power of two, minus one.
    mask: u32,
}

/// Level of a body: half the exponent of its radius.
fn level_of(radius: f32) -> usize {
    (radius.to_bits() >> 24) as usize % LEVEL_COUNT
}

/// Number of bodies and largest radius of each level.
type Census = [(u32, f32); LEVEL_COUNT];

fn census(radii: &[f32], members: &[u32]) -> Census {
    let count = |members: &[u32]| {
        let mut census = [(0, 0.0f32); LEVEL_COUNT];
        for &i in members {
            let radius = radii[i as usize];
            let (count, largest) = &mut census[level_of(radius)];
            *count += 1;
            *largest = largest.max(radius);
        }
        census
    };
    loops::reduce(
        members.par_chunks(1 << 14).map(count),
        || [(0, 0.0); LEVEL_COUNT],
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
    /// Bodies of the level within `range`.
    pub fn part_of(&self, range: &Range<usize>) -> Range<usize> {
        range.start.max(self.first as usize)..range.end.min(self.end as usize)
    }

    /// The cell that contains a point.
    fn cell(&self, at: DVec3) -> [i64; 3] {
        (at * self.cells_per_meter).to_array().map(floor)
    }

    /// The cells that may hold centres of bodies of this level that overlap the sphere: the first and the last along
    /// each axis.
    pub fn cells_overlapping(&self, [x, y, z, radius]: [f32; 4]) -> [[i64; 3]; 2] {
        let center = Vec3::new(x, y, z).as_dvec3();
        let reach = DVec3::splat((f64::from(radius) + f64::from(self.radius)) * ROUNDING);
        [self.cell(center - reach), self.cell(center + reach)]
    }

    /// About how many cells all bodies of this level look at in another level.
    pub fn cost_of_searching(&self, other: &Self) -> f64 {
        let reach = f64::from(self.radius) + f64::from(other.radius);
        let cells = 2.0 * reach * other.cells_per_meter + 1.0;
        f64::from(self.end - self.first) * cells.powi(3)
    }

    /// Bucket of the first cell in a row of a block.
    fn row(&self, [block_x, y, z]: [i64; 3]) -> u32 {
        let [block_y, block_z] = [y >> BLOCK_BITS[1], z >> BLOCK_BITS[2]];
        // Odd multipliers without a pattern; the high bits of the product depend on all bits of the block.
        let mixed = (block_x.wrapping_mul(0x1f83_d9ab_fb41_bd6b))
            .wrapping_add(block_y.wrapping_mul(0x5be0_cd19_137e_2179))
            .wrapping_add(block_z.wrapping_mul(0x3c6e_f372_fe94_f82b));
        let mixed = (mixed ^ mixed >> 29).wrapping_mul(0x510e_527f_ade6_82d1);
        let block = (mixed >> 32) as u32 & self.mask;
        let in_block = (z as u32 & ((1 << BLOCK_BITS[2]) - 1)) << BLOCK_BITS[1] | y as u32 & ((1 << BLOCK_BITS[1]) - 1);
        self.first_bucket + block * BLOCK_CELLS + (in_block << BLOCK_BITS[0])
    }
}

/// Rounds down. Without SSE 4.1 `f64::floor` is a function call.
fn floor(x: f64) -> i64 {
    let whole = x as i64;
    whole - i64::from(whole as f64 > x)
}

/// Index of the last cell of a row within its block.
const ROW_END: u32 = (1 << BLOCK_BITS[0]) - 1;

impl Grid {
    /// Whether the grid already holds exactly these `count` members with unchanged centres and radii.
    pub fn holds(
        &self,
        count: usize,
        is_member: impl Fn(usize) -> bool + Sync,
        centers: &[Vec3],
        radii: &[f32],
    ) -> bool {
        let [x, y, z, r] = &self.spheres;
        self.ids.len() == count
            && loops::all(
                (&self.ids, x, y, z, r).into_par_iter(),
                MIN_BODIES,
                |(&i, &x, &y, &z, &r)| {
                    let i = i as usize;
                    i < centers.len() && is_member(i) && centers[i].to_array() == [x, y, z] && radii[i] == r
                },
            )
    }

    /// Fills the grid with the bodies `members`. Returns whether cell sizes should change; the next call uses the new
    /// sizes.
    pub fn fill(&mut self, members: &[u32], centers: &[Vec3], radii: &[f32]) -> bool {
        self.is_canonical = false;
        self.sort(members, centers, radii);
        self.copy_spheres(centers, radii);
        self.adapt()
    }

    /// Fills the grid so that its order follows from the bodies alone, neither from threads nor from earlier calls:
    /// where a search ends early, the order decides what it finds.
    pub fn fill_canonically(&mut self, members: &[u32], centers: &[Vec3], radii: &[f32]) {
        self.doublings.clear();
        for bucket in 0..self.sort(members, centers, radii) {
            self.ids[self.buckets.range(bucket, bucket)].sort_unstable();
        }
        self.copy_spheres(centers, radii);
        self.adapt();
        self.is_canonical = true;
    }

    /// Whether [`Grid::fill_canonically`] filled it.
    pub fn is_canonical(&self) -> bool {
        self.is_canonical
    }

    /// Sorts the bodies `members` into levels and cells. Returns the number of buckets.
    fn sort(&mut self, members: &[u32], centers: &[Vec3], radii: &[f32]) -> u32 {
        self.levels.clear();
        self.doublings.resize(LEVEL_COUNT, 0);
        // Index of each level in `levels`.
        let mut places = [0; LEVEL_COUNT];
        let [mut buckets, mut bodies] = [0; 2];
        for (number, &(count, radius)) in census(radii, members).iter().enumerate() {
            if count == 0 {
                continue;
            }
            // At least twice as many cells as bodies.
            let blocks = (2 * count).div_ceil(BLOCK_CELLS).next_power_of_two();
            places[number] = self.levels.len();
            let size = CELL_SIZE_IN_RADII * f64::from(radius) * f64::from(1 << self.doublings[number]);
            self.levels.push(Level {
                number,
                is_coarsened: self.doublings[number] > 0,
                radius,
                first: bodies,
                end: bodies + count,
                // For bodies of zero radius any cell size will do.
                cells_per_meter: 1.0 / size.max(1.0e-12),
                first_bucket: buckets,
                mask: blocks - 1,
            });
            buckets += blocks * BLOCK_CELLS;
            bodies += count;
        }
        let levels = &self.levels;
        let keys = members.par_iter().map(|&i| {
            let level = &levels[places[level_of(radii[i as usize])]];
            let [x, y, z] = level.cell(centers[i as usize].as_dvec3());
            level.row([x >> BLOCK_BITS[0], y, z]) + (x as u32 & ROW_END)
        });
        loops::collect(keys, MIN_BODIES, &mut self.keys);
        self.buckets.sort(buckets as usize, &self.keys);
        let order = self.buckets.order();
        loops::collect(order.map(|at| members[at as usize]), MIN_BODIES, &mut self.ids);
        buckets
    }

    /// Copies the spheres of the bodies in the order of `ids`.
    fn copy_spheres(&mut self, centers: &[Vec3], radii: &[f32]) {
        // All values but the padding are overwritten.
        let n = self.ids.len();
        let [x, y, z, r] = self.spheres.each_mut().map(|numbers| {
            numbers.resize(n + LANES, 0.0);
            &mut numbers[..n]
        });
        let all = (&self.ids, x, y, z, r).into_par_iter();
        loops::for_each(all, MIN_BODIES, |(&i, x, y, z, r)| {
            [*x, *y, *z] = centers[i as usize].to_array();
            *r = radii[i as usize];
        });
    }

    /// Whether bodies have gathered so fast that they should be sorted again into smaller cells.
    pub fn is_overfull(&self) -> bool {
        self.overfull
    }

    /// Chooses the cell sizes of the next call. Returns whether any changes.
    fn adapt(&mut self) -> bool {
        let mut changed = false;
        self.overfull = false;
        for level in &self.levels {
            let blocks = level.mask + 1;
            let (mut bodies, mut squares) = (0.0, 0.0);
            for block in (0..blocks).step_by(blocks.div_ceil(SAMPLED_BLOCKS) as usize) {
                for cell in 0..BLOCK_CELLS {
                    let bucket = level.first_bucket + block * BLOCK_CELLS + cell;
                    let count = self.buckets.range(bucket, bucket).len() as f32;
                    bodies += count;
                    squares += count * count;
                }
            }
            let doublings = &mut self.doublings[level.number];
            let occupancy = squares / bodies;
            self.overfull |= *doublings > 0 && occupancy > MAX_OCCUPANCY;
            let wanted = match occupancy {
                occupancy if occupancy > MAX_OCCUPANCY => 0,
                occupancy if occupancy > OCCUPANCY[1] => doublings.saturating_sub(1),
                occupancy if occupancy < OCCUPANCY[0] => MAX_DOUBLINGS.min(*doublings + 1),
                // Also if no sample holds a body (NaN).
                _ => *doublings,
            };
            changed |= std::mem::replace(doublings, wanted) != wanted;
        }
        changed
    }

    /// Centre and radius of a body. This and the functions below use indices in grid order.
    pub fn sphere(&self, i: usize) -> [f32; 4] {
        self.spheres.each_ref().map(|numbers| numbers[i])
    }

    /// Cell of a body.
    pub fn cell(&self, level: &Level, i: usize) -> [i64; 3] {
        let [x, y, z, _] = self.sphere(i);
        level.cell(Vec3::new(x, y, z).as_dvec3())
    }

    /// Returns the end of a cell's bodies, and writes the runs of bodies in the neighbouring cells that come after it.
    pub fn later_neighbors(&self, level: &Level, [x, y, z]: [i64; 3], runs: &mut Vec<Range<usize>>) -> usize {
        runs.clear();
        self.rows(level, [[x + 1, y, z], [x + 1, y, z]], runs);
        for (dy, dz) in [(1, 0), (-1, 1), (0, 1), (1, 1)] {
            self.rows(level, [[x - 1, y + dy, z + dz], [x + 1, y + dy, z + dz]], runs);
        }
        let bucket = level.row([x >> BLOCK_BITS[0], y, z]) + (x as u32 & ROW_END);
        self.buckets.range(bucket, bucket).end
    }

    /// Adds runs that contain all bodies of the cells from `low` to `high` along each axis. Hash collisions add other
    /// bodies.
    pub fn rows(&self, level: &Level, [low, high]: [[i64; 3]; 2], runs: &mut Vec<Range<usize>>) {
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                for block in low[0] >> BLOCK_BITS[0]..=high[0] >> BLOCK_BITS[0] {
                    let row = level.row([block, y, z]);
                    let first = if block == low[0] >> BLOCK_BITS[0] {
                        low[0] as u32 & ROW_END
                    } else {
                        0
                    };
                    let last = if block == high[0] >> BLOCK_BITS[0] {
                        high[0] as u32 & ROW_END
                    } else {
                        ROW_END
                    };
                    let bodies = self.buckets.range(row + first, row + last);
                    if !bodies.is_empty() {
                        runs.push(bodies);
                    }
                }
            }
        }
    }

    /// Calls `found` with each body of `others` whose sphere overlaps this one.
    #[inline(always)]
    pub fn overlaps(&self, sphere: [f32; 4], others: Range<usize>, mut found: impl FnMut(usize) -> bool) {
        let simd = baseline();
        let [x, y, z, r] = sphere.map(|value| splat(simd, value));
        for first in others.clone().step_by(LANES) {
            let some = |numbers: &Vec<f32>| {
                let some: [f32; LANES] = numbers[first..first + LANES].try_into().expect("as many");
                f32x8::simd_from(simd, some)
            };
            let [p, q, o, other] = self.spheres.each_ref().map(some);
            let [dx, dy, dz] = [x - p, y - q, z - o];
            let reach = r + other;
            let overlap = (dx * dx + dy * dy + dz * dz).simd_le(reach * reach * splat(simd, SPHERE_SLACK));
            let mut hits = bitmask(overlap);
            while hits != 0 {
                let i = first + hits.trailing_zeros() as usize;
                if i < others.end && !found(i) {
                    return;
                }
                hits &= hits - 1;
            }
        }
    }
}
