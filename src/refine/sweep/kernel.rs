//! Flat loops: `out[k] = sum over groups of weight x symmetric sum of the members at k`.
//!
//! The sums are those of [`Rows`](crate::math::rows::Rows), bit for bit: the loops are compiled for several instruction
//! sets, but never with fused multiplication and addition.

use std::ops::Range;

use multiversion::multiversion;

use super::upcoming::{SUMS, Upcoming};
use crate::math::rows::{ascending_sum, symmetric_sum};

/// One group of a mask over a grid: a weight, and the plane and offset of each member.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FlatGroup {
    pub(super) weight: f64,
    /// Plane and offset of each member, the offset in values.
    pub(super) members: Vec<(u8, isize)>,
}

/// A mask over the planes of stacks of one size.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct FlatMask {
    pub(super) groups: Vec<FlatGroup>,
    /// Number of members of each group.
    sizes: Vec<usize>,
    /// The ranges in which sums are computed: where they are needed and all members lie in the planes.
    ranges: Vec<Range<usize>>,
}

impl FlatMask {
    /// Creates a mask over planes of `len` values, whose sums are needed in the ranges `wanted`.
    pub(super) fn new(groups: Vec<FlatGroup>, len: usize, wanted: Vec<Range<usize>>) -> Self {
        let distances = || groups.iter().flat_map(|group| &group.members).map(|&(_, distance)| distance);
        let low = distances().min().unwrap_or(0).min(0).unsigned_abs();
        let high = distances().max().unwrap_or(0).max(0).unsigned_abs();
        let possible = |range: Range<usize>| range.start.max(low)..range.end.min(len - high);
        let ranges = wanted.into_iter().map(possible).filter(|range| !range.is_empty()).collect();
        Self { sizes: groups.iter().map(|group| group.members.len()).collect(), groups, ranges }
    }

    /// Sets `out[k]` to the sum over the groups for each `k` in the ranges, or adds the sum if `adds` is set. Meanwhile
    /// asks for the memory that is `upcoming`.
    pub(super) fn combine(&self, source: &[&[f64]; 4], out: &mut [f64], adds: bool, upcoming: &mut Upcoming<'_>) {
        let mut sums = 0;
        for range in &self.ranges {
            let (mut at, mut out) = (range.start, &mut out[range.clone()]);
            while !out.is_empty() {
                if sums == 0 {
                    sums = if upcoming.fetch() { SUMS } else { usize::MAX };
                }
                let n = sums.min(out.len());
                let part;
                (part, out) = out.split_at_mut(n);
                self.combine_from(at, source, part, adds);
                (at, sums) = (at + n, sums - n);
            }
        }
    }

    /// Sets each `out[i]` to the sum over the groups at index `first + i`, or adds the sum.
    fn combine_from(&self, first: usize, source: &[&[f64]; 4], out: &mut [f64], adds: bool) {
        let n = out.len();
        let slice = |group: usize, member: usize| -> &[f64] {
            let (plane, distance) = self.groups[group].members[member];
            let start = first.wrapping_add_signed(distance);
            &source[plane as usize][start..start + n]
        };
        let w = |group: usize| self.groups[group].weight;
        let two = |g: usize| [slice(g, 0), slice(g, 1)];
        let four = |g: usize| [slice(g, 0), slice(g, 1), slice(g, 2), slice(g, 3)];
        let six = |g: usize| [0, 1, 2, 3, 4, 5].map(|m| slice(g, m));
        match (self.sizes.as_slice(), adds) {
            ([1, 2], false) => one_pair(out, [w(0), w(1)], slice(0, 0), two(1)),
            ([1, 4, 4], false) => one_quads(out, [w(0), w(1), w(2)], slice(0, 0), [four(1), four(2)]),
            ([1, 2, 2, 4], false) => {
                one_pairs_quad(out, [w(0), w(1), w(2), w(3)], slice(0, 0), [two(1), two(2)], four(3));
            }
            ([1, 6], false) => one_six(out, [w(0), w(1)], slice(0, 0), six(1)),
            ([2, 2], false) => two_pairs(out, [w(0), w(1)], [two(0), two(1)]),
            ([2, 2], true) => add_two_pairs(out, [w(0), w(1)], [two(0), two(1)]),
            ([4, 4], true) => add_two_quads(out, [w(0), w(1)], [four(0), four(1)]),
            // adding group by group gives the same sum as long as the first group starts it
            (sizes @ [_, rest @ ..], _)
                if sizes.iter().all(|size| matches!(size, 1 | 2 | 4 | 6)) && (rest.is_empty() || !adds) =>
            {
                for (g, size) in sizes.iter().enumerate() {
                    match (size, adds || g > 0) {
                        (1, false) => one(out, w(g), slice(g, 0)),
                        (1, true) => add_one(out, w(g), slice(g, 0)),
                        (2, false) => pair(out, w(g), two(g)),
                        (2, true) => add_pair(out, w(g), two(g)),
                        (4, false) => quad(out, w(g), four(g)),
                        (4, true) => add_quad(out, w(g), four(g)),
                        (_, false) => six_of(out, w(g), six(g)),
                        (_, true) => add_six(out, w(g), six(g)),
                    }
                }
            }
            _ => any(out, &self.groups, source, first, adds),
        }
    }
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
fn one_pair(out: &mut [f64], w: [f64; 2], a: &[f64], [b, c]: [&[f64]; 2]) {
    let n = out.len();
    let (a, b, c) = (&a[..n], &b[..n], &c[..n]);
    for k in 0..n {
        out[k] = w[0] * a[k] + w[1] * (b[k] + c[k]);
    }
}

#[multiversion(targets("x86_64+avx512f", "x86_64+avx2", "x86_64+avx"))]
fn one_quads(out: &mut [f64], w: [f64; 3], a: &[f64], quads: [[&[f64]; 4]; 2]) {
    let n = out.len();
    let a = &a[..n];
    let [[b, c, d, e], [f, g, h, i]] = quads.map(|quad| quad.map(|x| &x[..n]));
    for k in 0..n {
        let first = (b[k] + d[k]) + (c[k] + e[k]);
        let second = (f[k] + h[k]) + (g[k] + i[k]);
        out[k] = w[0] * a[k] + w[1] * first + w[2] * second;
    }
}

#[multiversion(targets("x86_64+avx512f", "x86_64+avx2", "x86_64+avx"))]
fn one_pairs_quad(out: &mut [f64], w: [f64; 4], a: &[f64], pairs: [[&[f64]; 2]; 2], quad: [&[f64]; 4]) {
    let n = out.len();
    let a = &a[..n];
    let [[b, c], [d, e]] = pairs.map(|pair| pair.map(|x| &x[..n]));
    let [f, g, h, i] = quad.map(|x| &x[..n]);
    for k in 0..n {
        let last = (f[k] + h[k]) + (g[k] + i[k]);
        out[k] = w[0] * a[k] + w[1] * (b[k] + c[k]) + w[2] * (d[k] + e[k]) + w[3] * last;
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

#[multiversion(targets("x86_64+avx512f", "x86_64+avx2", "x86_64+avx"))]
fn one_six(out: &mut [f64], w: [f64; 2], own: &[f64], six: [&[f64]; 6]) {
    let n = out.len();
    let own = &own[..n];
    let [a, b, c, d, e, f] = six.map(|x| &x[..n]);
    for k in 0..n {
        out[k] = w[0] * own[k] + w[1] * ascending_sum(a[k] + d[k], b[k] + e[k], c[k] + f[k]);
    }
}

#[multiversion(targets("x86_64+avx512f", "x86_64+avx2", "x86_64+avx"))]
fn two_pairs(out: &mut [f64], w: [f64; 2], pairs: [[&[f64]; 2]; 2]) {
    let n = out.len();
    let [[a, b], [c, d]] = pairs.map(|pair| pair.map(|x| &x[..n]));
    for k in 0..n {
        out[k] = w[0] * (a[k] + b[k]) + w[1] * (c[k] + d[k]);
    }
}

#[multiversion(targets("x86_64+avx512f", "x86_64+avx2", "x86_64+avx"))]
fn add_two_pairs(out: &mut [f64], w: [f64; 2], pairs: [[&[f64]; 2]; 2]) {
    let n = out.len();
    let [[a, b], [c, d]] = pairs.map(|pair| pair.map(|x| &x[..n]));
    for k in 0..n {
        out[k] += w[0] * (a[k] + b[k]) + w[1] * (c[k] + d[k]);
    }
}

#[multiversion(targets("x86_64+avx512f", "x86_64+avx2", "x86_64+avx"))]
fn add_two_quads(out: &mut [f64], w: [f64; 2], quads: [[&[f64]; 4]; 2]) {
    let n = out.len();
    let [[a, b, c, d], [e, f, g, h]] = quads.map(|quad| quad.map(|x| &x[..n]));
    for k in 0..n {
        out[k] += w[0] * ((a[k] + c[k]) + (b[k] + d[k])) + w[1] * ((e[k] + g[k]) + (f[k] + h[k]));
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
