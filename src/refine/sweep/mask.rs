//! The masks of a round on a regular grid, read off the rows of the operators on small nets.

use super::lanes::Lanes;
use super::lattice::{cell, fine, is_within};
use super::line::SharpSide;
use super::planes::{MaskGroup, PLANES, PlaneMask};
use super::sample::{MaskTable, SAMPLE_RADIUS, Sample, TableUse};
use crate::math::functions::ratio;
use crate::scheme::plan::{Plan, Scheduled};
use crate::shape::tile::Tile;

/// The masks on a line for each of the [`LATTICE_AXES`](super::lattice::LATTICE_AXES) along which patches have sides:
/// of vertices and of edge points.
pub(super) type LineMasks = Vec<[PlaneMask; 2]>;

/// How one step computes the points of the planes.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Pass {
    /// Each plane is computed from the coarse grid, which is the first plane.
    Up([PlaneMask; PLANES]),
    /// Each plane is computed from all planes.
    Blend {
        /// The masks where everything is smooth.
        planes: [PlaneMask; PLANES],
        /// For each line its masks, or `None` where the line is smooth.
        lines: Vec<Option<LineMasks>>,
    },
    /// The masks are applied to the differences between the coarse grid and its children, and added to each plane.
    Push([PlaneMask; PLANES]),
}

/// Returns the passes of a round on a net with these lines and lanes, or `None` if masks cannot express its rows.
pub(super) fn passes(
    plan: &Plan,
    round: &[Scheduled],
    tile: Tile,
    lines: &[Option<SharpSide>],
    lanes: Option<Lanes>,
) -> Option<Vec<Pass>> {
    let sample = |line| Sample::new(tile, line, SAMPLE_RADIUS).with_lanes(lanes);
    let smooth = sample(None).tables(plan, round)?;
    let mut passes: Vec<Pass> = smooth.iter().map(Pass::smooth).collect::<Option<_>>()?;
    for line in lines {
        let axes = if tile == Tile::Quad { 2 } else { 3 };
        // a net with lanes has boundaries along latitude edges only
        let occurs = |line: SharpSide, axis: usize| {
            line != SharpSide::Boundary || lanes.is_none_or(|lanes| lanes.turned == (axis == 1))
        };
        let along = |line: SharpSide| {
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
    fn smooth(table: &MaskTable) -> Option<Self> {
        let masks = table.masks.iter().map(|(_, mask)| mask.clone()).collect::<Vec<_>>();
        let masks: [PlaneMask; PLANES] = masks.try_into().ok()?;
        match table.is {
            TableUse::Up => {
                let stays = [MaskGroup { weight: 1.0, members: vec![(0, [0, 0])] }];
                (masks[0] == stays).then_some(Self::Up(masks))
            }
            TableUse::Push => Some(Self::Push(masks)),
            TableUse::Blend => Some(Self::Blend { planes: masks, lines: Vec::new() }),
        }
    }

    /// Adds a line, given its table for each axis on which it occurs, or `None` if the line is smooth. Returns `None`
    /// if points next to the line have other masks than elsewhere, or if points on it do in a pass that has no line
    /// masks.
    fn add_line(&mut self, tables: Option<&[Option<&MaskTable>]>) -> Option<()> {
        let masks = match self {
            Self::Up(masks) | Self::Push(masks) => masks,
            Self::Blend { planes, .. } => planes,
        };
        let as_elsewhere = |of: &[(usize, PlaneMask)]| of.iter().all(|(plane, mask)| same(mask, &masks[*plane]));
        for table in tables.into_iter().flatten().flatten() {
            if !as_elsewhere(&table.beside) || !(as_elsewhere(&table.masks) || table.is == TableUse::Blend) {
                return None;
            }
        }
        if let Self::Blend { lines, .. } = self {
            let on_line = |table: Option<&MaskTable>| {
                [0, 1].map(|point: usize| table.map_or_else(Vec::new, |table| table.masks[point].1.clone()))
            };
            lines.push(tables.map(|tables| tables.iter().copied().map(on_line).collect()));
        }
        Some(())
    }

    /// Returns the greatest distance, in points of the refined grid, at which the pass reads points; `None` for an
    /// upsampling, which reads the coarse grid. A push-back reads children of the coarse grid.
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

    /// Returns an upper bound of the factor by which values grow: the greatest value after the pass divided by the
    /// greatest value before it in the round.
    pub(super) fn growth(&self) -> f64 {
        let of = |masks: &[PlaneMask]| masks.iter().map(total).fold(1.0, f64::max);
        match self {
            Self::Up(masks) => of(masks),
            Self::Blend { planes, lines } => {
                lines.iter().flatten().flatten().map(|masks| of(masks)).fold(of(planes), f64::max)
            }
            // a difference of two values is at most twice as large
            Self::Push(masks) => 1.0 + 2.0 * of(masks),
        }
    }

    /// Returns the planes that must be known before the pass so that the `wanted` planes are known after it.
    pub(super) fn reads(&self, wanted: [bool; PLANES]) -> [bool; PLANES] {
        let mut reads = [false; PLANES];
        match self {
            // reads the coarse grid
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

/// Returns the sum of the absolute values of the weights of a mask.
fn total(mask: &PlaneMask) -> f64 {
    mask.iter().map(|group| group.weight.abs() * ratio(group.members.len(), 1)).sum()
}

/// Returns whether two masks are equal up to the order of members in a group, which keeps opposite pairs.
fn same(a: &PlaneMask, b: &PlaneMask) -> bool {
    let sorted = |mask: &PlaneMask| {
        let mut mask = mask.clone();
        mask.iter_mut().for_each(|group| group.members.sort_unstable());
        mask
    };
    sorted(a) == sorted(b)
}

/// Returns the smallest number of cells beyond a patch that must be known so that as many are known after a round;
/// `None` if it is greater than [`MAX_HALO`].
pub(super) fn halo(tile: Tile, passes: &[Pass]) -> Option<usize> {
    (1..=MAX_HALO).find(|&halo| KnownPoints::new(tile, halo).suffices(passes))
}

/// The widest halo: that of four averages. Five averages would need five cells, and three rounds would be refined by
/// rows before the sweep could begin, which does not pay.
const MAX_HALO: usize = 4;

/// The points of a refined grid around a patch that are known.
struct KnownPoints {
    tile: Tile,
    halo: isize,
    /// Whether each point is known, by plane and cell.
    points: Vec<bool>,
}

/// Pieces per side of the test patch: the smallest patch whose neighbours meet and whose corners are all distinct.
const PIECES_A_SIDE: isize = 2;

impl KnownPoints {
    fn new(tile: Tile, halo: usize) -> Self {
        let halo = halo.cast_signed();
        let side = Self::side(halo);
        Self { tile, halo, points: vec![false; PLANES * side * side] }
    }

    fn side(halo: isize) -> usize {
        (PIECES_A_SIDE + 2 * halo + 1).unsigned_abs()
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
        is_within(self.tile, PIECES_A_SIDE, self.halo, at)
    }

    /// Returns whether these passes compute all needed points of the refined grid from the points of the coarse grid in
    /// the patch and its halo.
    fn suffices(mut self, passes: &[Pass]) -> bool {
        for pass in passes {
            let whole = |mask: &PlaneMask, [i, j]: [isize; 2], has: &dyn Fn(usize, [isize; 2]) -> bool| {
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
        let mut places = (-reach..=2 * PIECES_A_SIDE + reach)
            .flat_map(|j| (-reach..=2 * PIECES_A_SIDE + reach).map(move |i| [i, j]));
        places.all(|place| {
            let (plane, at) = cell(place);
            !is_within(self.tile, 2 * PIECES_A_SIDE, self.halo, place) || self.has(plane, at)
        })
    }

    /// Returns all planes and cells, in order.
    fn places(&self) -> impl Iterator<Item = (usize, [isize; 2])> + use<> {
        let range = -self.halo..=PIECES_A_SIDE + self.halo;
        (0..PLANES).flat_map(move |plane| {
            let rows = range.clone();
            let columns = range.clone();
            rows.flat_map(move |j| columns.clone().map(move |i| (plane, [i, j])))
        })
    }
}
