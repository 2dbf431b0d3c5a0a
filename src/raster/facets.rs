//! A cache of facets while a tile is lit, since most triangles are visible in several rows of pixels.

use super::binned_model::BinnedModel;
use super::bins::TILE;
use super::facet_block::{BLOCK_FACETS, Facet, FacetBlock};
use super::paint::Tint;
use super::triangle::{NOBODY, SAMPLES};

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
    /// Triangles that have slots, but whose facets are still to be found.
    waiting: [u32; BLOCK_FACETS],
    n_waiting: usize,
}

impl Default for Facets {
    fn default() -> Self {
        let known = vec![Facet::default(); CACHED_FACETS].into_boxed_slice();
        let known = known.try_into().expect("there are as many");
        Self {
            owners: Box::new([NOBODY; CACHED_FACETS]),
            known,
            tints: Vec::new(),
            waiting: [NOBODY; BLOCK_FACETS],
            n_waiting: 0,
        }
    }
}

impl Facets {
    /// Removes all facets, because another tile is lit.
    pub(super) fn clear(&mut self) {
        self.owners.fill(NOBODY);
    }

    /// Finds the facets of the triangles seen at some samples of a row of pixels, at once or when [`Facets::settle`] is
    /// called: at each sample those of the pixels whose bits are set. Where several have the same slot, some will be
    /// missing.
    pub(super) fn prepare(
        &mut self,
        model: &BinnedModel<'_>,
        origin: [i32; 2],
        owners: &[[u32; SAMPLES]; TILE],
        seen: &[u32; SAMPLES],
    ) {
        for (s, &seen) in seen.iter().enumerate() {
            let mut rest = seen;
            while rest != 0 {
                let owner = owners[rest.trailing_zeros() as usize][s];
                rest &= rest - 1;
                let slot = &mut self.owners[owner as usize % CACHED_FACETS];
                if *slot != owner {
                    *slot = owner;
                    self.waiting[self.n_waiting % BLOCK_FACETS] = owner;
                    self.n_waiting += 1;
                    if self.n_waiting == BLOCK_FACETS {
                        self.settle(model, origin);
                    }
                }
            }
        }
    }

    /// Finds the facets of the triangles that wait.
    pub(super) fn settle(&mut self, model: &BinnedModel<'_>, origin: [i32; 2]) {
        if self.n_waiting > 0 {
            let waiting = self.waiting;
            self.learn(model, &waiting[..self.n_waiting.min(BLOCK_FACETS)], origin);
            self.n_waiting = 0;
        }
    }

    /// Returns the facet of triangle `owner` in the tile at `origin`, with the variation of its paint, if it has any.
    #[inline]
    pub(super) fn of(&mut self, model: &BinnedModel<'_>, owner: u32, origin: [i32; 2]) -> (&Facet, Option<&Tint>) {
        let place = owner as usize % CACHED_FACETS;
        if self.owners[place] != owner {
            self.learn(model, &[owner], origin);
        }
        (&self.known[place], self.tints.get(place))
    }

    /// Finds the facets of up to [`BLOCK_FACETS`] triangles. Of those with the same slot the last one has it.
    #[inline(never)]
    fn learn(&mut self, model: &BinnedModel<'_>, owners: &[u32], origin: [i32; 2]) {
        let block = FacetBlock::of(model, owners, origin);
        for (i, &owner) in owners.iter().enumerate() {
            let place = owner as usize % CACHED_FACETS;
            (self.owners[place], self.known[place]) = (owner, block.facet(i));
        }
        if model.paint.is_some() {
            self.tints.resize(CACHED_FACETS, Tint::default());
            for (i, &owner) in owners.iter().enumerate() {
                self.tints[owner as usize % CACHED_FACETS] = block.tint(i).unwrap_or_default();
            }
        }
    }
}
