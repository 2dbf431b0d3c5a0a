//! A lower bound of the joint spectral radius: a product of matrices with a proved eigenvalue.
//!
//! Eigenvalues of products in f64 suggest candidates. The proof is exact. The characteristic polynomial of a product of
//! l matrices has the leading coefficient 1, so that it has a real zero of at least t if it is not positive at t. The
//! joint spectral radius is then at least `t^(1/l)`.

use std::cmp::Ordering;

use num_traits::Signed;

use super::matrices::{ExactMatrix, multiply, price, product};
use crate::math::elimination::determinant_sign;
use crate::math::exact::{self, Exact, below, binary, rounded};
use crate::math::functions::{pow, real};
use crate::math::number::Number;
use crate::math::spectrum::eigenvalues;
use crate::watch::{Stopped, Watch};

/// Number of products that every search examines, whatever its budget: words of up to seven letters for binary schemes,
/// of four for ternary ones. All extremal products that are known here have two letters at most; half of it saves half
/// the time, twice of it takes one letter more.
const USUAL_WORDS: usize = 256;
/// Maximum number of products that a search examines: words of up to twelve letters for binary schemes, which take some
/// ten megabytes. Half of it has one letter less; twice of it takes twice as much memory.
const MAX_WORDS: usize = 1 << 13;
/// Cost of a product whose eigenvalues are computed, in plain products of the budget. It is the ratio of their times.
/// Half or twice of it needs half or twice of a budget for one letter more.
const EIGENVALUE_COST: u64 = 128;
/// Maximum size of matrices whose eigenvalues are proved. The 2n-point schemes have matrices of size 2n - 2, which is
/// 30 for n = 16. Half of it leaves those from n = 10 on without a bound; twice of it takes some thirty times as long,
/// because the numbers of the elimination grow.
const MAX_PROVED_SIZE: usize = 32;
/// Maximum number of products for whose eigenvalue a proof is attempted. The first attempt succeeds unless the
/// eigenvalues are complex or double. Half or twice of it changes nothing else.
const MAX_PROOFS: usize = 8;
/// Relative improvement that a longer word must bring, so that powers of a word, whose rates differ by the rounding of
/// their eigenvalues alone, do not replace the word. It is 450,000 roundings of 1, since double eigenvalues are wrong
/// by many; half of it is still far above the rounding of simple ones. Twice of it may leave bounds lower by 2e-10 of
/// themselves.
const LEAST_IMPROVEMENT: f64 = 1e-10;
/// Shares by which candidates for a lower bound stay below a computed eigenvalue, tried in turn: from its rounding to
/// that of defective matrices. The last is the smallest gap that upper bounds attempt: smaller ones alone would leave
/// defective matrices without a bound, larger ones would prove less than can be told.
const SHARES_BELOW: [f64; 5] = [1e-13, 1e-12, 1e-10, 1e-8, 1e-6];

/// A lower bound of the joint spectral radius, `t^(1/l)`.
#[derive(Debug, Clone, PartialEq)]
pub struct Lower {
    /// The indices of the matrices whose product has an eigenvalue of absolute value t or more, the first factor first;
    /// empty if it is the mean of all matrices that has the eigenvalue.
    pub word: Vec<usize>,
    /// The bound t of the absolute value of the eigenvalue.
    pub eigenvalue: Exact,
    /// The bound of the joint spectral radius in f64, rounded down.
    pub value: f64,
}

impl Lower {
    fn new(word: Vec<usize>, eigenvalue: Exact) -> Self {
        let length = i32::try_from(word.len().max(1)).unwrap_or(1);
        let root = |t: &Exact| pow(rounded(t), 1.0 / f64::from(length)).next_up();
        let mut value = if length == 1 { below(&eigenvalue) } else { root(&eigenvalue) };
        while value > 0.0 && binary(value).pow(length) > eigenvalue {
            value = value.next_down();
        }
        Self { word, eigenvalue, value }
    }

    /// Creates the bound by an eigenvalue of a single matrix.
    pub(super) fn of_one(eigenvalue: Exact) -> Self {
        Self::new(vec![0], eigenvalue)
    }

    /// Returns whether the joint spectral radius is proved to be at least `x >= 0`.
    pub fn reaches(&self, x: &Exact) -> bool {
        self.eigenvalue >= x.pow(i32::try_from(self.word.len().max(1)).unwrap_or(1))
    }
}

/// A word, the largest real eigenvalue of its product, and the root of its absolute value by the length of the word.
struct RatedWord {
    word: Vec<usize>,
    eigenvalue: f64,
    rate: f64,
}

/// The result of a search for lower bounds.
pub(super) struct LowerSearch {
    /// The best bound by the products that every search examines. The search for upper bounds starts from it and
    /// therefore takes the same course with every budget.
    pub(super) first: Option<Lower>,
    /// The best bound by all products.
    pub(super) best: Option<Lower>,
    /// The cost of the products beyond those of every search, in products of the budget.
    pub(super) nodes: u64,
}

/// Returns the bound by the mean of the matrices, which has the eigenvalue 1/d because every column of their sum adds
/// up to b(1) = 1.
pub(super) fn of_mean(matrices: &[ExactMatrix]) -> Lower {
    Lower::new(Vec::new(), Exact::ratio(1, i64::try_from(matrices.len()).unwrap_or(1)))
}

/// Searches for the best lower bounds that products prove within half of a budget, for any matrices. A longer word
/// replaces a shorter one only if it proves more, so that larger budgets prove at least as much.
///
/// # Errors
/// [`Stopped`].
pub(super) fn search(matrices: &[ExactMatrix], budget: u64, watch: &Watch) -> Result<LowerSearch, Stopped> {
    let n = matrices[0].len();
    if n > MAX_PROVED_SIZE {
        return Ok(LowerSearch { first: None, best: None, nodes: 0 });
    }
    let mut words = WordProducts::new(matrices);
    let mut candidates = Vec::new();
    while words.looked_at + words.longer() <= USUAL_WORDS {
        candidates.extend(words.lengthened());
    }
    let first = best_of(matrices, candidates);
    let (mut best, mut nodes) = (first.clone(), 0);
    while words.looked_at + words.longer() <= MAX_WORDS {
        let more = words.longer() as u64 * EIGENVALUE_COST * price(n);
        if nodes + more > budget / 2 {
            break;
        }
        watch.check()?;
        nodes += more;
        let known = best.as_ref().map_or(0.0, |best| best.value) * (1.0 + LEAST_IMPROVEMENT);
        let better: Vec<RatedWord> = words.lengthened().into_iter().filter(|found| found.rate > known).collect();
        best = best_of(matrices, better).filter(|found| found.value > known).or(best);
    }
    Ok(LowerSearch { first, best, nodes })
}

/// Returns the best bound that some candidates prove.
fn best_of(matrices: &[ExactMatrix], mut candidates: Vec<RatedWord>) -> Option<Lower> {
    candidates.sort_by(|a, b| b.rate.total_cmp(&a.rate).then(a.word.len().cmp(&b.word.len())));
    let best = candidates.first().map_or(0.0, |candidate| candidate.rate);
    // the shortest of the best candidates first
    candidates.sort_by_key(
        |candidate| if candidate.rate >= best * (1.0 - LEAST_IMPROVEMENT) { candidate.word.len() } else { 99 },
    );
    candidates.iter().take(MAX_PROOFS).find_map(|candidate| proved(matrices, candidate))
}

/// All words of one length with their products, as the search lengthens them.
struct WordProducts {
    n: usize,
    matrices: Vec<Vec<f64>>,
    last: Vec<(Vec<usize>, Vec<f64>)>,
    /// The number of words examined so far, of all lengths.
    looked_at: usize,
}

impl WordProducts {
    /// Starts with the empty word.
    fn new(matrices: &[ExactMatrix]) -> Self {
        let n = matrices[0].len();
        let flat = matrices.iter().map(|matrix| matrix.iter().flatten().map(rounded).collect()).collect();
        let identity = (0..n * n).map(|k| if k % (n + 1) == 0 { 1.0 } else { 0.0 }).collect();
        Self { n, matrices: flat, last: vec![(Vec::new(), identity)], looked_at: 0 }
    }

    /// Returns the number of words with one letter more.
    fn longer(&self) -> usize {
        self.last.len() * self.matrices.len()
    }

    /// Replaces the words by those with one letter more, and returns their candidates.
    fn lengthened(&mut self) -> Vec<RatedWord> {
        let mut longer = Vec::with_capacity(self.longer());
        let mut found = Vec::new();
        for (word, left) in &self.last {
            for (e, right) in self.matrices.iter().enumerate() {
                let mut matrix = Vec::new();
                multiply(left, right, self.n, &mut matrix);
                let word: Vec<usize> = word.iter().copied().chain([e]).collect();
                found.extend(candidate(&word, &matrix, self.n));
                longer.push((word, matrix));
            }
        }
        self.looked_at += longer.len();
        self.last = longer;
        found
    }
}

fn candidate(word: &[usize], matrix: &[f64], n: usize) -> Option<RatedWord> {
    // rotations of a word have the same eigenvalues, so that only the least rotation is examined
    let turned = |by: usize| word[by..].iter().chain(&word[..by]);
    if (1..word.len()).any(|by| turned(by).lt(word.iter())) {
        return None;
    }
    let first = *eigenvalues(matrix, n)?.iter().find(|x| x.im == 0.0)?;
    let rate = pow(first.modulus(), 1.0 / real(word.len()));
    (rate > 0.0).then_some(RatedWord { word: word.to_vec(), eigenvalue: first.re, rate })
}

/// Returns the bound of a candidate, as far as it can be proved.
fn proved(matrices: &[ExactMatrix], candidate: &RatedWord) -> Option<Lower> {
    let mut factors = candidate.word.iter().map(|&e| &matrices[e]);
    let first = factors.next()?.clone();
    let matrix = factors.fold(first, |left, right| product(&left, right));
    let x = candidate.eigenvalue;
    let simple = exact::simple(x).filter(|t| sign(&matrix, t) == Ordering::Equal);
    let slightly = SHARES_BELOW.map(|share| binary(x * (1.0 - share)));
    let mut tried = simple.into_iter().chain(slightly);
    let holds = |t: &Exact| {
        // at -t the leading term has the sign of (-1)^N
        let flips = t.is_negative() && matrix.len() % 2 == 1;
        let sign = sign(&matrix, t);
        (if flips { sign.reverse() } else { sign }) != Ordering::Greater
    };
    let found = tried.find(holds)?;
    Some(Lower::new(candidate.word.clone(), found.abs()))
}

/// Returns the sign of `det(t - matrix)`.
fn sign(matrix: &ExactMatrix, t: &Exact) -> Ordering {
    let shifted = |(i, row): (usize, &Vec<Exact>)| -> Vec<Exact> {
        row.iter().enumerate().map(|(k, x)| if i == k { t - x } else { -x.clone() }).collect()
    };
    determinant_sign(&matrix.iter().enumerate().map(shifted).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nine points in a ring: the first matrix moves each point to the next one, except the last point, which only the
    /// second matrix moves. No product of fewer than nine letters has an eigenvalue other than 0.
    #[test]
    fn larger_budgets_find_longer_words() {
        let moves = |pairs: &[(usize, usize)]| -> ExactMatrix {
            let cell = |i: usize, j: usize| Exact::whole(i64::from(pairs.contains(&(i, j))));
            (0..9).map(|i| (0..9).map(|j| cell(i, j)).collect()).collect()
        };
        let all_but_the_last: Vec<(usize, usize)> = (0..8).map(|i| (i, i + 1)).collect();
        let matrices = [moves(&all_but_the_last), moves(&[(8, 0)])];
        let found = |budget: u64| search(&matrices, budget, &Watch::new()).expect("a search that goes on");
        assert_eq!(found(100_000).best, None);
        let best = found(10_000_000).best.expect("a bound");
        assert_eq!((best.word.len(), best.value), (9, 1.0));
        assert_eq!(found(10_000_000).first, None);
    }
}
