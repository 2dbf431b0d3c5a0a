//! Tubes: the rings around a latitude line, as far as the scheme reaches, and the circle that the line becomes.

use super::boundary::{RingContinuation, beyond};
use super::outlook::{LimitCircle, Outlook};
use super::profile::Profile;
use super::ring::{CIRCLE_ROUNDING, TubeRing, tilt};
use super::words;
use crate::analysis::limit::{Unlimited, check_continuous};
use crate::math::expression::Expression;
use crate::math::functions::{cos, real};
use crate::math::vector::Vector;
use crate::refine::{carried, mesh_net};
use crate::scheme::operator::Role;
use crate::scheme::plan::{Plan, Scheduled};
use crate::scheme::rules::LatitudeRule;
use crate::shape::attributes::Attributes;
use crate::shape::directions::{Direction, Directions, LatitudeLine};
use crate::shape::mesh::Mesh;
use crate::shape::topology::Topology;

/// Number of levels after which radii have converged. The loop ends when nothing changes any more, so that twice of it
/// only matters to radii that converge more slowly; half of it suffices if each level quarters the change, as cosines
/// of halved angles do.
const RADIUS_LEVELS: u32 = 64;

/// A side of a directed line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum LineSide {
    Left,
    Right,
}

/// The rings on one side of a line, the nearest first.
#[derive(Default)]
struct TubeRings {
    nearest_first: Vec<TubeRing>,
    /// The push-back factor of each ring.
    deltas: Vec<f64>,
    /// The greatest deviation of the rings from the axis of the line, model units.
    tilt: f64,
}

/// Returns the limit of every latitude line of a mesh under a plan. An error as `plan` is the reason why the plan does
/// not fit the mesh; it is then the reason for every closed line.
pub fn outlooks(mesh: &Mesh, plan: Result<&Plan, &str>) -> Vec<Outlook> {
    let Some(directions) = &mesh.directions else { return Vec::new() };
    let lines = directions.lines(&mesh.topology).into_iter();
    let tube = plan.map_err(|reason| format!("the plan does not fit the mesh: {reason}"));
    let tube = tube.and_then(|plan| Tube::of(mesh, directions, plan));
    let circle = |line: &LatitudeLine| {
        if !line.closed {
            return Err("the line is open".into());
        }
        tube.as_ref().map_err(Clone::clone)?.circle(line)
    };
    lines.map(|line| Outlook { circle: circle(&line), line }).collect()
}

struct Tube<'a> {
    mesh: &'a Mesh,
    directions: &'a Directions,
    plan: &'a Plan,
    rule: LatitudeRule,
    /// Whether the word of the plan pushes anything back.
    pushes: bool,
    /// The vertex attributes that the plan uses.
    attributes: Attributes,
    /// Whether each vertex has exactly two latitude edges.
    on_line: Vec<bool>,
    steps: Vec<Scheduled>,
}

impl<'a> Tube<'a> {
    /// Prepares what all lines of a mesh share.
    ///
    /// # Errors
    /// A sentence if no line can become a circle.
    fn of(mesh: &'a Mesh, directions: &'a Directions, plan: &'a Plan) -> Result<Self, String> {
        let rule = plan.latitude.as_ref().map_or(LatitudeRule::Isotropic, |latitude| latitude.rule);
        if plan.perturbation.is_some_and(|perturbation| perturbation.amplitude != 0.0) {
            return Err("the plan perturbs kernel and compensation at random".into());
        }
        if !words::keeps_circles(&plan.word, rule) {
            return Err("only words in which a C follows each U, as U C^k and U C^k P, keep circles".into());
        }
        let pushes = words::pushes(&plan.word);
        let mut attributes = carried(mesh, plan).0.unwrap_or_default();
        attributes.delta = attributes.delta.filter(|_| pushes);
        attributes.compensation = attributes.compensation.filter(|_| pushes);
        if attributes.kernel.is_some() || attributes.compensation.is_some() {
            return Err("vertices carry a kernel or a compensation, which stay the same at all levels; circles need \
                        cos(alpha/2) and 1/cos(alpha/2)"
                .into());
        }
        let on_line = directions.latitude_pairs(&mesh.topology).iter().map(Option::is_some).collect();
        let steps = plan.schedule(RADIUS_LEVELS).map_err(|fault| fault.detail)?;
        if let Err(reason @ (Unlimited::Rough | Unlimited::Unsettled)) = check_continuous(plan, &mesh_net(mesh, plan)) {
            return Err(reason.to_string());
        }
        let tube = Self { mesh, directions, plan, rule, pushes, attributes, on_line, steps };
        if rule == LatitudeRule::Isotropic && tube.is_pushed() {
            return Err("the plan does not look at latitude tags, and pushes vertices back".into());
        }
        Ok(tube)
    }

    fn topology(&self) -> &Topology {
        &self.mesh.topology
    }

    fn circle(&self, line: &LatitudeLine) -> Result<LimitCircle, String> {
        let [given, widest] = words::reach(&self.steps, self.is_pushed());
        let (ring, delta) = (self.ring(&line.vertices)?, self.delta(&line.vertices)?);
        let alpha = self.alpha(&line.vertices)?;
        let mut like = ring;
        let sides = match self.beyond_ring(&line.vertices)? {
            RingContinuation::End => [LineSide::Left, LineSide::Right].map(|_| TubeRings::default()),
            RingContinuation::Smooth => [
                self.side(line, &mut like, LineSide::Left, given)?,
                self.side(line, &mut like, LineSide::Right, given)?,
            ],
        };
        let [left, right] = sides;
        let place = left.nearest_first.len();
        let rings: Vec<TubeRing> =
            left.nearest_first.into_iter().rev().chain([ring]).chain(right.nearest_first).collect();
        let deltas: Vec<f64> = left.deltas.into_iter().rev().chain([delta]).chain(right.deltas).collect();
        let irregularity = rings.iter().map(|ring| ring.irregularity).fold(left.tilt.max(right.tilt), f64::max);
        let profile = Profile::of(&rings, deltas, place, widest);
        // a ring without extent takes the winding number of the others
        Ok(LimitCircle { radius: self.limit(line.vertices.len(), like.winding, alpha, &profile)?, irregularity })
    }

    /// Returns whether vertices of valence 4 are pushed back.
    fn is_pushed(&self) -> bool {
        match &self.attributes.delta {
            Some(delta) => delta.iter().any(|&delta| delta != 0.0),
            None => self.pushes && self.plan.delta.value(4.0) != Ok(0.0),
        }
    }

    /// Returns the rings on one side of a line, up to `reach` rings or the end of the tube. All of them share the axis
    /// of `like`, which is replaced by the first ring with an extent if it has none.
    fn side(
        &self,
        line: &LatitudeLine,
        like: &mut TubeRing,
        side: LineSide,
        reach: usize,
    ) -> Result<TubeRings, String> {
        let mut rings = TubeRings::default();
        let mut vertices = line.vertices.clone();
        let alpha = self.alpha(&line.vertices)?;
        for away in 1..=reach {
            let place = if away == 1 { "next to it".to_owned() } else { format!("{away} rings away") };
            let at = |what: String| format!("{place}, {what}");
            vertices = self.beyond(&vertices, side).map_err(|what| at(what.into()))?;
            let found = self.ring(&vertices).map_err(at)?;
            rings.tilt = rings.tilt.max(tilt(like, &found).map_err(at)?);
            if like.axis.is_none() {
                *like = found;
            }
            if self.alpha(&vertices).map_err(at)?.map(f64::to_bits) != alpha.map(f64::to_bits) {
                return Err(at("vertices have another alpha".into()));
            }
            rings.nearest_first.push(found);
            if away == reach {
                // only the position of the last ring has an influence, provided that its push-back does not depend on
                // valence
                self.check_pushed_alike(&vertices).map_err(at)?;
                rings.deltas.push(0.0);
                break;
            }
            rings.deltas.push(self.delta(&vertices).map_err(at)?);
            if self.beyond_ring(&vertices).map_err(at)? == RingContinuation::End {
                break;
            }
        }
        Ok(rings)
    }

    /// Returns the neighbours of the vertices of a line on one side, in the order of the line.
    fn beyond(&self, line: &[u32], side: LineSide) -> Result<Vec<u32>, &'static str> {
        let topology = self.topology();
        let mut sides = Vec::with_capacity(line.len());
        for (i, &v) in line.iter().enumerate() {
            let w = line[(i + 1) % line.len()];
            let (from, to) = if side == LineSide::Left { (v, w) } else { (w, v) };
            let half_edge = topology.ring(from as usize).find(|&c| topology.vertex(topology.next(c)) == to);
            let half_edge = half_edge.ok_or("the boundary cuts the tube")?;
            let (after, before) = (topology.next(half_edge), topology.previous(half_edge));
            let along = [after, before].map(|c| self.directions.of(topology.edge(c)));
            if topology.face(topology.face_of(half_edge)).len() != 4 || along != [Direction::Longitude; 2] {
                return Err("a face is no quad between two longitude edges");
            }
            if self.directions.of(topology.edge(topology.next(after))) != Direction::Latitude {
                return Err("the tube is not tagged");
            }
            let ends = [topology.vertex(before), topology.vertex(topology.next(after))];
            sides.push(if side == LineSide::Left { ends } else { [ends[1], ends[0]] });
        }
        let joined = (0..sides.len()).all(|i| sides[i][1] == sides[(i + 1) % sides.len()][0]);
        if joined { Ok(sides.iter().map(|ends| ends[0]).collect()) } else { Err("a vertex has more than four edges") }
    }

    /// Classifies the ring of these vertices by whether rings beyond it have an influence.
    fn beyond_ring(&self, ring: &[u32]) -> Result<RingContinuation, String> {
        beyond(self.mesh, &self.on_line, ring)
    }

    /// Returns the regular polygon of these vertices.
    fn ring(&self, vertices: &[u32]) -> Result<TubeRing, String> {
        let point = |v: &u32| -> Vector { std::array::from_fn(|k| self.mesh.positions[3 * *v as usize + k]) };
        TubeRing::of(&vertices.iter().map(point).collect::<Vec<_>>()).ok_or("the ring is no regular polygon".into())
    }

    /// Returns the alpha that all these vertices carry; `None` if they have the alpha of the plan.
    fn alpha(&self, vertices: &[u32]) -> Result<Option<f64>, String> {
        let Some(alpha) = &self.attributes.alpha else { return Ok(None) };
        same(alpha, vertices).map(Some).ok_or("alpha differs from vertex to vertex".into())
    }

    /// Returns the push-back factor of all these vertices.
    fn delta(&self, vertices: &[u32]) -> Result<f64, String> {
        match &self.attributes.delta {
            Some(delta) => same(delta, vertices).ok_or("delta differs from vertex to vertex".into()),
            None if !self.pushes => Ok(0.0),
            None => self.plan.delta.value(4.0).map_err(|error| error.to_string()),
        }
    }

    /// Refuses a ring on which the plan pushes vertices back because of their valence although it does not push
    /// vertices of valence 4 back. Rings farther away would then have an influence, and beyond such vertices there is
    /// no tube.
    fn check_pushed_alike(&self, ring: &[u32]) -> Result<(), String> {
        if !self.pushes
            || self.attributes.delta.is_some()
            || self.is_pushed()
            || self.beyond_ring(ring) == Ok(RingContinuation::End)
        {
            return Ok(());
        }
        let is_pushed = |&&v: &&u32| {
            let topology = self.topology();
            let inside = topology.boundary_edges(v as usize).is_none();
            inside && self.plan.delta.value(real(topology.ring(v as usize).count())) != Ok(0.0)
        };
        let pushed = ring.iter().find(is_pushed);
        let valence = |&v: &u32| self.topology().ring(v as usize).count();
        pushed.map(valence).map_or(Ok(()), |n| Err(format!("a vertex has {n} edges, where delta is not 0")))
    }

    /// Returns the limit radius of a line of `n` vertices that goes around the axis `winding` times and carries this
    /// `alpha`.
    ///
    /// Going around `p` times one way is the same as going around `n - p` times the other way, so that the alpha of
    /// either is right.
    fn limit(&self, n: usize, winding: f64, alpha: Option<f64>, profile: &Profile) -> Result<f64, String> {
        let other = real(n) - winding;
        let radius_at = |winding: f64| self.radius_at(std::f64::consts::TAU * winding / real(n), alpha, profile);
        radius_at(winding).or_else(|said| radius_at(other).map_err(|_| said)).map_err(|said| {
            let or = if winding > 1.0 { format!(" or {} pi / {n}", 2.0 * other) } else { String::new() };
            said.unwrap_or_else(|| {
                format!(
                    "circles need the kernel cos(alpha/2), 1 in later averages, and the compensation 1/cos(alpha/2) \
                     with alpha = {} pi / {n}{or}",
                    2.0 * winding
                )
            })
        })
    }

    /// Returns the limit radius of a line whose neighbouring vertices are the angle `theta` apart. Otherwise the line
    /// is no circle; the error carries a reason only if it is something other than the values of kernel and
    /// compensation.
    fn radius_at(&self, mut theta: f64, alpha: Option<f64>, profile: &Profile) -> Result<f64, Option<String>> {
        let mut profile = profile.clone();
        let compensated = profile.is_pushed() || self.rule == LatitudeRule::Position;
        for level in self.steps.chunk_by(|a, b| a.level == b.level) {
            let before = profile.here();
            for block in level.chunk_by(|_, b| b.letter.facts().role != Role::Upsample) {
                profile = profile.refined(block, self.along(block, theta, alpha, compensated)?, theta);
                theta /= 2.0;
            }
            if level[0].level > 0 && profile.has_settled(before) {
                break;
            }
        }
        Ok(profile.radius())
    }

    /// Returns the kernel along the axis in a block that begins with an upsampling, if the block preserves circles.
    fn along(
        &self,
        block: &[Scheduled],
        theta: f64,
        alpha: Option<f64>,
        compensated: bool,
    ) -> Result<f64, Option<String>> {
        let upsampling = &block[0];
        let alpha_of = |plan: f64| alpha.map_or(plan, |alpha| alpha * upsampling.scale);
        let value = |function: &Expression, alpha: f64| function.value(alpha).map_err(|error| Some(error.to_string()));
        let c = cos(theta / 2.0);
        let kernel = value(self.plan.kernel.first().ok_or(None)?, alpha_of(upsampling.alpha))?;
        let pushed = words::pushes_back(block) && compensated;
        let seen = match self.plan.compensation_alpha {
            Some(_) => upsampling.compensation_alpha,
            None => alpha_of(upsampling.compensation_alpha),
        };
        let omega = value(&self.plan.compensation, seen)?;
        let later = block.iter().filter(|step| step.letter.facts().role == Role::Average && !step.first);
        let others = later.map(|step| (step.kernel - 1.0).abs()).fold(0.0, f64::max);
        if (kernel - c).abs() > CIRCLE_ROUNDING
            || pushed && (omega * c - 1.0).abs() > CIRCLE_ROUNDING
            || others > CIRCLE_ROUNDING
        {
            return Err(None);
        }
        let longitude = self.plan.latitude.as_ref().and_then(|latitude| latitude.kernel_longitude.as_ref());
        longitude.map_or(Ok(c), |kernel| value(kernel, alpha_of(upsampling.alpha)))
    }
}

/// Returns the number that all these vertices share, if they do.
fn same(numbers: &[f64], vertices: &[u32]) -> Option<f64> {
    let mut of = vertices.iter().map(|&v| numbers[v as usize]);
    let first = of.next()?;
    of.all(|other| other.to_bits() == first.to_bits()).then_some(first)
}
