//! The sweep of a net through the rounds of a plan: what depends on connectivity and plan, not on points.

use std::sync::Arc;

use super::grid::{FlatPass, Size, flat_passes};
use super::lanes::Lanes;
use super::lattice::reach;
use super::line::Line;
use super::mask::{Pass, halo, passes};
use super::numbering::Numbering;
use super::star::{StarRound, StarShape};
use super::surface::Surface;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::operator::Role;
use crate::scheme::parameters::SPLIT;
use crate::scheme::plan::{Plan, Scheduled};
use crate::shape::creases::INFINITE_SHARPNESS;
use crate::shape::tile::Tile;
use crate::shape::topology::Topology;

/// Most cells of a grid in each direction: the planes of three coordinates take 1 MB with it, what a core has as its
/// own cache. Half of it makes a tenth more points twice, in halos; twice of it leaves that cache.
const MOST_CELLS: usize = 64;

/// Most kinds of lines, boundaries among them, and most sharpnesses of vertices: vertices where they meet in different
/// ways have tables of their own in every round, 256 of them around four edges. With more the first rounds are taken by
/// rows, until only infinitely sharp edges are left.
const MOST_LINES: usize = 4;

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
    pub(super) orders: [Numbering; 2],
    /// Pieces of a patch's side where the sweep begins.
    pub(super) first_pieces: usize,
    /// By which factor numbers grow in all rounds together at most.
    growth: f64,
}

/// The passes of a round on patches whose first side is a latitude edge, and on those whose first side is a longitude
/// edge; where edges have no tags those of all patches.
type Turns = Vec<Vec<Pass>>;

/// The passes of all rounds on grids of their sizes, for each of the [`Turns`].
#[derive(Debug)]
pub(super) struct Flat(Vec<Vec<Vec<FlatPass>>>);

impl Flat {
    /// The passes of each round on patches whose first side is a longitude edge, or is none.
    pub(super) fn of(&self, turned: bool) -> &[Vec<FlatPass>] {
        &self.0[usize::from(turned)]
    }
}

/// What depends on a round alone.
#[derive(Debug)]
pub(super) struct Round {
    passes: Arc<Turns>,
    /// The tables of each kind of star.
    pub(super) stars: Arc<Vec<StarRound>>,
    /// Cells of the grids that enter it.
    pub(super) cells: usize,
}

impl Round {
    fn growth(&self) -> f64 {
        let passes = self.passes.iter().map(|passes| passes.iter().map(Pass::growth).product());
        self.stars.iter().map(StarRound::growth).chain(passes).fold(1.0, f64::max)
    }
}

/// What of a sweep is known before the mesh was looked at.
#[derive(Debug)]
pub(crate) struct Outline<'a> {
    tile: Tile,
    lines: Vec<Line>,
    lanes: Option<Lanes>,
    rounds: Vec<&'a [Scheduled]>,
    passes: Vec<Arc<Turns>>,
    halo: usize,
    /// Rounds that the net is refined elsewhere before.
    before: usize,
    /// How many of these make quads of other faces: one or none.
    splits: usize,
}

impl<'a> Outline<'a> {
    /// The outline of the sweep of a net that was not refined yet; none where some step of the plan does not work that
    /// way, where tags or parameters differ from point to point, or where all rounds have to be refined elsewhere.
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
            let line = |line: &Line| line.after(at).filter(|line| rough || *line != Line::Boundary);
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

impl Outline<'_> {
    /// Rounds that the net is refined by rows before the sweep begins.
    pub(crate) fn before(&self) -> usize {
        self.before
    }

    /// Into what all rounds split the faces.
    pub(crate) fn tile(&self) -> Tile {
        self.tile
    }
}

impl Sweep {
    /// The sweep of a net, where it has an [`Outline`] and the operators can be applied around each of its vertices.
    pub(crate) fn of(net: &MeshNet, plan: &Plan, steps: &[Scheduled]) -> Option<Self> {
        let Outline { tile, lines, lanes, rounds, passes, halo, before, splits } = Outline::of(net, plan, steps)?;
        let surface = Surface::new(net, tile, (&lines, lanes), before);
        let (head, tail) = rounds.split_at(before);
        let kinds = &surface.kinds;
        let stars = |at: usize, round: &[Scheduled]| {
            kinds.iter().map(|kind| StarRound::of(kind, (tile, reach(tile, halo)), at, plan, round)).collect()
        };
        let stars: Vec<Arc<Vec<StarRound>>> = each_round(tail, (&surface.softening(), lanes), stars)?;
        let first_pieces = 1 << (before - splits);
        let cells = |at: usize| (first_pieces << at).min(MOST_CELLS.max(first_pieces));
        let entries = passes.into_iter().skip(before).zip(stars).enumerate();
        let made: Vec<Round> = entries.map(|(at, (passes, stars))| Round { passes, stars, cells: cells(at) }).collect();
        let orders = [before, rounds.len()].map(|splits| Numbering::new(&net.mesh.base, tile, splits));
        let steps_before = head.iter().map(|round| round.len()).sum();
        let growth = made.iter().map(Round::growth).product::<f64>();
        Some(Self { surface, halo, before, steps_before, rounds: made, orders, first_pieces, growth })
    }

    /// Whether all numbers that are made of these are known to be finite: they and all sums on the way stay far below
    /// the largest number there is.
    pub(super) fn is_bounded(&self, start: &[f64]) -> bool {
        // twice as much as needed, for what is rounded
        start.iter().all(|x| x.abs() * self.growth < 0.5 * f64::MAX)
    }

    /// The same sweep in blocks of at most so many cells, but not of fewer than it begins with.
    pub(super) fn with_blocks(mut self, most_cells: usize) -> Self {
        for round in &mut self.rounds {
            round.cells = round.cells.min(most_cells.max(self.first_pieces));
        }
        self
    }

    /// Number of steps that the net has to be refined by before the sweep begins.
    pub(crate) fn steps_before(&self) -> usize {
        self.steps_before
    }

    /// The faces that are patches.
    pub(crate) fn patches(&self) -> &Arc<Topology> {
        &self.surface.patches
    }

    /// Into what each round splits the faces.
    pub(crate) fn tile(&self) -> Tile {
        self.surface.tile
    }

    /// Whether steps look at latitude and longitude tags.
    pub(crate) fn is_tagged(&self) -> bool {
        self.surface.is_tagged()
    }

    /// Rounds of the sweep.
    pub(super) fn n_rounds(&self) -> usize {
        self.rounds.len()
    }

    /// Rounds of the whole plan, each of which splits all faces.
    pub(crate) fn splits(&self) -> usize {
        self.before + self.rounds.len()
    }

    /// Bytes that it holds, a little more rather than less.
    pub(crate) fn bytes(&self) -> usize {
        /// Bytes a corner of the patches: their topology and that of the base, the sharpness of edges, and where the
        /// points of a patch are, in both orders.
        const CORNER: usize = 64;
        /// Bytes a point of a star in each round: its rows. Measured: 1,500 for UCCC, which is wide.
        const STAR_POINT: usize = 2048;
        let stars: usize = (0..self.surface.kinds.len()).map(|kind| self.shape(kind).len()).sum();
        let corners = self.surface.patches.n_half_edges() + self.surface.base.n_vertices();
        size_of::<Self>() + CORNER * corners + STAR_POINT * stars * self.rounds.len()
    }

    /// Pieces of a patch's side where the sweep ends.
    pub(super) fn patch_pieces(&self) -> usize {
        self.first_pieces << self.rounds.len()
    }

    /// Number of points in which the sweep ends.
    pub(crate) fn n_points(&self) -> usize {
        self.orders[1].n_vertices()
    }

    /// The passes of each round for points of `width` numbers.
    pub(super) fn flat(&self, width: usize) -> Flat {
        let flat = |(at, passes): (usize, &[Pass])| {
            let beyond = if at + 1 == self.rounds.len() { 0 } else { self.halo.cast_signed() };
            flat_passes(passes, self.size(at, width), beyond)
        };
        let turns = 0..self.rounds.iter().map(|round| round.passes.len()).min().unwrap_or(0);
        let of_turn =
            |turn: usize| self.rounds.iter().map(|round| &round.passes[turn][..]).enumerate().map(flat).collect();
        Flat(turns.map(of_turn).collect())
    }

    /// The size of the grids that enter a round.
    pub(super) fn size(&self, round: usize, width: usize) -> Size {
        Size { cells: self.rounds[round].cells, halo: self.halo, width }
    }

    /// The star around a vertex of this kind.
    pub(super) fn shape(&self, kind: usize) -> StarShape {
        let kind = &self.surface.kinds[kind];
        let tile = self.surface.tile;
        StarShape { tile, faces: kind.faces, closed: kind.closed, reach: reach(tile, self.halo) }
    }
}

/// The lines of a net, boundaries first, and the rounds after which they are known: where the sharpness of an edge
/// depends on its ends, or there are many different ones, when all that is sharp is infinitely sharp. None where that
/// is not known beforehand.
fn lines(net: &MeshNet) -> Option<(Vec<Line>, usize)> {
    let mut lines = vec![Line::Boundary];
    let Some(sharpness) = &net.sharpness else { return Some((lines, 0)) };
    if !sharpness.is_of_the_net_alone() {
        return None;
    }
    let finite = |&&(_, sharpness): &&(u32, f64)| sharpness < INFINITE_SHARPNESS;
    let most =
        sharpness.edges().iter().chain(sharpness.vertices()).filter(finite).fold(0.0, |most: f64, s| most.max(s.1));
    let mut own: Vec<f64> = Vec::new();
    for &(_, sharpness) in sharpness.vertices() {
        if own.len() <= MOST_LINES && !own.contains(&sharpness) {
            own.push(sharpness);
        }
    }
    let mut soft = (net.rules.creasing.evens_out() && most > 0.0) || own.len() > MOST_LINES;
    for &(_, sharpness) in sharpness.edges() {
        let line = Line::Crease(sharpness);
        if !lines.contains(&line) && !soft {
            lines.push(line);
            soft = lines.len() > MOST_LINES;
        }
    }
    if soft {
        let sharp = sharpness.edges().iter().find(|(_, sharpness)| *sharpness >= INFINITE_SHARPNESS);
        lines.truncate(1);
        lines.extend(sharp.map(|&(_, sharpness)| Line::Crease(sharpness)));
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "finite sharpness is at most 10")]
    Some((lines, if soft { most.ceil() as usize } else { 0 }))
}

/// What `make` gives for each round, with its number; rounds whose steps have the same numbers share it once
/// the lines do not change any more. Lanes may have an alpha that the steps do not tell, so that all rounds differ.
fn each_round<T>(
    rounds: &[&[Scheduled]],
    (lines, lanes): (&[Line], Option<Lanes>),
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
