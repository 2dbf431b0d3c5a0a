//! Flat loops: `out[k] = sum over groups of weight x symmetric sum of the members at k`.
//!
//! The sums are those of [`Rows`](crate::math::rows::Rows), bit for bit: the loops are compiled for several instruction
//! sets, but never with fused multiplication and addition.

use std::ops::Range;

use multiversion::multiversion;

use super::upcoming::Upcoming;
use crate::math::rows::{ascending_sum, symmetric_sum};

/// One group of a mask over a grid: a weight, and the plane and offset of each member.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FlatGroup {
    pub(super) weight: f64,
    /// Plane and offset of each member, the offset in values.
    pub(super) members: Vec<(u8, isize)>,
}

/// A mask over the planes of stacks of one size.
#[derive(Debug)]
pub(super) struct FlatMask {
    pub(super) groups: Vec<FlatGroup>,
    /// The ranges in which sums are computed: where they are needed and all members lie in the planes.
    ranges: Vec<Range<usize>>,
}

impl FlatMask {
    /// Creates a mask over planes of `len` values, whose sums are needed in the ranges `wanted`.
    pub(super) fn new(groups: Vec<FlatGroup>, len: usize, wanted: Vec<Range<usize>>) -> Self {
        let members = groups.iter().flat_map(|group| &group.members).copied();
        Self { ranges: ranges_within(members, len, wanted), groups }
    }

    /// Keeps only those parts of each range that `parts` returns.
    pub(super) fn keep<R: Iterator<Item = Range<usize>>>(&mut self, parts: impl Fn(&Range<usize>) -> R) {
        self.ranges = self.ranges.iter().flat_map(parts).collect();
    }

    /// Sets `out[k]` to the sum over the groups for each `k` in the ranges, or adds the sum if `adds` is set. Meanwhile
    /// asks for the memory that is `upcoming`.
    pub(super) fn combine(&self, source: &[&[f64]; 4], out: &mut [f64], adds: bool, upcoming: &mut Upcoming<'_>) {
        upcoming.between(&self.ranges, 1, |range| self.combine_from(range.start, source, &mut out[range], adds));
    }

    /// Sets each `out[i]` to the sum over the groups at index `first + i`, or adds the sum.
    fn combine_from(&self, first: usize, source: &[&[f64]; 4], out: &mut [f64], adds: bool) {
        let n = out.len();
        let slice = |group: usize, member: usize| -> &[f64] {
            let (plane, distance) = self.groups[group].members[member];
            let start = first.wrapping_add_signed(distance);
            &source[plane as usize][start..start + n]
        };
        // adding group by group gives the same sum as long as the first group starts it
        let starts = if adds { self.groups.len() == 1 } else { !self.groups.is_empty() };
        if !starts || self.groups.iter().any(|group| !matches!(group.members.len(), 1 | 2 | 4 | 6)) {
            return any(out, &self.groups, source, first, adds);
        }
        for (g, group) in self.groups.iter().enumerate() {
            let two = || [slice(g, 0), slice(g, 1)];
            let four = || [slice(g, 0), slice(g, 1), slice(g, 2), slice(g, 3)];
            let six = || [0, 1, 2, 3, 4, 5].map(|m| slice(g, m));
            match (group.members.len(), adds || g > 0) {
                (1, false) => one(out, group.weight, slice(g, 0)),
                (1, true) => add_one(out, group.weight, slice(g, 0)),
                (2, false) => pair(out, group.weight, two()),
                (2, true) => add_pair(out, group.weight, two()),
                (4, false) => quad(out, group.weight, four()),
                (4, true) => add_quad(out, group.weight, four()),
                (_, false) => six_of(out, group.weight, six()),
                (_, true) => add_six(out, group.weight, six()),
            }
        }
    }
}

/// Returns the parts of the ranges in which all points lie in planes of `len` values.
pub(super) fn ranges_within(
    points: impl Iterator<Item = (u8, isize)>,
    len: usize,
    wanted: Vec<Range<usize>>,
) -> Vec<Range<usize>> {
    let (low, high) = points.fold((0, 0), |(low, high), (_, distance)| (distance.min(low), distance.max(high)));
    let possible = |range: Range<usize>| range.start.max(low.unsigned_abs())..range.end.min(len - high.unsigned_abs());
    wanted.into_iter().map(possible).filter(|range| !range.is_empty()).collect()
}

#[multiversion(targets("x86_64+avx512f", "x86_64+avx2", "x86_64+avx"))]
fn one(out: &mut [f64], w: f64, a: &[f64]) {
    out.iter_mut().zip(a).for_each(|(x, a)| *x = w * a);
}

#[multiversion(targets("x86_64+avx512f", "x86_64+avx2", "x86_64+avx"))]
fn add_one(out: &mut [f64], w: f64, a: &[f64]) {
    out.iter_mut().zip(a).for_each(|(x, a)| *x += w * a);
}

#[multiversion(targets("x86_64+avx512f", "x86_64+avx2", "x86_64+avx"))]
fn pair(out: &mut [f64], w: f64, [a, b]: [&[f64]; 2]) {
    let n = out.len();
    let (a, b) = (&a[..n], &b[..n]);
    for k in 0..n {
        out[k] = w * (a[k] + b[k]);
    }
}

#[multiversion(targets("x86_64+avx512f", "x86_64+avx2", "x86_64+avx"))]
fn add_pair(out: &mut [f64], w: f64, [a, b]: [&[f64]; 2]) {
    let n = out.len();
    let (a, b) = (&a[..n], &b[..n]);
    for k in 0..n {
        out[k] += w * (a[k] + b[k]);
    }
}

#[multiversion(targets("x86_64+avx512f", "x86_64+avx2", "x86_64+avx"))]
fn quad(out: &mut [f64], w: f64, quad: [&[f64]; 4]) {
    let n = out.len();
    let [a, b, c, d] = quad.map(|x| &x[..n]);
    for k in 0..n {
        out[k] = w * ((a[k] + c[k]) + (b[k] + d[k]));
    }
}

#[multiversion(targets("x86_64+avx512f", "x86_64+avx2", "x86_64+avx"))]
fn add_quad(out: &mut [f64], w: f64, quad: [&[f64]; 4]) {
    let n = out.len();
    let [a, b, c, d] = quad.map(|x| &x[..n]);
    for k in 0..n {
        out[k] += w * ((a[k] + c[k]) + (b[k] + d[k]));
    }
}

#[multiversion(targets("x86_64+avx512f", "x86_64+avx2", "x86_64+avx"))]
fn six_of(out: &mut [f64], w: f64, six: [&[f64]; 6]) {
    let n = out.len();
    let [a, b, c, d, e, f] = six.map(|x| &x[..n]);
    for k in 0..n {
        out[k] = w * ascending_sum(a[k] + d[k], b[k] + e[k], c[k] + f[k]);
    }
}

#[multiversion(targets("x86_64+avx512f", "x86_64+avx2", "x86_64+avx"))]
fn add_six(out: &mut [f64], w: f64, six: [&[f64]; 6]) {
    let n = out.len();
    let [a, b, c, d, e, f] = six.map(|x| &x[..n]);
    for k in 0..n {
        out[k] += w * ascending_sum(a[k] + d[k], b[k] + e[k], c[k] + f[k]);
    }
}

/// Sets each `out[k]` to `a[k] - b[k]`.
#[multiversion(targets("x86_64+avx512f", "x86_64+avx2", "x86_64+avx"))]
pub(super) fn differences(out: &mut [f64], a: &[f64], b: &[f64]) {
    let n = out.len();
    let (a, b) = (&a[..n], &b[..n]);
    for k in 0..n {
        out[k] = a[k] - b[k];
    }
}

/// Adds groups of any number and size.
fn any(out: &mut [f64], groups: &[FlatGroup], source: &[&[f64]; 4], low: usize, adds: bool) {
    for (k, x) in out.iter_mut().enumerate() {
        let sum = sum_at(groups, source, low + k);
        *x = if adds { *x + sum } else { sum };
    }
}

/// Returns the sum over the groups at index `k`.
pub(super) fn sum_at(groups: &[FlatGroup], source: &[&[f64]; 4], k: usize) -> f64 {
    let term = |group: &FlatGroup| {
        let member = |m: usize| {
            let (plane, distance) = group.members[m];
            [source[plane as usize][k.wrapping_add_signed(distance)]]
        };
        group.weight * symmetric_sum(group.members.len(), member)[0]
    };
    groups.iter().fold(-0.0, |sum, group| sum + term(group))
}
