//! Proceeds from level to level with the current net and the bound of the faces that are no longer followed.

use super::bend;
use super::bound::{FOLLOWED_FACES, bound};
use super::budget::Budget;
use super::cut::{cut, twist};
use super::level::ComparedNet;
use super::placed::VertexPlacement;
use super::remainder::Remainders;
use super::spline::Spline;
use crate::analysis::limit::{self, LimitRequest};
use crate::analysis::no_level::NoLevel;
use crate::refine::{Points, act_on};
use crate::scheme::mesh_net::MeshNet;
use crate::shape::tile::Tile;
use crate::watch::Watch;

/// The current level, and the bound of the faces that are no longer followed.
pub(super) struct LevelWalk {
    pub(super) level: ComparedNet,
    /// An upper bound of the distance between these faces and their limits; each round divides it by 4.
    left: f64,
}

impl LevelWalk {
    /// Creates the walk that starts at a net with these points.
    pub(super) fn new(net: MeshNet, points: Points) -> Self {
        Self { level: ComparedNet::new(net, points), left: 0.0 }
    }

    /// Returns whether the level can be bounded: whether all live faces are of the kind that the scheme splits into, or
    /// the spline is halved, for which any faces can be bounded.
    pub(super) fn is_ready(&self, spline: &Spline) -> bool {
        let sides = if spline.tile == Tile::Quad { 4 } else { 3 };
        let topology = &self.level.topology;
        spline.halved || self.level.live.iter().all(|&f| topology.face(f as usize).len() == sides)
    }

    /// Returns an upper bound of the distance, either from the other, between the limit and the output with its
    /// vertices placed as given; infinite as soon as a distance clearly above the tolerance is measured.
    ///
    /// # Errors
    /// [`NoLevel`] when a level or a limit cannot be computed or the budget is over.
    pub(super) fn bound(
        &self,
        spline: &Spline,
        placed: VertexPlacement,
        tolerance: f64,
        rounding: f64,
        budget: &Budget,
    ) -> Result<f64, NoLevel> {
        // with vertices at their limits, faces move by up to the bound, which then counts twice
        let (places, times) = match placed {
            VertexPlacement::Refined => (self.level.points.now.clone(), 1.0),
            VertexPlacement::Limit => (self.limits(spline, &budget.watch)?, 2.0),
        };
        let left = times * self.left;
        if self.level.live.is_empty() {
            return Ok(left);
        }
        let base = self.level.compared(places);
        if spline.halved {
            let upsampling = spline.rounds[0].first().expect("a round begins with an upsampling");
            let split = base.upsampled(&spline.plan, upsampling, &budget.watch)?;
            let cut = cut(&base);
            return Ok(bound(&split, spline, tolerance - cut, rounding, budget)? + cut);
        }
        Ok(bound(&base, spline, tolerance, rounding, budget)?.max(left))
    }

    /// Returns the limit positions of the vertices, `n x 3`.
    fn limits(&self, spline: &Spline, watch: &Watch) -> Result<Vec<f64>, NoLevel> {
        if self.level.live.is_empty() {
            return Ok(self.level.points.now.clone());
        }
        let plan = &spline.plan;
        let steps = plan.schedule(limit::LEVELS_AHEAD).map_err(|fault| NoLevel::Refused(fault.detail))?;
        let asked = LimitRequest { positions: true, normals: false };
        let points = [self.level.points.clone()];
        let found = limit::limits(plan, &self.level.net, &points, &steps[spline.prefix.len()..], asked, watch)?;
        Ok(found.points.and_then(|mut points| points.pop()).unwrap_or_default())
    }

    /// Stops following faces that second differences bound if there are too many to follow all: those that are bounded
    /// by half the tolerance or, if too many are left then, all that have a bound. Halved splines follow all faces.
    pub(super) fn leave(&mut self, spline: &Spline, tolerance: f64, budget: &Budget) -> Result<(), NoLevel> {
        let fits = |level: &ComparedNet| level.faces_after(1) <= FOLLOWED_FACES;
        if fits(&self.level) || spline.halved {
            return Ok(());
        }
        let level = &self.level;
        let points = level.points.now.as_chunks::<3>().0;
        let twists: Vec<f64> = (0..level.topology.n_vertices())
            .map(|v| {
                let around = level.topology.ring(v).map(|half_edge| level.topology.face_of(half_edge));
                around.map(|f| twist(&level.topology, f, points)).fold(0.0, f64::max)
            })
            .collect();
        let twists = bend::spread(&level.topology, twists, spline.reach, f64::max);
        let remainders = Remainders::of(level, spline, budget)?;
        let of_face = |&f: &u32| {
            let twist = level.topology.face(f as usize).iter().map(|&v| twists[v as usize]).fold(0.0, f64::max);
            (f, remainders.bend(f) + twist)
        };
        let known: Vec<(u32, f64)> = level.live.iter().map(of_face).collect();
        let followed = |most: f64| {
            let (left, kept): (Vec<_>, Vec<_>) = known.iter().partition(|&&(_, distance)| distance <= most);
            let left = left.iter().map(|&(_, distance)| distance).fold(self.left, f64::max);
            let kept: Vec<u32> = kept.iter().map(|&(f, _)| f).collect();
            Self { level: level.focused(&kept, spline.margin()), left }
        };
        let some = followed(tolerance / 2.0);
        *self = if fits(&some.level) { some } else { followed(f64::MAX) };
        Ok(())
    }

    /// Refines by one level.
    pub(super) fn on(&mut self, spline: &Spline, watch: &Watch) -> Result<(), NoLevel> {
        for round in &spline.rounds {
            if spline.halved {
                let points = vec![self.level.points.clone()];
                let (net, mut points) = act_on(self.level.net.clone(), points, &spline.plan, round, watch)?;
                self.level = ComparedNet::new(net, points.remove(0));
                continue;
            }
            if !self.level.live.is_empty() {
                self.level = self.level.next(&spline.plan, round, watch)?;
            }
            self.left /= 4.0;
        }
        Ok(())
    }
}
