//! The eigenvalues of all blocks around one middle, and the masks that belong to the first two.

use super::blocks::{Block, Component};
use super::local::Local;
use super::sectors::{Kind, Point};
use crate::math::functions::{cos, real, sin};
use crate::math::spectrum::{Eigenvalue, eigenvalues};
use crate::watch::{Stopped, Watch};

/// An eigenvalue of the local matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found {
    /// The eigenvalue.
    pub value: Eigenvalue,
    /// Its Fourier index, from 0 to n - 1.
    pub fourier: usize,
}

/// The weight of a point around the middle.
#[derive(Debug, Clone, PartialEq)]
pub struct Weight {
    /// The point of each sector; `None` for the middle.
    pub point: Option<[i32; 2]>,
    /// The weight of this point in each of the sectors, or in all.
    pub values: Vec<f64>,
}

/// The blocks around a middle with n sectors, and their eigenvalues.
#[derive(Debug)]
pub(super) struct Spectrum {
    /// The kind of middle.
    pub(super) kind: Kind,
    /// The sectors.
    pub(super) n: usize,
    /// The blocks of the indices 0 to n / 2; that of n - k is like that of k.
    pub(super) blocks: Vec<Block>,
    /// The eigenvalues of each, the largest first.
    pub(super) values: Vec<Vec<Eigenvalue>>,
}

impl Spectrum {
    /// The eigenvalues over the points up to a radius; `None` where rows lack the reflection, or a search failed.
    pub(super) fn of(kind: Kind, n: usize, radius: i32, local: &Local, watch: &Watch) -> Result<Option<Self>, Stopped> {
        let (mut blocks, mut values) = (Vec::new(), Vec::new());
        for index in 0..=n / 2 {
            watch.check()?;
            let Some(block) = Block::of(kind, n, index, radius, local) else { return Ok(None) };
            let Some(found) = eigenvalues(&block.matrix.a, block.matrix.n) else { return Ok(None) };
            watch.advance(block.matrix.n as u64);
            blocks.push(block);
            values.push(found);
        }
        Ok(Some(Self { kind, n, blocks, values }))
    }

    /// All eigenvalues with their indices, the largest first; those of one size, as far as ten digits tell, by index.
    pub(super) fn sorted(&self) -> Vec<Found> {
        let mut all = Vec::new();
        for (index, values) in self.values.iter().enumerate() {
            let other = (self.n - index) % self.n;
            for &value in values {
                all.push(Found { value, fourier: index });
                if other != index {
                    all.push(Found { value, fourier: other });
                }
            }
        }
        #[expect(clippy::cast_possible_truncation, reason = "sizes are far below 10^8")]
        let digits = |x: f64| (x * 1e10).round() as i64;
        let key = |found: &Found| (-digits(found.value.modulus()), found.fourier, -digits(found.value.re));
        all.sort_by_key(key);
        all
    }

    /// The largest eigenvalue of the block of index 1, where it is real and above 0.
    pub(super) fn subdominant(&self) -> Option<f64> {
        self.values[1].first().filter(|value| value.im == 0.0 && value.re > 0.0).map(|value| value.re)
    }

    /// The largest size among the eigenvalues besides 1 and those of that of index 1, and its index.
    pub(super) fn next(&self) -> (f64, usize) {
        let of = |(index, values): (usize, &Vec<Eigenvalue>)| {
            let value = values.get(usize::from(index <= 1)).map_or(0.0, |value| value.modulus());
            (value, index)
        };
        self.values.iter().enumerate().map(of).fold((0.0, 0), |best, other| if other.0 > best.0 { other } else { best })
    }

    /// The column of ones in the block of index 0.
    pub(super) fn ones(&self) -> Vec<f64> {
        let one = |component: &Component| f64::from(u8::from(!matches!(component, Component::Odd(..))));
        self.blocks[0].components.iter().map(one).collect()
    }

    /// The left eigenvector of 1 in the block of index 0, its product with the ones being 1.
    pub(super) fn limit_row(&self) -> Vec<f64> {
        let left = self.blocks[0].matrix.transposed().eigenvector(1.0);
        let sum: f64 = left.iter().zip(self.ones()).map(|(l, one)| l * one).sum();
        left.iter().map(|l| l / sum).collect()
    }

    /// The weights of the limit position of the middle, per point.
    pub(super) fn limit_mask(&self) -> Vec<Weight> {
        let mut mask = Vec::new();
        let n = real(self.n);
        let mut add = |point: Option<Point>, value: f64| mask.push(Weight { point, values: vec![value] });
        for (component, &y) in self.blocks[0].components.iter().zip(&self.limit_row()) {
            match *component {
                Component::Centre => add(None, y),
                Component::OnAxis(p) => add(Some(p), y / n),
                Component::Even(p, q) => [p, q].map(|p| Some(p)).into_iter().for_each(|p| add(p, y / (2.0 * n))),
                Component::Odd(..) => {}
            }
        }
        mask
    }

    /// The weights of two tangents, for a left eigenvector of the block of index 1: of each point in each sector.
    pub(super) fn tangent_masks(&self, row: &[f64]) -> [Vec<Weight>; 2] {
        let mut complex: Vec<(Point, [f64; 2])> = Vec::new();
        for (component, &y) in self.blocks[1].components.iter().zip(row) {
            match *component {
                Component::Centre => {}
                Component::OnAxis(p) => complex.push((p, [y, 0.0])),
                Component::Even(p, q) => complex.extend([(p, [y / 2.0, 0.0]), (q, [y / 2.0, 0.0])]),
                Component::Odd(p, _) => {
                    let pair = complex.iter_mut().rev().take(2);
                    pair.for_each(|(at, w)| w[1] = if *at == p { -y / 2.0 } else { y / 2.0 });
                }
            }
        }
        let mask = |which: usize| {
            let weights = |&(point, [re, im]): &(Point, [f64; 2])| {
                let value = |sector: usize| {
                    let angle = std::f64::consts::TAU * (real(sector) + self.kind.turn(point)) / real(self.n);
                    let (c, s) = (cos(angle), sin(angle));
                    // twice, as a coordinate is half of a point and its conjugate
                    2.0 * (if which == 0 { re * c + im * s } else { re * s - im * c }) / real(self.n)
                };
                Weight { point: Some(point), values: (0..self.n).map(value).collect() }
            };
            complex.iter().map(weights).collect()
        };
        [mask(0), mask(1)]
    }
}
