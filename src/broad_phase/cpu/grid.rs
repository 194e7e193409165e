//! A grid: some of the bodies by level, and on each level by bucket.
//!
//! Cells are grouped into blocks of 8 x 4 x 4. A block is hashed to a run of 128 buckets, one for each of its cells: cells
//! near each other never share a bucket, so that nobody is seen twice, and neighbours along x are neighbours in memory.

use super::counting_sort::CountingSort;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::ops::Range;
use wide::f32x8;

/// Bodies that a thread takes at least.
const FEW: usize = 2048;

/// Least size of a level's cells in radii of its largest body. Larger cells hold more bodies, smaller ones are more to look
/// up. Measured: 3 is as fast, 2 a tenth slower.
const CELL_IN_RADII: f64 = 4.0;

/// A level's cells become twice as large, or half as large again, if bodies have fewer or more in their cell than this, on
/// average, themselves among them: where bodies are few and far between, one looks into fewer cells. Twice the size makes
/// up to eight times the others, and by chance alone half a body shares the bucket.
const OCCUPANCY: [f32; 2] = [1.75, 10.0];
/// With more than this, they start anew with the least size.
const OVERFULL: f32 = 64.0;
/// Cells become at most `2^MAX_GROWN` times as large as the least.
const MAX_GROWN: u8 = 20;
/// How many blocks of cells of a level are looked into to learn how full they are.
const SAMPLES: u32 = 64;

/// Spheres tested at once.
const LANES: usize = 8;

/// Bits of a cell's place in its block, along each axis.
const BITS: [u32; 3] = [3, 2, 2];
/// Cells in a block.
const BLOCK: u32 = 1 << (BITS[0] + BITS[1] + BITS[2]);

/// Spheres overlap if the square of their distance is no more than this times that of their radii together: for rounding.
pub(crate) const SPHERE_SLACK: f32 = 1.0 + 1.0e-6;
/// More than rounding can add to a distance that the sphere test accepts.
const SLACK: f64 = 1.0 + 2.0e-6;

/// Levels there can be: one for every two exponents of a number. With levels for each exponent, sizes 1:100 took a third
/// longer: a body looks into every coarser level.
const LEVELS: usize = 128;

/// Bodies in the grid's order.
#[derive(Default)]
pub struct Grid {
    /// Those that hold bodies, the finest first.
    pub levels: Vec<Level>,
    /// Centre and radius of each body, and some more at the end.
    spheres: [Vec<f32>; 4],
    /// Its number among all.
    pub ids: Vec<u32>,
    buckets: CountingSort,
    /// Bucket of each body, in the order in which they came.
    keys: Vec<u32>,
    /// How often the size of each level's cells is doubled.
    grown: Vec<u8>,
    /// Some level's cells are so full that they should not be searched.
    overfull: bool,
}

/// Bodies whose radii differ by less than a factor of four.
#[derive(Clone, Copy, Debug)]
pub struct Level {
    /// Ascends with the radii.
    pub number: usize,
    /// Whether cells are larger than the least size.
    pub is_sparse: bool,
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

/// The number of a body's level: half the exponent of the radius.
fn level_of(radius: f32) -> usize {
    (radius.to_bits() >> 24) as usize % LEVELS
}

/// How many bodies each level holds, and the largest radius there.
type Census = [(u32, f32); LEVELS];

fn census(radii: &[f32], members: &[u32]) -> Census {
    let count = |members: &[u32]| {
        let mut census = [(0, 0.0f32); LEVELS];
        for &i in members {
            let radius = radii[i as usize];
            let (count, largest) = &mut census[level_of(radius)];
            *count += 1;
            *largest = largest.max(radius);
        }
        census
    };
    members.par_chunks(1 << 14).map(count).reduce(
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
    /// Those of its bodies that are in `range`.
    pub fn part_of(&self, range: &Range<usize>) -> Range<usize> {
        range.start.max(self.first as usize)..range.end.min(self.end as usize)
    }

    /// The cell in which a point lies.
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
    /// Whether it holds all of so many members, where they are now and as large.
    pub fn holds(
        &self,
        count: usize,
        is_member: impl Fn(usize) -> bool + Sync,
        centers: &[Vec3],
        radii: &[f32],
    ) -> bool {
        let [x, y, z, r] = &self.spheres;
        self.ids.len() == count
            && (&self.ids, x, y, z, r)
                .into_par_iter()
                .with_min_len(FEW)
                .all(|(&i, &x, &y, &z, &r)| {
                    let i = i as usize;
                    i < centers.len() && is_member(i) && centers[i].to_array() == [x, y, z] && radii[i] == r
                })
    }

    /// Fills it with those bodies that are `members`, and tells whether its cells would better be of other sizes, which they
    /// will be the next time.
    pub fn fill(&mut self, members: &[u32], centers: &[Vec3], radii: &[f32]) -> bool {
        self.levels.clear();
        self.grown.resize(LEVELS, 0);
        // Where each level is in `levels`.
        let mut places = [0; LEVELS];
        let [mut buckets, mut bodies] = [0; 2];
        for (number, &(count, radius)) in census(radii, members).iter().enumerate() {
            if count == 0 {
                continue;
            }
            // Twice as many cells as bodies, or a few more.
            let blocks = (2 * count).div_ceil(BLOCK).next_power_of_two();
            places[number] = self.levels.len();
            let size = CELL_IN_RADII * f64::from(radius) * f64::from(1 << self.grown[number]);
            self.levels.push(Level {
                number,
                is_sparse: self.grown[number] > 0,
                radius,
                first: bodies,
                end: bodies + count,
                // Cells of bodies without size may be of any size.
                cells_per_meter: 1.0 / size.max(1.0e-12),
                first_bucket: buckets,
                mask: blocks - 1,
            });
            buckets += blocks * BLOCK;
            bodies += count;
        }
        let levels = &self.levels;
        self.keys.clear();
        self.keys.par_extend(members.par_iter().with_min_len(FEW).map(|&i| {
            let level = &levels[places[level_of(radii[i as usize])]];
            let [x, y, z] = level.cell(centers[i as usize].as_dvec3());
            level.row([x >> BITS[0], y, z]) + (x as u32 & ROW)
        }));
        self.buckets.sort(buckets as usize, &self.keys);
        self.ids.clear();
        let order = self.buckets.order().with_min_len(FEW);
        self.ids.par_extend(order.map(|at| members[at as usize]));
        // Values of the last step are overwritten.
        let n = self.ids.len();
        let [x, y, z, r] = self.spheres.each_mut().map(|numbers| {
            numbers.resize(n + LANES, 0.0);
            &mut numbers[..n]
        });
        let all = (&self.ids, x, y, z, r).into_par_iter().with_min_len(FEW);
        all.for_each(|(&i, x, y, z, r)| {
            [*x, *y, *z] = centers[i as usize].to_array();
            *r = radii[i as usize];
        });
        self.adapt()
    }

    /// Whether bodies have come together so fast that they should be sorted again, into smaller cells.
    pub fn is_overfull(&self) -> bool {
        self.overfull
    }

    /// Chooses the sizes of cells for the next time; whether any changes.
    fn adapt(&mut self) -> bool {
        let mut changed = false;
        self.overfull = false;
        for level in &self.levels {
            let blocks = level.mask + 1;
            let (mut bodies, mut squares) = (0.0, 0.0);
            for block in (0..blocks).step_by(blocks.div_ceil(SAMPLES) as usize) {
                for cell in 0..BLOCK {
                    let bucket = level.first_bucket + block * BLOCK + cell;
                    let count = self.buckets.range(bucket, bucket).len() as f32;
                    bodies += count;
                    squares += count * count;
                }
            }
            let grown = &mut self.grown[level.number];
            let occupancy = squares / bodies;
            self.overfull |= *grown > 0 && occupancy > OVERFULL;
            let wanted = match occupancy {
                occupancy if occupancy > OVERFULL => 0,
                occupancy if occupancy > OCCUPANCY[1] => grown.saturating_sub(1),
                occupancy if occupancy < OCCUPANCY[0] => MAX_GROWN.min(*grown + 1),
                // Or no sample.
                _ => *grown,
            };
            changed |= std::mem::replace(grown, wanted) != wanted;
        }
        changed
    }

    /// Centre and radius of a body, numbered in the grid's order as everywhere below.
    pub fn sphere(&self, i: usize) -> [f32; 4] {
        self.spheres.each_ref().map(|numbers| numbers[i])
    }

    /// The cell of a body.
    pub fn cell(&self, level: &Level, i: usize) -> [i64; 3] {
        let [x, y, z, _] = self.sphere(i);
        level.cell(Vec3::new(x, y, z).as_dvec3())
    }

    /// Where a cell's bodies end, and runs in which all bodies are of the neighbouring cells that come after it.
    pub fn later(&self, level: &Level, [x, y, z]: [i64; 3], runs: &mut Vec<Range<usize>>) -> usize {
        runs.clear();
        self.rows(level, [[x + 1, y, z], [x + 1, y, z]], runs);
        for (dy, dz) in [(1, 0), (-1, 1), (0, 1), (1, 1)] {
            self.rows(level, [[x - 1, y + dy, z + dz], [x + 1, y + dy, z + dz]], runs);
        }
        let bucket = level.row([x >> BITS[0], y, z]) + (x as u32 & ROW);
        self.buckets.range(bucket, bucket).end
    }

    /// Adds runs in which all bodies are of these cells, from the first to the last along each axis. Some others are among
    /// them.
    pub fn rows(&self, level: &Level, [low, high]: [[i64; 3]; 2], runs: &mut Vec<Range<usize>>) {
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
                        runs.push(bodies);
                    }
                }
            }
        }
    }

    /// Calls `found` with the bodies among `others` whose spheres overlap this one.
    #[inline(always)]
    pub fn overlaps(&self, sphere: [f32; 4], others: Range<usize>, mut found: impl FnMut(usize)) {
        let [x, y, z, r] = sphere.map(f32x8::splat);
        for first in others.clone().step_by(LANES) {
            let some = |numbers: &Vec<f32>| {
                let some: [f32; LANES] = numbers[first..first + LANES].try_into().expect("as many");
                f32x8::new(some)
            };
            let [p, q, o, other] = self.spheres.each_ref().map(some);
            let [dx, dy, dz] = [x - p, y - q, z - o];
            let reach = r + other;
            let overlap = (dx * dx + dy * dy + dz * dz).simd_le(reach * reach * f32x8::splat(SPHERE_SLACK));
            let mut hits = overlap.to_bitmask();
            while hits != 0 {
                let i = first + hits.trailing_zeros() as usize;
                if i < others.end {
                    found(i);
                }
                hits &= hits - 1;
            }
        }
    }
}
