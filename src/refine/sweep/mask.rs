//! The masks of a round on a regular grid, read off the rows of the operators on small nets.

use super::lanes::Lanes;
use super::lattice::{cell, fine, is_within};
use super::line::Line;
use super::planes::{Mask, MaskGroup, PLANES};
use super::sample::{RADIUS, Sample, Table, Use};
use crate::math::functions::ratio;
use crate::scheme::plan::{Plan, Scheduled};
use crate::shape::tile::Tile;

/// The masks on a line along each of [`AXES`](super::lattice::AXES), as far as patches have such sides: of vertices
/// and of points of edges.
pub(super) type LineMasks = Vec<[Mask; 2]>;

/// How one step makes the points of the planes.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Pass {
    /// All planes from the coarse grid, which is the first plane.
    Up([Mask; PLANES]),
    /// All planes from all planes.
    Blend {
        /// Where everything is smooth.
        planes: [Mask; PLANES],
        /// For each line the masks there, where that is not smooth.
        lines: Vec<Option<LineMasks>>,
    },
    /// The mask of the differences between the coarse grid and its children is added to each plane.
    Push([Mask; PLANES]),
}

/// The passes of a round on a net with such lines and lanes, or none where its rows are not those of masks.
pub(super) fn passes(
    plan: &Plan,
    round: &[Scheduled],
    tile: Tile,
    lines: &[Option<Line>],
    lanes: Option<Lanes>,
) -> Option<Vec<Pass>> {
    let sample = |line| Sample::new(tile, line, RADIUS).with_lanes(lanes);
    let smooth = sample(None).tables(plan, round)?;
    let mut passes: Vec<Pass> = smooth.iter().map(Pass::smooth).collect::<Option<_>>()?;
    for line in lines {
        let axes = if tile == Tile::Quad { 2 } else { 3 };
        // boundaries of lanes lie along latitude edges alone
        let occurs =
            |line: Line, axis: usize| line != Line::Boundary || lanes.is_none_or(|lanes| lanes.turned == (axis == 1));
        let along = |line: Line| {
            let tables = |axis| {
                if !occurs(line, axis) {
                    return Some(None);
                }
                sample(Some((line, axis))).tables(plan, round).map(Some)
            };
            (0..axes).map(tables).collect::<Option<Vec<_>>>()
        };
        let along = match *line {
            Some(line) => Some(along(line)?),
            None => None,
        };
        for (at, pass) in passes.iter_mut().enumerate() {
            let tables = along.as_ref().map(|axes| axes.iter().map(|tables| tables.as_ref().map(|tables| &tables[at])));
            let tables = tables.map(Iterator::collect::<Vec<_>>);
            pass.add_line(tables.as_deref())?;
        }
    }
    Some(passes)
}

impl Pass {
    fn smooth(table: &Table) -> Option<Self> {
        let masks = table.masks.iter().map(|(_, mask)| mask.clone()).collect::<Vec<_>>();
        let masks: [Mask; PLANES] = masks.try_into().ok()?;
        match table.is {
            Use::Up => {
                let stays = [MaskGroup { weight: 1.0, members: vec![(0, [0, 0])] }];
                (masks[0] == stays).then_some(Self::Up(masks))
            }
            Use::Push => Some(Self::Push(masks)),
            Use::Blend => Some(Self::Blend { planes: masks, lines: Vec::new() }),
        }
    }

    /// Adds a line, with the tables along each axis on which it occurs, where it is not smooth; none where points
    /// beside it have other masks than elsewhere, or those on it where that is not looked at.
    fn add_line(&mut self, tables: Option<&[Option<&Table>]>) -> Option<()> {
        let masks = match self {
            Self::Up(masks) | Self::Push(masks) => masks,
            Self::Blend { planes, .. } => planes,
        };
        let as_elsewhere = |of: &[(usize, Mask)]| of.iter().all(|(plane, mask)| same(mask, &masks[*plane]));
        for table in tables.into_iter().flatten().flatten() {
            if !as_elsewhere(&table.beside) || !(as_elsewhere(&table.masks) || table.is == Use::Blend) {
                return None;
            }
        }
        if let Self::Blend { lines, .. } = self {
            let on_line = |table: Option<&Table>| {
                [0, 1].map(|point: usize| table.map_or_else(Vec::new, |table| table.masks[point].1.clone()))
            };
            lines.push(tables.map(|tables| tables.iter().copied().map(on_line).collect()));
        }
        Some(())
    }

    /// By how many points of the refined grid a point looks around at most, where that does not begin anew. The
    /// push-back looks at children of the coarse grid.
    pub(super) fn radius(&self) -> Option<isize> {
        let planes = match self {
            Self::Up(_) => return None,
            Self::Blend { planes, .. } | Self::Push(planes) => planes,
        };
        let distances = planes.iter().enumerate().flat_map(|(to, mask)| {
            let members = mask.iter().flat_map(|group| &group.members);
            members.flat_map(move |&(from, at)| [0, 1].map(|axis| fine(from, at)[axis] - fine(to, [0, 0])[axis]))
        });
        distances.map(isize::abs).max()
    }

    /// By which factor numbers grow at most: those after the pass, counted by the largest of all numbers before it in
    /// the round.
    pub(super) fn growth(&self) -> f64 {
        let of = |masks: &[Mask]| masks.iter().map(total).fold(1.0, f64::max);
        match self {
            Self::Up(masks) => of(masks),
            Self::Blend { planes, lines } => {
                lines.iter().flatten().flatten().map(|masks| of(masks)).fold(of(planes), f64::max)
            }
            // of differences of two numbers
            Self::Push(masks) => 1.0 + 2.0 * of(masks),
        }
    }

    /// The planes that have to be known before the pass, so that these are known after it.
    pub(super) fn reads(&self, wanted: [bool; PLANES]) -> [bool; PLANES] {
        let mut reads = [false; PLANES];
        match self {
            // of the coarse grid
            Self::Up(_) => reads[0] = true,
            Self::Push(_) => {
                reads = wanted;
                reads[0] = true;
            }
            Self::Blend { planes, lines } => {
                let smooth = planes.iter().zip(wanted).filter(|(_, wanted)| *wanted).map(|(mask, _)| mask);
                let on_lines = lines.iter().flatten().flatten().flatten();
                let members = smooth.chain(on_lines).flatten().flat_map(|group| &group.members);
                members.for_each(|&(plane, _)| reads[plane] = true);
            }
        }
        reads
    }
}

/// The sum of the sizes of the weights of a mask.
fn total(mask: &Mask) -> f64 {
    mask.iter().map(|group| group.weight.abs() * ratio(group.members.len(), 1)).sum()
}

/// Whether two masks are the same but for the order of the members of their groups, which keeps opposite pairs.
fn same(a: &Mask, b: &Mask) -> bool {
    let sorted = |mask: &Mask| {
        let mut mask = mask.clone();
        mask.iter_mut().for_each(|group| group.members.sort_unstable());
        mask
    };
    sorted(a) == sorted(b)
}

/// How many cells beyond a patch are to be known so that as many points are known there after a round: the least such
/// number, if it is a small one.
pub(super) fn halo(tile: Tile, passes: &[Pass]) -> Option<usize> {
    (1..=MAX_HALO).find(|&halo| Known::new(tile, halo).suffices(passes))
}

/// The widest halo: that of four averages. A round with five would need five cells, and its first three levels would be
/// refined elsewhere before it pays.
const MAX_HALO: usize = 4;

/// Which points of a refined grid around a patch are known.
struct Known {
    tile: Tile,
    halo: isize,
    /// By plane and cell.
    points: Vec<bool>,
}

/// Pieces of the patch: as many as the least patch has whose neighbours touch, so that all corners differ.
const PIECES: isize = 2;

impl Known {
    fn new(tile: Tile, halo: usize) -> Self {
        let halo = halo.cast_signed();
        let side = Self::side(halo);
        Self { tile, halo, points: vec![false; PLANES * side * side] }
    }

    fn side(halo: isize) -> usize {
        (PIECES + 2 * halo + 1).unsigned_abs()
    }

    fn at(&self, plane: usize, [i, j]: [isize; 2]) -> Option<usize> {
        let side = Self::side(self.halo);
        let [i, j] = [i, j].map(|x| usize::try_from(x + self.halo).ok().filter(|&x| x < side));
        Some((plane * side + j?) * side + i?)
    }

    fn has(&self, plane: usize, at: [isize; 2]) -> bool {
        self.at(plane, at).is_some_and(|at| self.points[at])
    }

    fn is_coarse(&self, at: [isize; 2]) -> bool {
        is_within(self.tile, PIECES, self.halo, at)
    }

    /// Whether, with all points of the coarse grid in the patch and its halo, those of the refined one are known after
    /// these passes.
    fn suffices(mut self, passes: &[Pass]) -> bool {
        for pass in passes {
            let whole = |mask: &Mask, [i, j]: [isize; 2], has: &dyn Fn(usize, [isize; 2]) -> bool| {
                mask.iter().flat_map(|group| &group.members).all(|&(plane, [a, b])| has(plane, [i + a, j + b]))
            };
            let after: Vec<bool> = self
                .places()
                .map(|(plane, at)| match pass {
                    Pass::Up(masks) => whole(&masks[plane], at, &|_, at| self.is_coarse(at)),
                    Pass::Blend { planes, .. } => whole(&planes[plane], at, &|plane, at| self.has(plane, at)),
                    Pass::Push(masks) => {
                        self.has(plane, at) && whole(&masks[plane], at, &|_, at| self.is_coarse(at) && self.has(0, at))
                    }
                })
                .collect();
            self.points = after;
        }
        let reach = 2 * self.halo;
        let mut places = (-reach..=2 * PIECES + reach).flat_map(|j| (-reach..=2 * PIECES + reach).map(move |i| [i, j]));
        places.all(|place| {
            let (plane, at) = cell(place);
            !is_within(self.tile, 2 * PIECES, self.halo, place) || self.has(plane, at)
        })
    }

    /// All planes and cells, in order.
    fn places(&self) -> impl Iterator<Item = (usize, [isize; 2])> + use<> {
        let range = -self.halo..=PIECES + self.halo;
        (0..PLANES).flat_map(move |plane| {
            let rows = range.clone();
            let columns = range.clone();
            rows.flat_map(move |j| columns.clone().map(move |i| (plane, [i, j])))
        })
    }
}
