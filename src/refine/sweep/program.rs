//! Prepares the sweep of a net through the rounds of a plan: everything that depends on connectivity and plan, not on
//! points.

use std::sync::Arc;

use super::grid::{FlatPass, GridSize, flat_passes};
use super::lanes::Lanes;
use super::lattice::reach;
use super::line::SharpSide;
use super::mask::{Pass, halo, passes};
use super::numbering::SplitOrder;
use super::overlay::Overlay;
use super::star::{StarRound, StarShape};
use super::surface::PatchSurface;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::operator::Role;
use crate::scheme::parameters::SPLIT;
use crate::scheme::plan::{Plan, Scheduled};
use crate::shape::creases::INFINITE_SHARPNESS;
use crate::shape::tile::Tile;
use crate::shape::topology::Topology;

/// Maximum number of cells of a grid in each direction: its planes of three coordinates take 1 MB, the size of a core's
/// own cache. With half as many, a tenth more points are computed twice, in halos; with twice as many, the planes leave
/// the cache.
const MAX_GRID_CELLS: usize = 64;

/// Maximum number of kinds of lines, boundaries included, and of sharpnesses of vertices. Vertices at which lines meet
/// in different ways have tables of their own in every round, 256 of them around four edges. With more kinds, the first
/// rounds are refined by rows until only infinitely sharp edges are left. Half of it has 16 tables and leaves more to
/// rows; twice of it has 4,096.
const MAX_LINE_KINDS: usize = 4;

/// Maximum number of patches that are refined as a stack while they are small. With half as many, level 3 takes a
/// tenth longer; twice as many make no measurable difference.
const STACK: usize = 16;

/// Maximum number of points in a plane of a stack: 32 KB of three coordinates, so that eight planes take a quarter of a
/// core's own cache. With half of it, mixed meshes take a thirtieth longer; with twice of it, level 5 takes a fifteenth
/// longer.
const STACK_POINTS: usize = 1_365;

/// Minimum number of grids in a stack. With half as many, rows are so short that large patches take a tenth longer;
/// with twice as many, stacks end a round earlier, which makes no measurable difference.
const LEAST_STACK: usize = 4;

/// The sweep of a net through the rounds of a plan.
#[derive(Debug)]
pub(crate) struct Sweep {
    pub(super) surface: PatchSurface,
    /// Number of cells known around a grid.
    pub(super) halo: usize,
    /// Number of rounds by which the net is refined by rows before the sweep.
    before: usize,
    /// Number of steps in those rounds.
    steps_before: usize,
    pub(super) rounds: Vec<Round>,
    /// The documented orders of the nets where the sweep begins and where it ends.
    pub(super) orders: [SplitOrder; 2],
    /// Number of pieces of a patch's side where the sweep begins.
    pub(super) first_pieces: usize,
    /// An upper bound of the factor by which values grow over all rounds.
    growth: f64,
    pub(super) overlay: Overlay,
}

/// The passes of a round on patches whose first side is a latitude edge, and on those whose first side is a longitude
/// edge; on nets without tags, one list for all patches.
type Turns = Vec<Vec<Pass>>;

/// The passes of all rounds, prepared for their sizes of grids.
#[derive(Debug)]
pub(super) struct Flat {
    /// For each of the [`Turns`] the passes of each round on single grids.
    single: Vec<Vec<Vec<FlatPass>>>,
    /// The same on stacks, for the first rounds.
    stacked: Vec<Vec<Vec<FlatPass>>>,
    /// The number of grids of a stack in each round; 1 if the grids are refined one by one. They are powers of two that
    /// never grow, so that each stack divides into those of the next round.
    grids: Vec<usize>,
}

impl Flat {
    /// Returns the number of grids of a stack in a round.
    pub(super) fn grids(&self, round: usize) -> usize {
        self.grids[round]
    }

    /// Returns the passes of a round on single grids or on stacks; `turned` tells whether the first side of the patch
    /// is a longitude edge.
    pub(super) fn of(&self, turned: bool, round: usize, is_stacked: bool) -> &[FlatPass] {
        let turns = if is_stacked { &self.stacked } else { &self.single };
        &turns[usize::from(turned)][round]
    }
}

/// The data of one round.
#[derive(Debug)]
pub(super) struct Round {
    passes: Arc<Turns>,
    /// The tables of each kind of star.
    pub(super) stars: Arc<Vec<StarRound>>,
    /// Number of cells per side of the grids before the round.
    pub(super) cells: usize,
}

impl Round {
    fn growth(&self) -> f64 {
        let passes = self.passes.iter().map(|passes| passes.iter().map(Pass::growth).product());
        self.stars.iter().map(StarRound::growth).chain(passes).fold(1.0, f64::max)
    }
}

/// The part of a sweep that can be determined without classifying the vertices of the mesh.
#[derive(Debug)]
pub(crate) struct SweepOutline<'a> {
    tile: Tile,
    lines: Vec<SharpSide>,
    lanes: Option<Lanes>,
    rounds: Vec<&'a [Scheduled]>,
    passes: Vec<Arc<Turns>>,
    halo: usize,
    /// Number of rounds by which the net is refined by rows before the sweep.
    before: usize,
    /// Number of those rounds that turn other faces into quads: zero or one.
    splits: usize,
}

impl<'a> SweepOutline<'a> {
    /// Returns the outline of the sweep of an unrefined net. Returns `None` if some step of the plan does not support
    /// sweeps, if tags or vertex parameters vary from place to place, or if all rounds would be refined by rows.
    pub(crate) fn of(net: &MeshNet, plan: &Plan, steps: &'a [Scheduled]) -> Option<Self> {
        let numbered = plan.perturbation.is_some() || net.annotations.numbering.is_some();
        let cut = net.surroundings.is_some() || net.mesh.parent.is_some() || net.mesh.rounds > 0;
        let ops = steps.iter().all(|step| step.letter.facts().symmetric && step.letter.settings.arity() == 2);
        if numbered || cut || !ops || steps.first()?.letter.facts().role != Role::Upsample {
            return None;
        }
        let tile = steps.first()?.letter.settings.tile();
        let base = &net.mesh.base;
        if steps.iter().any(|step| step.letter.facts().has(&SPLIT) && step.letter.settings.tile() != tile)
            || (tile == Tile::Triangle && base.first_other_than_triangle().is_some())
        {
            return None;
        }
        let lanes = Lanes::of(net, plan).ok()?;
        let rounds: Vec<&[Scheduled]> = steps.chunk_by(|_, next| next.letter.facts().role != Role::Upsample).collect();
        let (lines, soft) = lines(net)?;
        let rough = base.n_boundary() > 0;
        let on_lines = |at: usize, round: &[Scheduled]| {
            let line = |line: &SharpSide| line.after(at).filter(|line| rough || *line != SharpSide::Boundary);
            let lines: Vec<_> = lines.iter().map(line).collect();
            match lanes {
                None => Some(vec![passes(plan, round, tile, &lines, None)?]),
                Some(lanes) => {
                    let turns = [false, true].map(|turned| Some(lanes.seen(turned)));
                    turns.into_iter().map(|lanes| passes(plan, round, tile, &lines, lanes)).collect()
                }
            }
        };
        let passes = each_round(&rounds, (&lines, lanes), on_lines)?;
        let all = passes.iter().flat_map(|turns| &**turns);
        let halos = all.map(|passes| halo(tile, passes)).collect::<Option<Vec<_>>>()?;
        let halo = halos.into_iter().max()?;
        let splits = usize::from(tile == Tile::Quad && !base.is_quads());
        let before = (splits + reach(tile, halo).next_power_of_two().trailing_zeros() as usize).max(soft);
        (before < rounds.len()).then_some(Self { tile, lines, lanes, rounds, passes, halo, before, splits })
    }
}

impl SweepOutline<'_> {
    /// Returns the number of rounds by which the net is refined by rows before the sweep.
    pub(crate) fn before(&self) -> usize {
        self.before
    }

    /// Returns the tile into which each round splits the faces.
    pub(crate) fn tile(&self) -> Tile {
        self.tile
    }
}

impl Sweep {
    /// Returns the sweep of a net, if it has a [`SweepOutline`] and the operators can be applied around each of its
    /// vertices.
    pub(crate) fn of(net: &MeshNet, plan: &Plan, steps: &[Scheduled]) -> Option<Self> {
        let SweepOutline { tile, lines, lanes, rounds, passes, halo, before, splits } =
            SweepOutline::of(net, plan, steps)?;
        let surface = PatchSurface::new(net, tile, (&lines, lanes), before);
        let (head, tail) = rounds.split_at(before);
        let kinds = &surface.kinds;
        let stars = |at: usize, round: &[Scheduled]| {
            kinds.iter().map(|kind| StarRound::of(kind, (tile, reach(tile, halo)), at, plan, round)).collect()
        };
        let stars: Vec<Arc<Vec<StarRound>>> = each_round(tail, (&surface.softening(), lanes), stars)?;
        let first_pieces = 1 << (before - splits);
        let cells = |at: usize| (first_pieces << at).min(MAX_GRID_CELLS.max(first_pieces));
        let entries = passes.into_iter().skip(before).zip(stars).enumerate();
        let made: Vec<Round> = entries.map(|(at, (passes, stars))| Round { passes, stars, cells: cells(at) }).collect();
        let orders = [before, rounds.len()].map(|splits| SplitOrder::new(&net.mesh.base, tile, splits));
        let steps_before = head.iter().map(|round| round.len()).sum();
        let growth = made.iter().map(Round::growth).product::<f64>();
        let overlay = Overlay::new(tile, halo);
        Some(Self { surface, halo, before, steps_before, rounds: made, orders, first_pieces, growth, overlay })
    }

    /// Returns whether all values computed from `start` are certain to be finite: they and all intermediate sums stay
    /// below the largest finite number.
    pub(super) fn is_bounded(&self, start: &[f64]) -> bool {
        // twice the bound that is needed, to allow for rounding
        start.iter().all(|x| x.abs() * self.growth < 0.5 * f64::MAX)
    }

    /// Returns the sweep with blocks of at most `most_cells` cells, but at least as many as it begins with.
    pub(super) fn with_blocks(mut self, most_cells: usize) -> Self {
        for round in &mut self.rounds {
            round.cells = round.cells.min(most_cells.max(self.first_pieces));
        }
        self
    }

    /// Returns the number of steps by which the net must be refined before the sweep.
    pub(crate) fn steps_before(&self) -> usize {
        self.steps_before
    }

    /// Returns the topology whose faces are the patches.
    pub(crate) fn patches(&self) -> &Arc<Topology> {
        &self.surface.patches
    }

    /// Returns the tile into which each round splits the faces.
    pub(crate) fn tile(&self) -> Tile {
        self.surface.tile
    }

    /// Returns whether steps read latitude and longitude tags.
    pub(crate) fn is_tagged(&self) -> bool {
        self.surface.is_tagged()
    }

    /// Returns the number of rounds of the sweep.
    pub(super) fn n_rounds(&self) -> usize {
        self.rounds.len()
    }

    /// Returns the number of rounds of the whole plan, each of which splits all faces.
    pub(crate) fn splits(&self) -> usize {
        self.before + self.rounds.len()
    }

    /// Returns the number of bytes that the sweep occupies, rounded up rather than down.
    pub(crate) fn bytes(&self) -> usize {
        /// Bytes per corner of the patches: their topology and that of the base, the sharpness of edges, and where some
        /// base faces are no quads, how many points lie inside the faces before each, in both orders.
        const PATCH_CORNER_BYTES: usize = 64;
        /// Bytes per point of a star and round, for its rows. Measured: 1,500 for UCCC, whose stencils are wide.
        const STAR_POINT: usize = 2048;
        /// Bytes per pass of a round, for its masks on smooth grids. Measured: at most 1,100 for UCCP.
        /// Masks of lines come with stars, whose bytes leave room for them.
        const PASS_BYTES: usize = 2048;
        let stars: usize = (0..self.surface.kinds.len()).map(|kind| self.shape(kind).len()).sum();
        let corners = self.surface.patches.n_half_edges() + self.surface.base.n_vertices();
        let of_points = PATCH_CORNER_BYTES * corners + STAR_POINT * stars * self.rounds.len();
        let passes: usize = self.rounds.iter().flat_map(|round| round.passes.iter()).map(Vec::len).sum();
        size_of::<Self>() + self.overlay.bytes() + PASS_BYTES * passes + of_points
    }

    /// Returns the number of pieces of a patch's side where the sweep ends.
    pub(super) fn patch_pieces(&self) -> usize {
        self.first_pieces << self.rounds.len()
    }

    /// Returns the number of points of the net where the sweep ends.
    pub(crate) fn n_points(&self) -> usize {
        self.orders[1].n_vertices()
    }

    /// Prepares the passes of each round for points of `width` values, and for stacks of at most about `patches`
    /// patches.
    pub(super) fn flat(&self, width: usize, patches: usize) -> Flat {
        let most = patches.next_power_of_two().min(STACK);
        let grids = |round: usize| {
            let fitting = most.min(STACK_POINTS / self.size(round, 1, 1).len());
            if fitting < LEAST_STACK { 1 } else { 1 << fitting.ilog2() }
        };
        let grids: Vec<usize> = (0..self.rounds.len()).map(grids).collect();
        let stacks = grids.iter().take_while(|&&grids| grids > 1).count();
        let flat = |turn: usize, round: usize, grids: usize| {
            let beyond = if round + 1 == self.rounds.len() { 0 } else { self.halo.cast_signed() };
            flat_passes(&self.rounds[round].passes[turn], self.size(round, width, grids), beyond)
        };
        let turns = || 0..self.rounds.iter().map(|round| round.passes.len()).min().unwrap_or(0);
        let single = |turn| (0..self.rounds.len()).map(|round| flat(turn, round, 1)).collect();
        let stacked = |turn| (0..stacks).map(|round| flat(turn, round, grids[round])).collect();
        Flat { single: turns().map(single).collect(), stacked: turns().map(stacked).collect(), grids }
    }

    /// Returns the size of a stack of grids before a round.
    pub(super) fn size(&self, round: usize, width: usize, grids: usize) -> GridSize {
        GridSize { cells: self.rounds[round].cells, halo: self.halo, width, grids, place: 0 }
    }

    /// Returns the shape of the star around a vertex of this kind.
    pub(super) fn shape(&self, kind: usize) -> StarShape {
        self.surface.shape(kind, self.halo)
    }
}

/// Returns the lines of a net, boundaries first, and the number of rounds after which they are known: zero, or the
/// rounds until only infinite sharpness is left if the sharpness of an edge depends on its ends or there are too many
/// different ones. Returns `None` if sharpness depends on more than the net itself.
fn lines(net: &MeshNet) -> Option<(Vec<SharpSide>, usize)> {
    let mut lines = vec![SharpSide::Boundary];
    let Some(sharpness) = &net.sharpness else { return Some((lines, 0)) };
    if !sharpness.is_of_the_net_alone() {
        return None;
    }
    let finite = |&&(_, sharpness): &&(u32, f64)| sharpness < INFINITE_SHARPNESS;
    let most =
        sharpness.edges().iter().chain(sharpness.vertices()).filter(finite).fold(0.0, |most: f64, s| most.max(s.1));
    let mut own: Vec<f64> = Vec::new();
    for &(_, sharpness) in sharpness.vertices() {
        if own.len() <= MAX_LINE_KINDS && !own.contains(&sharpness) {
            own.push(sharpness);
        }
    }
    let mut soft = (net.rules.creasing.evens_out() && most > 0.0) || own.len() > MAX_LINE_KINDS;
    for &(_, sharpness) in sharpness.edges() {
        let line = SharpSide::Crease(sharpness);
        if !lines.contains(&line) && !soft {
            lines.push(line);
            soft = lines.len() > MAX_LINE_KINDS;
        }
    }
    if soft {
        let sharp = sharpness.edges().iter().find(|(_, sharpness)| *sharpness >= INFINITE_SHARPNESS);
        lines.truncate(1);
        lines.extend(sharp.map(|&(_, sharpness)| SharpSide::Crease(sharpness)));
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "finite sharpness is at most 10")]
    Some((lines, if soft { most.ceil() as usize } else { 0 }))
}

/// Returns the result of `make` for each round, with the round's index. Consecutive rounds with equal steps share a
/// result once the lines no longer change. With lanes, nothing is shared, as the alpha of vertices is not part of the
/// steps.
fn each_round<T>(
    rounds: &[&[Scheduled]],
    (lines, lanes): (&[SharpSide], Option<Lanes>),
    make: impl Fn(usize, &[Scheduled]) -> Option<T>,
) -> Option<Vec<Arc<T>>> {
    let same = |a: &Scheduled, b: &Scheduled| {
        let numbers = |step: &Scheduled| [step.kernel, step.compensation].map(f64::to_bits);
        a.letter == b.letter && a.first == b.first && numbers(a) == numbers(b)
    };
    let mut made: Vec<Arc<T>> = Vec::new();
    for (at, round) in rounds.iter().enumerate() {
        let stay = |at: usize| lines.iter().all(|line| line.after(at) == line.after(at - 1));
        let alike = at.checked_sub(1).filter(|_| lanes.is_none() && stay(at)).map(|before| rounds[before]);
        let alike = alike
            .is_some_and(|before| before.len() == round.len() && before.iter().zip(*round).all(|(a, b)| same(a, b)));
        let next = if alike { made[at - 1].clone() } else { Arc::new(make(at, round)?) };
        made.push(next);
    }
    Some(made)
}
