//! A: the mean of as many neighbours as the arity says, the "window-average" of the catalogue.

use super::dual::cannot_carry;
use super::masked::apply;
use crate::math::mask::Mask;
use crate::math::number::Number;
use crate::scheme::curve_rule::CurveRule;
use crate::scheme::mask_range::MaskRange;
use crate::scheme::operator::{Facts, Nets, Operator, Role};
use crate::scheme::parameters::ARITY;
use crate::scheme::polygon_net::PolygonNet;
use crate::scheme::settings::LetterSettings;
use crate::scheme::step::{Action, Step, StepValues};
use crate::scheme::step_error::StepError;

/// A, the mean of neighbours: `q[j] = (p[j] + ... + p[j + d - 1]) / d` with the arity d of the last U, re-centred.
#[derive(Debug)]
pub(super) struct BoxAverage;

static FACTS: Facts = Facts {
    letter: Some('A'),
    name: "window-average",
    doc: "The mean of d neighbouring points of a curve, d being the arity of the last U; equals D when d is 2. For odd \
     d the point itself stands in the middle; for even d the window reaches further forward the first time after a U, \
     further back the second, and so on. U3 A^(g-1) gives the B-spline of degree g.",
    source: "Zhang and Wang 2002, section 4.2; Lane and Riesenfeld, IEEE PAMI 2 (1980), 35-46",
    nets: Nets::Polygons("A averages the points of polygons; meshes take U, D, C and P"),
    curve: Some(CurveRule::Mean),
    role: Role::Average,
    parameters: &[ARITY],
    needs_upsampling: Some("A needs a U before it: it averages as many points as the arity of the last U"),
    ..Facts::USUAL
};

impl Operator for BoxAverage {
    fn facts(&self) -> &'static Facts {
        &FACTS
    }

    fn mask_range(&self, settings: &LetterSettings, duals: u32) -> Option<MaskRange> {
        Some(MaskRange::mean(settings.arity(), duals % 2 == 1))
    }

    fn on_polygon(&self, net: &PolygonNet, values: &StepValues<'_>) -> Result<Step<PolygonNet>, StepError> {
        let d = values.settings.arity();
        let range = MaskRange::mean(d, net.duals % 2 == 1);
        if !net.corners.is_empty() && range.shifts() {
            return Err(cannot_carry("corners"));
        }
        let mask = Mask { first: range.first, values: vec![f64::ratio(1, d.into()); d as usize] };
        let (landed, rows) = apply(net, range, mask)?;
        Ok(Step { net: landed.shifted(u32::from(range.shifts())), action: Action::Blend(rows) })
    }
}
