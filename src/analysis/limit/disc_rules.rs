//! The properties that all discs cut out of the nets of a cycle share.

use crate::scheme::plan::Plan;
use crate::scheme::rules::Rules;
use crate::scheme::tags::Boundary;
use crate::shape::topology::Topology;

/// What holds of all discs of a net.
#[derive(Debug, Clone, Copy)]
pub(super) struct DiscRules {
    /// Rules of the scheme.
    pub(super) rules: Rules,
    /// Where a D makes new vertices with one face: whether they keep their place.
    pub(super) boundary: Boundary,
    /// Whether the net has all vertices that D needs, so that a disc loses some where it was cut out only.
    pub(super) cut: bool,
    /// Boundaries are cut in every so many-th step.
    pub(super) boundary_every: u32,
}

impl DiscRules {
    /// Of the nets that a plan makes of a mesh.
    pub(super) fn of(plan: &Plan, topology: &Topology) -> Self {
        let is_open = topology.n_boundary() > 0;
        let cut = !is_open && (0..topology.n_vertices()).all(|v| topology.ring(v).nth(2).is_some());
        let boundary = if is_open { plan.boundary } else { Boundary::EdgeOnly };
        let boundary_every = plan.word.cycle.iter().map(|letter| letter.facts().boundary_every).max().unwrap_or(1);
        Self { rules: plan.rules, boundary, cut, boundary_every }
    }
}
