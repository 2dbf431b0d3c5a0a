//! Facets of a tile, kept while the tile is lit: a triangle is mostly seen in several rows of pixels.

use super::binned_model::{BinnedModel, Facet};
use super::paint::Tint;
use super::triangle::NOBODY;

/// Facets kept at once. Triangles of consecutive numbers mostly lie in the same tile, so their places differ.
/// Half of it finds triangles of a few pixels less often; twice of it needs twice the second-level cache (36 KB now).
/// Pictures are the same.
const KEPT: usize = 1024;

/// Facets of triangles, each at the place that the last bits of its number name.
#[derive(Debug)]
pub(super) struct Facets {
    owners: Vec<u32>,
    known: Vec<Facet>,
    /// Of painted surfaces only.
    tints: Vec<Tint>,
}

impl Default for Facets {
    fn default() -> Self {
        Self { owners: vec![NOBODY; KEPT], known: vec![Facet::default(); KEPT], tints: Vec::new() }
    }
}

impl Facets {
    /// Forgets all, as another tile is lit.
    pub(super) fn clear(&mut self) {
        self.owners.fill(NOBODY);
    }

    /// The facet of triangle number `owner` in the tile at `origin`, and how its paint varies where it has some.
    pub(super) fn of(&mut self, model: &BinnedModel<'_>, owner: u32, origin: [i32; 2]) -> (&Facet, Option<&Tint>) {
        let place = owner as usize % KEPT;
        if self.owners[place] != owner {
            let (facet, tint) = model.facet(owner, origin);
            (self.owners[place], self.known[place]) = (owner, facet);
            if let Some(tint) = tint {
                self.tints.resize(KEPT, Tint::default());
                self.tints[place] = tint;
            }
        }
        (&self.known[place], self.tints.get(place))
    }
}
