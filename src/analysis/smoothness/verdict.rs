//! Conclusions on smoothness from bounds and certificates.

use num_traits::{One, Signed};

use super::lower::{self, Lower, LowerSearch};
use super::matrices::of_residual;
use super::norms::{SmoothnessCertificate, certificates};
use super::reduction::Reduction;
use super::stability::is_stable;
use super::symbol::Symbol;
use super::upper::{self, Upper};
use crate::math::exact::{Exact, binary, rounded};
use crate::math::functions::ln;
use crate::math::number::Number;
use crate::watch::{Stopped, Watch};

/// Relative amount by which the radius of a rounded scheme must exceed a threshold to disprove smoothness. It is a
/// million times the effect of rounding on short masks. Half or twice of it only matters to schemes that lie as close
/// to the end of a range.
const DISPROOF_MARGIN: f64 = 1e-6;

/// The conclusion on the smoothness of limits.
#[derive(Debug, Clone, PartialEq)]
pub struct Smoothness {
    /// The certificates by norms.
    pub certificates: Vec<SmoothnessCertificate>,
    /// The largest k for which limits are proved to be C^k; -1 if not even convergence is proved.
    pub proved_c: i64,
    /// The largest k for which C^k is proved by contracting differences of the scheme itself; such proofs carry over to
    /// schemes that converge to it.
    pub contracts_c: i64,
    /// The smallest k for which C^k is disproved, if any.
    pub disproved_c: Option<i64>,
    /// Whether the integer shifts of the basic limit function are proved to be stable.
    pub is_stable: bool,
    /// If the shifts are not stable: the scheme with stable shifts of whose basic limit function this scheme's is a
    /// combination.
    pub reduction: Option<Reduction>,
    /// Bounds of the joint spectral radius of the residual's matrices; `None` without sum rules.
    pub radius: Option<Radius>,
}

/// Bounds of the joint spectral radius and of the Hoelder exponent.
#[derive(Debug, Clone, PartialEq)]
pub struct Radius {
    /// The lower bound of the radius.
    pub lower: Lower,
    /// The upper bound of the radius.
    pub upper: Upper,
    /// The lower and the upper bound of the Hoelder exponent; the upper bound needs stable shifts, or a reduction to a
    /// scheme with stable shifts.
    pub holder: [f64; 2],
}

impl Smoothness {
    /// Returns what can be proved with at most `budget` matrix products.
    ///
    /// # Errors
    /// [`Stopped`].
    pub fn of(symbol: &Symbol, budget: u64, watch: &Watch) -> Result<Self, Stopped> {
        let Some(most) = i64::try_from(symbol.order).ok().filter(|order| *order > 0) else {
            let (certificates, reduction, radius) = (Vec::new(), None, None);
            let (proved_c, contracts_c, disproved_c) = (-1, -1, Some(0));
            return Ok(Self { certificates, proved_c, contracts_c, disproved_c, is_stable: false, reduction, radius });
        };
        let is_stable = is_stable(symbol);
        let certificates = certificates(symbol);
        watch.check()?;
        let matrices = of_residual(&symbol.residual, symbol.arity);
        // limits are C^k if the radius is below d^(K-1-k)
        let threshold = |k: i64| threshold(symbol, most - 1 - k);
        let LowerSearch { first, best, nodes } = lower::search(&matrices, budget, watch)?;
        let first = first.unwrap_or_else(|| lower::of_mean(&matrices));
        let lower = best.unwrap_or_else(|| first.clone());
        let thresholds: Vec<Exact> = (0..most).map(threshold).collect();
        let upper = upper::bound(&matrices, &first, &thresholds, budget - nodes, watch)?.after(nodes);
        let by_radius = (0..most).rev().find(|&k| upper.stays_below(&threshold(k)));
        let by_norms = certificates.iter().filter_map(|c| i64::try_from(c.k).ok()).max();
        let proved_c = by_radius.max(by_norms).unwrap_or(-1);
        let disproved_c = disproved(symbol, &lower, most);
        let holder = [exponent(symbol, &over(&upper), -1.0), exponent(symbol, &binary(lower.value), 1.0)];
        // a scheme whose differences do not contract diverges, whether its shifts are stable or not
        let diverges = disproved_c == Some(0);
        let disproved_c = disproved_c.filter(|_| is_stable || diverges);
        let left = budget.saturating_sub(upper.nodes);
        let radius = Some(Radius { lower, upper, holder });
        let (contracts_c, reduction) = (proved_c, None);
        let found = Self { certificates, proved_c, contracts_c, disproved_c, is_stable, reduction, radius };
        match if is_stable || diverges { None } else { Reduction::of(symbol) } {
            Some(reduction) => found.with(reduction, left, watch),
            None => Ok(found),
        }
    }

    /// Adds the results for the scheme with stable shifts: the two basic limit functions are C^k for the same k.
    /// Convergence does not carry over; the matrices of the scheme itself have to prove it.
    fn with(self, reduction: Reduction, budget: u64, watch: &Watch) -> Result<Self, Stopped> {
        let stable = Self::of(&reduction.symbol, budget, watch)?;
        let proved_c = if self.proved_c < 0 { -1 } else { self.proved_c.max(stable.proved_c) };
        let radius = self.radius.zip(stable.radius).map(|(own, of_stable)| {
            let Radius { lower, upper, holder: [least, _] } = own;
            let upper = upper.after(of_stable.upper.nodes);
            Radius { lower, upper, holder: [least.max(of_stable.holder[0]), of_stable.holder[1]] }
        });
        Ok(Self { proved_c, disproved_c: stable.disproved_c, reduction: Some(reduction), radius, ..self })
    }
}

/// Returns the smallest k for which limits are not C^k, given stable shifts: the radius is at least `d^(K-1-k)`, or
/// there are no K + 1 sum rules. If the mask is rounded, the radius must exceed the threshold by far more than rounding
/// can explain, and a missing sum rule disproves nothing.
fn disproved(symbol: &Symbol, lower: &Lower, most: i64) -> Option<i64> {
    let margin = if symbol.is_exact { Exact::one() } else { Exact::one() + binary(DISPROOF_MARGIN) };
    let found = (0..most).find(|&k| lower.reaches(&(threshold(symbol, most - 1 - k) * &margin)));
    found.or_else(|| symbol.is_exact.then_some(most))
}

/// Returns `d^n`.
fn threshold(symbol: &Symbol, n: i64) -> Exact {
    Exact::whole(symbol.arity).pow(i32::try_from(n).unwrap_or(0))
}

fn over(upper: &Upper) -> Exact {
    upper.exact.clone().unwrap_or_else(|| binary(upper.value))
}

/// Returns `(K - 1) - log_d(rho)`, exactly if it is a whole number, otherwise rounded in `direction`.
fn exponent(symbol: &Symbol, radius: &Exact, direction: f64) -> f64 {
    let (d, most) = (Exact::whole(symbol.arity), f64::whole(i64::try_from(symbol.order).unwrap_or(1) - 1));
    let mut power = Exact::one();
    for whole in 0..64 {
        if *radius == power {
            return most - f64::whole(whole);
        }
        if *radius == power.recip() {
            return most + f64::whole(whole);
        }
        power *= &d;
    }
    debug_assert!(radius.is_positive(), "bounds are above 0");
    let exponent = most - ln(rounded(radius)) / ln(rounded(&d));
    // covers some roundings of logarithms and their quotient
    exponent + direction * 8.0 * f64::EPSILON * (1.0 + exponent.abs() + most)
}
