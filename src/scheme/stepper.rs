//! Applies the steps of a plan to polygons and to meshes.

use super::local::Sources;
use super::mesh_net::MeshNet;
use super::operator::Operator;
use super::plan::{Plan, Scheduled};
use super::polygon_net::PolygonNet;
use super::rules::LatitudeRule;
use super::step::{Step, StepValues};
use super::step_error::StepError;

/// A net to which operators are applied.
pub trait Net: Sized {
    /// Applies an operator.
    ///
    /// # Errors
    /// When the operator cannot be applied here.
    fn apply(&self, operator: &dyn Operator, values: &StepValues<'_>) -> Result<Step<Self>, StepError>;
}

impl Net for PolygonNet {
    fn apply(&self, operator: &dyn Operator, values: &StepValues<'_>) -> Result<Step<Self>, StepError> {
        operator.on_polygon(self, values)
    }
}

impl Net for MeshNet {
    fn apply(&self, operator: &dyn Operator, values: &StepValues<'_>) -> Result<Step<Self>, StepError> {
        operator.on_mesh(self, values)
    }
}

/// Takes the steps of one plan.
#[derive(Debug, Clone, Copy)]
pub struct Stepper<'a> {
    plan: &'a Plan,
}

impl<'a> Stepper<'a> {
    /// Creates the stepper of a plan.
    pub fn new(plan: &'a Plan) -> Self {
        Self { plan }
    }

    /// Returns the net after a scheduled step of the plan, and the action on its points.
    ///
    /// # Errors
    /// If the operator cannot be applied to this net.
    pub fn next<N: Net>(self, net: &N, step: &Scheduled) -> Result<Step<N>, StepError> {
        self.next_from(net, step, self.plan.sources(step))
    }

    /// Takes a step in which upsamplings compute the values of single points from `sources`; if that is `None`, all
    /// points have the values of the plan.
    ///
    /// # Errors
    /// If the operator cannot be applied to this net.
    pub fn next_from<N: Net>(
        self,
        net: &N,
        step: &Scheduled,
        sources: Option<Sources<'_>>,
    ) -> Result<Step<N>, StepError> {
        let values = StepValues {
            settings: &step.letter.settings,
            alpha: step.alpha,
            kernel: step.kernel,
            mu: self.plan.mu,
            compensation: step.compensation,
            delta: &self.plan.delta,
            first: step.first,
            latitude_rule: self.plan.latitude.as_ref().map_or(LatitudeRule::Isotropic, |latitude| latitude.rule),
            sources,
        };
        net.apply(step.letter.operator, &values)
    }
}
