//! Sparse Cholesky factorisation of symmetric matrices of 6 by 6 blocks, in double precision.

use super::order::Pattern;

/// Unknowns of a body: its linear and its angular velocity.
pub(super) const N: usize = 6;

/// A block, row by row.
pub(super) type Block = [[f64; N]; N];
pub(super) type Vector = [f64; N];

const ZERO: Block = [[0.0; N]; N];

/// A symmetric positive definite matrix, and then its factor.
#[derive(Clone, Debug, Default)]
pub(super) struct Matrix {
    /// The blocks on the diagonal, in the order of elimination.
    pub diagonal: Vec<Block>,
    /// The blocks below it, column by column.
    pub lower: Vec<Block>,
    /// Where the column of each place begins in `lower`.
    starts: Vec<u32>,
    /// The row of each block of `lower`.
    rows: Vec<u32>,
    /// The targets of all products of blocks of a column, column by column: blocks of `lower`.
    targets: Vec<u32>,
}

impl Matrix {
    /// A matrix with these blocks.
    pub fn new(pattern: &Pattern) -> Self {
        let count = pattern.columns.len();
        let mut matrix = Self {
            diagonal: vec![ZERO; count],
            starts: Vec::with_capacity(count + 1),
            ..Self::default()
        };
        for column in &pattern.columns {
            matrix.starts.push(matrix.rows.len() as u32);
            matrix.rows.extend_from_slice(column);
        }
        matrix.starts.push(matrix.rows.len() as u32);
        matrix.lower = vec![ZERO; matrix.rows.len()];
        for column in &pattern.columns {
            for (i, &left) in column.iter().enumerate() {
                let blocks = column[i + 1..].iter().map(|&below| matrix.find(below, left));
                let blocks: Vec<u32> = blocks.collect();
                matrix.targets.extend(blocks);
            }
        }
        matrix
    }

    /// The number of the block at two places, `row > column`.
    pub fn find(&self, row: u32, column: u32) -> u32 {
        let (start, end) = (self.starts[column as usize], self.starts[column as usize + 1]);
        let rows = &self.rows[start as usize..end as usize];
        start + rows.binary_search(&row).expect("the pattern has all blocks") as u32
    }

    pub fn clear_lower(&mut self) {
        self.lower.fill(ZERO);
    }

    /// Replaces the matrix by its factor `L` with `L L^T` equal to it. `None` if it is not positive definite within
    /// rounding.
    #[inline(always)]
    pub fn factorize(&mut self) -> Option<()> {
        let mut target = 0;
        for column in 0..self.diagonal.len() {
            let inverse = invert(cholesky(&self.diagonal[column])?);
            self.diagonal[column] = inverse;
            let own = self.starts[column] as usize..self.starts[column + 1] as usize;
            for block in &mut self.lower[own.clone()] {
                *block = times_transposed(block, &inverse);
            }
            for i in own.clone() {
                let left = self.lower[i];
                let row = self.rows[i] as usize;
                subtract_product(&mut self.diagonal[row], &left, &left);
                for k in i + 1..own.end {
                    let below = self.lower[k];
                    subtract_product(&mut self.lower[self.targets[target] as usize], &below, &left);
                    target += 1;
                }
            }
        }
        Some(())
    }

    /// Solves the system with the factor: `x` is the right side, and then the solution, in the order of elimination.
    #[inline(always)]
    pub fn solve(&self, x: &mut [Vector]) {
        let columns = self.diagonal.len();
        for column in 0..columns {
            let own = lower_times(&self.diagonal[column], &x[column]);
            x[column] = own;
            for i in self.starts[column] as usize..self.starts[column + 1] as usize {
                let to = &mut x[self.rows[i] as usize];
                for (to, row) in to.iter_mut().zip(&self.lower[i]) {
                    *to -= (0..N).map(|k| row[k] * own[k]).sum::<f64>();
                }
            }
        }
        for column in (0..columns).rev() {
            let mut own = x[column];
            for i in self.starts[column] as usize..self.starts[column + 1] as usize {
                let from = x[self.rows[i] as usize];
                for (row, from) in self.lower[i].iter().zip(from) {
                    for k in 0..N {
                        own[k] -= row[k] * from;
                    }
                }
            }
            x[column] = upper_times(&self.diagonal[column], &own);
        }
    }
}

/// The lower triangular factor of a positive definite block.
#[inline(always)]
fn cholesky(a: &Block) -> Option<Block> {
    let mut l = ZERO;
    for j in 0..N {
        let pivot = l[j][..j].iter().fold(a[j][j], |pivot, x| pivot - x * x);
        // A pivot that rounding has made of the whole diagonal element has no meaning.
        if !(pivot > 1.0e-14 * a[j][j] && pivot.is_finite()) {
            return None;
        }
        let root = pivot.sqrt();
        l[j][j] = root;
        for i in j + 1..N {
            let known = l[i][..j].iter().zip(&l[j][..j]);
            l[i][j] = known.fold(a[i][j], |sum, (x, y)| sum - x * y) / root;
        }
    }
    Some(l)
}

/// The inverse of a lower triangular block.
#[inline(always)]
fn invert(l: Block) -> Block {
    let mut inverse = ZERO;
    for j in 0..N {
        inverse[j][j] = 1.0 / l[j][j];
        for i in j + 1..N {
            let mut sum = 0.0;
            for k in j..i {
                sum += l[i][k] * inverse[k][j];
            }
            inverse[i][j] = -sum / l[i][i];
        }
    }
    inverse
}

/// `a` times the transpose of the lower triangular `l`.
#[inline(always)]
fn times_transposed(a: &Block, l: &Block) -> Block {
    let mut product = ZERO;
    for i in 0..N {
        for j in 0..N {
            let mut sum = 0.0;
            for k in 0..=j {
                sum += a[i][k] * l[j][k];
            }
            product[i][j] = sum;
        }
    }
    product
}

/// Subtracts `a` times the transpose of `b`.
#[inline(always)]
fn subtract_product(from: &mut Block, a: &Block, b: &Block) {
    let mut transposed = ZERO;
    for i in 0..N {
        for k in 0..N {
            transposed[k][i] = b[i][k];
        }
    }
    for i in 0..N {
        let mut row = from[i];
        for k in 0..N {
            for j in 0..N {
                row[j] -= a[i][k] * transposed[k][j];
            }
        }
        from[i] = row;
    }
}

#[inline(always)]
fn lower_times(l: &Block, x: &Vector) -> Vector {
    let mut product = [0.0; N];
    for i in 0..N {
        for k in 0..=i {
            product[i] += l[i][k] * x[k];
        }
    }
    product
}

/// The transpose of the lower triangular `l` times `x`.
#[inline(always)]
fn upper_times(l: &Block, x: &Vector) -> Vector {
    let mut product = [0.0; N];
    for k in 0..N {
        for i in 0..=k {
            product[i] += l[k][i] * x[k];
        }
    }
    product
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Random blocks at these pairs and on the diagonal, dominated by the diagonal.
    #[test]
    fn solutions_satisfy_the_system() {
        let mut random = fastrand::Rng::with_seed(3);
        for _ in 0..20 {
            let count = random.usize(1..12);
            let mut pairs: Vec<[u32; 2]> = (1..count as u32).map(|i| [random.u32(..i), i]).collect();
            for _ in 0..count / 2 {
                let [a, b] = [random.u32(..count as u32), random.u32(..count as u32)];
                if a < b {
                    pairs.push([a, b]);
                }
            }
            pairs.sort_unstable();
            pairs.dedup();
            let pattern = Pattern::new(count, pairs.iter().copied(), usize::MAX).unwrap();
            let mut matrix = Matrix::new(&pattern);
            let size = N * count;
            let row = |i| (0..size).map(|k| if i == k { 20.0 } else { 0.0 }).collect();
            let mut dense: Vec<Vec<f64>> = (0..size).map(row).collect();
            for pair in &pairs {
                let [a, b] = pair.map(|body| pattern.place[body as usize]);
                let (row, column) = (a.max(b), a.min(b));
                let block = matrix.find(row, column) as usize;
                for i in 0..N {
                    for k in 0..N {
                        let value = random.f64() - 0.5;
                        matrix.lower[block][i][k] = value;
                        let (r, c) = (row as usize * N + i, column as usize * N + k);
                        (dense[r][c], dense[c][r]) = (value, value);
                    }
                }
            }
            for diagonal in &mut matrix.diagonal {
                (0..N).for_each(|i| diagonal[i][i] = 20.0);
            }
            let right: Vec<Vector> = (0..count).map(|_| std::array::from_fn(|_| random.f64())).collect();
            let mut x = right.clone();
            matrix.factorize().unwrap();
            matrix.solve(&mut x);
            let (x, right) = (x.as_flattened(), right.as_flattened());
            for (row, right) in dense.iter().zip(right) {
                let left: f64 = row.iter().zip(x).map(|(a, x)| a * x).sum();
                assert!((left - right).abs() < 1.0e-12);
            }
        }
    }

    #[test]
    fn a_matrix_that_is_not_definite_is_refused() {
        let pattern = Pattern::new(1, std::iter::empty(), 10).unwrap();
        let mut matrix = Matrix::new(&pattern);
        assert!(matrix.factorize().is_none());
    }
}
