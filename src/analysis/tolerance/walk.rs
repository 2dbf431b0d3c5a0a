//! Proceeds from level to level with the current net, and with the bounds of faces that are no longer followed.

use super::bend;
use super::bound::{FOLLOWED_FACES, bound};
use super::budget::Budget;
use super::cut::{cut, twist};
use super::level::Level;
use super::placed::Placed;
use super::remainder::Remainders;
use super::spline::Spline;
use crate::analysis::limit::{self, LimitRequest};
use crate::analysis::no_level::NoLevel;
use crate::refine::{Points, act_on};
use crate::scheme::mesh_net::MeshNet;
use crate::shape::tile::Tile;
use crate::watch::Watch;

/// The level that is looked at, and what is known of faces that are followed no longer.
pub(super) struct Walk {
    pub(super) level: Level,
    /// How far they are from their limit, at most; a quarter of it a round later.
    left: f64,
}

impl Walk {
    /// From a net with these points on.
    pub(super) fn new(net: MeshNet, points: Points) -> Self {
        Self { level: Level::new(net, points), left: 0.0 }
    }

    /// Whether all faces are those that the scheme splits regularly.
    pub(super) fn is_ready(&self, spline: &Spline) -> bool {
        let sides = if spline.tile == Tile::Quad { 4 } else { 3 };
        let topology = &self.level.topology;
        spline.halved || self.level.live.iter().all(|&f| topology.face(f as usize).len() == sides)
    }

    /// How far the output is from the limit at most, with its vertices there; infinite where it is soon seen to be
    /// above the tolerance.
    pub(super) fn bound(
        &self,
        spline: &Spline,
        placed: Placed,
        tolerance: f64,
        rounding: f64,
        budget: &Budget,
    ) -> Result<f64, NoLevel> {
        let (places, times) = match placed {
            Placed::Refined => (self.level.points.now.clone(), 1.0),
            Placed::Limit => (self.limits(spline, &budget.watch)?, 2.0),
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

    /// The limits of the vertices.
    fn limits(&self, spline: &Spline, watch: &Watch) -> Result<Vec<f64>, NoLevel> {
        if self.level.live.is_empty() {
            return Ok(self.level.points.now.clone());
        }
        let plan = &spline.plan;
        let steps = plan.schedule(limit::AHEAD).map_err(|fault| NoLevel::Refused(fault.detail))?;
        let asked = LimitRequest { positions: true, normals: false };
        let points = [self.level.points.clone()];
        let found = limit::limits(plan, &self.level.net, &points, &steps[spline.prefix.len()..], asked, watch)?;
        Ok(found.points.and_then(|mut points| points.pop()).unwrap_or_default())
    }

    /// Leaves faces behind whose distance second differences bound, where there are too many to go on with all: first
    /// those that are within half the tolerance.
    pub(super) fn leave(&mut self, spline: &Spline, tolerance: f64, budget: &Budget) -> Result<(), NoLevel> {
        let fits = |level: &Level| level.faces_after(1) <= FOLLOWED_FACES;
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

    /// One level further.
    pub(super) fn on(&mut self, spline: &Spline, watch: &Watch) -> Result<(), NoLevel> {
        for round in &spline.rounds {
            if spline.halved {
                let points = vec![self.level.points.clone()];
                let (net, mut points) = act_on(self.level.net.clone(), points, &spline.plan, round, watch)?;
                self.level = Level::new(net, points.remove(0));
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
