//! A lower bound of the joint spectral radius: a product of matrices with an eigenvalue that is proved.
//!
//! Eigenvalues of products in f64 say where to look. The proof is exact: the characteristic polynomial of a product of
//! l matrices has the leading coefficient 1, so that it has a real zero of at least t where it is not positive at t,
//! and then the joint spectral radius is at least `t^(1/l)`.

use std::cmp::Ordering;

use num_traits::Signed;

use super::matrices::{ExactMatrix, multiply, price, product};
use crate::math::elimination::determinant_sign;
use crate::math::exact::{self, Exact, below, binary, rounded};
use crate::math::functions::pow;
use crate::math::number::Number;
use crate::math::spectrum::eigenvalues;
use crate::watch::{Stopped, Watch};

/// Products that every search looks at, whatever its budget.
/// It is words of up to seven letters for binary schemes, of four for ternary ones. All extremal products that are
/// known here have two letters at most; half of it saves half the time, twice of it takes one letter more.
const USUAL_WORDS: usize = 256;
/// Most products that are looked at.
/// It is words of up to twelve letters for binary schemes, which take some ten megabytes. Half of it has one letter
/// less; twice of it takes twice as much memory.
const MAX_WORDS: usize = 1 << 13;
/// As how many products of the budget one counts whose eigenvalues are computed.
/// It is what these take over a product. Half and twice of it need half and twice of a budget for one letter more.
const EIGENVALUES: u64 = 128;
/// Largest matrices whose eigenvalues are proved.
/// The 2n-point schemes come to 28 for n = 16. Half of it leaves those from n = 9 on without a bound; twice of it takes
/// some thirty times as long, as the numbers of the elimination grow.
const MAX_SIZE: usize = 32;
/// Most products whose eigenvalue is tried to be proved.
/// The first succeeds unless its eigenvalues are complex or double. Half and twice of it change nothing else.
const MAX_PROOFS: usize = 8;
/// A longer word has to be better by so much, so that powers of a word do not stand for it.
const BETTER: f64 = 1e-10;

/// A lower bound of the joint spectral radius, `t^(1/l)`.
#[derive(Debug, Clone, PartialEq)]
pub struct Lower {
    /// The matrices whose product has an eigenvalue of a size of at least t, the first factor first; none where it is
    /// the mean of all that has it.
    pub word: Vec<usize>,
    /// The bound t of the eigenvalue.
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

    /// A bound of a single matrix.
    pub(super) fn of_one(eigenvalue: Exact) -> Self {
        Self::new(vec![0], eigenvalue)
    }

    /// Whether the joint spectral radius is known to be at least `x >= 0`.
    pub fn reaches(&self, x: &Exact) -> bool {
        self.eigenvalue >= x.pow(i32::try_from(self.word.len().max(1)).unwrap_or(1))
    }
}

/// A word and what its eigenvalue comes to.
struct Candidate {
    word: Vec<usize>,
    eigenvalue: f64,
    rate: f64,
}

/// What a search for lower bounds has found.
pub(super) struct Search {
    /// By the products that every search looks at; the search for upper bounds starts from it, so that it goes the same
    /// way with every budget.
    pub(super) first: Option<Lower>,
    /// By all products.
    pub(super) best: Option<Lower>,
    /// What the products beyond those of every search count as.
    pub(super) nodes: u64,
}

/// What the mean of the matrices proves: it has the eigenvalue 1/d, as every column of their sum adds up to b(1) = 1.
pub(super) fn of_mean(matrices: &[ExactMatrix]) -> Lower {
    Lower::new(Vec::new(), Exact::ratio(1, i64::try_from(matrices.len()).unwrap_or(1)))
}

/// The best lower bounds of any matrices that products of up to half of a budget prove. A longer word takes the place
/// of a shorter one where it proves more alone, so that larger budgets prove at least as much.
///
/// # Errors
/// [`Stopped`].
pub(super) fn search(matrices: &[ExactMatrix], budget: u64, watch: &Watch) -> Result<Search, Stopped> {
    let n = matrices[0].len();
    if n > MAX_SIZE {
        return Ok(Search { first: None, best: None, nodes: 0 });
    }
    let mut words = Words::new(matrices);
    let mut candidates = Vec::new();
    while words.looked_at + words.longer() <= USUAL_WORDS {
        candidates.extend(words.lengthened());
    }
    let first = best_of(matrices, candidates);
    let (mut best, mut nodes) = (first.clone(), 0);
    while words.looked_at + words.longer() <= MAX_WORDS {
        let more = words.longer() as u64 * EIGENVALUES * price(n);
        if nodes + more > budget / 2 {
            break;
        }
        watch.check()?;
        nodes += more;
        let known = best.as_ref().map_or(0.0, |best| best.value) * (1.0 + BETTER);
        let better: Vec<Candidate> = words.lengthened().into_iter().filter(|found| found.rate > known).collect();
        best = best_of(matrices, better).filter(|found| found.value > known).or(best);
    }
    Ok(Search { first, best, nodes })
}

/// The best bound of some candidates.
fn best_of(matrices: &[ExactMatrix], mut candidates: Vec<Candidate>) -> Option<Lower> {
    candidates.sort_by(|a, b| b.rate.total_cmp(&a.rate).then(a.word.len().cmp(&b.word.len())));
    let best = candidates.first().map_or(0.0, |candidate| candidate.rate);
    // among those that are as good as the best the shortest first
    candidates.sort_by_key(|candidate| if candidate.rate >= best * (1.0 - BETTER) { candidate.word.len() } else { 99 });
    candidates.iter().take(MAX_PROOFS).find_map(|candidate| proved(matrices, candidate))
}

/// All words of one length with their products.
struct Words {
    n: usize,
    matrices: Vec<Vec<f64>>,
    last: Vec<(Vec<usize>, Vec<f64>)>,
    /// Words that were looked at, of all lengths.
    looked_at: usize,
}

impl Words {
    /// The word without letters.
    fn new(matrices: &[ExactMatrix]) -> Self {
        let n = matrices[0].len();
        let flat = matrices.iter().map(|matrix| matrix.iter().flatten().map(rounded).collect()).collect();
        let identity = (0..n * n).map(|k| if k % (n + 1) == 0 { 1.0 } else { 0.0 }).collect();
        Self { n, matrices: flat, last: vec![(Vec::new(), identity)], looked_at: 0 }
    }

    /// How many words have one letter more.
    fn longer(&self) -> usize {
        self.last.len() * self.matrices.len()
    }

    /// Goes on to the words with one letter more, and tells their eigenvalues.
    fn lengthened(&mut self) -> Vec<Candidate> {
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

fn candidate(word: &[usize], matrix: &[f64], n: usize) -> Option<Candidate> {
    // turned around it is the same: only the first of all turns is looked at
    let turned = |by: usize| word[by..].iter().chain(&word[..by]);
    if (1..word.len()).any(|by| turned(by).lt(word.iter())) {
        return None;
    }
    let first = *eigenvalues(matrix, n)?.iter().find(|x| x.im == 0.0)?;
    #[expect(clippy::cast_precision_loss, reason = "words are short")]
    let rate = pow(first.modulus(), 1.0 / word.len() as f64);
    (rate > 0.0).then_some(Candidate { word: word.to_vec(), eigenvalue: first.re, rate })
}

/// The bound of a candidate, as far as it can be proved.
fn proved(matrices: &[ExactMatrix], candidate: &Candidate) -> Option<Lower> {
    let mut factors = candidate.word.iter().map(|&e| &matrices[e]);
    let first = factors.next()?.clone();
    let matrix = factors.fold(first, |left, right| product(&left, right));
    let x = candidate.eigenvalue;
    let simple = exact::simple(x).filter(|t| sign(&matrix, t) == Ordering::Equal);
    let slightly = |share: f64| Some(binary(x * (1.0 - share)));
    let tried = [simple, slightly(1e-13), slightly(1e-12), slightly(1e-10), slightly(1e-8), slightly(1e-6)];
    let holds = |t: &Exact| {
        // at -t the sign of the leading term is that of (-1)^N
        let flips = t.is_negative() && matrix.len() % 2 == 1;
        let sign = sign(&matrix, t);
        (if flips { sign.reverse() } else { sign }) != Ordering::Greater
    };
    let found = tried.into_iter().flatten().find(holds)?;
    Some(Lower::new(candidate.word.clone(), found.abs()))
}

/// The sign of `det(t - matrix)`.
fn sign(matrix: &ExactMatrix, t: &Exact) -> Ordering {
    let shifted = |(i, row): (usize, &Vec<Exact>)| -> Vec<Exact> {
        row.iter().enumerate().map(|(k, x)| if i == k { t - x } else { -x.clone() }).collect()
    };
    determinant_sign(&matrix.iter().enumerate().map(shifted).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nine points in a ring: the first matrix moves each to the next, but the last, which only the second moves. No
    /// product of fewer than nine letters has an eigenvalue but 0.
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
