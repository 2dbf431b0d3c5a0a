//! A: the window average.

use super::dual::cannot_carry;
use super::masked::apply;
use crate::math::mask::Mask;
use crate::math::number::Number;
use crate::scheme::curve_rule::CurveRule;
use crate::scheme::operator::{Facts, Nets, Operator, Role};
use crate::scheme::parameters::ARITY;
use crate::scheme::polygon_net::PolygonNet;
use crate::scheme::settings::LetterSettings;
use crate::scheme::step::{Action, Step, StepValues};
use crate::scheme::step_error::StepError;
use crate::scheme::window::Window;

/// A, the window average: `q[j] = (p[j] + ... + p[j + d - 1]) / d` with the arity d of the last U, re-centred.
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
    curve: Some(CurveRule::Window),
    role: Role::Average,
    parameters: &[ARITY],
    needs_upsampling: Some("A needs a U before it: it averages as many points as the arity of the last U"),
    ..Facts::USUAL
};

impl Operator for BoxAverage {
    fn facts(&self) -> &'static Facts {
        &FACTS
    }

    fn window(&self, settings: &LetterSettings, duals: u32) -> Option<Window> {
        Some(Window::mean(settings.arity(), duals % 2 == 1))
    }

    fn on_polygon(&self, net: &PolygonNet, values: &StepValues<'_>) -> Result<Step<PolygonNet>, StepError> {
        let d = values.settings.arity();
        let window = Window::mean(d, net.duals % 2 == 1);
        if !net.corners.is_empty() && window.shifts() {
            return Err(cannot_carry("corners"));
        }
        let mask = Mask { first: window.first, values: vec![f64::ratio(1, d.into()); d as usize] };
        let (landed, rows) = apply(net, window, mask)?;
        Ok(Step { net: landed.shifted(u32::from(window.shifts())), action: Action::Blend(rows) })
    }
}
