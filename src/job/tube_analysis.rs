//! The limit of a straight tube whose rings are tagged as latitude lines: its radius, and the inverse problem.

use super::analysis::{DEFAULT_NODES, too_many_nodes};
use super::codec::Item;
use super::key::{Key, plan_of, versioned};
use crate::analysis::circles::StraightTube;
use crate::analysis::smoothness::{SmoothnessReport, Symbol};
use crate::analysis::surface::latitude_curves;
use crate::fault::{Fault, under};
use crate::math::functions::ratio;
use crate::scheme::plan::{Carried, Plan, PlanInput, Subject};
use crate::watch::{Stopped, Watch};

/// Maximum number of vertices of a ring. Angles below 1e-6 change a circle by rounding errors only; half or twice of it
/// would do as well.
const MAX_VERTICES: u64 = 1_000_000;
/// Approximate milliseconds, most of them for the smoothness of the two curves. With half of it, long searches would
/// take longer than their share; with twice of it, others would wait longer.
const TUBE_ANALYSIS_MS: u64 = 50;

/// Upper bound of the memory in bytes: two masks and their matrix products, as much as for other curves. Half of it
/// suffices for words of a few averages; twice of it would let half as many analyses run at once.
const TUBE_ANALYSIS_BYTES: u64 = 64 << 20;

/// Angles, radians, that differ by less are equal but for the rounding of their decimals, which is a thousandth of it.
/// Half and twice of it accept the same decimals.
const EQUAL_ANGLES_RAD: f64 = 1e-12;

/// The tube that a client asks about.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TubeInput {
    /// Number of vertices of a ring.
    pub vertices: u64,
    /// Number of turns of a ring: 1, except for stars.
    pub turns: u64,
    /// The radius of the control rings, in model units.
    pub control_radius: Option<f64>,
    /// The desired limit radius, in model units.
    pub limit_radius: Option<f64>,
}

/// A question about a tube.
#[derive(Debug)]
pub struct TubeAnalysis {
    asked: TubeInput,
    tube: StraightTube,
    curves: [Symbol; 2],
    nodes: u64,
    key: Key,
}

/// The result for a tube.
#[derive(Debug)]
pub struct TubeFindings {
    /// The tube of the request.
    pub asked: TubeInput,
    /// The angle between neighbours on a ring, in radians.
    pub theta: f64,
    /// The push-back factor of the plan.
    pub delta: f64,
    /// The ratio of the limit radius to the control radius.
    pub factor: f64,
    /// The push-back factor that yields the desired radius from the control radius, if both are given.
    pub wanted_delta: Option<f64>,
    /// The curve scheme along latitude lines, at alpha = 0.
    pub along: SmoothnessReport,
    /// The curve scheme across latitude lines, at alpha = 0.
    pub across: SmoothnessReport,
}

impl TubeAnalysis {
    /// Creates the question about a tube under a plan.
    ///
    /// # Errors
    /// Every fault found, with pointers into the request.
    pub fn new(plan: &PlanInput, asked: TubeInput, nodes: Option<u64>, watch: &Watch) -> Result<Self, Vec<Fault>> {
        let nodes = nodes.unwrap_or(DEFAULT_NODES);
        let mut faults = asked.faults();
        faults.extend(too_many_nodes(nodes));
        let subject = Subject { is_mesh: true, carried: Some(Carried::Latitude), ..Subject::default() };
        let plan = Plan::resolve(plan, subject).map_err(|found| under("/plan", found));
        let plan = plan.map_err(|found| faults.extend(found)).ok().filter(|_| faults.is_empty());
        let Some(plan) = plan else { return Err(faults) };
        let refused = |detail: String| vec![Fault::new("/plan", detail)];
        let theta = std::f64::consts::TAU * ratio_of(asked.turns, asked.vertices);
        let own = plan.latitude.as_ref().is_none_or(|latitude| latitude.own_alpha);
        if !own && (plan.alpha - theta).abs() > EQUAL_ANGLES_RAD {
            return Err(refused(format!("alpha is {}, a ring of the tube needs {theta}; leave it out", plan.alpha)));
        }
        let tube = StraightTube::of(&plan, theta).map_err(refused)?;
        let curves = latitude_curves(&plan, watch).map_err(|error| refused(error.to_string()))?;
        if let Some(detail) = asked.without_delta(&tube) {
            return Err(vec![Fault::new("/tube/limit_radius", detail)]);
        }
        let key = key(&plan, &asked, nodes);
        Ok(Self { asked, tube, curves, nodes, key })
    }

    /// Returns the key of the result.
    pub fn key(&self) -> Key {
        self.key
    }

    /// Returns an upper bound of the work, in the units of the watch.
    pub fn work(&self) -> u64 {
        2 * self.nodes
    }

    /// Returns the approximate time in milliseconds on one core.
    pub fn milliseconds(&self) -> u64 {
        self.nodes / 200 + TUBE_ANALYSIS_MS
    }

    /// Returns an upper bound of the memory in bytes.
    pub fn bytes(&self) -> u64 {
        TUBE_ANALYSIS_BYTES
    }

    /// Runs the analysis.
    ///
    /// # Errors
    /// [`Stopped`] when the watch says so.
    pub fn run(&self, watch: &Watch) -> Result<TubeFindings, Stopped> {
        let [along, across] = &self.curves;
        let TubeInput { control_radius, limit_radius, .. } = self.asked;
        let wanted_delta = limit_radius.zip(control_radius).and_then(|(r, c)| self.tube.delta_for(r / c));
        Ok(TubeFindings {
            asked: self.asked,
            theta: self.tube.theta,
            delta: self.tube.delta,
            factor: self.tube.factor(self.tube.delta),
            wanted_delta,
            along: SmoothnessReport::of(along.clone(), self.nodes, watch)?,
            across: SmoothnessReport::of(across.clone(), self.nodes, watch)?,
        })
    }
}

fn ratio_of(a: u64, b: u64) -> f64 {
    ratio(usize::try_from(a).unwrap_or(0), usize::try_from(b).unwrap_or(1).max(1))
}

impl TubeInput {
    fn faults(&self) -> Vec<Fault> {
        let mut faults = Vec::new();
        if !(3..=MAX_VERTICES).contains(&self.vertices) {
            let detail = format!("a ring has 3 to {MAX_VERTICES} vertices, here {}", self.vertices);
            faults.push(Fault::new("/tube/vertices", detail));
        } else if self.turns == 0 || 2 * self.turns.min(self.vertices) >= self.vertices {
            let detail = format!("{} turns of {} vertices are no star; give 1", self.turns, self.vertices);
            faults.push(Fault::new("/tube/turns", detail));
        }
        for (radius, name) in [(self.control_radius, "control_radius"), (self.limit_radius, "limit_radius")] {
            if let Some(radius) = radius.filter(|radius| !radius.is_finite() || *radius <= 0.0) {
                faults.push(Fault::new(format!("/tube/{name}"), format!("{radius} is no radius; give one above 0")));
            }
        }
        faults
    }

    /// Returns why no push-back factor yields the desired radius from the control radius, if both are given.
    fn without_delta(&self, tube: &StraightTube) -> Option<String> {
        let (wanted, control) = self.limit_radius.zip(self.control_radius)?;
        if !tube.pushes {
            return Some("nothing pushes back here, so that one radius follows from the other; leave one out".into());
        }
        let [least, most] = [0.0, 1.0].map(|delta| control * tube.factor(delta));
        let inside = tube.delta_for(wanted / control).is_some();
        (!inside).then(|| {
            format!(
                "{wanted} is out of reach: with delta from 0 to 1 rings of radius {control} become {least} to {most}"
            )
        })
    }
}

/// Returns the key of a question about a tube: over the results version, the plan without what its operators do not
/// use, and the request.
fn key(asked: &Plan, tube: &TubeInput, nodes: u64) -> Key {
    let TubeInput { vertices, turns, control_radius, limit_radius } = tube;
    let radius = |radius: &Option<f64>| Item::List(radius.iter().map(|radius| Item::Number(*radius)).collect());
    // alpha is that of the ring
    let asked = Plan { alpha: 0.0, compensation_alpha: None, ..asked.clone() };
    let items = [
        plan_of(&asked, 1, true, [true, false], Vec::new()),
        Item::List([vertices, turns].map(|n| Item::Integer(*n)).into()),
        radius(control_radius),
        radius(limit_radius),
        Item::Integer(nodes),
    ];
    versioned("planish tube analysis", items)
}
