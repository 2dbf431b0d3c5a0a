//! The theorems of Zhang and Wang (2002) for plans whose masks change from level to level, and their conclusions.

use num_traits::{Signed, Zero};

use super::smoothness::Symbol;
use super::study::{LEAST_SCHEME_DISTANCE, Study};
use crate::math::exact::Exact;
use crate::math::functions::pow;
use crate::math::number::Number;

/// A theorem, applied to a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct Theorem {
    /// The paper and the number of the theorem.
    pub name: &'static str,
    /// Whether all conditions of the theorem are met.
    pub applies: bool,
    /// The conditions, and how the plan meets them or fails to.
    pub because: String,
    /// What the theorem proves if it applies.
    pub proves: &'static str,
}

/// The bound (11) of theorem 3, as far as the listed levels show it: the norm of the difference between level h and the
/// static limit is at most `c gamma^h`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Decay {
    /// The factor c.
    pub c: f64,
    /// The ratio gamma, below 1.
    pub gamma: f64,
}

impl Decay {
    /// Returns the bound for a plan; `None` if the distances do not shrink.
    pub fn of(study: &Study) -> Option<Self> {
        let gamma = study.rate().filter(|gamma| *gamma < 1.0)?;
        let scaled = (0_u16..).zip(&study.levels).map(|(h, level)| level.distance / pow(gamma, f64::from(h)));
        // the distances of the last levels are rounding errors only
        let n_significant = study.levels.iter().take_while(|level| level.distance > LEAST_SCHEME_DISTANCE).count();
        Some(Self { c: scaled.take(n_significant.max(1)).fold(0.0, f64::max), gamma })
    }
}

/// Applies the theorems to a plan; `converges` says whether its static limit is proved to converge.
pub fn theorems(study: &Study, converges: bool) -> Vec<Theorem> {
    vec![circles(study), in_box(&study.settled), perturbed(study, converges)]
}

fn circles(study: &Study) -> Theorem {
    let applies = study.levels.iter().all(|level| level.keeps_circles);
    let because = if applies {
        "every level refines cos and sin with its own spacing alpha to combinations of themselves"
    } else {
        "some level does not refine cos and sin with its own spacing alpha to combinations of themselves"
    };
    Theorem {
        name: "Zhang and Wang 2002, theorem 1",
        applies,
        because: because.to_owned(),
        proves: "a regular K-gon becomes a circle when alpha is 2 pi/K",
    }
}

/// Applies theorem 2. With `s = (1 - delta)/(4 (1 + f))` and `w = delta omega/(8 (1 + f))` a mask `(-w, s, 1/2 + w, 1 -
/// 2 s, ...)` belongs to some `f > 0`, `|omega| < 2` and `0 <= delta <= 1` if and only if `s >= 0` and `s + |w| < 1/4`.
fn in_box(symbol: &Symbol) -> Theorem {
    let at = |j: i64| symbol.at(j);
    let is_symmetric = (0..=3).all(|j| at(j) == at(-j)) && symbol.first >= -3 && symbol.last() <= 3;
    let (s, w) = (at(2), -at(3));
    let applies = symbol.arity == 2
        && symbol.order >= 1
        && is_symmetric
        && s >= Exact::zero()
        && &s + w.abs() < Exact::ratio(1, 4);
    let because = if applies {
        format!("the static limit has the mask (-w, s, 1/2 + w, 1 - 2s, ...) with s = {s}, w = {w}, s + |w| < 1/4")
    } else {
        "the static limit is not that of one average and a push-back with kernel > 0, |compensation| < 2 and 0 <= \
         delta <= 1"
            .to_owned()
    };
    Theorem {
        name: "Zhang and Wang 2002, theorem 2",
        applies,
        because,
        proves: "limits of the static scheme are continuous; its remark on smoothness is disproved, see docs/papers.md",
    }
}

fn perturbed(study: &Study, converges: bool) -> Theorem {
    let decay = Decay::of(study);
    let because = match (decay, converges) {
        (Some(Decay { c, gamma }), true) => {
            format!("the static limit converges, and level h is within {c:.4} * {gamma:.4}^h of it, as far as listed")
        }
        (Some(_), false) => "the static limit is not proved to converge".to_owned(),
        (None, _) => "the distances of the levels from the static limit do not shrink by a factor".to_owned(),
    };
    Theorem {
        name: "Zhang and Wang 2002, theorem 3",
        applies: decay.is_some() && converges,
        because,
        proves: "limits are continuous; that they are as smooth as those of the static limit takes sum rules of every \
                 level as well, see conclusion.theorem",
    }
}
