//! Properties that presets claim, for the catalogue and for a test that checks them against the analysis.

/// A property of a preset for some range of its parameters. Numbers are constant expressions, which may use the
/// parameter that is named first in `at`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Claim {
    /// The range of the parameters in words; empty if the claim holds for all values.
    pub range: &'static str,
    /// Parameter values at which the claim is tested, one set after another; the parameter of the expressions comes
    /// first in each set.
    pub at: &'static [&'static [(&'static str, &'static str)]],
    /// The largest k for which limits are C^k.
    pub smoothness: &'static str,
    /// The width of the support of the basic limit function.
    pub support: &'static str,
    /// The largest degree of polynomials that the scheme reproduces.
    pub reproduction_degree: &'static str,
    /// For schemes on meshes, whose other claims hold on regular meshes: the least and the greatest valence, of
    /// vertices or of faces in their place, at which limits are C^1. `None` for claims on curves, and for schemes that
    /// are not C^1 anywhere.
    pub valences: Option<[u32; 2]>,
    /// Whether this is a claim on meshes.
    pub is_of_meshes: bool,
}

impl Claim {
    /// Creates a claim on curves from expressions for smoothness, support width and degree of reproduction.
    pub(super) const fn new(
        range: &'static str,
        at: &'static [&'static [(&'static str, &'static str)]],
        [smoothness, support, reproduction_degree]: [&'static str; 3],
    ) -> Self {
        Self { range, at, smoothness, support, reproduction_degree, valences: None, is_of_meshes: false }
    }

    /// Creates a claim on meshes, with the range of valences at which limits are C^1.
    pub(super) const fn on_meshes(
        range: &'static str,
        at: &'static [&'static [(&'static str, &'static str)]],
        numbers: [&'static str; 3],
        valences: Option<[u32; 2]>,
    ) -> Self {
        Self { valences, is_of_meshes: true, ..Self::new(range, at, numbers) }
    }
}
