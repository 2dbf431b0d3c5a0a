//! The contents of a drawing.

use super::label::Label;
use crate::kept::Kept;

/// A point of the drawing, in pixels, y downwards.
pub type Point = [f32; 2];
/// A colour: red, green, blue and alpha, straight sRGB.
pub type Color = [u8; 4];
/// A polyline of two or more points; closed if it ends where it starts.
pub type PolylinePoints = Vec<Point>;

/// Items over a background.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    /// Width and height, in pixels.
    pub size: [u32; 2],
    /// The colour behind everything.
    pub background: Color,
    /// A description of the drawing, for screen readers and window titles; may be empty.
    pub title: String,
    /// The items, in painting order.
    pub items: Vec<DrawingItem>,
}

/// How letters are written in formats that can hold text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lettering {
    /// As text, which can be searched and copied. SVG names the bundled font and leaves its letters to the viewer; PDF
    /// holds the letters of the font that occur.
    Text,
    /// As outlines of the letters, which look the same everywhere.
    Outlines,
}

/// An item to paint.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawingItem {
    /// The class of the item (`"curve"`, `"axis"`) for style sheets of SVG; may be empty.
    pub class: &'static str,
    /// A description of the item, shown as a tooltip in SVG; may be empty.
    pub title: String,
    /// The appearance of the item.
    pub mark: Mark,
}

/// The appearance of an item.
#[derive(Debug, Clone, PartialEq)]
pub enum Mark {
    /// Polylines with round joins.
    Lines(Vec<PolylinePoints>, Stroke),
    /// The areas that polygons enclose by the even-odd rule; each polygon is closed.
    Areas(Vec<PolylinePoints>, Color),
    /// Filled discs with a ring.
    Discs(Discs),
    /// A line of text.
    Text(Text),
    /// A raster image.
    Picture(Picture),
    /// Items that are moved, scaled and clipped together.
    Group(Group),
}

/// The style of lines.
#[derive(Debug, Clone, PartialEq)]
pub struct Stroke {
    /// Width, in pixels.
    pub width_px: f32,
    /// Colour.
    pub color: Color,
    /// Alternating lengths of dashes and gaps, in pixels; empty for a solid line.
    pub dash: Vec<f32>,
    /// The ends of lines and dashes.
    pub cap: Cap,
}

impl Stroke {
    /// Creates a solid line with round ends.
    pub const fn solid(width_px: f32, color: Color) -> Self {
        Self { width_px, color, dash: Vec::new(), cap: Cap::Round }
    }
}

/// The ends of lines and dashes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cap {
    /// Rounded by a half disc.
    Round,
    /// Cut off at the end of the line.
    Butt,
}

/// Discs of the same appearance.
#[derive(Debug, Clone, PartialEq)]
pub struct Discs {
    /// The centres.
    pub centres: Vec<Point>,
    /// Radius of a disc including its ring, in pixels.
    pub radius_px: f32,
    /// Width of the ring, in pixels; 0 for none.
    pub ring_px: f32,
    /// Colour of the disc.
    pub color: Color,
    /// Colour of the ring.
    pub ring: Color,
}

/// A line of text.
#[derive(Debug, Clone, PartialEq)]
pub struct Text {
    /// The text.
    pub label: Label,
    /// The position of the anchor.
    pub at: Point,
    /// Font size, in pixels: the size of the em square.
    pub size_px: f32,
    /// The horizontal position of the anchor in the text.
    pub anchor: HorizontalAlign,
    /// The vertical position of the anchor in the text.
    pub level: VerticalAlign,
    /// Rotation about the anchor, in degrees, clockwise.
    pub turn_deg: f32,
    /// Colour.
    pub color: Color,
}

/// The horizontal position of the anchor in a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HorizontalAlign {
    /// The left end.
    Start,
    /// The middle.
    Middle,
    /// The right end.
    End,
}

/// The vertical position of the anchor in a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VerticalAlign {
    /// The baseline.
    Baseline,
    /// The middle of a capital letter.
    Middle,
    /// The top of a capital letter.
    Top,
}

/// A raster image in a rectangle.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Number of columns and rows of the image.
    pub size: [u32; 2],
    /// Rows of red, green, blue and alpha (straight), from the top: `4 * columns * rows` bytes.
    pub pixels: Kept<u8>,
    /// Upper left corner of the rectangle.
    pub at: Point,
    /// Width and height of the rectangle, in pixels of the drawing.
    pub extent: [f32; 2],
}

/// Items that are moved, scaled and clipped together: a point `p` of an item is drawn at `shift + scale p`.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// The position of the origin of the items.
    pub shift: Point,
    /// Scale factor from the group's pixels to those outside; greater than 0.
    pub scale: f32,
    /// Clip rectangle: left, top, width and height, in pixels of the group.
    pub clip: Option<[f32; 4]>,
    /// The items, in painting order.
    pub items: Vec<DrawingItem>,
}

impl DrawingItem {
    /// Creates an item without a title.
    pub fn new(class: &'static str, mark: Mark) -> Self {
        Self { class, title: String::new(), mark }
    }

    /// Returns the item with a title.
    #[must_use]
    pub fn titled(self, title: impl Into<String>) -> Self {
        Self { title: title.into(), ..self }
    }

    /// Creates lines of one style.
    pub fn lines(class: &'static str, runs: Vec<PolylinePoints>, stroke: Stroke) -> Self {
        Self::new(class, Mark::Lines(runs, stroke))
    }

    /// Creates a filled rectangle: left, top, width, height.
    pub fn rectangle(class: &'static str, [x, y, width, height]: [f32; 4], color: Color) -> Self {
        let corners = vec![[x, y], [x + width, y], [x + width, y + height], [x, y + height]];
        Self::new(class, Mark::Areas(vec![corners], color))
    }
}

impl Drawing {
    /// Returns the drawing as an item of another one: as large as fits into a rectangle (left, top, width, height),
    /// centred, with its background, and clipped at its own edges.
    pub fn into_group(self, [left, top, width, height]: [f32; 4]) -> DrawingItem {
        #[expect(clippy::cast_precision_loss, reason = "pictures have some thousand pixels a side")]
        let [w, h] = self.size.map(|side| side.max(1) as f32);
        let scale = (width / w).min(height / h);
        let shift = [left + 0.5 * (width - scale * w), top + 0.5 * (height - scale * h)];
        let mut items = self.items;
        if self.background[3] > 0 {
            items.insert(0, DrawingItem::rectangle("background", [0.0, 0.0, w, h], self.background));
        }
        let group = Group { shift, scale, clip: Some([0.0, 0.0, w, h]), items };
        DrawingItem::new("panel", Mark::Group(group)).titled(self.title)
    }
}
