//! The layout of a figure: the places of its panels, and the texts beside them.

use crate::drawing::{
    ASCENT, Color, DESCENT, DrawingItem, FontWeight, HorizontalAlign, Label, Mark, Text, VerticalAlign, wrapped,
};
use crate::raster::MAX_SIDE_PX;

/// Maximum number of panels of a figure. Papers have up to some twenty. Half of it refuses contact sheets; twice of it
/// draws pictures of a hundred pixels.
pub const MAX_PANELS: usize = 64;
/// Maximum number of columns of a figure, and of rows and columns that a panel spans. A column of a dozen has 130
/// pixels of a wide figure. Half of it refuses contact sheets; at twice of it nothing is recognisable in them.
pub const MAX_COLUMNS: u32 = 12;
/// Maximum number of characters of a title or caption: half a page. Half of it cuts long captions; twice of it is not a
/// caption.
pub const MAX_CAPTION_CHARS: usize = 1000;
/// Minimum side of a panel, pixels, as of every picture.
const LEAST_SIDE: u32 = 16;
/// Colour of texts.
const CAPTION_INK: Color = [30, 41, 59, 255];

/// A panel and the layers on it, before its position is known.
#[derive(Debug, Clone, PartialEq)]
pub struct PanelCell {
    /// Numbers of columns and rows that the panel spans.
    pub span: [u32; 2],
    /// Width and height of the picture, of which only the ratio matters.
    pub proportion: [u32; 2],
    /// The text below the panel.
    pub caption: Option<String>,
    /// Number of pictures on top of each other, at least 1.
    pub layers: usize,
}

/// The panels of a figure, in their order.
#[derive(Debug, Clone, PartialEq)]
pub struct PanelGrid {
    /// Number of columns.
    pub columns: u32,
    /// The text above all panels.
    pub title: Option<String>,
    /// Whether captions begin with (a), (b), ...
    pub letters: bool,
    /// The panels.
    pub cells: Vec<PanelCell>,
}

/// A rectangle of pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PanelRect {
    /// The upper left corner.
    pub at: [u32; 2],
    /// Width and height.
    pub size: [u32; 2],
}

/// The layout of a figure of some width.
#[derive(Debug, Clone, PartialEq)]
pub struct Sheet {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// The places of the pictures of all panels; the layers of a panel are in order from the lowest up.
    pub pictures: Vec<PanelRect>,
    /// The texts.
    pub texts: Vec<DrawingItem>,
}

/// Heights in a row: of its pictures, and of the captions below them.
#[derive(Debug, Clone, Copy, Default)]
struct RowHeights {
    picture: u32,
    caption: u32,
}

impl PanelGrid {
    /// Lays out the figure in a width in pixels. Panels are placed row by row, each at the first free place after the
    /// one before it; a row is as high as the highest picture in it needs, and a picture that spans rows fills them.
    ///
    /// # Errors
    /// A sentence, if a picture would be too small or the figure too high, or a text cannot be typeset.
    pub fn sheet(&self, width: u32) -> Result<Sheet, String> {
        let gap = width / 100;
        let columns = self.columns.max(1);
        // the left edge of a column; the left edge after the last column is a gap beyond the right edge
        let left = |column: u32| {
            let left = u64::from(column) * u64::from(width + gap) / u64::from(columns);
            u32::try_from(left).unwrap_or(u32::MAX)
        };
        let seats = self.seats();
        let widths = seats.iter().zip(&self.cells);
        let widths =
            widths.map(|([column, _], cell)| (left(column + cell.span[0]) - left(*column)).saturating_sub(gap));
        let widths: Vec<u32> = widths.collect();
        let font = FontSize::of(width);
        let captions: Result<Vec<Vec<Label>>, String> =
            (0..self.cells.len()).map(|i| font.lines(&self.caption(i), FontWeight::Regular, widths[i])).collect();
        let captions = captions?;
        let natural: Vec<u32> =
            self.cells.iter().zip(&widths).map(|(cell, width)| scaled(*width, cell.proportion)).collect();
        let rows = self.rows(&seats, &natural, &captions, (font, gap));
        let title = font.title().lines(self.title.as_deref().unwrap_or_default(), FontWeight::Bold, width)?;
        let mut top = font.title().height(title.len());
        let tops = rows.iter().map(|row| {
            let here = top;
            top = top.saturating_add(row.picture).saturating_add(row.caption).saturating_add(gap);
            here
        });
        let tops: Vec<u32> = tops.collect();
        let height = top.saturating_sub(gap);
        let mut texts = font.title().items("title", &title, [width / 2, 0]);
        let mut pictures = Vec::with_capacity(self.cells.len());
        for (i, [column, first]) in seats.iter().enumerate() {
            let (first, n) = (*first as usize, self.cells[i].span[1] as usize);
            let last = first + n - 1;
            let room = tops[last].saturating_add(rows[last].picture) - tops[first];
            let height = if n == 1 { natural[i] } else { room };
            let at = [left(*column), tops[first] + (room - height) / 2];
            pictures.extend(vec![PanelRect { at, size: [widths[i], height] }; self.cells[i].layers]);
            let below = tops[first].saturating_add(room);
            texts.extend(font.items("caption", &captions[i], [at[0] + widths[i] / 2, below]));
        }
        check(&pictures, [width, height])?;
        Ok(Sheet { size: [width, height], pictures, texts })
    }

    /// Returns the caption of panel `i`.
    fn caption(&self, i: usize) -> String {
        let said = self.cells[i].caption.as_deref().unwrap_or_default();
        if !self.letters {
            return said.to_owned();
        }
        // after z come aa, ab, ...
        let letter = |k: usize| char::from(b'a' + u8::try_from(k % 26).unwrap_or(0));
        let first = (i / 26).checked_sub(1).map(letter);
        let letters: String = first.into_iter().chain([letter(i)]).collect();
        format!("({letters}) {said}").trim_end().to_owned()
    }

    /// Returns the heights of the rows.
    fn rows(
        &self,
        seats: &[[u32; 2]],
        natural: &[u32],
        captions: &[Vec<Label>],
        (font, gap): (FontSize, u32),
    ) -> Vec<RowHeights> {
        let ends = |(seat, cell): (&[u32; 2], &PanelCell)| (seat[1] + cell.span[1]) as usize;
        let mut rows = vec![RowHeights::default(); seats.iter().zip(&self.cells).map(ends).max().unwrap_or(0)];
        // pictures of few rows first, so that pictures of several rows know the heights of those
        let mut order: Vec<usize> = (0..self.cells.len()).collect();
        order.sort_by_key(|&i| (self.cells[i].span[1], i));
        for &i in &order {
            let last = (seats[i][1] + self.cells[i].span[1]) as usize - 1;
            rows[last].caption = rows[last].caption.max(font.height(captions[i].len()));
        }
        for i in order {
            let (first, n) = (seats[i][1] as usize, self.cells[i].span[1] as usize);
            let last = first + n - 1;
            let before =
                rows[first..last].iter().fold(0_u32, |sum, row| sum.saturating_add(row.picture + row.caption + gap));
            rows[last].picture = rows[last].picture.max(natural[i].saturating_sub(before));
        }
        rows
    }

    /// Returns the column and the row of the upper left corner of each panel.
    fn seats(&self) -> Vec<[u32; 2]> {
        let columns = self.columns.max(1);
        // for each column the first row below all panels in it
        let mut free = vec![0_u32; columns as usize];
        let mut seats = Vec::with_capacity(self.cells.len());
        let mut next = [0_u32; 2];
        for cell in &self.cells {
            let [across, down] = cell.span;
            let is_taken = |[column, row]: [u32; 2]| {
                column + across > columns || free[column as usize..(column + across) as usize].iter().any(|n| *n > row)
            };
            while is_taken(next) {
                next = if next[0] + 1 < columns { [next[0] + 1, next[1]] } else { [0, next[1] + 1] };
            }
            free[next[0] as usize..(next[0] + across) as usize].fill(next[1] + down);
            seats.push(next);
            next[0] += across;
        }
        seats
    }
}

/// The size of letters.
#[derive(Debug, Clone, Copy)]
struct FontSize {
    size_px: f32,
}

impl FontSize {
    /// Returns the font of captions: a line across the figure has some hundred legible letters.
    fn of(width: u32) -> Self {
        #[expect(clippy::cast_precision_loss, reason = "figures have some thousand pixels")]
        let size_px = (width as f32 / 64.0).clamp(12.0, 40.0);
        Self { size_px }
    }

    /// Returns the font of the title.
    fn title(self) -> Self {
        Self { size_px: 1.3 * self.size_px }
    }

    fn lines(self, text: &str, weight: FontWeight, width: u32) -> Result<Vec<Label>, String> {
        if text.is_empty() {
            return Ok(Vec::new());
        }
        #[expect(clippy::cast_precision_loss, reason = "figures have some thousand pixels")]
        wrapped(text, weight, self.size_px, width as f32)
    }

    /// Returns the distance between baselines, pixels.
    fn step(self) -> f32 {
        1.3 * self.size_px
    }

    /// Returns the height of `lines` lines with the space around them, pixels.
    #[expect(clippy::cast_precision_loss, reason = "a text has some lines")]
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a text is some hundred pixels high")]
    fn height(self, lines: usize) -> u32 {
        if lines == 0 {
            return 0;
        }
        ((lines - 1) as f32 * self.step() + (ASCENT + DESCENT + 0.7) * self.size_px).ceil() as u32
    }

    /// Returns lines centred at `x`, below `y`.
    #[expect(clippy::cast_precision_loss, reason = "figures have some thousand pixels, and texts some lines")]
    fn items(self, class: &'static str, lines: &[Label], [x, y]: [u32; 2]) -> Vec<DrawingItem> {
        let line = |(i, label): (usize, &Label)| {
            let baseline = y as f32 + (ASCENT + 0.35) * self.size_px + i as f32 * self.step();
            let text = Text {
                label: label.clone(),
                at: [x as f32, baseline],
                size_px: self.size_px,
                anchor: HorizontalAlign::Middle,
                level: VerticalAlign::Baseline,
                turn_deg: 0.0,
                color: CAPTION_INK,
            };
            DrawingItem::new(class, Mark::Text(text))
        };
        lines.iter().enumerate().map(line).collect()
    }
}

/// Returns the height of a picture of this width and these proportions.
fn scaled(width: u32, [w, h]: [u32; 2]) -> u32 {
    let height = (2 * u64::from(width) * u64::from(h) + u64::from(w)) / (2 * u64::from(w.max(1)));
    u32::try_from(height).unwrap_or(u32::MAX)
}

fn check(pictures: &[PanelRect], [width, height]: [u32; 2]) -> Result<(), String> {
    if let Some(n) = pictures.iter().position(|place| place.size.iter().any(|side| *side < LEAST_SIDE)) {
        let [w, h] = pictures[n].size;
        return Err(format!(
            "panel {n} would have {w} x {h} pixels, and a picture has at least {LEAST_SIDE} a side; ask for a wider \
             figure, or for fewer columns"
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
