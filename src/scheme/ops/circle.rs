//! A level of the d-ary circle scheme, whose mask depends on alpha.

use super::masked::apply_own;
use crate::math::functions::sin;
use crate::math::mask::Mask;
use crate::scheme::curve_rule::{CurveRule, spread};
use crate::scheme::extent::Extent;
use crate::scheme::operator::{Children, Facts, Nets, Operator, Role};
use crate::scheme::parameters::{ARITY, AVERAGES, FIRST, MASK};
use crate::scheme::polygon_anchor::PolygonAnchor;
use crate::scheme::polygon_net::PolygonNet;
use crate::scheme::settings::LetterSettings;
use crate::scheme::step::{Action, Step, StepValues};
use crate::scheme::step_error::StepError;

/// A level of the d-ary scheme with m averages that reproduces circles sampled at the angle alpha: the mask
/// `d sigma^m E / (sigma(1)^m E(1))` with `sigma = 1 + z + ... + z^(d-1)`, `E` having the coefficients
/// `e[j] = sin((j+1) alpha/d) / sin(alpha/d)` for `0 <= j < d` and `e[2d-2-j] = e[j]`.
#[derive(Debug)]
pub struct Circle;

impl Circle {
    /// Returns the mask at alpha, centred at 0 or half a step before it; `None` where it has a pole.
    pub fn mask(arity: u32, averages: u32, alpha: f64) -> Option<Mask> {
        let angle = alpha / f64::from(arity);
        let term = |j: u32| {
            let k = f64::from(j);
            if angle == 0.0 { k } else { sin(k * angle) / sin(angle) }
        };
        let scaled = spread(arity, averages, term);
        if scaled.iter().any(|a| !a.is_finite() || a.abs() > 1e9) {
            return None;
        }
        let reach = i32::try_from(scaled.len() / 2).ok()?;
        Some(Mask { first: -reach, values: scaled })
    }
}

static FACTS: Facts = Facts {
    name: "circle-mask",
    doc: "A level of the d-ary scheme that keeps circles of angle alpha a point. Used by the preset d-ary-circle.",
    source: "after Zhang and Wang 2002, section 4.2; space {1, ..., t^(m-1), cos t, sin t}",
    nets: Nets::Polygons("this scheme refines polygons"),
    curve: Some(CurveRule::Circle),
    role: Role::Upsample,
    children: Children::Vertices,
    parameters: &[ARITY, AVERAGES, MASK, FIRST],
    needs_alpha: true,
    ..Facts::USUAL
};

impl Operator for Circle {
    fn facts(&self) -> &'static Facts {
        &FACTS
    }

    fn at_alpha(&self, settings: &mut LetterSettings, alpha: f64) -> Result<(), String> {
        let averages = settings.whole(&AVERAGES).unwrap_or(0);
        let mask = Self::mask(settings.arity(), averages, alpha);
        settings.set_mask(mask.ok_or_else(|| format!("the circle mask has a pole at alpha = {alpha}"))?);
        Ok(())
    }

    fn on_polygon(&self, net: &PolygonNet, values: &StepValues<'_>) -> Result<Step<PolygonNet>, StepError> {
        let settings = values.settings;
        let (landed, rows) = apply_own(net, settings, "a circle mask is scheduled before it is applied")?;
        let lost = net.extent == Extent::Natural && settings.whole(&AVERAGES).is_some_and(|averages| averages > 0);
        let anchor = PolygonAnchor { lost, ..net.as_anchor() };
        let phase = Some(net.phase_after(settings.arity()));
        let next = PolygonNet { duals: 0, phase, anchor: Some(anchor), ..landed };
        Ok(Step { net: next, action: Action::BlendFromAnchor(rows) })
    }
}
