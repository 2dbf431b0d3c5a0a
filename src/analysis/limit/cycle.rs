//! The cycle of a plan as limits use it: applied level by level to discs until its values no longer change.

use std::sync::Arc;

use super::bounds::MAX_LEVEL_POINTS;
use super::child::child;
use super::disc::{Disc, Located, RingCount};
use super::disc_rules::DiscRules;
use super::error::Unlimited;
use super::record::{CycleRecord, WeightMode};
use super::vertex_parameters::VertexParameters;
use super::walk::WholeNet;
use crate::math::rows::Rows;
use crate::scheme::letter::Letter;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::operator::Children;
use crate::scheme::plan::{Plan, Scheduled};
use crate::scheme::step::Action;
use crate::scheme::stepper::Stepper;
use crate::scheme::surroundings::Surroundings;
use crate::shape::topology::{Topology, index};
use crate::watch::Watch;

/// Number of levels scheduled beyond the last one. An alpha that is halved as often is below 1e-18 of its first value.
/// Cosines settle after 26 halvings, as their distance from 1 is a square; linear functions of alpha take up to 52.
/// Half of it would refuse these as unsettled; twice of it only schedules more levels.
pub(in crate::analysis) const LEVELS_AHEAD: u32 = 62;

/// Tolerance within which numbers are equal, relative to the larger of 1 and their size. It is one unit in the last
/// place of 1. At half of it only identical numbers are equal, and functions that keep moving by one unit never settle;
/// at twice of it the limit may differ by as much more.
const NUMBER_TOLERANCE: f64 = 2e-16;

/// The operators of the levels after the last refined one; each level starts with an upsampling.
#[derive(Debug)]
pub(super) struct Cycle<'a> {
    pub(super) plan: &'a Plan,
    /// The properties that its nets have in common.
    pub(super) disc_rules: DiscRules,
    levels: Vec<&'a [Scheduled]>,
    /// The first level from which on no number changes.
    pub(super) settled: usize,
    /// Counts the points made and the discs found; may stop the computation.
    pub(super) watch: Watch,
}

/// The child of a disc under one level.
#[derive(Debug)]
pub(super) struct Child {
    /// The disc around the centre's child.
    pub(super) disc: Disc,
    /// The matrix from the points of the parent disc to those of the child disc.
    matrix: Rows,
    /// Number of points of the parent disc that the matrix maps.
    n_columns: usize,
    /// Index of the face at the parent's centre that becomes face 0 of the child: upsamplings keep the order around a
    /// vertex.
    pub(super) rotation: usize,
}

impl Child {
    /// Creates the child of a disc from a record.
    ///
    /// # Errors
    /// [`Unlimited::Reach`] if points of the child's support depend on points outside the parent's support.
    pub(super) fn new(
        found: &Located,
        record: &CycleRecord,
        origins: &[u32],
        n_columns: usize,
    ) -> Result<Self, Unlimited> {
        let matrix = record.matrix(&found.vertices[..found.disc.support], origins, n_columns);
        let matrix = matrix.ok_or(Unlimited::Reach)?;
        Ok(Self { disc: found.disc.clone(), matrix, n_columns, rotation: found.rotation })
    }

    /// Turns a row over the child's points into one over the points of the parent disc.
    pub(super) fn back(&self, row: &[f64]) -> Vec<f64> {
        self.matrix.times_row(row, self.n_columns)
    }

    /// Maps the points of the parent disc to those of the child.
    pub(super) fn forth(&self, column: &[f64]) -> Vec<f64> {
        self.matrix.times_column(column)
    }

    /// Returns whether two children have the same weights over the points of their parents.
    pub(super) fn has_weights_of(&self, other: &Self) -> bool {
        self.n_columns == other.n_columns && self.matrix == other.matrix
    }
}

impl<'a> Cycle<'a> {
    /// Creates the cycle from the steps ahead, `length` steps per level, each level starting with an upsampling.
    /// `alphas` are values of alpha that vertices carry.
    pub(super) fn new(
        plan: &'a Plan,
        (ahead, length): (&'a [Scheduled], usize),
        disc_rules: DiscRules,
        alphas: &[f64],
        watch: &Watch,
    ) -> Self {
        let levels: Vec<&[Scheduled]> = ahead.chunks_exact(length).collect();
        let last = levels.len() - 1;
        let settled = |&level: &usize| {
            let (level, last) = (levels[level], levels[last]);
            same(level, last) && alphas.iter().all(|&alpha| same_at(plan, alpha, level, last))
        };
        let settled = (0..last).rev().take_while(settled).last().unwrap_or(last);
        Self { plan, disc_rules, levels, settled, watch: watch.clone() }
    }

    /// Returns the operators of a level; levels beyond the settled one are equal to it.
    pub(super) fn level(&self, level: usize) -> &'a [Scheduled] {
        self.levels[level.min(self.settled)]
    }

    /// Returns the number of upsamplings before a step of a level, from the beginning of the plan.
    pub(super) fn upsamplings(&self, level: usize, step: &Scheduled) -> u32 {
        let each = self.level(level).iter().filter(|step| step.letter.facts().children.refine()).count();
        step.upsamplings + index(level.saturating_sub(self.settled) * each)
    }

    /// Applies one level to the disc around a centre. Levels beyond the settled one are equal to it.
    pub(super) fn step(&self, level: usize, disc: &Disc, rings: RingCount) -> Result<Child, Unlimited> {
        let parameters = VertexParameters::default();
        let (found, record, origins, _) = self.refined(level, disc, &parameters, rings, WeightMode::Exact)?;
        Child::new(&found, &record, &origins, disc.support)
    }

    /// Returns the child's disc, its location in the net after the settled level, and the topology of that net.
    pub(super) fn child(
        &self,
        disc: &Disc,
        parameters: &VertexParameters,
        rings: RingCount,
    ) -> Result<(Located, Arc<Topology>), Unlimited> {
        let refined = self.refined(self.settled, disc, parameters, rings, WeightMode::Exact);
        refined.map(|(found, _, _, topology)| (found, topology))
    }

    /// Returns whether the child's support depends on the support of the disc only, for any weights; and the child's
    /// disc.
    pub(super) fn closes(&self, disc: &Disc, rings: RingCount) -> Result<(bool, Disc), Unlimited> {
        let parameters = VertexParameters::default();
        let (found, record, origins, _) =
            self.refined(self.settled, disc, &parameters, rings, WeightMode::Structural)?;
        let matrix = record.matrix(&found.vertices[..found.disc.support], &origins, disc.support);
        Ok((matrix.is_some(), found.disc))
    }

    fn refined(
        &self,
        level: usize,
        disc: &Disc,
        parameters: &VertexParameters,
        rings: RingCount,
        weights: WeightMode,
    ) -> Result<(Located, CycleRecord, Vec<u32>, Arc<Topology>), Unlimited> {
        let (net, origins) = disc.net(self.disc_rules).ok_or(Unlimited::Reach)?;
        let mut net = parameters.carried_by(net, &origins);
        let mut record = CycleRecord::new(weights);
        let (mut centre, mut made) = (disc.centre(), PointCount::default());
        for step in self.level(level) {
            let next = Stepper::new(self.plan).next(&net, step)?;
            made.add(&next.net)?;
            record.add(next.action)?;
            centre = child(centre, step.letter.facts().children, [&net, &next.net], &record)?;
            net = next.net;
        }
        let topology = net.mesh.topology();
        let whole = WholeNet::of(&net, &topology);
        self.watch.advance(made.0 as u64);
        let found = whole.least_disc(centre, rings, &self.watch)?.ok_or(Unlimited::Size)?;
        Ok((found, record, origins, topology))
    }

    /// Applies the settled level to a whole net, calling `act` with each action. Probes of the scheme use it.
    pub(super) fn applied(
        &self,
        net: MeshNet,
        mut act: impl FnMut(&Action, &Scheduled) -> Result<(), Unlimited>,
    ) -> Result<MeshNet, Unlimited> {
        let (mut net, mut made) = (net, PointCount::default());
        net.tags.cut = self.disc_rules.cut;
        for step in self.levels[self.settled] {
            let next = Stepper::new(self.plan).next(&net, step)?;
            made.add(&next.net)?;
            act(&next.action, step)?;
            net = next.net;
        }
        Ok(net)
    }

    /// Returns, for each operator of a level, the number of pieces into which it and those before it cut an edge.
    pub(super) fn pieces(&self) -> Vec<usize> {
        pieces(self.levels[self.settled].iter().map(|step| &step.letter))
    }

    /// Returns what rules need to know of a mesh beyond a disc of it: something only if arities above 2 split quads
    /// into fewer pieces than other faces.
    pub(super) fn surroundings(&self, topology: &Topology) -> Option<Surroundings> {
        let matters = |step: &Scheduled| step.letter.settings.pieces(false) != step.letter.settings.pieces(true);
        self.levels[self.settled].iter().any(matters).then(|| Surroundings::of(topology))
    }

    /// Returns whether rules reach a ring farther beside extraordinary vertices.
    pub(super) fn reaches_farther(&self) -> bool {
        self.levels[self.settled].iter().any(|step| step.letter.facts().reaches_farther)
    }

    /// Returns the number of operators that put faces in the place of vertices.
    pub(super) fn n_duals(&self) -> usize {
        let swaps = |step: &&Scheduled| matches!(step.letter.facts().children, Children::Dual | Children::Faces);
        self.levels[self.settled].iter().filter(swaps).count()
    }
}

/// Returns, for each operator of a level, the number of pieces into which it and those before it cut an edge.
pub(super) fn pieces<'a>(letters: impl Iterator<Item = &'a Letter>) -> Vec<usize> {
    let after = |pieces: &mut usize, letter: &Letter| {
        let refines = letter.facts().children.refine();
        *pieces = pieces.saturating_mul(if refines { letter.settings.arity() as usize } else { 1 });
        Some(*pieces)
    };
    letters.scan(1, after).collect()
}

/// Returns the approximate number of points that all operators of `levels` levels make of `n` points. `pieces` are the
/// pieces of an edge after each operator of a level.
pub(super) fn made(n: usize, pieces: &[usize], levels: usize) -> usize {
    let of_one = |pieces: usize| pieces.saturating_mul(pieces);
    let each = pieces.iter().fold(0, |sum: usize, &pieces| sum.saturating_add(of_one(pieces)));
    let last = of_one(pieces.last().copied().unwrap_or(1));
    let mut before = n;
    (0..levels).fold(0, |sum: usize, _| {
        let sum = sum.saturating_add(before.saturating_mul(each));
        before = before.saturating_mul(last);
        sum
    })
}

/// The number of points that a level has made.
#[derive(Debug, Default)]
struct PointCount(usize);

impl PointCount {
    /// Counts the points of a net, before any work is done on each.
    fn add(&mut self, net: &MeshNet) -> Result<(), Unlimited> {
        self.0 += net.mesh.n_vertices();
        if self.0 > MAX_LEVEL_POINTS { Err(Unlimited::Fine) } else { Ok(()) }
    }
}

fn close(x: f64, y: f64) -> bool {
    (x - y).abs() <= NUMBER_TOLERANCE * y.abs().max(1.0)
}

fn same(a: &[Scheduled], b: &[Scheduled]) -> bool {
    a.iter().zip(b).all(|(a, b)| close(a.kernel, b.kernel) && close(a.compensation, b.compensation))
}

/// Returns whether the functions of an alpha that vertices carry have the same values at two levels.
fn same_at(plan: &Plan, alpha: f64, a: &[Scheduled], b: &[Scheduled]) -> bool {
    let longitude = plan.latitude.as_ref().and_then(|latitude| latitude.kernel_longitude.as_ref());
    let compensation = plan.compensation_alpha.is_none().then_some(&plan.compensation);
    let functions = plan.kernel.first().into_iter().chain(longitude).chain(compensation);
    functions.into_iter().all(|function| {
        let at = |step: &Scheduled| function.value(alpha * step.scale).unwrap_or(f64::NAN);
        a.iter().zip(b).all(|(a, b)| close(at(a), at(b)))
    })
}
