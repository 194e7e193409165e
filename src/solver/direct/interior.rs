//! Newton's method along the central path.

use super::blocks::{Block, N, Vector};
use super::island::{Direct, NONE, ranges};
use super::point::{Point, Row, along, dot};

/// Most iterations from one start.
const MOST_ITERATIONS: u32 = 24;
/// Most starts of a solve, and how much higher the barrier of the next one is.
const MOST_STARTS: u32 = 4;
const HIGHER_START: f64 = 30.0;
/// The least part of a step that is taken.
const LEAST_PART: f64 = 0.15;
/// Most iterations at the end, while the limits of friction settle.
const LAST_ITERATIONS: u32 = 4;
/// Errors of velocities below this do not count, m/s.
const TOLERANCE: f64 = 1.0e-4;
/// Velocities of a solution may be wrong by this, m/s, or by this part of the largest error before.
const ACCEPTED: f64 = 5.0e-3;
const IMPROVEMENT: f64 = 0.05;
/// The barrier of the solution, (m/s)^2.
const END: f64 = 1.0e-7;
/// The part of an impulse or a slack that one iteration may take away.
const MOST_TAKEN: f64 = 0.95;

impl Direct {
    /// Sets impulses and slacks to those of the solution. Returns whether it was found.
    #[inline(always)]
    pub(super) fn iterate(&mut self) -> bool {
        let mut barrier = self.initial_barrier();
        for _ in 0..MOST_STARTS {
            if self.iterate_from(barrier) {
                return true;
            }
            barrier *= HIGHER_START;
        }
        false
    }

    /// Iterates from the impulses and velocities before the solve.
    #[inline(always)]
    fn iterate_from(&mut self, mut barrier: f64) -> bool {
        self.moved.clear();
        self.moved.resize(self.slots.len(), [0.0; N]);
        for point in &mut self.points {
            point.begin(barrier);
        }
        let mut at_end = 0;
        for _ in 0..MOST_ITERATIONS {
            if !self.find_velocities(barrier) {
                return false;
            }
            let part = self.find_impulses(barrier);
            // With short steps it would take too long. From a higher barrier they are longer.
            if part.is_nan() || part < LEAST_PART {
                return false;
            }
            at_end += u32::from(barrier <= END);
            let (gap, error) = self.advance(part, 1.0 / f64::from(at_end.max(1)));
            if gap < 4.0 * END && (error < TOLERANCE || at_end >= LAST_ITERATIONS) {
                return self.is_solution();
            }
            // A whole step shows that the linearisation holds, and that the barrier may fall faster.
            let reduction = match part {
                0.95.. => 0.03,
                0.5.. => 0.3,
                _ => 0.8,
            };
            barrier = (reduction * gap).max(END);
        }
        false
    }

    /// Sets the changes of the velocities to those that follow from the impulses. Returns whether they satisfy the
    /// constraints.
    #[inline(always)]
    fn is_solution(&mut self) -> bool {
        self.change.fill([0.0; N]);
        for (pair, range) in ranges(&self.pairs) {
            for point in &self.points[range] {
                pair.push(point, &mut self.change);
            }
        }
        for (change, mass) in self.change.iter_mut().zip(&self.masses) {
            *change = std::array::from_fn(|i| dot(&mass.inverse[i], change));
        }
        let (mut worst, mut before) = (0.0f64, 0.0f64);
        for (pair, range) in ranges(&self.pairs) {
            let velocities = pair.of(&self.change);
            for point in self.points[range].iter().filter(|point| point.is_solved) {
                let normal = f64::from(point.result()[0]) / point.unit;
                let velocity = point.initial_errors[0] + along(&point.rows[0], &velocities);
                let error = velocity + point.compliance * normal;
                worst = worst.max(if normal > 0.0 { error.abs() } else { -error });
                before = before.max(-point.initial_errors[0] - point.compliance * point.start[0]);
            }
        }
        worst < ACCEPTED.max(IMPROVEMENT * before)
    }

    /// The mean product of impulses and slacks to begin with: as large as the errors of the present impulses.
    fn initial_barrier(&self) -> f64 {
        let (mut worst, mut sum, mut count) = (0.0f64, 0.0, 0.0);
        for point in self.points.iter().filter(|point| point.is_solved) {
            let p = point.impulses[0];
            let error = point.errors[0] + point.compliance * p;
            // How far the point is from a solution: its error, or its impulse where it should have none.
            worst = worst.max(if error < 0.0 { -error } else { error.min(p) });
            sum += p * error.abs();
            count += 1.0;
        }
        (worst * worst).max(sum / f64::max(count, 1.0)).max(END)
    }

    /// Sets the changes of the velocities. Returns whether the system has a solution.
    #[inline(always)]
    fn find_velocities(&mut self, barrier: f64) -> bool {
        self.assemble(barrier);
        if self.matrix.factorize().is_none() {
            return false;
        }
        self.matrix.solve(&mut self.change);
        true
    }

    /// Sets the matrix, and the right side in place of the changes.
    #[inline(always)]
    fn assemble(&mut self, barrier: f64) {
        self.matrix.clear_lower();
        self.change.clear();
        for ((diagonal, mass), moved) in self.matrix.diagonal.iter_mut().zip(&self.masses).zip(&self.moved) {
            *diagonal = mass.mass;
            self.change.push(std::array::from_fn(|i| -dot(&mass.mass[i], moved)));
        }
        for (pair, range) in ranges(&self.pairs) {
            let mut blocks = PairBlocks::default();
            // The block below the diagonal has the rows of the later body.
            let later = usize::from(pair.block == NONE || pair.places[1] > pair.places[0]);
            for point in self.points[range].iter().filter(|point| point.is_solved) {
                blocks.add_point(point, barrier, later);
            }
            for (side, &place) in pair.places.iter().enumerate().filter(|(_, place)| **place != NONE) {
                add(&mut self.matrix.diagonal[place as usize], &blocks.own[side]);
                for i in 0..N {
                    self.change[place as usize][i] += blocks.impulse[side][i];
                }
            }
            if pair.block != NONE {
                add(&mut self.matrix.lower[pair.block as usize], &blocks.between);
            }
        }
    }

    /// Sets the changes of impulses and slacks. Returns which part of them keeps both positive.
    #[inline(always)]
    fn find_impulses(&mut self, barrier: f64) -> f64 {
        let mut part: f64 = 1.0;
        for (pair, range) in ranges(&self.pairs) {
            let velocities = pair.of(&self.change);
            for point in self.points[range].iter_mut().filter(|point| point.is_solved) {
                let [n, t, u] = point.rows.each_ref().map(|row| along(row, &velocities));
                let (weight, impulse) = point.normal_law(barrier);
                point.change[0] = impulse - weight * n;
                point.slack_change =
                    n + point.errors[0] + point.compliance * (point.impulses[0] + point.change[0]) - point.slack;
                if point.rubs {
                    let ([tt, tu, uu], [pt, pu]) = point.friction_law(barrier);
                    point.change[1] = pt - tt * t - tu * u;
                    point.change[2] = pu - tu * t - uu * u;
                }
                for (value, change) in [(point.impulses[0], point.change[0]), (point.slack, point.slack_change)] {
                    if change < 0.0 {
                        part = part.min(-MOST_TAKEN * value / change);
                    }
                }
            }
        }
        part
    }

    /// Goes this part of the changes. Returns the mean product of impulses and slacks, and the largest error of a
    /// velocity.
    #[inline(always)]
    fn advance(&mut self, part: f64, settling: f64) -> (f64, f64) {
        for (moved, change) in self.moved.iter_mut().zip(&self.change) {
            for i in 0..N {
                moved[i] += part * change[i];
            }
        }
        let (mut sum, mut count, mut error) = (0.0, 0.0, 0.0f64);
        for (pair, range) in ranges(&self.pairs) {
            let velocities = pair.of(&self.change);
            for point in self.points[range].iter_mut().filter(|point| point.is_solved) {
                for i in 0..3 {
                    point.errors[i] += part * along(&point.rows[i], &velocities);
                    point.impulses[i] += part * point.change[i];
                }
                point.slack += part * point.slack_change;
                let residual = point.errors[0] + point.compliance * point.impulses[0] - point.slack;
                error = error.max(residual.abs()).max((1.0 - part) * point.change[0].abs());
                if point.rubs {
                    for change in &point.change[1..] {
                        error = error.max(0.1 * change.abs());
                    }
                }
                sum += point.impulses[0] * point.slack;
                count += 1.0;
                point.limit += settling * (point.friction * point.impulses[0] - point.limit);
                point.limit_friction();
            }
        }
        (if count > 0.0 { sum / count } else { 0.0 }, error)
    }
}

/// What the points of a pair add to the system.
#[derive(Default)]
struct PairBlocks {
    /// On the diagonal, for each side.
    own: [Block; 2],
    between: Block,
    impulse: [Vector; 2],
}

impl PairBlocks {
    #[inline(always)]
    fn add_point(&mut self, point: &Point, barrier: f64, later: usize) {
        let (weight, change) = point.normal_law(barrier);
        let push = |i: usize, change: f64| (point.impulses[i] - point.start[i] + change) * point.unit;
        self.add_row(&point.rows[0], weight * point.unit, push(0, change), later);
        if point.rubs {
            let ([tt, tu, uu], [change_t, change_u]) = point.friction_law(barrier);
            let [t, u] = [&point.rows[1], &point.rows[2]];
            let [push_t, push_u] = [push(1, change_t), push(2, change_u)];
            // The matrix of friction as a sum of two squares.
            let ratio = if tt > 0.0 { tu / tt } else { 0.0 };
            let both: Row = [0, 1].map(|side| std::array::from_fn(|i| t[side][i] + ratio * u[side][i]));
            self.add_row(&both, tt * point.unit, push_t, later);
            self.add_row(u, (uu - ratio * tu) * point.unit, push_u - ratio * push_t, later);
        }
    }

    /// Adds a row of this stiffness and impulse.
    #[inline(always)]
    fn add_row(&mut self, row: &Row, stiffness: f64, impulse: f64, later: usize) {
        for ((own, sum), row) in self.own.iter_mut().zip(&mut self.impulse).zip(row) {
            add_outer(own, row, row, stiffness);
            for (sum, coefficient) in sum.iter_mut().zip(row) {
                *sum += impulse * coefficient;
            }
        }
        add_outer(&mut self.between, &row[later], &row[1 - later], stiffness);
    }
}

#[inline(always)]
fn add_outer(to: &mut Block, rows: &Vector, columns: &Vector, weight: f64) {
    for i in 0..N {
        for k in 0..N {
            to[i][k] += weight * rows[i] * columns[k];
        }
    }
}

#[inline(always)]
fn add(to: &mut Block, block: &Block) {
    for i in 0..N {
        for k in 0..N {
            to[i][k] += block[i][k];
        }
    }
}
