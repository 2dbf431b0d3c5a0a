//! The smoothness of limits of regular nets.

use super::convergence::certificates;
use super::quotient::{Quotient, fraction};
use super::regular::RegularMask;
use super::verdict::Status;
use crate::analysis::smoothness::{SmoothnessCertificate, SmoothnessReport, Symbol};
use crate::math::exact::{Exact, binary};
use crate::math::mask::Mask;
use crate::watch::{Stopped, Watch};

/// The method by which the smoothness of regular nets is proved.
#[derive(Debug, Clone, PartialEq)]
pub enum SmoothnessProof {
    /// The limit is a box spline.
    BoxSpline,
    /// The mask is a product of two curve masks: the report on the first, and on the second if it differs.
    Product(Vec<SmoothnessReport>),
    /// Norms of difference schemes, and the joint spectral radius of a step modulo polynomials, if it is computed.
    Norms(Vec<SmoothnessCertificate>, Option<Box<Quotient>>),
}

/// The smoothness of limits of regular nets.
#[derive(Debug, Clone, PartialEq)]
pub struct RegularSmoothness {
    /// The proof.
    pub proof: SmoothnessProof,
    /// The largest k for which limits are proved to be C^k; -1 if not even convergence is proved.
    pub proved_c: i64,
    /// The smallest k for which C^k is disproved, if any.
    pub disproved_c: Option<i64>,
}

/// Reciprocal of the unit of which weights must be multiples to be regarded as exact, because fractions over a power of
/// two have no roundings. Masks of splines up to degree 20 qualify. Half or twice of it only matters to masks with 21
/// digits.
const DYADIC_DENOMINATOR: f64 = 1_048_576.0;

/// Returns the symbol of a curve mask: the exact symbol if the weights are fractions over a small power of two, or near
/// fractions with small denominators that sum to 1; otherwise the symbol beside the mask.
pub(super) fn symbol(arity: i32, mask: &Mask) -> Option<Symbol> {
    if mask.values.iter().all(|a| (a * DYADIC_DENOMINATOR).fract() == 0.0) {
        let exactly: Vec<Exact> = mask.values.iter().map(|&a| binary(a)).collect();
        return Symbol::exact(arity.into(), mask.first.into(), &exactly);
    }
    let near: Option<Vec<Exact>> = mask.values.iter().map(|&a| fraction(a)).collect();
    let near = near.and_then(|near| Symbol::exact(arity.into(), mask.first.into(), &near));
    near.filter(|symbol| symbol.order > 0).or_else(|| Symbol::beside(arity.into(), mask))
}

/// Divisor of the budget of matrix products for surfaces, whose matrices are larger than those of curves. The rest
/// decides all presets; its time, some 50 ms, is small beside that of the fractions of norms. Half of it narrows
/// intervals by a third; twice of it leaves the push-back with delta = 1/4 undecided.
const BUDGET_DIVISOR: u64 = 10;

impl RegularSmoothness {
    /// Returns what can be proved with at most `nodes` matrix products.
    pub(super) fn of(regular: &RegularMask, nodes: u64, watch: &Watch) -> Result<Self, Stopped> {
        if let Some(k) = regular.spline_smoothness() {
            return Ok(Self { proof: SmoothnessProof::BoxSpline, proved_c: k, disproved_c: Some(k + 1) });
        }
        if let Some([first, second]) = regular.tensor() {
            let both = if first == second { vec![first] } else { vec![first, second] };
            let report = |mask: &Mask| Some(SmoothnessReport::of(symbol(regular.arity, mask)?, nodes, watch));
            if let Some(reports) = both.iter().map(report).collect::<Option<Result<Vec<_>, _>>>() {
                let reports = reports?;
                let proved_c = reports.iter().map(|report| report.smoothness.proved_c).min().unwrap_or(-1);
                let disproved_c = reports.iter().filter_map(|report| report.smoothness.disproved_c).min();
                return Ok(Self { proof: SmoothnessProof::Product(reports), proved_c, disproved_c });
            }
        }
        let certificates = certificates(regular);
        let by_norms = i64::try_from(certificates.len()).unwrap_or(0) - 1;
        let quotient = Quotient::of(regular, nodes / BUDGET_DIVISOR, watch)?.map(Box::new);
        let proved_c = quotient.as_ref().map_or(by_norms, |quotient| quotient.proved_c.max(by_norms));
        let disproved_c = quotient.as_ref().and_then(|quotient| quotient.disproved_c);
        Ok(Self { proof: SmoothnessProof::Norms(certificates, quotient), proved_c, disproved_c })
    }

    /// Returns whether limits are proved or disproved to be C^1.
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
