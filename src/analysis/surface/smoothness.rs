//! The smoothness of limits of regular nets.

use super::convergence::{LatticeCertificate, certificates};
use super::quotient::{Quotient, fraction};
use super::regular::RegularMask;
use super::verdict::Status;
use crate::analysis::smoothness::{Report, Symbol};
use crate::math::exact::{Exact, binary};
use crate::math::mask::Mask;
use crate::watch::{Stopped, Watch};

/// The method by which the smoothness of regular nets is proved.
#[derive(Debug, Clone, PartialEq)]
pub enum Proof {
    /// The limit is a box spline.
    BoxSpline,
    /// The mask is a product of two masks of curves: what is known of the first, and of the second where it is another.
    Product(Vec<Report>),
    /// Norms of difference schemes, and the radius of what a step leaves of points around a cell, where it is known.
    Norms(Vec<LatticeCertificate>, Option<Box<Quotient>>),
}

/// The smoothness of limits of regular nets.
#[derive(Debug, Clone, PartialEq)]
pub struct RegularSmoothness {
    /// The proof.
    pub proof: Proof,
    /// The largest k for which limits are proved to be C^k, -1 where not even convergence is.
    pub proved_c: i64,
    /// The smallest k for which it is disproved that limits are C^k.
    pub disproved_c: Option<i64>,
}

/// Twice of what weights have to be multiples of to be told exactly: fractions over a power of two have no roundings.
/// Masks of splines up to degree 20 are such. Half and twice of it only matter to those with 21 digits.
const DYADIC: f64 = 1_048_576.0;

/// The symbol of a curve's mask: of what it is exactly where its weights are fractions over a small power of two, or
/// next to fractions with small denominators that sum to 1.
pub(super) fn symbol(arity: i32, mask: &Mask) -> Option<Symbol> {
    if mask.values.iter().all(|a| (a * DYADIC).fract() == 0.0) {
        let exactly: Vec<Exact> = mask.values.iter().map(|&a| binary(a)).collect();
        return Symbol::exact(arity.into(), mask.first.into(), &exactly);
    }
    let near: Option<Vec<Exact>> = mask.values.iter().map(|&a| fraction(a)).collect();
    let near = near.and_then(|near| Symbol::exact(arity.into(), mask.first.into(), &near));
    near.filter(|symbol| symbol.order > 0).or_else(|| Symbol::beside(arity.into(), mask))
}

/// The share of the products that matrices of surfaces may take, which are larger than those of curves.
/// It decides all presets; what it takes, some 50 ms, is little beside the fractions of norms. Half of it narrows
/// intervals by a third; twice of it leaves the push-back with delta = 1/4 undecided.
const SHARE: u64 = 10;

impl RegularSmoothness {
    /// What can be proved with so many products of matrices.
    pub(super) fn of(regular: &RegularMask, nodes: u64, watch: &Watch) -> Result<Self, Stopped> {
        if let Some(k) = regular.spline_smoothness() {
            return Ok(Self { proof: Proof::BoxSpline, proved_c: k, disproved_c: Some(k + 1) });
        }
        if let Some([first, second]) = regular.tensor() {
            let both = if first == second { vec![first] } else { vec![first, second] };
            let report = |mask: &Mask| Some(Report::of(symbol(regular.arity, mask)?, nodes, watch));
            if let Some(reports) = both.iter().map(report).collect::<Option<Result<Vec<_>, _>>>() {
                let reports = reports?;
                let proved_c = reports.iter().map(|report| report.smoothness.proved_c).min().unwrap_or(-1);
                let disproved_c = reports.iter().filter_map(|report| report.smoothness.disproved_c).min();
                return Ok(Self { proof: Proof::Product(reports), proved_c, disproved_c });
            }
        }
        let certificates = certificates(regular);
        let by_norms = i64::try_from(certificates.len()).unwrap_or(0) - 1;
        let quotient = Quotient::of(regular, nodes / SHARE, watch)?.map(Box::new);
        let proved_c = quotient.as_ref().map_or(by_norms, |quotient| quotient.proved_c.max(by_norms));
        let disproved_c = quotient.as_ref().and_then(|quotient| quotient.disproved_c);
        Ok(Self { proof: Proof::Norms(certificates, quotient), proved_c, disproved_c })
    }

    /// Whether limits are proved to be C^1, or not to be.
    pub(super) fn is_c1(&self) -> Status {
        if self.proved_c >= 1 {
            Status::Proved
        } else if self.disproved_c.is_some_and(|k| k <= 1) {
            Status::Disproved
        } else {
            Status::Open
        }
    }
}
