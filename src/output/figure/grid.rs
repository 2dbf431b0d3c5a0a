//! Where the panels of a figure stand.

use crate::raster::MAX_SIDE_PX;

/// Most panels of a figure.
/// Papers have up to some twenty. Half of it refuses contact sheets; twice of it draws pictures of a hundred pixels.
pub const MAX_PANELS: usize = 64;
/// Most columns of a figure, and most rows and columns that a panel spans.
/// A column of a dozen has 130 pixels of a wide figure. Half of it refuses contact sheets; with twice of it nothing is
/// to be seen in them.
pub const MAX_COLUMNS: u32 = 12;
/// Smallest side of a panel, pixels, as of every picture.
const LEAST_SIDE: u32 = 16;

/// A panel before it has a place.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// Columns and rows that it spans.
    pub span: [u32; 2],
    /// Width and height of its picture, of which the proportion counts.
    pub proportion: [u32; 2],
}

/// The panels of a figure, in their order.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Columns.
    pub columns: u32,
    /// The panels.
    pub cells: Vec<Cell>,
}

/// A rectangle of pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Place {
    /// The upper left corner.
    pub at: [u32; 2],
    /// Width and height.
    pub size: [u32; 2],
}

/// A figure of some width, laid out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Sheet {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// The pictures of the panels.
    pub pictures: Vec<Place>,
}

impl Grid {
    /// The layout in so many pixels of width. Panels stand row by row, each at the first place after the one before it
    /// that is free; a row is as high as the highest picture in it needs, and a picture that spans rows fills them.
    ///
    /// # Errors
    /// A sentence, when a picture would be too small or the figure too high.
    pub fn sheet(&self, width: u32) -> Result<Sheet, String> {
        let gap = gap(width);
        let columns = self.columns.max(1);
        // the left edge of a column; that after the last is a gap beyond the right edge
        let left = |column: u32| (u64::from(column) * u64::from(width + gap) / u64::from(columns)) as u32;
        let seats = self.seats();
        let widths: Vec<u32> = (seats.iter().zip(&self.cells))
            .map(|([column, _], cell)| (left(column + cell.span[0]) - left(*column)).saturating_sub(gap))
            .collect();
        let mut rows: Vec<u32> = Vec::new();
        let ends = |(seat, cell): (&[u32; 2], &Cell)| (seat[1] + cell.span[1]) as usize;
        rows.resize(seats.iter().zip(&self.cells).map(ends).max().unwrap_or(0), 0);
        let natural: Vec<u32> =
            self.cells.iter().zip(&widths).map(|(cell, width)| scaled(*width, cell.proportion)).collect();
        // pictures of few rows first, so that those of several know what these have
        let mut order: Vec<usize> = (0..self.cells.len()).collect();
        order.sort_by_key(|&i| (self.cells[i].span[1], i));
        for i in order {
            let (first, n) = (seats[i][1] as usize, self.cells[i].span[1]);
            let last = first + n as usize - 1;
            let has = rows[first..last].iter().fold(0_u32, |sum, row| sum.saturating_add(row + gap));
            rows[last] = rows[last].max(natural[i].saturating_sub(has));
        }
        let tops = rows.iter().scan(0_u32, |top, row| {
            let here = *top;
            *top = top.saturating_add(row.saturating_add(gap));
            Some(here)
        });
        let tops: Vec<u32> = tops.collect();
        let pictures = (0..self.cells.len()).map(|i| {
            let (first, n) = (seats[i][1] as usize, self.cells[i].span[1] as usize);
            let last = first + n - 1;
            let room = tops[last].saturating_add(rows[last]) - tops[first];
            let height = if n == 1 { natural[i] } else { room };
            let top = tops[first] + (room - height) / 2;
            Place { at: [left(seats[i][0]), top], size: [widths[i], height] }
        });
        let pictures: Vec<Place> = pictures.collect();
        let height = tops.iter().zip(&rows).next_back().map_or(0, |(top, row)| top.saturating_add(*row));
        check(&pictures, [width, height])?;
        Ok(Sheet { size: [width, height], pictures })
    }

    /// Column and row of the upper left corner of each panel.
    fn seats(&self) -> Vec<[u32; 2]> {
        let columns = self.columns.max(1);
        // for each column the first row that is free in it, below all panels there
        let mut free = vec![0_u32; columns as usize];
        let mut seats = Vec::with_capacity(self.cells.len());
        let mut next = [0_u32; 2];
        for cell in &self.cells {
            let [across, down] = cell.span;
            while next[0] + across > columns
                || (next[0]..next[0] + across).any(|column| free[column as usize] > next[1])
            {
                next = if next[0] + 1 < columns { [next[0] + 1, next[1]] } else { [0, next[1] + 1] };
            }
            (next[0]..next[0] + across).for_each(|column| free[column as usize] = next[1] + down);
            seats.push(next);
            next[0] += across;
        }
        seats
    }
}

/// Pixels between panels.
fn gap(width: u32) -> u32 {
    width / 100
}

/// The height of a picture of this width and these proportions.
fn scaled(width: u32, [w, h]: [u32; 2]) -> u32 {
    let height = (2 * u64::from(width) * u64::from(h) + u64::from(w)) / (2 * u64::from(w.max(1)));
    u32::try_from(height).unwrap_or(u32::MAX)
}

fn check(pictures: &[Place], [width, height]: [u32; 2]) -> Result<(), String> {
    if let Some(n) = pictures.iter().position(|place| place.size.iter().any(|side| *side < LEAST_SIDE)) {
        let [w, h] = pictures[n].size;
        return Err(format!(
            "panel {n} would have {w} x {h} pixels, and a picture has at least {LEAST_SIDE} a side; ask for a wider \
             figure, or for fewer columns"
        ));
    }
    if let Some(n) = pictures.iter().position(|place| place.size[1] > MAX_SIDE_PX).filter(|_| height > MAX_SIDE_PX) {
        let h = pictures[n].size[1];
        return Err(format!(
            "panel {n} would be {h} pixels high; pictures have at most {MAX_SIDE_PX} a side: ask for a narrower figure"
        ));
    }
    if height > MAX_SIDE_PX {
        return Err(format!(
            "the figure would have {width} x {height} pixels; pictures have at most {MAX_SIDE_PX} a side: ask for a \
             narrower figure, or for more columns"
        ));
    }
    Ok(())
}
