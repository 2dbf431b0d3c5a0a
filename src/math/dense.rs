//! Small dense matrices of f64: products, solutions, and rigorous bounds of resolvents that allow for rounding.

/// A square matrix, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct Dense {
    /// Number of rows.
    pub n: usize,
    /// Entries, row by row.
    pub a: Vec<f64>,
}

/// Maximum number of squarings of a matrix whose powers should decay. After 2^20 steps, a radius of 1 - 1e-5 has shrunk
/// by e^-10. Half as many give up where two eigenvalues differ by less than 1 percent; twice as many find nothing more,
/// as rounding errors have accumulated.
const MAX_SQUARINGS: u32 = 20;

/// Returns the dot product of two lists of numbers, summed from the first to the last.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

impl Dense {
    /// Creates the zero matrix.
    pub fn zero(n: usize) -> Self {
        Self { n, a: vec![0.0; n * n] }
    }

    /// Returns the entry in row i and column j.
    pub fn at(&self, i: usize, j: usize) -> f64 {
        self.a[i * self.n + j]
    }

    /// Returns the entry in row i and column j for modification.
    pub fn at_mut(&mut self, i: usize, j: usize) -> &mut f64 {
        &mut self.a[i * self.n + j]
    }

    /// Returns the rows.
    pub fn rows(&self) -> impl Iterator<Item = &[f64]> {
        // a matrix without rows has no chunks either
        self.a.chunks_exact(self.n.max(1))
    }

    /// Returns the transposed matrix.
    #[must_use]
    pub fn transposed(&self) -> Self {
        let mut other = Self::zero(self.n);
        (0..self.n).for_each(|i| (0..self.n).for_each(|j| *other.at_mut(j, i) = self.at(i, j)));
        other
    }

    /// Returns the maximum absolute row sum, the norm induced by the maximum norm.
    pub fn norm(&self) -> f64 {
        self.rows().map(|row| row.iter().map(|x| x.abs()).sum()).fold(0.0, f64::max)
    }

    /// Returns the product with a column.
    pub fn times_column(&self, x: &[f64]) -> Vec<f64> {
        self.rows().map(|row| dot(row, x)).collect()
    }

    fn square(&self) -> Self {
        let n = self.n;
        let mut product = Self::zero(n);
        for i in 0..n {
            for k in 0..n {
                let factor = self.at(i, k);
                if factor != 0.0 {
                    (0..n).for_each(|j| product.a[i * n + j] += factor * self.a[k * n + j]);
                }
            }
        }
        product
    }

    /// Solves `(A - shift) x = b` by elimination with partial pivoting. Divisions by 0 are replaced by divisions by
    /// `tiny`, so that the solution points along an eigenvector if the shift is an eigenvalue.
    pub fn solved(&self, shift: f64, b: &[f64], tiny: f64) -> Vec<f64> {
        let n = self.n;
        let (mut a, mut x) = (self.clone(), b.to_vec());
        (0..n).for_each(|i| *a.at_mut(i, i) -= shift);
        for k in 0..n {
            let pivot = (k..n).fold(k, |best, i| if a.at(i, k).abs() > a.at(best, k).abs() { i } else { best });
            if pivot != k {
                (0..n).for_each(|j| a.a.swap(pivot * n + j, k * n + j));
                x.swap(pivot, k);
            }
            if a.at(k, k).abs() < tiny {
                *a.at_mut(k, k) = tiny;
            }
            for i in k + 1..n {
                let factor = a.at(i, k) / a.at(k, k);
                if factor != 0.0 {
                    (k..n).for_each(|j| a.a[i * n + j] -= factor * a.a[k * n + j]);
                    x[i] -= factor * x[k];
                }
            }
        }
        for k in (0..n).rev() {
            let rest: f64 = (k + 1..n).map(|j| a.at(k, j) * x[j]).sum();
            x[k] = (x[k] - rest) / a.at(k, k);
        }
        x
    }

    /// Returns an approximate eigenvector x, `A x = value x`, scaled to the largest component 1, by inverse iteration;
    /// the caller must check how well it fits.
    pub fn eigenvector(&self, value: f64) -> Vec<f64> {
        // three steps: each leaves of other directions a part as small as the error of the value
        (0..3).fold(pattern_free(self.n), |x, _| {
            let y = self.solved(value, &x, 1e-14 * self.norm().max(1e-300));
            let largest = y.iter().copied().fold(0.0, |most: f64, x| if x.abs() > most.abs() { x } else { most });
            y.iter().map(|x| x / largest).collect()
        })
    }

    /// Returns a bound of `|(z - A)^-1|` for all |z| >= radius, where A is any matrix within `error` of this one in the
    /// norm; `None` if it cannot be shown that all eigenvalues are smaller than the radius.
    ///
    /// With `M = A / radius` powers `M^K` are squared until their norm is below 1/2; then the sum of all powers is at
    /// most `product of (1 + |M^(2^j)|) / (1 - |M^K|)`.
    pub fn resolvent_beyond(&self, radius: f64, error: f64) -> Option<f64> {
        let unit = (crate::math::functions::real(self.n) + 2.0) * f64::EPSILON;
        let mut power = Self { n: self.n, a: self.a.iter().map(|x| x / radius).collect() };
        let mut size = power.norm();
        let mut error = error / radius + unit * size;
        let mut sum = 1.0;
        for _ in 0..MAX_SQUARINGS {
            let most = (size + error) * (1.0 + unit);
            // false for NaN, too
            if most < 0.5 {
                return Some(sum / (1.0 - most) / radius * (1.0 + 64.0 * unit));
            }
            if !most.is_finite() || most > 1e100 {
                return None;
            }
            sum *= 1.0 + most;
            error = 2.0 * most * error + unit * most * most;
            power = power.square();
            size = power.norm();
        }
        None
    }
}

/// Returns fixed numbers without a symmetry that the matrix could share.
fn pattern_free(n: usize) -> Vec<f64> {
    let mut state = 0x2545_F491_4F6C_DD1D_u64;
    let next = |_| f64::from(u32::try_from(xorshift(&mut state) >> 33).unwrap_or(0)) / f64::from(u32::MAX) + 0.25;
    (0..n).map(next).collect()
}

/// Returns the next number of a fixed sequence. Source: G. Marsaglia, Journal of Statistical Software 8 (2003), 1-6.
pub fn xorshift(state: &mut u64) -> u64 {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    *state
}
