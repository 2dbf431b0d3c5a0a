//! What presets claim of themselves, for the catalogue and for the test that holds all of it against the analysis.

/// What holds of a preset for some values of its parameters. Numbers are constant expressions, which may use the
/// parameter that is named first in `at`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Claim {
    /// For which values of the parameters it holds, in words; empty where it does for all.
    pub range: &'static str,
    /// Values of parameters at which it is tested, one set after another, each with the parameter of the expressions
    /// first.
    pub at: &'static [&'static [(&'static str, &'static str)]],
    /// The largest k for which limits are C^k.
    pub smoothness: &'static str,
    /// The width of the support of the basic limit function.
    pub support: &'static str,
    /// The largest degree of polynomials that are limits of their own samples.
    pub reproduction_degree: &'static str,
    /// For schemes on meshes, of which all of the above is said where nothing is extraordinary: the least and the
    /// greatest valence of vertices, or of faces where these take their place, at which limits are C^1. `None` where
    /// the claim is one of curves, or of a scheme that is not C^1 anywhere.
    pub valences: Option<[u32; 2]>,
    /// Whether it is one of meshes.
    pub is_of_meshes: bool,
}

impl Claim {
    /// A claim with expressions for smoothness, width of the support, and degree of reproduction.
    pub(super) const fn new(
        range: &'static str,
        at: &'static [&'static [(&'static str, &'static str)]],
        [smoothness, support, reproduction_degree]: [&'static str; 3],
    ) -> Self {
        Self { range, at, smoothness, support, reproduction_degree, valences: None, is_of_meshes: false }
    }

    /// A claim of meshes, with the valences at which limits are C^1.
    pub(super) const fn on_meshes(
        range: &'static str,
        at: &'static [&'static [(&'static str, &'static str)]],
        numbers: [&'static str; 3],
        valences: Option<[u32; 2]>,
    ) -> Self {
        Self { valences, is_of_meshes: true, ..Self::new(range, at, numbers) }
    }
}
