//! A cache of facets while a tile is lit, since most triangles are visible in several rows of pixels.

use super::binned_model::{BinnedModel, Facet};
use super::paint::Tint;
use super::triangle::NOBODY;

/// Number of cached facets. Triangles with consecutive indices mostly lie in the same tile, so their slots differ. Half
/// as many find triangles of a few pixels less often; twice as many need twice the second-level cache (48 KB now).
/// Pictures do not depend on it.
const CACHED_FACETS: usize = 1024;

/// Facets of triangles, each in the slot given by the last bits of its index.
#[derive(Debug)]
pub(super) struct Facets {
    owners: Box<[u32; CACHED_FACETS]>,
    known: Box<[Facet; CACHED_FACETS]>,
    /// The tints of the same triangles; empty unless the surface is painted.
    tints: Vec<Tint>,
}

impl Default for Facets {
    fn default() -> Self {
        let known = vec![Facet::default(); CACHED_FACETS].into_boxed_slice();
        let known = known.try_into().expect("there are as many");
        Self { owners: Box::new([NOBODY; CACHED_FACETS]), known, tints: Vec::new() }
    }
}

impl Facets {
    /// Removes all facets, because another tile is lit.
    pub(super) fn clear(&mut self) {
        self.owners.fill(NOBODY);
    }

    /// Returns the facet of triangle `owner` in the tile at `origin`, with the variation of its paint, if it has any.
    #[inline]
    pub(super) fn of(&mut self, model: &BinnedModel<'_>, owner: u32, origin: [i32; 2]) -> (&Facet, Option<&Tint>) {
        let place = owner as usize % CACHED_FACETS;
        if self.owners[place] != owner {
            self.learn(model, owner, origin);
        }
        (&self.known[place], self.tints.get(place))
    }

    #[inline(never)]
    fn learn(&mut self, model: &BinnedModel<'_>, owner: u32, origin: [i32; 2]) {
        let place = owner as usize % CACHED_FACETS;
        let (facet, tint) = model.facet(owner, origin);
        (self.owners[place], self.known[place]) = (owner, facet);
        if let Some(tint) = tint {
            self.tints.resize(CACHED_FACETS, Tint::default());
            self.tints[place] = tint;
        }
    }
}
