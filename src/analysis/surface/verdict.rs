//! Decides whether limits are C^1 at an extraordinary point, with the evidence.

use super::characteristic::{CharacteristicNet, LEAST_DETERMINANT, RingProof, RingVerdict};
use super::enclosure::{Enclosure, is_below, without_one};
use super::spectrum::{EQUAL_EIGENVALUES, Spectrum};
use crate::watch::{Stopped, Watch};

/// How far a statement is decided.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// The statement is proved.
    Proved,
    /// Numbers and samples support the statement without a proof.
    Supported,
    /// The statement is disproved by a proof.
    Disproved,
    /// The statement is undecided.
    Open,
}

/// A statement on which C^1 depends, and how far it is decided.
#[derive(Debug, Clone, PartialEq)]
pub struct Criterion {
    /// The statement.
    pub statement: &'static str,
    /// How far the statement is decided.
    pub status: Status,
}

/// The statement about regular nets.
pub(super) const REGULAR_NETS: &str = "limits of regular nets are C1";
/// The statement about the eigenvalue 1.
pub(super) const SIMPLE_EIGENVALUE_ONE: &str = "the eigenvalue 1 is simple, and all others are smaller";
/// The statement about the subdominant eigenvalue.
const SUBDOMINANT_EIGENVALUE: &str = "the next eigenvalue is real, positive and there twice, with the Fourier \
                           indices 1 and n - 1, and all others are smaller";
/// The statement about the characteristic map.
const CHARACTERISTIC_MAP: &str = "the characteristic map is regular and injective";

/// The data that decide about one extraordinary point.
pub(super) struct Case<'a> {
    /// The eigenvalues around the point.
    pub(super) spectrum: &'a Spectrum,
    /// How far C^1 of regular nets is decided.
    pub(super) regular: Status,
    /// The proof method for the characteristic map, and by how many rings its ring lies farther out than necessary;
    /// `None` if the regular rules do not apply on the ring.
    pub(super) ring: Option<(&'a RingProof, i32)>,
    /// The net of the characteristic map.
    pub(super) net: Option<&'a CharacteristicNet>,
    /// The least sine of the corner angles of the net.
    pub(super) least_sine: Option<f64>,
}

impl Case<'_> {
    /// Decides all criteria.
    pub(super) fn criteria(&self, watch: &Watch) -> Result<Vec<Criterion>, Stopped> {
        if self.spectrum.n == self.spectrum.kind.regular() {
            let numbers = [self.numbers_of_one(), self.numbers_of_subdominant()];
            let supported = self.regular == Status::Open && numbers == [Status::Supported; 2];
            let status = if supported { Status::Supported } else { self.regular };
            return Ok(vec![Criterion { statement: REGULAR_NETS, status }]);
        }
        let regular = Criterion { statement: REGULAR_NETS, status: self.regular };
        let mut one = self.numbers_of_one();
        let mut subdominant = self.numbers_of_subdominant();
        let mut error = None;
        if subdominant == Status::Supported {
            if let Some(found) = self.enclosed(watch)? {
                (one, subdominant, error) = (Status::Proved, Status::Proved, Some(found));
            }
        } else if self.is_of_another_index(watch)? {
            subdominant = Status::Disproved;
        }
        let map = self.map(error, watch)?;
        Ok(vec![
            regular,
            Criterion { statement: SIMPLE_EIGENVALUE_ONE, status: one },
            Criterion { statement: SUBDOMINANT_EIGENVALUE, status: subdominant },
            Criterion { statement: CHARACTERISTIC_MAP, status: map },
        ])
    }

    fn numbers_of_one(&self) -> Status {
        let values = &self.spectrum.values;
        let first = values[0].first().is_some_and(|x| (x.re - 1.0).abs() < EQUAL_EIGENVALUES && x.im == 0.0);
        let others = values[1..].iter().filter_map(|values| values.first()).chain(values[0].get(1));
        let smaller = others.map(|x| x.modulus()).fold(0.0, f64::max) < 1.0 - EQUAL_EIGENVALUES;
        if first && smaller { Status::Supported } else { Status::Open }
    }

    fn numbers_of_subdominant(&self) -> Status {
        let (next, _) = self.spectrum.next();
        match self.spectrum.subdominant() {
            Some(value) if next < value * (1.0 - EQUAL_EIGENVALUES) => Status::Supported,
            _ => Status::Open,
        }
    }

    /// Returns a radius between the subdominant eigenvalue and all smaller eigenvalues.
    fn between(&self, value: f64) -> f64 {
        let (next, _) = self.spectrum.next();
        value * crate::math::functions::sqrt((next / value).max(0.25))
    }

    /// Returns the error bound of the subdominant eigenvector if all other eigenvalues are proved to be smaller.
    fn enclosed(&self, watch: &Watch) -> Result<Option<f64>, Stopped> {
        let spectrum = self.spectrum;
        let Some(value) = spectrum.subdominant() else { return Ok(None) };
        let theta = self.between(value);
        let Some(enclosure) = Enclosure::of(&spectrum.blocks[1].matrix, value, theta) else { return Ok(None) };
        if enclosure.value + enclosure.radius >= 1.0 {
            return Ok(None);
        }
        let first = without_one(&spectrum.blocks[0].matrix, &spectrum.ones(), &spectrum.limit_row());
        let others = spectrum.blocks.iter().skip(2).map(|block| &block.matrix);
        for matrix in others.chain([&first]) {
            watch.check()?;
            if !is_below(matrix, theta) {
                return Ok(None);
            }
        }
        Ok(Some(enclosure.error))
    }

    /// Returns whether an eigenvalue of another index is proved to be larger than all eigenvalues of index 1; the
    /// surface is then stretched to a line, or wound around several times.
    fn is_of_another_index(&self, watch: &Watch) -> Result<bool, Stopped> {
        let spectrum = self.spectrum;
        let (next, index) = spectrum.next();
        let own = spectrum.values[1].first().map_or(0.0, |value| value.modulus());
        watch.check()?;
        if index == 1 || next <= own {
            return Ok(false);
        }
        let theta = crate::math::functions::sqrt(next * own.max(0.25 * next));
        let matrix = if index == 0 {
            without_one(&spectrum.blocks[0].matrix, &spectrum.ones(), &spectrum.limit_row())
        } else {
            spectrum.blocks[index].matrix.clone()
        };
        let value = spectrum.values[index].get(usize::from(index == 0)).filter(|value| value.im == 0.0);
        let larger = value.is_some_and(|value| Enclosure::of(&matrix, value.re, theta).is_some());
        Ok(larger && is_below(&spectrum.blocks[1].matrix, theta))
    }

    /// Decides about the characteristic map; `error` bounds the error of its net if the eigenvalues are proved.
    fn map(&self, error: Option<f64>, watch: &Watch) -> Result<Status, Stopped> {
        let sampled = if self.least_sine.is_some_and(|sine| sine > 0.0) { Status::Supported } else { Status::Open };
        let (Some(net), Some((ring, farther)), Some(error)) = (self.net, self.ring, error) else { return Ok(sampled) };
        // the slack of a ring must cover this error even if derivatives are short
        if self.regular != Status::Proved || error > LEAST_DETERMINANT / 1000.0 {
            return Ok(sampled);
        }
        Ok(match ring.of(net, farther, watch)? {
            RingVerdict::Proved => Status::Proved,
            RingVerdict::Folded => Status::Disproved,
            RingVerdict::Open => sampled,
        })
    }
}

/// Returns the verdict of all criteria: proved if all are proved, disproved if one is disproved.
pub fn verdict(criteria: &[Criterion]) -> Status {
    let all = |wanted: Status| criteria.iter().all(|criterion| criterion.status == wanted);
    if criteria.iter().any(|criterion| criterion.status == Status::Disproved) {
        Status::Disproved
    } else if all(Status::Proved) {
        Status::Proved
    } else {
        Status::Open
    }
}

/// Returns the weakest status of all criteria.
pub fn evidence(criteria: &[Criterion]) -> Status {
    let rank = |status: Status| {
        [Status::Disproved, Status::Open, Status::Supported, Status::Proved].iter().position(|other| *other == status)
    };
    criteria.iter().map(|criterion| criterion.status).min_by_key(|status| rank(*status)).unwrap_or(Status::Open)
}
