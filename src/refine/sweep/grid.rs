//! A patch, or a block of one, as planes of points that flat loops refine.

use std::ops::Range;

use super::kernel::{FlatGroup, FlatMask, sum_at};
use super::mask::{Line, Mask, MaskGroup, PLANES, Pass};

/// One pass at one size of grid.
#[derive(Debug)]
pub(super) struct FlatPass {
    is: FlatUse,
    planes: [FlatMask; PLANES],
    /// Masks along boundaries and creases, for sides along the first and the second axis.
    lines: [[[Vec<FlatGroup>; 2]; 2]; 2],
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum FlatUse {
    Up,
    Blend,
    Push,
}

/// The size of a grid: `cells x cells` with a halo of cells around it, points of `width` numbers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Size {
    pub(super) cells: usize,
    pub(super) halo: usize,
    pub(super) width: usize,
}

impl Size {
    /// Points in a row.
    pub(super) fn stride(self) -> usize {
        self.cells + 1 + 2 * self.halo
    }

    /// Numbers of a plane.
    pub(super) fn len(self) -> usize {
        self.stride() * self.stride() * self.width
    }

    /// Where the numbers of a cell's point begin; cells of the halo are negative or beyond.
    pub(super) fn at(self, cell: [isize; 2]) -> usize {
        let [i, j] = cell.map(|x| x.cast_unsigned().wrapping_add(self.halo));
        (j * self.stride() + i) * self.width
    }

    /// The numbers of the rows of a plane that hold points of the refined grid within it or up to `beyond` outside.
    fn rows(self, plane: usize, beyond: isize) -> Range<usize> {
        let odd = (plane >> 1 & 1).cast_signed();
        let halo = self.halo.cast_signed();
        let first = (1 - beyond - odd).div_euclid(2).max(-halo);
        let last = (2 * self.cells.cast_signed() + beyond - odd).div_euclid(2).min(self.cells.cast_signed() + halo);
        self.at([-halo, first])..self.at([-halo, last]) + self.stride() * self.width
    }

    fn distance(self, [i, j]: [isize; 2]) -> isize {
        (j * self.stride().cast_signed() + i) * self.width.cast_signed()
    }

    fn flat(self, group: &MaskGroup) -> FlatGroup {
        let members = group
            .members
            .iter()
            .map(|&(plane, at)| (u8::try_from(plane).unwrap_or(FACES), self.distance(at)))
            .collect();
        FlatGroup { weight: group.weight, members }
    }
}

/// The passes of a round on grids of a size, after which the points of the refined grid matter that lie within it or up
/// to `beyond` outside.
pub(super) fn flat_passes(passes: &[Pass], size: Size, beyond: isize) -> Vec<FlatPass> {
    let mut beyond = beyond;
    let mut flat: Vec<FlatPass> = Vec::new();
    for pass in passes.iter().rev() {
        if let Pass::Push(_) = pass {
            beyond += beyond & 1;
        }
        flat.push(FlatPass::new(pass, size, beyond));
        beyond += pass.radius().unwrap_or(0);
    }
    flat.reverse();
    flat
}

impl FlatPass {
    fn new(pass: &Pass, size: Size, beyond: isize) -> Self {
        let flat = |mask: &Mask| mask.iter().map(|group| size.flat(group)).collect::<Vec<_>>();
        let (is, planes) = match pass {
            Pass::Up(masks) => (FlatUse::Up, masks),
            Pass::Blend { planes, .. } => (FlatUse::Blend, planes),
            Pass::Push(masks) => (FlatUse::Push, masks),
        };
        let lines = match pass {
            Pass::Blend { lines, .. } => {
                let turned = |mask: &Mask, axis| mask.iter().map(|group| size.flat(&turned(group, axis))).collect();
                [0, 1].map(|axis| [0, 1].map(|kind| [0, 1].map(|plane| turned(&lines[kind][plane], axis))))
            }
            _ => Default::default(),
        };
        let mask = |plane: usize| FlatMask::new(flat(&planes[plane]), size.len(), size.rows(plane, beyond));
        Self { is, planes: std::array::from_fn(mask), lines }
    }

    /// Whether the points of a plane stay, wherever they lie.
    fn keeps(&self, plane: usize) -> bool {
        let groups = self.planes[plane].groups.as_slice();
        plane == PLANES - 1
            && matches!(groups, [FlatGroup { weight: 1.0, members }] if matches!(members[..], [(FACES, 0)]))
    }
}

/// The plane of the points of faces.
const FACES: u8 = 3;

/// A group of a mask on a line along the first axis, on a line along this axis.
fn turned(group: &MaskGroup, axis: usize) -> MaskGroup {
    let turn = |&(plane, [i, _]): &(usize, [isize; 2])| match axis {
        0 => (plane, [i, 0]),
        _ => (2 * plane, [0, i]),
    };
    MaskGroup { members: group.members.iter().map(turn).collect(), ..group.clone() }
}

/// A side of a grid that is not smooth.
#[derive(Debug, Clone, Copy)]
pub(super) struct SharpSide {
    pub(super) side: usize,
    pub(super) line: Line,
}

/// The points of a grid while it is refined: before a round only the first plane.
#[derive(Debug, Default)]
pub(super) struct Planes {
    pub(super) now: [Vec<f64>; PLANES],
    next: [Vec<f64>; PLANES],
    anchor: Vec<f64>,
}

/// Makes a buffer at least so long; what it held stays in it.
pub(super) fn at_least(buffer: &mut Vec<f64>, len: usize) {
    if buffer.len() < len {
        buffer.resize(len, 0.0);
    }
}

impl Planes {
    /// Refines the grid once. The result lies in all planes: vertices, points of edges along the first and second axis,
    /// points of faces, each at the cell to whose lower left it belongs.
    pub(super) fn refine(&mut self, passes: &[FlatPass], size: Size, sides: &[SharpSide]) {
        let len = size.len();
        self.now.iter_mut().chain(&mut self.next).for_each(|plane| at_least(plane, len));
        let pushes = passes.iter().any(|pass| pass.is == FlatUse::Push);
        if pushes {
            at_least(&mut self.anchor, len);
            self.anchor[..len].copy_from_slice(&self.now[0][..len]);
        }
        for pass in passes {
            match pass.is {
                FlatUse::Up => {
                    let [coarse, planes @ ..] = &mut self.now;
                    let source = [&coarse[..len]; PLANES];
                    for (plane, out) in planes.iter_mut().enumerate() {
                        pass.planes[plane + 1].combine(&source, &mut out[..len], false);
                    }
                }
                FlatUse::Blend => self.blend(pass, size, sides),
                FlatUse::Push => self.push(pass, len),
            }
        }
    }

    fn blend(&mut self, pass: &FlatPass, size: Size, sides: &[SharpSide]) {
        let len = size.len();
        let Self { now, next, .. } = self;
        let source = now.each_ref().map(|plane| &plane[..len]);
        let moved = |plane: usize| !pass.keeps(plane);
        for plane in (0..PLANES).filter(|&plane| moved(plane)) {
            pass.planes[plane].combine(&source, &mut next[plane][..len], false);
        }
        for side in sides {
            draw_line(pass, &source, next, size, *side);
        }
        for plane in (0..PLANES).filter(|&plane| moved(plane)) {
            std::mem::swap(&mut now[plane], &mut next[plane]);
        }
    }

    fn push(&mut self, pass: &FlatPass, len: usize) {
        let differences = &mut self.next[0][..len];
        for ((d, anchor), child) in differences.iter_mut().zip(&self.anchor[..len]).zip(&self.now[0][..len]) {
            *d = anchor - child;
        }
        let source = [&self.next[0][..len]; PLANES];
        for (mask, out) in pass.planes.iter().zip(&mut self.now) {
            mask.combine(&source, &mut out[..len], true);
        }
    }
}

/// Makes the points on a sharp side of what lies on that side, those beyond its ends, too, as far as what they are made
/// of is in the grid: a block of a patch needs them.
fn draw_line(pass: &FlatPass, source: &[&[f64]; PLANES], next: &mut [Vec<f64>; PLANES], size: Size, side: SharpSide) {
    let axis = side.side % 2;
    let (n, halo) = (size.cells.cast_signed(), size.halo.cast_signed());
    let across = [0, n, n, 0][side.side];
    let kind = match side.line {
        Line::Boundary => 0,
        Line::Crease => 1,
    };
    let cell = size.distance(if axis == 0 { [1, 0] } else { [0, 1] });
    for (plane, groups) in pass.lines[axis][kind].iter().enumerate() {
        let out = &mut next[plane << axis];
        let shifts = || groups.iter().flat_map(|group| &group.members).map(|&(_, distance)| distance / cell);
        let (low, high) = (shifts().min().unwrap_or(0).min(0), shifts().max().unwrap_or(0).max(0));
        for steps in -halo - low..=n + halo - high {
            let at = size.at(if axis == 0 { [steps, across] } else { [across, steps] });
            for (k, x) in (at..).zip(&mut out[at..at + size.width]) {
                *x = sum_at(groups, source, k);
            }
        }
    }
}
