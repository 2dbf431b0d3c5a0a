//! The properties that all discs cut out of the nets of a cycle share.

use crate::scheme::plan::Plan;
use crate::scheme::rules::Rules;
use crate::scheme::tags::Boundary;
use crate::shape::topology::Topology;

/// The properties common to all discs of a net.
#[derive(Debug, Clone, Copy)]
pub(super) struct DiscRules {
    /// The rules of the scheme.
    pub(super) rules: Rules,
    /// How D treats new vertices with one face: whether they keep their place.
    pub(super) boundary: Boundary,
    /// Whether the net has all vertices that D needs, so that a disc lacks some only because it was cut out.
    pub(super) cut: bool,
    /// The period, in steps, at which boundaries are cut.
    pub(super) boundary_every: u32,
}

impl DiscRules {
    /// Returns the properties of the nets that a plan makes of a mesh.
    pub(super) fn of(plan: &Plan, topology: &Topology) -> Self {
        let is_open = topology.n_boundary() > 0;
        let cut = !is_open && (0..topology.n_vertices()).all(|v| topology.ring(v).nth(2).is_some());
        let boundary = if is_open { plan.boundary } else { Boundary::EdgeOnly };
        let boundary_every = plan.word.cycle.iter().map(|letter| letter.facts().boundary_every).max().unwrap_or(1);
        Self { rules: plan.rules, boundary, cut, boundary_every }
    }
}
