//! A patch, or a block of one, stored as planes of points that are refined by flat loops.

use std::ops::{Range, RangeInclusive};

use super::aligned::AlignedBuffer;
use super::joint::JointMask;
use super::kernel::{FlatGroup, FlatMask, differences, sum_at};
use super::lattice::{LATTICE_AXES, after, cell};
use super::mask::{LineMasks, Pass};
use super::planes::{MaskGroup, PLANES, PlaneMask};
use super::upcoming::Upcoming;

/// One pass, prepared for stacks of one size.
#[derive(Debug)]
pub(super) struct FlatPass {
    is: FlatUse,
    /// Whether each plane is computed: it is read later, and points move.
    moves: [bool; PLANES],
    /// The masks of all these planes, if there is a loop for them.
    joint: Option<JointMask>,
    /// The mask of each plane, where `joint` does not compute it.
    planes: [FlatMask; PLANES],
    /// For each line the masks along each axis, or `None` where the line is smooth.
    lines: Vec<Option<Vec<[FlatLine; 2]>>>,
}

/// The mask of vertices, or of edge points, on a line.
#[derive(Debug)]
struct FlatLine {
    groups: Vec<FlatGroup>,
    /// The smallest and the largest cell offset of its members, from the cell of the point.
    reach: [[isize; 2]; 2],
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum FlatUse {
    Up,
    Blend,
    Push,
}

/// The size of a grid: `cells x cells` plus a halo of `halo` cells on each side; points have `width` coordinates.
/// Planes hold a stack of `grids` grids of one size: first all first points, then all second ones, and so on.
#[derive(Debug, Clone, Copy)]
pub(super) struct GridSize {
    pub(super) cells: usize,
    pub(super) halo: usize,
    pub(super) width: usize,
    /// Number of grids in the stack.
    pub(super) grids: usize,
    /// The place of the grid in the stack.
    pub(super) place: usize,
}

impl GridSize {
    /// Number of points in a row.
    pub(super) fn stride(self) -> usize {
        self.cells + 1 + 2 * self.halo
    }

    /// Number of values of all points at one place.
    pub(super) fn step(self) -> usize {
        self.grids * self.width
    }

    /// Number of values in a plane.
    pub(super) fn len(self) -> usize {
        self.stride() * self.stride() * self.step()
    }

    /// Returns the size with another place in the stack.
    pub(super) fn stacked(self, place: usize) -> Self {
        Self { place, ..self }
    }

    /// Returns the index of the first value of a cell's point; cells in the halo are negative or greater than `cells`.
    pub(super) fn at(self, cell: [isize; 2]) -> usize {
        let [i, j] = cell.map(|x| x.cast_unsigned().wrapping_add(self.halo));
        (j * self.stride() + i) * self.step() + self.place * self.width
    }

    /// Returns the ranges of values of planes where any of them has points of the refined grids, or at most `beyond`
    /// outside these: a range for each row of a stack. For a single grid, whose rows are short or have small halos, one
    /// range with the halos costs less.
    fn ranges(self, planes: &[usize], beyond: isize) -> Vec<Range<usize>> {
        let [halo, cells] = [self.halo, self.cells].map(usize::cast_signed);
        let [columns, rows] = [0, 1].map(|axis| {
            let odd = planes.iter().map(|plane| (plane >> axis & 1).cast_signed());
            let [least, most] = [odd.clone().min(), odd.max()].map(Option::unwrap_or_default);
            let first = (1 - beyond - most).div_euclid(2).max(-halo);
            let last = (2 * cells + beyond - least).div_euclid(2).min(cells + halo);
            [first, last]
        });
        let between = |first: [isize; 2], last: [isize; 2]| self.at(first)..self.at(last) + self.step();
        if self.grids == 1 {
            return vec![between([columns[0], rows[0]], [columns[1], rows[1]])];
        }
        (rows[0]..=rows[1]).map(|row| between([columns[0], row], [columns[1], row])).collect()
    }

    /// Returns how far apart the values of two points are that lie so many cells apart.
    pub(super) fn distance(self, [i, j]: [isize; 2]) -> isize {
        (j * self.stride().cast_signed() + i) * self.step().cast_signed()
    }

    fn flat(self, group: &MaskGroup) -> FlatGroup {
        let members =
            group.members.iter().map(|&(plane, at)| (u8::try_from(plane).unwrap_or(0), self.distance(at))).collect();
        FlatGroup { weight: group.weight, members }
    }
}

/// Prepares the passes of a round for grids of one size. After them, the points of the refined grid are correct that
/// lie within it or at most `beyond` outside.
pub(super) fn flat_passes(passes: &[Pass], size: GridSize, beyond: isize) -> Vec<FlatPass> {
    let (mut beyond, mut wanted) = (beyond, [true; PLANES]);
    let mut flat: Vec<FlatPass> = Vec::new();
    for pass in passes.iter().rev() {
        let radius = pass.radius().unwrap_or(0);
        if let Pass::Push(_) = pass {
            // odd points between children read the next child, too
            beyond += beyond & 1;
            flat.push(FlatPass::new(pass, size, beyond, wanted));
            beyond += (radius - 1).max(0);
        } else {
            flat.push(FlatPass::new(pass, size, beyond, wanted));
            beyond += radius;
        }
        wanted = pass.reads(wanted);
    }
    flat.reverse();
    flat
}

impl FlatPass {
    fn new(pass: &Pass, size: GridSize, beyond: isize, wanted: [bool; PLANES]) -> Self {
        let flat = |mask: &PlaneMask| mask.iter().map(|group| size.flat(group)).collect::<Vec<_>>();
        let (is, masks) = match pass {
            Pass::Up(masks) => (FlatUse::Up, masks),
            Pass::Blend { planes, .. } => (FlatUse::Blend, planes),
            Pass::Push(masks) => (FlatUse::Push, masks),
        };
        let lines: Vec<Option<Vec<[FlatLine; 2]>>> = match pass {
            Pass::Blend { lines, .. } => {
                let line = |mask: &PlaneMask| FlatLine { groups: flat(mask), reach: reach(mask) };
                let along = |masks: &LineMasks| masks.iter().map(|masks| masks.each_ref().map(line)).collect();
                lines.iter().map(|masks| masks.as_ref().map(along)).collect()
            }
            _ => Vec::new(),
        };
        let is_drawn = |plane: usize| lines.iter().flatten().any(|masks| plane <= masks.len());
        let moves = std::array::from_fn(|plane| {
            wanted[plane]
                && match is {
                    FlatUse::Up => plane > 0,
                    FlatUse::Blend => is_drawn(plane) || !stays(plane, &masks[plane]),
                    FlatUse::Push => true,
                }
        });
        let mask = |plane: usize| FlatMask::new(flat(&masks[plane]), size.len(), size.ranges(&[plane], beyond));
        let mut planes: [FlatMask; PLANES] = std::array::from_fn(mask);
        let moving: Vec<usize> = (0..PLANES).filter(|&plane| moves[plane]).collect();
        let groups: Vec<&[FlatGroup]> = moving.iter().map(|&plane| &*planes[plane].groups).collect();
        let joint = JointMask::new(&groups, is == FlatUse::Push, size.len(), size.ranges(&moving, beyond));
        if let Some(joint) = &joint {
            planes.iter_mut().for_each(|mask| mask.keep(|range| joint.without(range)));
        }
        Self { is, moves, joint, planes, lines }
    }

    /// Sets the planes that move to the sums of the masks, or adds these to them.
    fn combine(&self, source: &[&[f64]; PLANES], mut planes: [&mut [f64]; PLANES], upcoming: &mut Upcoming<'_>) {
        if let Some(joint) = &self.joint {
            let mut moving =
                planes.iter_mut().zip(self.moves).filter_map(|(plane, moves)| moves.then_some(&mut **plane));
            joint.combine(source, std::array::from_fn(|_| moving.next().unwrap_or_default()), upcoming);
        }
        let moving = self.planes.iter().zip(planes).zip(self.moves).filter(|(_, moves)| *moves);
        for ((mask, plane), _) in moving {
            mask.combine(source, plane, self.is == FlatUse::Push, upcoming);
        }
    }
}

/// Returns whether a mask of this plane leaves its points where they are.
fn stays(plane: usize, mask: &PlaneMask) -> bool {
    matches!(&mask[..], [MaskGroup { weight: 1.0, members }] if members[..] == [(plane, [0, 0])])
}

/// Returns the smallest and the largest cell offset of the members of a mask.
fn reach(mask: &PlaneMask) -> [[isize; 2]; 2] {
    let members = || mask.iter().flat_map(|group| &group.members);
    let along = |axis: usize| members().map(move |(_, at)| at[axis]);
    [[0, 1].map(|axis| along(axis).min().unwrap_or(0)), [0, 1].map(|axis| along(axis).max().unwrap_or(0))]
}

/// A line on a grid: the place of the grid in its stack, the index of the line, the axis along which it runs, and a
/// vertex on it.
#[derive(Debug, Clone, Copy)]
pub(super) struct GridLine {
    pub(super) grid: usize,
    pub(super) line: usize,
    pub(super) axis: usize,
    pub(super) from: [isize; 2],
}

/// The points of a stack of grids under refinement; before a round only the first plane is used.
#[derive(Debug, Default)]
pub(super) struct Planes {
    pub(super) now: [AlignedBuffer; PLANES],
    next: [AlignedBuffer; PLANES],
    anchor: AlignedBuffer,
}

impl Planes {
    /// Returns the points of a line on the refined grid, by the number of steps `along` it from the place `start`.
    pub(super) fn line<const W: usize>(
        &self,
        size: GridSize,
        start: [isize; 2],
        along: [isize; 2],
    ) -> impl Fn(usize) -> [f64; W] {
        // every second point belongs to the same plane, in the next cell
        let first = |place: [isize; 2]| {
            let (plane, cell) = cell(place);
            (&self.now[plane][..], size.at(cell))
        };
        let (even, odd) = (first(start), first([start[0] + along[0], start[1] + along[1]]));
        let next = size.distance(along);
        move |steps| {
            let (plane, at) = if steps.is_multiple_of(2) { even } else { odd };
            let at = at.wrapping_add_signed((steps / 2).cast_signed() * next);
            std::array::from_fn(|c| plane[at + c])
        }
    }

    /// Refines a stack of grids once. Afterwards the planes hold the vertices, the edge points along the first and the
    /// second axis, and the face points, each at the cell whose lower left corner it belongs to.
    ///
    /// The loops run over all grids of the stack. Meanwhile asks for the memory that is `upcoming`.
    pub(super) fn refine(
        &mut self,
        passes: &[FlatPass],
        size: GridSize,
        lines: &[GridLine],
        upcoming: &mut Upcoming<'_>,
    ) {
        let len = size.len();
        for plane in self.now[1..].iter_mut().chain(&mut self.next) {
            plane.first(len);
        }
        let pushes = passes.iter().any(|pass| pass.is == FlatUse::Push);
        if pushes {
            self.anchor.first(len).copy_from_slice(&self.now[0][..len]);
        }
        for pass in passes {
            match pass.is {
                FlatUse::Up => {
                    let [coarse, planes @ ..] = &mut self.now;
                    let [a, b, c] = planes.each_mut().map(|plane| &mut plane[..len]);
                    pass.combine(&[&coarse[..len]; PLANES], [&mut [], a, b, c], upcoming);
                }
                FlatUse::Blend => self.blend(pass, size, lines, upcoming),
                FlatUse::Push => {
                    differences(&mut self.next[0][..len], &self.anchor[..len], &self.now[0][..len]);
                    let planes = self.now.each_mut().map(|plane| &mut plane[..len]);
                    pass.combine(&[&self.next[0][..len]; PLANES], planes, upcoming);
                }
            }
        }
    }

    fn blend(&mut self, pass: &FlatPass, size: GridSize, lines: &[GridLine], upcoming: &mut Upcoming<'_>) {
        let len = size.len();
        let Self { now, next, .. } = self;
        let source = now.each_ref().map(|plane| &plane[..len]);
        pass.combine(&source, next.each_mut().map(|plane| &mut plane[..len]), upcoming);
        for line in lines {
            draw_line(pass, &source, next, size.stacked(line.grid), *line);
        }
        for ((now, next), _) in now.iter_mut().zip(next).zip(pass.moves).filter(|(_, moves)| *moves) {
            std::mem::swap(now, next);
        }
    }
}

/// Computes the points on a line, including those beyond its ends whose stencils lie in the grid, because blocks of a
/// patch need them.
fn draw_line(
    pass: &FlatPass,
    source: &[&[f64]; PLANES],
    next: &mut [AlignedBuffer; PLANES],
    size: GridSize,
    line: GridLine,
) {
    let Some(masks) = &pass.lines[line.line] else { return };
    for (point, mask) in masks[line.axis].iter().enumerate() {
        let (plane, start) = if point == 0 { (0, line.from) } else { after(line.axis, line.from) };
        for steps in steps_on_line(line.axis, start, mask.reach, size) {
            let at = size.at([0, 1].map(|k| start[k] + steps * LATTICE_AXES[line.axis][k]));
            for (k, x) in (at..).zip(&mut next[plane][at..at + size.width]) {
                *x = sum_at(&mask.groups, source, k);
            }
        }
    }
}

/// Returns the steps along an axis from `start` for which the stencil of the point, with this reach, lies in the grid.
fn steps_on_line(axis: usize, start: [isize; 2], reach: [[isize; 2]; 2], size: GridSize) -> RangeInclusive<isize> {
    let [low, high] = [-size.halo.cast_signed(), (size.cells + size.halo).cast_signed()];
    let (mut least, mut most) = (-high - size.halo.cast_signed(), high + size.halo.cast_signed());
    for k in 0..2 {
        let (back, onward) = (low - start[k] - reach[0][k].min(0), high - start[k] - reach[1][k].max(0));
        match LATTICE_AXES[axis][k] {
            1 => (least, most) = (least.max(back), most.min(onward)),
            -1 => (least, most) = (least.max(-onward), most.min(-back)),
            _ if back > 0 || onward < 0 => most = least - 1,
            _ => {}
        }
    }
    least..=most
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::math::parameter::Literal;
    use crate::refine::sweep::joint::LOOPS;
    use crate::refine::sweep::lanes::Lanes;
    use crate::refine::sweep::mask::{halo, passes};
    use crate::scheme::operator::Role;
    use crate::scheme::parameters::SPLIT;
    use crate::scheme::plan::{Carried, Plan, PlanInput, Scheduled, Subject};
    use crate::scheme::presets::PRESETS;
    use crate::shape::tile::Tile;

    /// Returns the plan of a preset or a word for meshes, if they can have it.
    fn plan(scheme: &str, tile: Tile, kernel: f64, lanes: Option<Lanes>) -> Option<Plan> {
        let is_word = scheme.starts_with('U');
        let split = || ("split".to_owned(), Literal::Text("triangle".to_owned()));
        let kernel = (kernel < 1.0).then(|| ("kernel".to_owned(), Literal::Number(kernel)));
        let input = PlanInput {
            preset: (!is_word).then(|| scheme.to_owned()),
            word: is_word.then(|| scheme.to_owned()),
            parameters: kernel.into_iter().chain((is_word && tile == Tile::Triangle).then(split)).collect(),
            ..PlanInput::default()
        };
        let subject = Subject { is_mesh: true, carried: lanes.map(|_| Carried::Latitude), ..Subject::default() };
        let plan = Plan::resolve(&input, subject).ok()?;
        let steps = plan.schedule(1).ok()?;
        let splits = |step: &&Scheduled| step.letter.facts().has(&SPLIT);
        let fits = steps.iter().filter(splits).all(|step| step.letter.settings.tile() == tile);
        fits.then_some(plan)
    }

    /// The planes of all schemes that are swept are computed together on nets without lines, and each loop serves one.
    #[test]
    fn planes_are_computed_together() {
        let names = || PRESETS.iter().map(|preset| preset.name).chain(["UC", "UCCP", "UCPCP"]);
        let plain = [Tile::Quad, Tile::Triangle].map(|tile| names().map(move |name| (name, tile, 1.0, None)));
        let kernels = [("UC", Tile::Quad, 0.75, None), ("UC", Tile::Triangle, 0.75, None)];
        let lanes = [false, true].map(|turned| Some(Lanes::with_alpha(0.5).seen(turned)));
        let tubes = lanes.map(|lanes| ("UCP", Tile::Quad, 1.0, lanes));
        let mut met = BTreeSet::new();
        for (scheme, tile, kernel, lanes) in plain.into_iter().flatten().chain(kernels).chain(tubes) {
            let Some(plan) = plan(scheme, tile, kernel, lanes) else { continue };
            let steps = plan.schedule(2).expect("finite parameters");
            for round in steps.chunk_by(|_, next| next.letter.facts().role != Role::Upsample) {
                let Some(passes) = passes(&plan, round, tile, &[], lanes) else { continue };
                let halo = halo(tile, &passes).expect("a halo");
                for grids in [1, 16] {
                    let size = GridSize { cells: 4, halo, width: 3, grids, place: 0 };
                    for pass in flat_passes(&passes, size, 0) {
                        assert_eq!(pass.moves.contains(&true), pass.joint.is_some(), "{scheme}: {:?}", pass.planes);
                        met.extend(pass.joint.and_then(|joint| joint.number()));
                    }
                }
            }
        }
        assert!(met.into_iter().eq(0..LOOPS.len()), "each loop serves a scheme");
    }
}
