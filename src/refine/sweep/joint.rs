//! Masks of several planes whose sums are computed together: each point that they share is loaded once.
//!
//! The sums are those of the masks one by one, bit for bit: the loops are compiled for several instruction sets, but
//! never with fused multiplication and addition.

use std::ops::Range;

use multiversion::multiversion;

use super::kernel::{FlatGroup, ranges_within};
use super::planes::PLANES;
use super::upcoming::Upcoming;
use crate::math::rows::ascending_sum;

/// Maximum number of points that a loop reads at an index: those of the average on quads.
const MAX_POINTS: usize = 16;

/// Maximum number of groups of a loop: those of the average on quads.
const MAX_GROUPS: usize = 14;

/// Planes that a loop computes at an index, each as groups, each as the numbers of its members among the points.
type LoopShape = &'static [&'static [&'static [usize]]];

/// A function that computes planes from weights and points.
type JointSums = fn([&mut [f64]; PLANES], &[f64; MAX_GROUPS], &[&[f64]; MAX_POINTS]);

/// A loop over the masks of several planes.
#[derive(Debug)]
pub(super) struct JointLoop {
    shape: LoopShape,
    /// Whether the sums are added to the planes.
    adds: bool,
    run: JointSums,
}

/// Masks of several planes of stacks of one size.
#[derive(Debug)]
pub(super) struct JointMask {
    run: &'static JointLoop,
    weights: [f64; MAX_GROUPS],
    /// Plane and offset of each point, the offset in values.
    points: Vec<(u8, isize)>,
    /// The ranges in which sums are computed: where they are needed and all points lie in the planes.
    ranges: Vec<Range<usize>>,
}

impl JointMask {
    /// Joins the masks of planes of `len` values, which are needed in the ranges `wanted` and added if `adds` is set.
    /// Returns `None` if there is no loop for them.
    pub(super) fn new(masks: &[&[FlatGroup]], adds: bool, len: usize, wanted: Vec<Range<usize>>) -> Option<Self> {
        let mut points = Vec::new();
        let mut number = |point: &(u8, isize)| {
            points.iter().position(|known| known == point).unwrap_or_else(|| {
                points.push(*point);
                points.len() - 1
            })
        };
        let mut numbers = |group: &FlatGroup| group.members.iter().map(&mut number).collect();
        let shape: Vec<Vec<Vec<usize>>> =
            masks.iter().map(|groups| groups.iter().map(&mut numbers).collect()).collect();
        let run = LOOPS.iter().find(|run| run.adds == adds && *run.shape == *shape)?;
        let mut weights = [0.0; MAX_GROUPS];
        weights.iter_mut().zip(masks.iter().copied().flatten()).for_each(|(weight, group)| *weight = group.weight);
        let ranges = ranges_within(points.iter().copied(), len, wanted);
        Some(Self { run, weights, points, ranges })
    }

    /// Returns the number of the loop.
    #[cfg(test)]
    pub(super) fn number(&self) -> Option<usize> {
        LOOPS.iter().position(|run| std::ptr::eq(run, self.run))
    }

    /// Returns the parts of a range of one of the masks in which the sums are not computed. The range must lie in one
    /// of the ranges that were wanted, which are those of rows or a single one, so that it meets at most one range.
    pub(super) fn without(&self, range: &Range<usize>) -> impl Iterator<Item = Range<usize>> + use<> {
        let meets = |computed: &&Range<usize>| computed.start < range.end && range.start < computed.end;
        let computed = self.ranges.iter().find(meets).cloned().unwrap_or(range.end..range.end);
        [range.start..computed.start, computed.end..range.end].into_iter().filter(|part| !part.is_empty())
    }

    /// Sets the planes to the sums, or adds these, at each index in the ranges; planes beyond those of the masks are
    /// empty. Meanwhile asks for the memory that is `upcoming`.
    pub(super) fn combine(
        &self,
        source: &[&[f64]; PLANES],
        mut planes: [&mut [f64]; PLANES],
        upcoming: &mut Upcoming<'_>,
    ) {
        upcoming.between(&self.ranges, self.run.shape.len(), |range| {
            let mut points = [&[][..]; MAX_POINTS];
            for (slice, &(plane, distance)) in points.iter_mut().zip(&self.points) {
                *slice = &source[plane as usize][range.start.wrapping_add_signed(distance)..][..range.len()];
            }
            let parts = planes.each_mut().map(|plane| plane.get_mut(range.clone()).unwrap_or_default());
            (self.run.run)(parts, &self.weights, &points);
        });
    }
}

/// The symmetric sum of a group at an index.
macro_rules! group {
    ($x:ident, $k:ident, $a:literal) => {
        $x[$a][$k]
    };
    ($x:ident, $k:ident, $a:literal $b:literal) => {
        ($x[$a][$k] + $x[$b][$k])
    };
    ($x:ident, $k:ident, $a:literal $b:literal $c:literal $d:literal) => {
        (($x[$a][$k] + $x[$c][$k]) + ($x[$b][$k] + $x[$d][$k]))
    };
    ($x:ident, $k:ident, $a:literal $b:literal $c:literal $d:literal $e:literal $f:literal) => {
        ascending_sum($x[$a][$k] + $x[$d][$k], $x[$b][$k] + $x[$e][$k], $x[$c][$k] + $x[$f][$k])
    };
}

/// Whether an assignment adds.
macro_rules! adds {
    (=) => {
        false
    };
    (+=) => {
        true
    };
}

/// Defines the loops. Of each it tells the number of points and, for each plane, the groups: the number of the weight,
/// and in brackets the numbers of the members.
macro_rules! loops {
    ($($name:ident $op:tt $points:literal {
        $($plane:ident: $w:literal ($($member:literal)+) $(+ $v:literal ($($other:literal)+))*;)+
    })+) => {
        $(
            #[multiversion(targets("x86_64+avx512f", "x86_64+avx2", "x86_64+avx"))]
            fn $name($($plane: &mut [f64]),+, weights: &[f64; MAX_GROUPS], points: [&[f64]; $points]) {
                let n = points[0].len();
                let points = points.map(|point| &point[..n]);
                $(let $plane = &mut $plane[..n];)+
                for k in 0..n {
                    $($plane[k] $op weights[$w] * group!(points, k, $($member)+)
                        $(+ weights[$v] * group!(points, k, $($other)+))*;)+
                }
            }
        )+

        /// The loops, one for each shape of masks that schemes have.
        pub(super) static LOOPS: &[JointLoop] = &[$(JointLoop {
            shape: &[$(&[&[$($member),+] $(, &[$($other),+])*]),+],
            adds: adds!($op),
            run: |[$($plane),+, ..], weights, points| {
                $name($($plane),+, weights, std::array::from_fn(|i| points[i]));
            },
        }),+];
    };
}

loops! {
    // upsampling of quads and of triangles
    split_quads = 4 { a: 0 (0 1); b: 1 (1 2); c: 2 (1 0 3 2); }
    split_triangles = 3 { a: 0 (0 1); b: 1 (1 2); c: 2 (0 2); }
    // averages of quads and of triangles
    average_quads = 16 {
        a: 0 (0) + 1 (1 2 3 4) + 2 (5 6 7 8);
        b: 3 (3) + 4 (9 0) + 5 (6 7) + 6 (2 10 11 4);
        c: 7 (4) + 8 (0 12) + 9 (8 7) + 10 (13 1 3 14);
        d: 11 (7) + 12 (0 9 15 12) + 13 (3 11 14 4);
    }
    average_triangles = 14 {
        a: 0 (0) + 1 (1 2 3 4 5 6);
        b: 2 (4) + 3 (0 3 7 8 9 5);
        c: 4 (5) + 5 (10 11 6 0 4 9);
        d: 6 (9) + 7 (10 5 4 8 12 13);
    }
    // the average of triangles that weighs the ends of edges differently
    average_triangles_by_ends = 14 {
        a: 0 (0) + 1 (1 2 3 4 5 6);
        b: 2 (4) + 3 (0 7) + 4 (3 8 9 5);
        c: 5 (5) + 6 (10 0) + 7 (11 6 4 9);
        d: 8 (9) + 9 (10 7) + 10 (5 4 12 13);
    }
    // push-back of quads, of quads with latitude lines along either axis, and of triangles
    push_quads += 4 { a: 0 (0); b: 1 (1 0); c: 2 (0 2); d: 3 (0 1 3 2); }
    push_lanes += 8 { a: 0 (0); b: 1 (1 0); c: 2 (0 2) + 3 (3 4); d: 4 (0 1 5 2) + 5 (3 6 7 4); }
    push_turned_lanes += 8 { a: 0 (0); b: 1 (1 0) + 2 (2 3); c: 3 (0 4); d: 4 (1 5 4 0) + 5 (2 6 7 3); }
    push_triangles += 3 { a: 0 (0); b: 1 (1 0); c: 2 (0 2); d: 3 (1 2); }
    // vertices and edge points of quads whose face points stay
    vertices_and_edges = 9 { a: 0 (0) + 1 (1 2 3 4) + 2 (5 6 7 8); b: 3 (3) + 4 (6 7); c: 5 (4) + 6 (8 7); }
    // vertices of triangles from the vertices around them, and edge points from those of two triangles
    rings_and_edges = 8 {
        a: 0 (0) + 1 (1 2 3 4 5 6);
        b: 2 (4 0) + 3 (3 5);
        c: 4 (0 5) + 5 (6 4);
        d: 6 (4 5) + 7 (0 7);
    }
    // edge points of triangles from eight vertices
    edges_of_eight = 12 {
        b: 0 (0 1) + 1 (2 3) + 2 (4 5 6 7);
        c: 3 (1 3) + 4 (7 0) + 5 (8 9 2 6);
        d: 6 (0 3) + 7 (1 6) + 8 (7 2 10 11);
    }
    // edge points of quads from four vertices on a line, and face points from eight edge points on a cross
    edges_of_four = 7 { b: 0 (0) + 1 (1) + 2 (2) + 3 (3); c: 4 (1) + 5 (4) + 6 (5) + 7 (6); }
    faces_of_eight = 8 { d: 0 (0) + 1 (1) + 2 (2) + 3 (3) + 4 (4) + 5 (5) + 6 (6) + 7 (7); }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::refine::sweep::kernel::sum_at;

    /// Number of values in a plane, and the greatest distance of a point.
    const LEN: usize = 90;
    const FAR: isize = 9;

    /// The masks of a loop over these points.
    fn masks(run: &JointLoop, points: &[(u8, isize)], weights: &[f64]) -> Vec<Vec<FlatGroup>> {
        let mut weights = weights.iter();
        let mut group = |members: &&[usize]| FlatGroup {
            weight: *weights.next().expect("a weight for each group"),
            members: members.iter().map(|&member| points[member]).collect(),
        };
        run.shape.iter().map(|groups| groups.iter().map(&mut group).collect()).collect()
    }

    fn points() -> impl Strategy<Value = Vec<(u8, isize)>> {
        let all = (0_u8..4).flat_map(|plane| (-FAR..=FAR).map(move |distance| (plane, distance))).collect();
        Just(all).prop_shuffle()
    }

    fn values() -> impl Strategy<Value = Vec<Vec<f64>>> {
        prop::collection::vec(prop::collection::vec(-1.0..1.0, LEN), PLANES)
    }

    proptest! {
        /// Sums of several planes are those of their masks, bit for bit, in the ranges where all points are known, and
        /// what is left of a range is where they are not.
        #[test]
        fn sums_are_those_of_each_mask(
            (at, points) in (0..LOOPS.len(), points()),
            weights in prop::collection::vec(-2.0..2.0, MAX_GROUPS),
            (before, source) in (values(), values()),
            (first, gap, last) in (0..40_usize, 1..20_usize, 61..LEN),
        ) {
            let run = &LOOPS[at];
            let masks = masks(run, &points, &weights);
            let groups: Vec<&[FlatGroup]> = masks.iter().map(|groups| &groups[..]).collect();
            let wanted = vec![0..first, first + gap..last];
            let joint = JointMask::new(&groups, run.adds, LEN, wanted.clone()).expect("a loop for the shape");
            let source: Vec<&[f64]> = source.iter().map(|plane| &plane[..]).collect();
            let source: [&[f64]; PLANES] = source.try_into().expect("all planes");
            let mut after = before.clone();
            let mut planes = after.iter_mut().take(masks.len());
            let planes = std::array::from_fn(|_| planes.next().map(|plane| &mut plane[..]).unwrap_or_default());
            joint.combine(&source, planes, &mut Upcoming::default());
            let left: Vec<_> = wanted.iter().flat_map(|range| joint.without(range)).collect();
            for k in 0..LEN {
                let has = |ranges: &[Range<usize>]| ranges.iter().any(|range| range.contains(&k));
                let members = masks.iter().flatten().flat_map(|group| &group.members);
                let is_known = members.map(|point| k.checked_add_signed(point.1)).all(|k| k.is_some_and(|k| k < LEN));
                prop_assert!(has(&wanted) || !has(&left));
                prop_assert!(is_known || !has(&wanted) || has(&left));
                for plane in 0..PLANES {
                    let old = before[plane][k];
                    let new = match masks.get(plane).filter(|_| has(&wanted) && !has(&left)) {
                        Some(groups) if run.adds => old + sum_at(groups, &source, k),
                        Some(groups) => sum_at(groups, &source, k),
                        None => old,
                    };
                    prop_assert_eq!(after[plane][k].to_bits(), new.to_bits(), "plane {} at {}", plane, k);
                }
            }
        }
    }
}
