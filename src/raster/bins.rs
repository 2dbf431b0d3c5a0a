//! Bins: the items that touch each tile, in the order of submission.

/// Side of a tile in pixels: the depths of a tile (four samples of 4 bytes per pixel, 16 KB) stay in the first-level
/// cache. At twice the side they do not; at half of it, four times as many tiles list each large triangle.
pub(super) const TILE: usize = 32;

/// A rectangle of tiles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct TileRect {
    /// The first tile; tiles are numbered row by row from the top.
    pub(super) first: u32,
    /// The numbers of further columns to the right and of further rows below, see [`TileRect::packed`].
    pub(super) further: u32,
}

impl TileRect {
    /// Returns the tiles touched by the pixels `left..=right` x `top..=bottom`, or `None` if these lie outside the
    /// picture.
    pub(super) fn of(grid: TileGrid, [left, top, right, bottom]: [i32; 4]) -> Option<Self> {
        if right < 0 || bottom < 0 || left > right || top > bottom {
            return None;
        }
        let tile = |pixel: i32| u16::try_from(pixel.max(0) / TILE_PX).unwrap_or(u16::MAX);
        let [left, top, right, bottom] = [tile(left), tile(top), tile(right), tile(bottom)];
        (left < grid.columns && top < grid.rows).then(|| Self {
            first: u32::from(top) * u32::from(grid.columns) + u32::from(left),
            further: Self::packed(
                (right.min(grid.columns - 1) - left).into(),
                (bottom.min(grid.rows - 1) - top).into(),
            ),
        })
    }

    /// Returns the numbers of further columns to the right and of further rows below, below 2^16 each, as one number:
    /// 0 for a single tile.
    #[expect(clippy::inline_always, reason = "callers that are compiled for wider vectors need it to be, too")]
    #[inline(always)]
    pub(super) fn packed(across: u32, down: u32) -> u32 {
        across | down << 16
    }

    /// Calls a function with the number of each tile, in a grid of so many columns.
    #[inline]
    fn each(self, columns: usize, mut at: impl FnMut(usize)) {
        let first = self.first as usize;
        if self.further == 0 {
            return at(first);
        }
        let [across, down] = self.unpacked();
        for row in 0..=down {
            (0..=across).for_each(|column| at(first + row * columns + column));
        }
    }

    /// Returns the numbers of further columns and rows.
    #[inline]
    fn unpacked(self) -> [usize; 2] {
        [self.further as usize & 0xffff, self.further as usize >> 16]
    }

    /// Returns whether it has more than [`FEW_TILES`].
    #[inline]
    fn is_large(self) -> bool {
        let [across, down] = self.unpacked();
        self.further != 0 && (across + 1) * (down + 1) > FEW_TILES
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_possible_wrap, reason = "a tile is some dozen pixels wide")]
pub(super) const TILE_PX: i32 = TILE as i32;

/// The numbers of columns and rows of tiles of a picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct TileGrid {
    pub(super) columns: u16,
    pub(super) rows: u16,
}

impl TileGrid {
    pub(super) fn of(width: u32, height: u32) -> Self {
        let tiles = |pixels: u32| u16::try_from((pixels as usize).div_ceil(TILE)).expect("pictures are bounded");
        Self { columns: tiles(width), rows: tiles(height) }
    }

    pub(super) fn len(self) -> usize {
        usize::from(self.columns) * usize::from(self.rows)
    }
}

/// Items that touch more tiles than this are kept in one common list, so that memory stays proportional to the items.
/// Half of it would put more items on the list that every tile reads; twice of it may take twice as many entries.
pub(super) const FEW_TILES: usize = 16;

/// An item, the tiles that it touches, and its largest depth.
pub(super) type BinnedItem = (u32, TileRect, f32);

/// The items of one run of the submission, sorted by tile.
#[derive(Debug, Default)]
pub(super) struct Bins {
    starts: Vec<u32>,
    items: Vec<u32>,
    large: Vec<u32>,
    /// The largest depth of the items of each tile, without the large items.
    nearest: Vec<f32>,
}

impl Bins {
    /// Sorts items by tile; the order within a tile is kept.
    pub(super) fn sort(grid: TileGrid, found: &[BinnedItem]) -> Self {
        if found.is_empty() {
            return Self::default();
        }
        let columns = usize::from(grid.columns);
        // the number of items of each tile, and their largest depth
        let mut tiles = vec![(0_u32, 0.0_f32); grid.len()];
        let mut large = Vec::new();
        for &(item, rect, depth) in found {
            if rect.is_large() {
                large.push(item);
                continue;
            }
            rect.each(columns, |tile| {
                let (n, nearest) = &mut tiles[tile];
                *n += 1;
                *nearest = if depth > *nearest { depth } else { *nearest };
            });
        }
        let mut starts = Vec::with_capacity(tiles.len() + 1);
        let mut n_items = 0;
        for (n, _) in &mut tiles {
            starts.push(n_items);
            (*n, n_items) = (n_items, n_items + *n);
        }
        starts.push(n_items);
        let mut items = vec![0; n_items as usize];
        for &(item, rect, _) in found.iter().filter(|(_, rect, _)| !rect.is_large()) {
            rect.each(columns, |tile| {
                let next = &mut tiles[tile].0;
                items[*next as usize] = item;
                *next += 1;
            });
        }
        // not in place, which would keep the memory of the numbers of items
        let nearest = tiles.iter().map(|(_, nearest)| *nearest).collect();
        Self { starts, items, large, nearest }
    }

    /// Returns every item that may touch tile `tile`; tiles are numbered row by row from the top.
    pub(super) fn tile(&self, tile: usize) -> impl Iterator<Item = u32> + '_ {
        self.tile_from(tile, 0.0).into_iter().flatten().copied()
    }

    /// Returns the items of [`Bins::tile`], or only the large ones if no other has a depth of at least `depth`.
    pub(super) fn tile_from(&self, tile: usize, depth: f32) -> [&[u32]; 2] {
        let own = if self.starts.is_empty() || self.nearest[tile] < depth {
            0..0
        } else {
            self.starts[tile] as usize..self.starts[tile + 1] as usize
        };
        [&self.large, &self.items[own]]
    }

    /// Adds `shift` to every item from `first` on.
    pub(super) fn shift_from(&mut self, first: u32, shift: u32) {
        self.items.iter_mut().chain(&mut self.large).filter(|item| **item >= first).for_each(|item| *item += shift);
    }
}
