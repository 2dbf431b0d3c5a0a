//! The light of a tile: first the parts of pixels in which one triangle is seen are listed, then they are lit, several
//! at once.

#![expect(clippy::cast_precision_loss, reason = "pixel numbers are small")]

use multiversion::multiversion;

use super::binned_model::BinnedModel;
use super::bins::TILE;
use super::facet_block::Facet;
use super::facets::Facets;
use super::fine::{FINE_PLACES, FINE_SAMPLES, Fine, PixelSet};
use super::paint::Tint;
use super::shade::Lamps;
use super::spots::Spots;
use super::triangle::{NOBODY, SAMPLE_PLACES, SAMPLES};

/// Accumulates the light of the pixels of a tile.
pub(super) struct Lighter {
    /// Linear light of each pixel, premultiplied by the lit fraction.
    pub(super) light: Vec<[f32; 4]>,
    /// Pixels with a visible edge: partly covered, or with parts of different light.
    pub(super) marks: PixelSet,
    facets: Facets,
    spots: Spots,
}

/// What is lit in a tile.
pub(super) struct LitTile<'a> {
    model: &'a BinnedModel<'a>,
    lamps: &'a Lamps,
    /// The first pixel of the tile.
    origin: [i32; 2],
    /// Whether alpha matters.
    is_clear: bool,
    /// Whether the surface is lit in a single colour.
    is_plain: bool,
}

/// What is seen of triangles in a row of pixels: each has a part at the first of its samples in a pixel.
struct RowParts {
    /// The pixels with a part at each sample, one bit each.
    at: [u32; SAMPLES],
    /// For each sample and pixel, the samples of the pixel that see the same triangle, one bit each.
    held: [[u32; TILE]; SAMPLES],
    /// The pixels with a part at the first sample where another triangle is seen than in the pixel to the left.
    fresh: u32,
    /// The pixels that are covered only in part, one bit each.
    cut: u32,
}

/// The number of changes from triangle to triangle along the first samples of a row from which the other samples are
/// looked up ahead, too: many triangles are then so small that no pixel sees them at its first sample. Half of it looks
/// up parts in vain, twice of it finds many facets alone; pictures are the same.
const CROWDED_ROW: u32 = 12;

impl RowParts {
    const NONE: Self = Self { at: [0; SAMPLES], held: [[0; TILE]; SAMPLES], fresh: 0, cut: 0 };

    /// Returns the pixels with parts at each sample whose triangles are looked up ahead.
    fn prepared(&self) -> [u32; SAMPLES] {
        if self.fresh.count_ones() < CROWDED_ROW {
            return [self.fresh, 0, 0, 0];
        }
        [self.fresh, self.at[1], self.at[2], self.at[3]]
    }
}

/// Rows of pixels whose facets are found before they are lit, so that most are found eight at a time. Half of it finds
/// some alone where triangles are small; twice of it takes twice the memory of the first-level cache for parts (2 KB
/// now).
const ROWS_AHEAD: usize = 4;

impl<'a> LitTile<'a> {
    pub(super) fn new(model: &'a BinnedModel<'a>, lamps: &'a Lamps, origin: [i32; 2], is_clear: bool) -> Self {
        let is_plain = model.paint.is_none() && model.finisher.is_none();
        Self { model, lamps, origin, is_clear, is_plain }
    }
}

impl Lighter {
    pub(super) fn new(model: &BinnedModel<'_>) -> Self {
        Self {
            light: vec![[0.0; 4]; TILE * TILE],
            marks: PixelSet::default(),
            facets: Facets::default(),
            spots: Spots::new(model.lamps.as_ref().map_or([0.0; 3], |lamps| lamps.outside)),
        }
    }

    /// Lights what is seen in a tile, given the triangle seen at each sample.
    pub(super) fn illuminate(&mut self, tile: &LitTile<'_>, owners: &[[u32; SAMPLES]]) {
        self.facets.clear();
        self.marks.clear();
        self.light.fill([0.0; 4]);
        let rows = owners.as_chunks::<TILE>().0;
        let mut ahead = [const { RowParts::NONE }; ROWS_AHEAD];
        for (first, rows) in (0_u32..).step_by(ROWS_AHEAD).zip(rows.chunks(ROWS_AHEAD)) {
            for (y, (owners, parts)) in (first..).zip(rows.iter().zip(&mut ahead)) {
                find_parts(owners, parts);
                self.marks.add_row(y as usize, parts.cut);
                self.facets.prepare(tile.model, tile.origin, owners, &parts.prepared());
            }
            self.facets.settle(tile.model, tile.origin);
            for (y, (owners, parts)) in (first..).zip(rows.iter().zip(&ahead)) {
                self.add_row(tile, y, owners, parts);
            }
        }
        self.finish(tile);
    }

    /// Lights the parts of a row of pixels.
    fn add_row(&mut self, tile: &LitTile<'_>, y: u32, owners: &[[u32; SAMPLES]; TILE], parts: &RowParts) {
        for (s, (mut rest, held)) in parts.at.into_iter().zip(&parts.held).enumerate() {
            while rest != 0 {
                let x = rest.trailing_zeros();
                rest &= rest - 1;
                let (owner, held) = (owners[x as usize][s], held[x as usize]);
                // a set of four samples is below 16 anyway; this spares a check
                self.add(tile, ([x, y], owner), SAMPLE_CENTRES[held as usize % SAMPLE_CENTRES.len()]);
            }
        }
    }

    /// Lights the pixels that were drawn with more samples anew.
    pub(super) fn look_closely(&mut self, tile: &LitTile<'_>, fine: &Fine) {
        for (pixel, owners) in fine.pixels() {
            self.light[pixel as usize] = [0.0; 4];
            let all = (1 << FINE_SAMPLES) - 1;
            let mut rest = held_by(owners, NOBODY);
            while rest != all {
                let owner = owners[rest.trailing_ones() as usize];
                let held = held_by(owners, owner);
                rest |= held;
                self.add(tile, ([pixel % TILE_WIDTH, pixel / TILE_WIDTH], owner), fine_centre(held));
            }
        }
        self.finish(tile);
    }

    /// Lights the part of a pixel in which a triangle is seen; the part is given by its centroid and its share.
    #[expect(
        clippy::inline_always,
        reason = "it is called for every part of a pixel, and keeps its numbers in registers"
    )]
    #[inline(always)]
    fn add(&mut self, tile: &LitTile<'_>, ([x, y], owner): ([u32; 2], u32), [right, down, share]: [f32; 3]) {
        let (facet, tint) = self.facets.of(tile.model, owner, tile.origin);
        let place = [x as f32 + right, y as f32 + down];
        let share =
            if tile.is_plain { share } else { share * dress(&mut self.spots, tile, owner, (facet, tint), place) };
        self.spots.push((TILE_WIDTH * y + x, share), facet.normal(place), place);
        if self.spots.are_full() {
            self.finish(tile);
        }
    }

    /// Adds the light of the waiting spots; if the surface has a finish, their colours unchanged.
    #[inline(never)]
    fn finish(&mut self, tile: &LitTile<'_>) {
        let lamps = Some(tile.lamps).filter(|_| tile.model.finisher.is_none());
        self.spots.shine(lamps, tile.origin.map(|o| o as f32), &mut self.light, &mut self.marks);
    }
}

/// Gives the next spot the colour, and what else the paint and the finish of a triangle say; returns its opacity.
#[inline(never)]
fn dress(
    spots: &mut Spots,
    tile: &LitTile<'_>,
    owner: u32,
    (facet, tint): (&Facet, Option<&Tint>),
    place: [f32; 2],
) -> f32 {
    let LitTile { model, lamps, origin, .. } = *tile;
    let paint = model.paint.as_ref().zip(tint);
    let painted = paint.map(|(paint, tint)| paint.color(tint, place));
    let finished = model.finisher.as_ref().map(|finisher| {
        let normal = |place| facet.normal(place);
        finisher.color(painted.unwrap_or(lamps.outside), normal, place, origin.map(|o| o as f32))
    });
    if let Some(color) = finished.or(painted) {
        spots.color(color);
    }
    if let Some(paint) = &model.paint {
        spots.finish(paint.finish(model.whole(owner)));
    }
    paint.filter(|_| tile.is_clear).map_or(1.0, |(paint, tint)| paint.alpha(model.whole(owner), tint, place))
}

/// Finds the parts of the pixels of a row, given the triangle seen at each sample.
///
/// Whether samples of a pixel see the same triangle is as good as random, so there is no branch that depends on it.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn find_parts(owners: &[[u32; SAMPLES]; TILE], parts: &mut RowParts) {
    let mut seen = [[NOBODY; TILE]; SAMPLES];
    for (x, owners) in owners.iter().enumerate() {
        for s in 0..SAMPLES {
            seen[s][x] = owners[s];
        }
    }
    let [mut second, mut third, mut fourth, mut cut] = [[0; TILE]; 4];
    for x in 0..TILE {
        let (a, b, c, d) = (seen[0][x], seen[1][x], seen[2][x], seen[3][x]);
        let (ab, ac, ad) = (u32::from(a == b), u32::from(a == c), u32::from(a == d));
        let (bc, bd, cd) = (u32::from(b == c), u32::from(b == d), u32::from(c == d));
        parts.held[0][x] = 1 | ab << 1 | ac << 2 | ad << 3;
        parts.held[1][x] = ab | 1 << 1 | bc << 2 | bd << 3;
        parts.held[2][x] = ac | bc << 1 | 1 << 2 | cd << 3;
        parts.held[3][x] = ad | bd << 1 | cd << 2 | 1 << 3;
        let (no_b, no_c, no_d) = (u32::from(b == NOBODY), u32::from(c == NOBODY), u32::from(d == NOBODY));
        second[x] = 1 ^ (ab | no_b);
        third[x] = 1 ^ (ac | bc | no_c);
        fourth[x] = 1 ^ (ad | bd | cd | no_d);
        cut[x] = (u32::from(a == NOBODY) | no_b | no_c | no_d) & (1 ^ ab & ac & ad);
    }
    let mut fresh = [1; TILE];
    for x in 1..TILE {
        fresh[x] = u32::from(seen[0][x] != seen[0][x - 1]);
    }
    let (mut at, mut fresh_at, mut cut_at) = ([0; SAMPLES], 0, 0);
    for x in 0..TILE {
        at[0] |= u32::from(seen[0][x] != NOBODY) << x;
        at[1] |= second[x] << x;
        at[2] |= third[x] << x;
        at[3] |= fourth[x] << x;
        fresh_at |= fresh[x] << x;
        cut_at |= cut[x] << x;
    }
    fresh_at &= at[0];
    (parts.at, parts.fresh, parts.cut) = (at, fresh_at, cut_at);
}

#[expect(clippy::cast_possible_truncation, reason = "a tile is some dozen pixels wide")]
const TILE_WIDTH: u32 = TILE as u32;

/// Returns the samples of `owner` as a bit set.
fn held_by<const SAMPLES: usize>(owners: &[u32; SAMPLES], owner: u32) -> u32 {
    (0..SAMPLES).fold(0, |held, s| held | (u32::from(owners[s] == owner) << s))
}

/// Returns the centroid in the pixel of a set of sixteen samples, right and down, and its fraction of the pixel.
fn fine_centre(held: u32) -> [f32; 3] {
    let (mut x, mut y, mut rest) = (0, 0, held);
    while rest != 0 {
        let [right, down] = FINE_PLACES[rest.trailing_zeros() as usize];
        (x, y) = (x + right, y + down);
        rest &= rest - 1;
    }
    let n = held.count_ones() as f32;
    [x as f32 / (32.0 * n), y as f32 / (32.0 * n), n / FINE_SAMPLES as f32]
}

/// For each set of four samples its centroid in the pixel, right and down, and its fraction of the pixel.
const SAMPLE_CENTRES: [[f32; 3]; 1 << SAMPLES] = {
    let mut centres = [[0.0; 3]; 1 << SAMPLES];
    let mut held = 1;
    while held < 1 << SAMPLES {
        let (mut n, mut x, mut y, mut s) = (0, 0, 0, 0);
        while s < SAMPLES {
            if held >> s & 1 == 1 {
                (n, x, y) = (n + 1, x + SAMPLE_PLACES[s][0], y + SAMPLE_PLACES[s][1]);
            }
            s += 1;
        }
        let eighths = 8.0 * n as f32;
        centres[held] = [x as f32 / eighths, y as f32 / eighths, n as f32 / SAMPLES as f32];
        held += 1;
    }
    centres
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_triangle_in_a_pixel_has_one_part_with_all_its_samples() {
        // all ways in which four samples see one of three triangles or none
        let patterns: Vec<[u32; SAMPLES]> = (0..256_u32)
            .map(|code| [0, 2, 4, 6].map(|shift| [7, 40, NOBODY - 1, NOBODY][(code >> shift & 3) as usize]))
            .collect();
        for owners in patterns.as_chunks::<TILE>().0 {
            let mut parts = RowParts::NONE;
            find_parts(owners, &mut parts);
            for (x, owners) in owners.iter().enumerate() {
                let of = |s: usize| (owners[s], held_by(owners, owners[s]));
                let firsts = (0..SAMPLES).filter(|&s| owners[s] != NOBODY && !owners[..s].contains(&owners[s]));
                let expected: Vec<(u32, u32)> = firsts.map(of).collect();
                let found = (0..SAMPLES).filter(|&s| parts.at[s] >> x & 1 == 1);
                let found: Vec<(u32, u32)> = found.map(|s| (owners[s], parts.held[s][x])).collect();
                assert_eq!(found, expected, "{owners:?}");
                let is_cut = owners.contains(&NOBODY) && owners.iter().any(|owner| *owner != NOBODY);
                assert_eq!(parts.cut >> x & 1 == 1, is_cut, "{owners:?}");
            }
        }
    }
}
