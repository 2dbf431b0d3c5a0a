//! Masks of several functionals at regular points, which are summed together: each point that they share is loaded
//! once.

use multiversion::multiversion;

use super::aligned::AlignedBuffer;

/// The largest number of functionals in a bundle: a position and two tangents.
pub(super) const FUNCTIONALS: usize = 3;

/// Number of values that are summed at a time: two of the widest registers for each functional. With half of it weights
/// are loaded twice as often; twice of it takes all registers of smaller ones.
pub(super) const SUMS_AT_A_TIME: usize = 16;

/// The masks of up to [`FUNCTIONALS`] functionals over one array.
#[derive(Debug)]
pub(super) struct Bundle {
    terms: Vec<BundleTerm>,
    /// Number of functionals.
    n: usize,
}

/// A value that functionals weigh.
#[derive(Debug, Clone, Copy)]
struct BundleTerm {
    weights: [f64; FUNCTIONALS],
    /// Which of the weights are not zero. Asked for at each step of a loop, this costs less than comparing them.
    is_weighted: [bool; FUNCTIONALS],
    /// The distance of the value.
    distance: isize,
}

impl Bundle {
    /// Bundles masks, each a list of weights and distances; each sum keeps the order of its terms.
    ///
    /// # Panics
    /// If there are more than [`FUNCTIONALS`] masks.
    pub(super) fn new(masks: &[Vec<(f64, isize)>]) -> Self {
        let mut terms: Vec<BundleTerm> = Vec::new();
        for (functional, mask) in masks.iter().enumerate() {
            let mut next = 0;
            for &(weight, distance) in mask {
                let shared = terms[next..].iter().position(|term| term.distance == distance);
                let at = shared.map_or(terms.len(), |ahead| next + ahead);
                if at == terms.len() {
                    let (weights, is_weighted) = ([0.0; FUNCTIONALS], [false; FUNCTIONALS]);
                    terms.push(BundleTerm { weights, is_weighted, distance });
                }
                (terms[at].weights[functional], terms[at].is_weighted[functional]) = (weight, weight != 0.0);
                next = at + 1;
            }
        }
        Self { terms, n: masks.len() }
    }

    /// Sets the first `len` values of each row to the sums at consecutive places of `source` from `first` on. Also
    /// computes up to [`SUMS_AT_A_TIME`] sums beyond, which mean nothing.
    pub(super) fn sums(&self, rows: &mut [AlignedBuffer; FUNCTIONALS], len: usize, source: &[f64], first: usize) {
        let len = len.next_multiple_of(SUMS_AT_A_TIME);
        let [a, b, c] = rows.each_mut().map(|row| row.first(len));
        match self.n {
            1 => sums([a], source, first, &self.terms),
            2 => sums([a, b], source, first, &self.terms),
            _ => sums([a, b, c], source, first, &self.terms),
        }
    }
}

#[multiversion(targets("x86_64+avx512f", "x86_64+avx2", "x86_64+avx"))]
fn sums<const N: usize>(rows: [&mut [f64]; N], source: &[f64], first: usize, terms: &[BundleTerm]) {
    for start in (0..rows[0].len()).step_by(SUMS_AT_A_TIME) {
        let mut sums = [[-0.0; SUMS_AT_A_TIME]; N];
        for BundleTerm { weights, is_weighted, distance } in terms {
            let mut values = [0.0; SUMS_AT_A_TIME];
            values.copy_from_slice(&source[(first + start).wrapping_add_signed(*distance)..][..SUMS_AT_A_TIME]);
            for f in 0..N {
                // a functional without the term does not add zero, which could change the sign of a sum that is zero
                if is_weighted[f] {
                    for k in 0..SUMS_AT_A_TIME {
                        sums[f][k] += weights[f] * values[k];
                    }
                }
            }
        }
        for f in 0..N {
            rows[f][start..start + SUMS_AT_A_TIME].copy_from_slice(&sums[f]);
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn masks() -> impl Strategy<Value = Vec<Vec<(f64, isize)>>> {
        let term = (prop_oneof![Just(0.0), -2.0..2.0], -4_isize..=4);
        prop::collection::vec(prop::collection::vec(term, 0..9), 1..=FUNCTIONALS)
    }

    proptest! {
        /// Sums of a bundle are those of its masks, one by one: terms are added in the order of each mask, also where
        /// masks name places in different orders or several times.
        #[test]
        fn sums_of_masks(masks in masks(), len in 1_usize..40, source in prop::collection::vec(-1.0..1.0, 80)) {
            let mut rows = std::array::from_fn(|_| AlignedBuffer::default());
            Bundle::new(&masks).sums(&mut rows, len, &source, 8);
            for (mask, row) in masks.iter().zip(&rows) {
                for (k, sum) in row[..len].iter().enumerate() {
                    let value = |distance: isize| source[(8 + k).wrapping_add_signed(distance)];
                    let terms = mask.iter().filter(|(weight, _)| *weight != 0.0);
                    let alone = terms.fold(-0.0, |sum, &(weight, distance)| sum + weight * value(distance));
                    prop_assert_eq!(sum.to_bits(), f64::to_bits(alone));
                }
            }
        }
    }
}
