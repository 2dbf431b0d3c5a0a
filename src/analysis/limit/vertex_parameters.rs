//! The parameters that vertices of a disc may carry: alpha, kernel, compensation and delta.

use crate::scheme::mesh_net::MeshNet;
use crate::shape::attributes::Attributes;

/// Tolerance within which parameters are equal, relative to the larger of 1 and their size. It is about 5 units in the
/// last place of 1. Each level halves differences, so that half of it follows one level more; twice of it follows one
/// less, and the limit may differ by as much.
const PARAMETER_TOLERANCE: f64 = 1e-15;

/// The bits of the parameters that the vertices of a disc carry, for each kind one array if they carry it.
#[derive(Debug, Clone, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct VertexParameters([Option<Vec<u64>>; 4]);

/// The bits of the parameters that all vertices of a disc share, for each kind one number if they carry it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct CommonParameters([Option<u64>; 4]);

impl VertexParameters {
    /// Returns the parameters that these vertices of a net carry.
    pub(super) fn of(net: &MeshNet, vertices: &[u32]) -> Self {
        let Some(attributes) = &net.annotations.attributes else { return Self::default() };
        let bits = |array: &[f64]| vertices.iter().map(|&v| array[v as usize].to_bits()).collect();
        Self(attributes.arrays().map(|(_, array)| array.map(bits)))
    }

    /// Adds these parameters to the net of a disc. `origins` are the indices of the net's vertices in the disc.
    pub(super) fn carried_by(&self, net: MeshNet, origins: &[u32]) -> MeshNet {
        let directions = net.annotations.directions.as_deref().cloned();
        if self.first().are_there() { net.carrying(Some(self.attributes(origins)), directions) } else { net }
    }

    /// Returns the parameters as attributes of vertices that have these `origins` in the disc.
    fn attributes(&self, origins: &[u32]) -> Attributes {
        let numbers = |bits: &Option<Vec<u64>>| {
            bits.as_ref().map(|bits| origins.iter().map(|&v| f64::from_bits(bits[v as usize])).collect())
        };
        let [alpha, kernel, compensation, delta] = self.0.each_ref().map(numbers);
        Attributes { alpha, kernel, compensation, delta }
    }

    /// Returns the parameters of the first vertex.
    pub(super) fn first(&self) -> CommonParameters {
        CommonParameters(self.0.each_ref().map(|bits| bits.as_ref().and_then(|bits| bits.first().copied())))
    }

    /// Returns whether all vertices have the parameters of the first, up to rounding.
    pub(super) fn agree(&self) -> bool {
        self.0.iter().flatten().all(|bits| {
            let first = bits.first().map_or(0.0, |&bits| f64::from_bits(bits));
            bits.iter().all(|&bits| (f64::from_bits(bits) - first).abs() <= PARAMETER_TOLERANCE * first.abs().max(1.0))
        })
    }
}

impl CommonParameters {
    /// Returns these parameters for each of `n` vertices.
    pub(super) fn of_all(self, n: usize) -> VertexParameters {
        VertexParameters(self.0.map(|bits| bits.map(|bits| vec![bits; n])))
    }

    /// Returns the alpha in radians, if the vertices carry one.
    pub(super) fn alpha(&self) -> Option<f64> {
        self.0[0].map(f64::from_bits)
    }

    /// Returns whether the vertices carry any parameters.
    pub(super) fn are_there(self) -> bool {
        self.0.iter().any(Option::is_some)
    }
}

/// Returns all combinations of the smallest and the largest value of each kind of parameter; for vertices without
/// parameters the single empty combination.
pub(super) fn extremes(attributes: Option<&Attributes>) -> Vec<CommonParameters> {
    let mut all = vec![CommonParameters::default()];
    for (place, (_, array)) in attributes.map(Attributes::arrays).into_iter().flatten().enumerate() {
        let Some(array) = array else { continue };
        let ends = [f64::min, f64::max].map(|pick| array.iter().copied().reduce(pick).unwrap_or_default());
        let with = |common: &CommonParameters, x: f64| {
            let mut bits = common.0;
            bits[place] = Some(x.to_bits());
            CommonParameters(bits)
        };
        all = all.iter().flat_map(|common| ends.map(|x| with(common, x))).collect();
        all.dedup();
    }
    all
}
