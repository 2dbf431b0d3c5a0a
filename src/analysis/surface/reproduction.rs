//! The polynomials that a regular scheme reproduces: those that are limits of their own samples.
//!
//! If old points c are at the places c + s and new points f at (f + s)/d, linear polynomials imply `s = (sum of a[k] k
//! over one residue class)/(d - 1)`. A degree is reproduced if the sums over each residue class r of `a[k] ((r - k)/d +
//! s)^m` are `((r + s)/d)^m` for all powers m of that degree, and if all lower degrees are reproduced.
//!
//! Source: Conti and Hormann, Journal of Approximation Theory 163 (2011), 413-437, here for two variables.

use super::regular::{Polynomial, RegularMask};
use super::sectors::LatticePoint;

/// Maximum degree that is tested. The schemes of the catalogue have three at most. Half of it is enough for them; twice
/// of it only takes time.
const MAX_TESTED_DEGREE: i32 = 8;
/// Largest error of a sum that is regarded as rounding, for weights of about 1 times powers of places up to 5. Sums
/// that do not fit are off by at least a thousandth. Half or twice of it decides alike.
const SUM_ROUNDING: f64 = 1e-9;

impl RegularMask {
    /// Returns the largest degree of polynomials that are reproduced; -1 if not even constants are.
    pub fn reproduction_degree(&self) -> i32 {
        let d = f64::from(self.arity);
        let shift = [0, 1].map(|axis| self.class([0, 0]).map(|(k, a)| a * f64::from(k[axis])).sum::<f64>() / (d - 1.0));
        let times = |x: f64, n: i32| (0..n).fold(1.0, |product, _| product * x);
        let power = |[x, y]: [f64; 2], [i, j]: [i32; 2]| times(x, i) * times(y, j);
        let fits = |r: LatticePoint, powers: [i32; 2]| {
            let old = |k: &LatticePoint| [0, 1].map(|axis| f64::from(r[axis] - k[axis]) / d + shift[axis]);
            let sum: f64 = self.class(r).map(|(k, a)| a * power(old(k), powers)).sum();
            let new = [0, 1].map(|axis| (f64::from(r[axis]) + shift[axis]) / d);
            (sum - power(new, powers)).abs() <= SUM_ROUNDING
        };
        let classes = || (0..self.arity).flat_map(|x| (0..self.arity).map(move |y| [x, y]));
        let holds = |degree: &i32| (0..=*degree).all(|i| classes().all(|r| fits(r, [i, degree - i])));
        (0..=MAX_TESTED_DEGREE).take_while(holds).last().unwrap_or(-1)
    }

    /// Returns the ends of the support of the basic limit function along the two sides of a face.
    pub fn support(&self) -> [[f64; 2]; 2] {
        let [x, y, _] = Self::ends(&self.mask);
        [x, y].map(|ends| ends.map(|end| f64::from(end) / f64::from(self.arity - 1)))
    }

    /// Returns the entries of a residue class.
    fn class(&self, r: LatticePoint) -> impl Iterator<Item = (&LatticePoint, &f64)> {
        let mask: &Polynomial = &self.mask;
        mask.iter().filter(move |(k, _)| (0..2).all(|axis| (k[axis] - r[axis]).rem_euclid(self.arity) == 0))
    }
}
