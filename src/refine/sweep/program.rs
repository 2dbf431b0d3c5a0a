//! The sweep of a net through the rounds of a plan: what depends on connectivity and plan, not on points.

use std::sync::Arc;

use super::grid::{FlatPass, Size, flat_passes};
use super::mask::{Pass, halo, passes};
use super::star::{StarRound, StarShape};
use super::surface::Surface;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::operator::Role;
use crate::scheme::plan::{Plan, Scheduled};
use crate::shape::creases::INFINITE_SHARPNESS;
use crate::shape::grid::Grid;

/// Most cells of a grid in each direction: the planes of three coordinates take 1 MB with it, what a core has as its
/// own cache. Half of it makes a tenth more points twice, in halos; twice of it leaves that cache.
const MOST_CELLS: usize = 64;

/// The sweep of a net through the rounds of a plan.
#[derive(Debug)]
pub(crate) struct Sweep {
    pub(super) surface: Surface,
    /// Cells known beyond a grid.
    pub(super) halo: usize,
    /// Rounds that the net is refined elsewhere before.
    before: usize,
    /// Steps of these.
    steps_before: usize,
    pub(super) rounds: Vec<Round>,
    /// The documented orders of the nets in which the sweep begins and ends.
    pub(super) orders: [Grid; 2],
    /// Pieces of a patch's side where the sweep begins.
    pub(super) first_pieces: usize,
}

/// What depends on a round alone.
#[derive(Debug)]
pub(super) struct Round {
    passes: Arc<Vec<Pass>>,
    /// The tables of each kind of star.
    pub(super) stars: Arc<Vec<StarRound>>,
    /// Cells of the grids that enter it.
    pub(super) cells: usize,
}

/// What of a sweep is known before the mesh was looked at.
#[derive(Debug)]
pub(crate) struct Outline<'a> {
    rounds: Vec<&'a [Scheduled]>,
    passes: Vec<Arc<Vec<Pass>>>,
    halo: usize,
    /// Rounds that the net is refined elsewhere before.
    before: usize,
    /// How many of these make quads of other faces: one or none.
    splits: usize,
}

impl<'a> Outline<'a> {
    /// The outline of the sweep of a net that was not refined yet; none where some step of the plan does not work that
    /// way, where single points have parameters of their own, or where all rounds have to be refined elsewhere.
    pub(crate) fn of(net: &MeshNet, plan: &Plan, steps: &'a [Scheduled]) -> Option<Self> {
        let apart = net.annotations.attributes.is_some() || net.annotations.directions.is_some();
        let numbered = plan.perturbation.is_some() || net.annotations.numbering.is_some();
        let cut = net.surroundings.is_some() || net.mesh.parent.is_some() || net.mesh.rounds > 0;
        let ops = steps.iter().all(|step| step.letter.facts().symmetric && step.letter.settings.arity() == 2);
        if apart || numbered || cut || !ops || steps.first()?.letter.facts().role != Role::Upsample {
            return None;
        }
        let rounds: Vec<&[Scheduled]> = steps.chunk_by(|_, next| next.letter.facts().role != Role::Upsample).collect();
        let soft = softening(net)?;
        let passes = each_round(&rounds, |round| passes(plan, round))?;
        let halos = passes.iter().map(|passes| halo(passes)).collect::<Option<Vec<_>>>()?;
        let halo = halos.into_iter().max()?;
        let splits = usize::from(!net.mesh.base.is_quads());
        let before = (splits + halo.next_power_of_two().trailing_zeros() as usize).max(soft);
        (before < rounds.len()).then_some(Self { rounds, passes, halo, before, splits })
    }
}

impl Sweep {
    /// The sweep of a net, where it has an [`Outline`] and the operators can be applied around each of its vertices.
    pub(crate) fn of(net: &MeshNet, plan: &Plan, steps: &[Scheduled]) -> Option<Self> {
        let Outline { rounds, passes, halo, before, splits } = Outline::of(net, plan, steps)?;
        let surface = Surface::new(net);
        let (head, tail) = rounds.split_at(before);
        let kinds = &surface.kinds;
        let stars = |round: &[Scheduled]| kinds.iter().map(|kind| StarRound::of(kind, halo, plan, round)).collect();
        let stars: Vec<Arc<Vec<StarRound>>> = each_round(tail, stars)?;
        let first_pieces = 1 << (before - splits);
        let cells = |at: usize| (first_pieces << at).min(MOST_CELLS.max(first_pieces));
        let entries = passes.into_iter().skip(before).zip(stars).enumerate();
        let made = entries.map(|(at, (passes, stars))| Round { passes, stars, cells: cells(at) }).collect();
        let orders = [before, rounds.len()]
            .map(|splits| Grid::new(net.mesh.base.clone(), net.mesh.base.clone(), vec![2; splits].into()));
        let steps_before = head.iter().map(|round| round.len()).sum();
        Some(Self { surface, halo, before, steps_before, rounds: made, orders, first_pieces })
    }

    /// Number of steps that the net has to be refined by before the sweep begins.
    pub(crate) fn steps_before(&self) -> usize {
        self.steps_before
    }

    /// Rounds of the whole plan, each of which splits all quads.
    pub(crate) fn splits(&self) -> usize {
        self.before + self.rounds.len()
    }

    /// Bytes that it holds, a little more rather than less.
    pub(crate) fn bytes(&self) -> usize {
        /// Bytes a corner of the patches: their topology and that of the base, the sharpness of edges, and where the
        /// points of a patch are, in both orders.
        const CORNER: usize = 64;
        /// Bytes a point of a star in each round: its rows. Measured: 400 for Catmull-Clark, 1,100 for UCCP.
        const STAR_POINT: usize = 2048;
        let stars: usize = (0..self.surface.kinds.len()).map(|kind| self.shape(kind).len()).sum();
        let corners = self.surface.patches.n_half_edges() + self.surface.base.n_vertices();
        size_of::<Self>() + CORNER * corners + STAR_POINT * stars * self.rounds.len()
    }

    /// Number of points in which the sweep ends.
    pub(crate) fn n_points(&self) -> usize {
        self.orders[1].n_vertices()
    }

    /// The passes of each round for points of `width` numbers.
    pub(super) fn flat(&self, width: usize) -> Vec<Vec<FlatPass>> {
        let flat = |(at, round): (usize, &Round)| {
            let beyond = if at + 1 == self.rounds.len() { 0 } else { self.halo.cast_signed() };
            flat_passes(&round.passes, self.size(at, width), beyond)
        };
        self.rounds.iter().enumerate().map(flat).collect()
    }

    /// The size of the grids that enter a round.
    pub(super) fn size(&self, round: usize, width: usize) -> Size {
        Size { cells: self.rounds[round].cells, halo: self.halo, width }
    }

    /// The star around a vertex of this kind.
    pub(super) fn shape(&self, kind: usize) -> StarShape {
        let kind = &self.surface.kinds[kind];
        StarShape { faces: kind.faces, closed: kind.closed, reach: self.halo }
    }
}

/// Rounds after which all that is sharp is infinitely sharp; none where that is not known beforehand.
fn softening(net: &MeshNet) -> Option<usize> {
    let Some(sharpness) = &net.sharpness else { return Some(0) };
    let unusual = !sharpness.is_of_the_net_alone();
    let all = sharpness.edges().iter().chain(sharpness.vertices()).map(|&(_, sharpness)| sharpness);
    let most = all.filter(|&sharpness| sharpness < INFINITE_SHARPNESS).fold(0.0, f64::max);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "finite sharpness is at most 10")]
    (!unusual).then_some(most.ceil() as usize)
}

/// What `make` gives for each round; rounds whose steps have the same numbers share it.
fn each_round<T>(rounds: &[&[Scheduled]], make: impl Fn(&[Scheduled]) -> Option<T>) -> Option<Vec<Arc<T>>> {
    let same = |a: &Scheduled, b: &Scheduled| {
        let numbers = |step: &Scheduled| [step.kernel, step.compensation].map(f64::to_bits);
        a.letter == b.letter && a.first == b.first && numbers(a) == numbers(b)
    };
    let mut made: Vec<Arc<T>> = Vec::new();
    for (at, round) in rounds.iter().enumerate() {
        let alike = at.checked_sub(1).map(|before| rounds[before]);
        let alike = alike
            .is_some_and(|before| before.len() == round.len() && before.iter().zip(*round).all(|(a, b)| same(a, b)));
        let next = if alike { made[at - 1].clone() } else { Arc::new(make(round)?) };
        made.push(next);
    }
    Some(made)
}
