//! What a drawing consists of.

use super::label::Label;

/// A place in the drawing, pixels, y downwards.
pub type Point = [f32; 2];
/// Red, green, blue and alpha: straight sRGB.
pub type Color = [u8; 4];
/// A polyline of two or more places; one that ends where it starts is closed.
pub type Run = Vec<Point>;

/// Items over a background.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Colour behind everything.
    pub background: Color,
    /// What the drawing shows, for readers that hear it and for the heads of windows; empty when nothing is said.
    pub title: String,
    /// What is painted, the first undermost.
    pub items: Vec<Item>,
}

/// How the letters of a drawing are written where the bytes can hold text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lettering {
    /// As text, which can be searched and copied. SVG names the bundled font and leaves its letters to the viewer; PDF
    /// holds the letters of the font that occur.
    Text,
    /// As outlines of the letters, which look the same everywhere.
    Outlines,
}

/// One thing to paint.
#[derive(Debug, Clone, PartialEq)]
pub struct Item {
    /// What kind of thing it is (`"curve"`, `"axis"`), for style sheets of SVG; empty for none.
    pub class: &'static str,
    /// What it is, in words: SVG shows them where a pointer rests. Empty for nothing.
    pub title: String,
    /// How it looks.
    pub mark: Mark,
}

/// How an item looks.
#[derive(Debug, Clone, PartialEq)]
pub enum Mark {
    /// Polylines with round joins.
    Lines(Vec<Run>, Stroke),
    /// What polygons, each closed by itself, lead around an odd number of times.
    Areas(Vec<Run>, Color),
    /// Filled discs in a ring.
    Discs(Discs),
    /// A line of text.
    Text(Text),
    /// Pixels.
    Picture(Picture),
    /// Items that are moved, scaled and cut together.
    Group(Group),
}

/// How lines are drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Stroke {
    /// Width, pixels.
    pub width_px: f32,
    /// Colour.
    pub color: Color,
    /// Lengths of dashes and gaps in turn, pixels; empty for a solid line.
    pub dash: Vec<f32>,
    /// How lines and dashes end.
    pub cap: Cap,
}

impl Stroke {
    /// A solid line with round ends.
    pub const fn solid(width_px: f32, color: Color) -> Self {
        Self { width_px, color, dash: Vec::new(), cap: Cap::Round }
    }
}

/// How lines and dashes end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cap {
    /// In a half disc.
    Round,
    /// Where the line ends.
    Butt,
}

/// Discs of one look.
#[derive(Debug, Clone, PartialEq)]
pub struct Discs {
    /// Centres.
    pub centres: Vec<Point>,
    /// Radius of a disc with its ring, pixels.
    pub radius_px: f32,
    /// Width of the ring, pixels; 0 for none.
    pub ring_px: f32,
    /// Colour of the disc.
    pub color: Color,
    /// Colour of the ring.
    pub ring: Color,
}

/// A line of text.
#[derive(Debug, Clone, PartialEq)]
pub struct Text {
    /// What it says.
    pub label: Label,
    /// Where the anchor stands.
    pub at: Point,
    /// Size of the font, pixels: the side of the square that holds an M.
    pub size_px: f32,
    /// Which end of the text stands at the anchor.
    pub anchor: Anchor,
    /// Which height of the text stands at the anchor.
    pub level: Level,
    /// Turn about the anchor, degrees, clockwise.
    pub turn_deg: f32,
    /// Colour.
    pub color: Color,
}

/// Which end of a text stands at its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// The left one.
    Start,
    /// The middle.
    Middle,
    /// The right one.
    End,
}

/// Which height of a text stands at its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Level {
    /// The line on which letters stand.
    Baseline,
    /// The middle of a capital letter.
    Middle,
    /// The top of a capital letter.
    Top,
}

/// Pixels in a rectangle.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Columns and rows, pixels of the picture.
    pub size: [u32; 2],
    /// Rows of red, green, blue and alpha (straight), from the top: `4 * columns * rows` bytes.
    pub pixels: Vec<u8>,
    /// Upper left corner of the rectangle.
    pub at: Point,
    /// Width and height of the rectangle, pixels of the drawing.
    pub extent: [f32; 2],
}

/// Items that are moved, scaled and cut together: a place `p` of an item is seen at `shift + scale p`.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// Where the origin of the items stands.
    pub shift: Point,
    /// Pixels of what the group stands in for each of its own; greater than 0.
    pub scale: f32,
    /// Left, top, width and height of the rectangle outside of which nothing is seen, in pixels of the group.
    pub clip: Option<[f32; 4]>,
    /// What is painted, the first undermost.
    pub items: Vec<Item>,
}

impl Item {
    /// An item without a title.
    pub fn new(class: &'static str, mark: Mark) -> Self {
        Self { class, title: String::new(), mark }
    }

    /// The same with a title.
    #[must_use]
    pub fn titled(self, title: impl Into<String>) -> Self {
        Self { title: title.into(), ..self }
    }

    /// Lines of one look.
    pub fn lines(class: &'static str, runs: Vec<Run>, stroke: Stroke) -> Self {
        Self::new(class, Mark::Lines(runs, stroke))
    }

    /// A filled rectangle: left, top, width, height.
    pub fn rectangle(class: &'static str, [x, y, width, height]: [f32; 4], color: Color) -> Self {
        let corners = vec![[x, y], [x + width, y], [x + width, y + height], [x, y + height]];
        Self::new(class, Mark::Areas(vec![corners], color))
    }

    /// Text that stands upright.
    pub fn text(class: &'static str, label: Label, at: Point, size_px: f32, color: Color) -> Self {
        let (anchor, level) = (Anchor::Start, Level::Baseline);
        Self::new(class, Mark::Text(Text { label, at, size_px, anchor, level, turn_deg: 0.0, color }))
    }
}

impl Drawing {
    /// The drawing as an item of another: as large as it fits into a rectangle (left, top, width, height), in its
    /// middle, with its background, and cut at its own edges.
    pub fn into_group(self, [left, top, width, height]: [f32; 4]) -> Item {
        #[expect(clippy::cast_precision_loss, reason = "pictures have some thousand pixels a side")]
        let [w, h] = self.size.map(|side| side.max(1) as f32);
        let scale = (width / w).min(height / h);
        let shift = [left + 0.5 * (width - scale * w), top + 0.5 * (height - scale * h)];
        let mut items = self.items;
        if self.background[3] > 0 {
            items.insert(0, Item::rectangle("background", [0.0, 0.0, w, h], self.background));
        }
        let group = Group { shift, scale, clip: Some([0.0, 0.0, w, h]), items };
        Item::new("panel", Mark::Group(group)).titled(self.title)
    }
}
