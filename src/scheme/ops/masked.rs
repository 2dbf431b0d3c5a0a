//! A whole level of a linear curve scheme, given by its mask.

use crate::math::mask::Mask;
use crate::math::rows::{RowSource, Rows};
use crate::scheme::curve_rule::CurveRule;
use crate::scheme::mask_range::{MaskRange, steps};
use crate::scheme::operator::{Children, Facts, Nets, Operator, Role};
use crate::scheme::parameters::{ARITY, FIRST, MASK};
use crate::scheme::polygon_net::PolygonNet;
use crate::scheme::settings::LetterSettings;
use crate::scheme::step::{Action, Step, StepValues};
use crate::scheme::step_error::StepError;

/// A level of the scheme `q[j] = sum over i of a[j - d i] p[i]` of arity d with the mask a.
#[derive(Debug)]
pub struct Masked;

static FACTS: Facts = Facts {
    name: "mask",
    doc: "A level of a linear curve scheme of arity d: q[j] = sum over i of a[j - d i] p[i]. Used by presets.",
    source: "Dyn, Subdivision schemes in CAGD, 1992, section 2",
    nets: Nets::Polygons("this scheme refines polygons"),
    curve: Some(CurveRule::Mask),
    role: Role::Upsample,
    parameters: &[ARITY, MASK, FIRST],
    children: Children::Vertices,
    ..Facts::USUAL
};

impl Operator for Masked {
    fn facts(&self) -> &'static Facts {
        &FACTS
    }

    fn on_polygon(&self, net: &PolygonNet, values: &StepValues<'_>) -> Result<Step<PolygonNet>, StepError> {
        let (landed, rows) = apply_own(net, values.settings, "a mask operator has a mask")?;
        let next = PolygonNet { duals: 0, phase: None, anchor: None, ..landed };
        Ok(Step { net: next, action: Action::Blend(rows) })
    }
}

/// Returns the net and the rows after the mask of a letter; `missing` says that it has none.
pub(super) fn apply_own(
    net: &PolygonNet,
    settings: &LetterSettings,
    missing: &'static str,
) -> Result<(PolygonNet, Box<dyn RowSource>), StepError> {
    let mask = settings.mask().ok_or_else(|| StepError::new(missing))?;
    if !net.corners.is_empty() {
        return Err(StepError::new("corners need a word over U, C and P; this scheme is a mask and has none"));
    }
    apply(net, MaskRange::of(settings.arity(), &mask), mask)
}

/// Returns the net and the rows after a mask. Clamped ends keep their position; with a symmetric mask, they would do so
/// in any case.
pub(super) fn apply(
    net: &PolygonNet,
    range: MaskRange,
    mask: Mask,
) -> Result<(PolygonNet, Box<dyn RowSource>), StepError> {
    let (landed, preimages) = net.land(range)?;
    let uniform = net.corners.is_empty();
    let old = net.clone();
    let rows = preimages.rows(net.n, move |j, out: &mut Rows| {
        if old.is_corner(old.control(j)) {
            old.add(j, 1.0, out);
            return;
        }
        let d = steps(range.arity);
        let (lowest, highest) = (j - range.last as isize, j - range.first as isize);
        for i in -(-lowest).div_euclid(d)..=highest.div_euclid(d) {
            let weight = mask.at(j - d * i);
            if weight != 0.0 {
                old.add(i, weight, out);
            }
        }
    });
    let margin = usize::try_from(range.first.unsigned_abs() + range.last.unsigned_abs() + 3 * range.arity).unwrap_or(0);
    let rows = if uniform { rows.repeating(range.arity as usize, margin) } else { rows };
    Ok((landed, Box::new(rows)))
}
