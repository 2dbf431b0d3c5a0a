//! The eigenvalues of all blocks around one centre, and the masks of the first two eigenvalues.

use super::blocks::{Component, FourierBlock};
use super::local::LocalRows;
use super::sectors::{LatticePoint, NetKind};
use crate::math::dense::dot;
use crate::math::functions::{cos, real, sin};
use crate::math::spectrum::{Eigenvalue, eigenvalues};
use crate::watch::{Stopped, Watch};

/// Largest difference of two eigenvalues, relative to the larger one, at which they count as equal. Simple eigenvalues
/// of matrices of some dozen rows are wrong by 1e-13; half of it is still far above that. Twice of it counts
/// eigenvalues as equal, and leaves open what depends on their order, that differ by 2e-9 of themselves.
pub(super) const EQUAL_EIGENVALUES: f64 = 1e-9;
/// Number of steps per unit on which absolute values are compared in lists. Ten digits are well above the rounding of
/// eigenvalues. Half of it takes more of them for equal in size; twice of it comes closer to rounding, but not near.
const LISTED_STEPS: f64 = 1e10;

/// Rounds a number to the digits by which eigenvalues are listed.
#[expect(clippy::cast_possible_truncation, reason = "sizes are far below 10^8")]
pub(super) fn listed_digits(x: f64) -> i64 {
    (x * LISTED_STEPS).round() as i64
}

/// An eigenvalue of the local matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocalEigenvalue {
    /// The eigenvalue.
    pub value: Eigenvalue,
    /// The Fourier index of the eigenvalue, from 0 to n - 1.
    pub fourier: usize,
}

/// The weights of a point around the centre in all sectors.
#[derive(Debug, Clone, PartialEq)]
pub struct PointWeight {
    /// The point in sector coordinates; `None` for the centre.
    pub point: Option<[i32; 2]>,
    /// The weight of this point in each of the sectors, or one weight for all.
    pub values: Vec<f64>,
}

/// The blocks around a centre with n sectors, and their eigenvalues.
#[derive(Debug)]
pub(super) struct Spectrum {
    /// The kind of net around the centre.
    pub(super) kind: NetKind,
    /// The number of sectors.
    pub(super) n: usize,
    /// The blocks of the indices 0 to n / 2; the block of n - k has the eigenvalues of the block of k.
    pub(super) blocks: Vec<FourierBlock>,
    /// The eigenvalues of each block, the largest first.
    pub(super) values: Vec<Vec<Eigenvalue>>,
}

impl Spectrum {
    /// Computes the eigenvalues for the points up to a radius; `None` if the rows lack the reflection symmetry, or an
    /// eigenvalue search fails.
    pub(super) fn of(
        kind: NetKind,
        n: usize,
        radius: i32,
        local: &LocalRows,
        watch: &Watch,
    ) -> Result<Option<Self>, Stopped> {
        let (mut blocks, mut values) = (Vec::new(), Vec::new());
        for index in 0..=n / 2 {
            watch.check()?;
            let Some(block) = FourierBlock::of(kind, n, index, radius, local) else { return Ok(None) };
            let Some(found) = eigenvalues(&block.matrix.a, block.matrix.n) else { return Ok(None) };
            watch.advance(block.matrix.n as u64);
            blocks.push(block);
            values.push(found);
        }
        Ok(Some(Self { kind, n, blocks, values }))
    }

    /// Returns all eigenvalues with their indices, the largest first; those of the same absolute value up to ten digits
    /// are in the order of their indices.
    pub(super) fn sorted(&self) -> Vec<LocalEigenvalue> {
        let mut all = Vec::new();
        for (index, values) in self.values.iter().enumerate() {
            let other = (self.n - index) % self.n;
            for &value in values {
                all.push(LocalEigenvalue { value, fourier: index });
                if other != index {
                    all.push(LocalEigenvalue { value, fourier: other });
                }
            }
        }
        let key = |found: &LocalEigenvalue| {
            (-listed_digits(found.value.modulus()), found.fourier, -listed_digits(found.value.re))
        };
        all.sort_by_key(key);
        all
    }

    /// Returns the largest eigenvalue of the block of index 1, if it is real and positive.
    pub(super) fn subdominant(&self) -> Option<f64> {
        self.values[1].first().filter(|value| value.im == 0.0 && value.re > 0.0).map(|value| value.re)
    }

    /// Returns the largest absolute value, with its index, of the eigenvalues other than 1 and the largest of index 1.
    pub(super) fn next(&self) -> (f64, usize) {
        let of = |(index, values): (usize, &Vec<Eigenvalue>)| {
            let value = values.get(usize::from(index <= 1)).map_or(0.0, |value| value.modulus());
            (value, index)
        };
        self.values.iter().enumerate().map(of).fold((0.0, 0), |best, other| if other.0 > best.0 { other } else { best })
    }

    /// Returns the constant vector 1 in the components of the block of index 0.
    pub(super) fn ones(&self) -> Vec<f64> {
        let one = |component: &Component| f64::from(u8::from(!matches!(component, Component::Odd(..))));
        self.blocks[0].components.iter().map(one).collect()
    }

    /// Returns the left eigenvector for 1 in the block of index 0, scaled to the product 1 with [`Self::ones`].
    pub(super) fn limit_row(&self) -> Vec<f64> {
        let left = self.blocks[0].matrix.transposed().eigenvector(1.0);
        let sum = dot(&left, &self.ones());
        left.iter().map(|l| l / sum).collect()
    }

    /// Returns the weights of the limit position of the centre, by point.
    pub(super) fn limit_mask(&self) -> Vec<PointWeight> {
        let mut mask = Vec::new();
        let n = real(self.n);
        let mut add = |point: Option<LatticePoint>, value: f64| mask.push(PointWeight { point, values: vec![value] });
        for (component, &y) in self.blocks[0].components.iter().zip(&self.limit_row()) {
            match *component {
                Component::Centre => add(None, y),
                Component::OnAxis(p) => add(Some(p), y / n),
                Component::Even(p, q) => [p, q].map(Some).into_iter().for_each(|p| add(p, y / (2.0 * n))),
                Component::Odd(..) => {}
            }
        }
        mask
    }

    /// Returns the weights of two tangents for a left eigenvector of the block of index 1, by point and sector.
    pub(super) fn tangent_masks(&self, row: &[f64]) -> [Vec<PointWeight>; 2] {
        let components = &self.blocks[1].components;
        let halved = |(component, &y): (&Component, &f64)| match component {
            Component::Centre | Component::OnAxis(_) => y,
            Component::Even(..) => y / 2.0,
            Component::Odd(..) => -y / 2.0,
        };
        let complex = FourierBlock::values(components, &components.iter().zip(row).map(halved).collect::<Vec<_>>());
        let mask = |which: usize| {
            let weights = |&(point, [re, im]): &(LatticePoint, [f64; 2])| {
                let value = |sector: usize| {
                    let angle = std::f64::consts::TAU * (real(sector) + self.kind.turn(point)) / real(self.n);
                    let (c, s) = (cos(angle), sin(angle));
                    // twice, because a coordinate is half of a point plus its conjugate
                    2.0 * (if which == 0 { re * c + im * s } else { re * s - im * c }) / real(self.n)
                };
                PointWeight { point: Some(point), values: (0..self.n).map(value).collect() }
            };
            complex.iter().map(weights).collect()
        };
        [mask(0), mask(1)]
    }
}
