//! Eigenvalues of small dense matrices of real numbers.
//!
//! Source: Golub and Van Loan, Matrix Computations, 4th edition, sections 7.4 and 7.5: reduction to Hessenberg form by
//! elimination, then QR steps with Francis' double shift.

use crate::math::functions::sqrt;
use crate::math::vector;

/// Maximum number of QR steps per eigenvalue; two or three usually suffice. Half as many would give up on rare
/// matrices; twice as many would help no others.
const MAX_QR_STEPS: usize = 60;
/// Number of steps without success after which an exceptional shift is used, so that steps do not cycle; 10 as in
/// `hqr` of EISPACK. Half of it disturbs steps that still converge; twice of it takes ten more steps where they cycle.
const ODD_SHIFT: usize = 10;
/// Largest difference of two absolute values, relative to the larger one, at which eigenvalues are listed as of the
/// same absolute value: 900 roundings of 1, as eigenvalues of matrices of some dozen rows have. Half of it may leave
/// the order of conjugates and opposites to rounding; twice of it orders eigenvalues by their parts that differ in the
/// 13th digit.
const EQUAL_MODULI: f64 = 2e-13;

/// An eigenvalue: real and imaginary part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Eigenvalue {
    /// Real part.
    pub re: f64,
    /// Imaginary part.
    pub im: f64,
}

impl Eigenvalue {
    /// Returns the absolute value.
    pub fn modulus(self) -> f64 {
        sqrt(self.re * self.re + self.im * self.im)
    }
}

/// Returns the eigenvalues of an n x n matrix, given row by row, by descending modulus, then by real and imaginary
/// part. `None` if the steps do not converge.
///
/// If the pattern of nonzero entries is reducible, the matrix is block triangular up to a permutation, and its
/// eigenvalues are those of the diagonal blocks. Each block is treated separately, so that equal eigenvalues of two
/// blocks stay accurate.
pub fn eigenvalues(matrix: &[f64], n: usize) -> Option<Vec<Eigenvalue>> {
    let mut found = Vec::with_capacity(n);
    for block in blocks(matrix, n) {
        let entries: Vec<f64> = block.iter().flat_map(|i| block.iter().map(move |j| matrix[i * n + j])).collect();
        found.extend(of_block(&entries, block.len())?);
    }
    found.sort_by(|x, y| y.modulus().total_cmp(&x.modulus()));
    // moduli that differ from the largest of a run by rounding only count as equal, so that the parts decide the order
    let mut left = found.as_mut_slice();
    while let Some(first) = left.first() {
        let most = first.modulus();
        let count = left.iter().take_while(|x| most - x.modulus() <= EQUAL_MODULI * most).count().max(1);
        let (run, rest) = left.split_at_mut(count);
        run.sort_by(|x, y| y.re.total_cmp(&x.re).then(y.im.total_cmp(&x.im)));
        left = rest;
    }
    Some(found)
}

/// Returns the strongly connected components of the pattern of nonzero entries, each ascending, by first index.
fn blocks(matrix: &[f64], n: usize) -> Vec<Vec<usize>> {
    let reached = |from: usize, entry: &dyn Fn(usize, usize) -> f64| {
        let (mut seen, mut open) = (vec![false; n], vec![from]);
        seen[from] = true;
        while let Some(i) = open.pop() {
            for j in (0..n).filter(|&j| entry(i, j) != 0.0) {
                if !std::mem::replace(&mut seen[j], true) {
                    open.push(j);
                }
            }
        }
        seen
    };
    let (mut known, mut found) = (vec![false; n], Vec::new());
    for first in 0..n {
        if known[first] {
            continue;
        }
        let forth = reached(first, &|i, j| matrix[i * n + j]);
        let back = reached(first, &|i, j| matrix[j * n + i]);
        let block: Vec<usize> = (first..n).filter(|&i| forth[i] && back[i]).collect();
        block.iter().for_each(|&i| known[i] = true);
        found.push(block);
    }
    found
}

/// Returns the eigenvalues of one block, in any order.
fn of_block(matrix: &[f64], n: usize) -> Option<Vec<Eigenvalue>> {
    let mut h = Hessenberg { a: matrix.to_vec(), n, negligible: 0.0 };
    h.reduce();
    // if eigenvalues near 0 keep the steps from converging, entries as small as rounding errors of the largest are
    // dropped
    let negligible = f64::EPSILON * matrix.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let second = Hessenberg { a: h.a.clone(), n, negligible };
    h.decompose().or_else(|| { second }.decompose())
}

struct Hessenberg {
    a: Vec<f64>,
    n: usize,
    /// The absolute value up to which subdiagonal entries count as 0.
    negligible: f64,
}

impl Hessenberg {
    fn at(&self, i: usize, j: usize) -> f64 {
        self.a[i * self.n + j]
    }

    fn put(&mut self, i: usize, j: usize, x: f64) {
        self.a[i * self.n + j] = x;
    }

    /// Reduces the matrix to Hessenberg form by similarity transformations.
    fn reduce(&mut self) {
        let n = self.n;
        for m in 1..n.saturating_sub(1) {
            let pivot =
                (m..n).fold(m, |best, i| if self.at(i, m - 1).abs() > self.at(best, m - 1).abs() { i } else { best });
            let x = self.at(pivot, m - 1);
            if x == 0.0 {
                continue;
            }
            if pivot != m {
                (0..n).for_each(|j| self.a.swap(pivot * n + j, m * n + j));
                (0..n).for_each(|i| self.a.swap(i * n + pivot, i * n + m));
            }
            for i in m + 1..n {
                let factor = self.at(i, m - 1) / x;
                if factor == 0.0 {
                    continue;
                }
                (0..n).for_each(|j| self.a[i * n + j] -= factor * self.at(m, j));
                (0..n).for_each(|k| self.a[k * n + m] += factor * self.at(k, i));
            }
        }
        for i in 2..n {
            (0..i - 1).for_each(|j| self.put(i, j, 0.0));
        }
    }

    /// Splits off one or two eigenvalues at a time from the end.
    fn decompose(&mut self) -> Option<Vec<Eigenvalue>> {
        let norm: f64 = self.a.iter().map(|x| x.abs()).sum();
        let mut found = Vec::with_capacity(self.n);
        let (mut end, mut steps) = (self.n, 0);
        while end > 0 {
            let start = self.block(end, norm);
            match end - start {
                1 => {
                    found.push(Eigenvalue { re: self.at(end - 1, end - 1), im: 0.0 });
                    (end, steps) = (end - 1, 0);
                }
                2 => {
                    found.extend(self.pair(end - 2));
                    (end, steps) = (end - 2, 0);
                }
                _ if steps == MAX_QR_STEPS => return None,
                _ => {
                    steps += 1;
                    self.step(start, end, steps.is_multiple_of(ODD_SHIFT));
                }
            }
        }
        Some(found)
    }

    /// Returns the first row of the last irreducible block.
    fn block(&mut self, end: usize, norm: f64) -> usize {
        for i in (1..end).rev() {
            let around = self.at(i - 1, i - 1).abs() + self.at(i, i).abs();
            let scale = if around == 0.0 { norm } else { around };
            if self.at(i, i - 1).abs() <= (f64::EPSILON * scale).max(self.negligible) {
                self.put(i, i - 1, 0.0);
                return i;
            }
        }
        0
    }

    /// Returns the eigenvalues of the 2 x 2 block at `i`.
    fn pair(&self, i: usize) -> [Eigenvalue; 2] {
        let [a, b, c, d] = [self.at(i, i), self.at(i, i + 1), self.at(i + 1, i), self.at(i + 1, i + 1)];
        let half = (a - d) / 2.0;
        let square = half * half + b * c;
        if square < 0.0 {
            let (re, im) = (f64::midpoint(a, d), sqrt(-square));
            return [Eigenvalue { re, im }, Eigenvalue { re, im: -im }];
        }
        // the larger summand first, to avoid cancellation
        let far = half + if half < 0.0 { -sqrt(square) } else { sqrt(square) };
        let near = if far == 0.0 { 0.0 } else { -b * c / far };
        [far, near].map(|x| Eigenvalue { re: d + x, im: 0.0 })
    }

    /// Performs a double-shift QR step on the rows and columns from `start` to before `end`, at least three.
    fn step(&mut self, start: usize, end: usize, odd: bool) {
        let last = end - 1;
        let (mut trace, mut determinant) = {
            let [a, b, c, d] =
                [self.at(last - 1, last - 1), self.at(last - 1, last), self.at(last, last - 1), self.at(last, last)];
            (a + d, a * d - b * c)
        };
        if odd {
            let s = self.at(last, last - 1).abs() + self.at(last - 1, last - 2).abs();
            (trace, determinant) = (1.5 * s, s * s);
        }
        let (h00, h10) = (self.at(start, start), self.at(start + 1, start));
        let mut x = h00 * h00 + self.at(start, start + 1) * h10 - trace * h00 + determinant;
        let mut y = h10 * (h00 + self.at(start + 1, start + 1) - trace);
        let mut z = h10 * self.at(start + 2, start + 1);
        for k in start..last {
            let rows = 3.min(end - k);
            self.reflect(k, rows, [x, y, if rows == 3 { z } else { 0.0 }], start, end);
            x = self.at(k + 1, k);
            y = if k + 2 < end { self.at(k + 2, k) } else { 0.0 };
            z = if k + 3 < end { self.at(k + 3, k) } else { 0.0 };
        }
        for i in start + 2..end {
            (start..i - 1).for_each(|j| self.put(i, j, 0.0));
        }
    }

    /// Applies from both sides the reflection that maps `v` to a multiple of the first unit vector.
    fn reflect(&mut self, k: usize, rows: usize, v: [f64; 3], start: usize, end: usize) {
        let length = vector::length(v);
        if length == 0.0 {
            return;
        }
        let mut u = v;
        u[0] += if v[0] < 0.0 { -length } else { length };
        let square = vector::dot(u, u);
        let from = if k > start { k - 1 } else { start };
        for j in from..end {
            let product: f64 = (0..rows).map(|i| u[i] * self.at(k + i, j)).sum();
            let factor = 2.0 * product / square;
            (0..rows).for_each(|i| self.a[(k + i) * self.n + j] -= factor * u[i]);
        }
        for i in start..end.min(k + 4) {
            let product: f64 = (0..rows).map(|j| u[j] * self.at(i, k + j)).sum();
            let factor = 2.0 * product / square;
            (0..rows).for_each(|j| self.a[i * self.n + k + j] -= factor * u[j]);
        }
    }
}
