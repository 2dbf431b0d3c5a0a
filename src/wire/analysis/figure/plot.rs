//! One plot of a figure: axes, and the marks between them.

use crate::drawing::{Axes, Axis, Color, Discs, DrawingItem, FontWeight, Group, Label, Mark as Drawn, Point, Stroke};

/// Colour of text.
pub(super) const TEXT_INK: Color = [15, 23, 42, 255];
/// Colour of functions.
pub(super) const FUNCTION_COLOR: Color = [37, 99, 235, 255];
/// Colour of proved statements.
pub(super) const PROVED_COLOR: Color = [22, 163, 74, 255];
/// Colour of disproved statements.
pub(super) const DISPROVED_COLOR: Color = [220, 38, 38, 255];
/// Colour of guides.
const GUIDE_COLOR: Color = [148, 163, 184, 255];
/// Number of edges of a circle. With a radius of a hundred pixels each edge has six. Half as many would be visible;
/// twice as many would only be longer.
const CIRCLE_EDGES: u8 = 96;

/// A plot.
pub(super) struct Plot {
    pub(super) title: String,
    names: [String; 2],
    range: [[f64; 2]; 2],
    /// Whether both axes have the same scale, so that circles are round.
    one_scale: bool,
    marks: Vec<Marks>,
}

/// Marks of one kind and colour, in the coordinates of the axes.
pub(super) struct Marks {
    points: Vec<[f64; 2]>,
    kind: MarkKind,
    color: Color,
}

enum MarkKind {
    Line,
    Guide,
    Dots,
    Stems,
    Area,
}

pub(super) fn line(points: Vec<[f64; 2]>, color: Color) -> Marks {
    Marks { points, kind: MarkKind::Line, color }
}

pub(super) fn dots(points: Vec<[f64; 2]>, color: Color) -> Marks {
    Marks { points, kind: MarkKind::Dots, color }
}

/// Creates stems from the line y = 0 to the points.
pub(super) fn stems(points: Vec<[f64; 2]>, color: Color) -> Marks {
    Marks { points, kind: MarkKind::Stems, color }
}

/// Creates the area between two lines.
pub(super) fn band(low: Vec<[f64; 2]>, high: Vec<[f64; 2]>, color: Color) -> Marks {
    let points = low.into_iter().chain(high.into_iter().rev()).collect();
    Marks { points, kind: MarkKind::Area, color: [color[0], color[1], color[2], 64] }
}

/// Creates a circle around the origin, as a guide.
pub(super) fn circle(radius: f64) -> Marks {
    let angle = |k: u8| std::f64::consts::TAU * f64::from(k) / f64::from(CIRCLE_EDGES);
    let place = |k| [radius * crate::math::functions::cos(angle(k)), radius * crate::math::functions::sin(angle(k))];
    Marks { points: (0..=CIRCLE_EDGES).map(place).collect(), kind: MarkKind::Guide, color: GUIDE_COLOR }
}

impl Plot {
    /// Creates a plot whose axes enclose all marks; the vertical axis also encloses 0.
    pub(super) fn around(title: &str, x: &str, y: &str, marks: Vec<Marks>) -> Self {
        let all = || marks.iter().flat_map(|marks| &marks.points);
        let reach = |axis: usize, start: f64| {
            let [low, high] = all().fold([start, start], |[low, high], p| [low.min(p[axis]), high.max(p[axis])]);
            let room = 0.06 * (high - low).max(1e-6);
            [low - room, high + room]
        };
        let first = all().next().map_or(0.0, |p| p[0]);
        let range = [reach(0, first), reach(1, 0.0)];
        Self { title: title.to_owned(), names: [x.to_owned(), y.to_owned()], range, one_scale: false, marks }
    }

    /// Creates a plot with axes of the given ranges.
    pub(super) fn within(title: &str, [x, y]: [&str; 2], range: [[f64; 2]; 2], marks: Vec<Marks>) -> Self {
        Self { title: title.to_owned(), names: [x.to_owned(), y.to_owned()], range, one_scale: false, marks }
    }

    /// Sets the same scale for both axes, which extends the range of one of them.
    pub(super) fn in_one_scale(self) -> Self {
        Self { one_scale: true, ..self }
    }

    /// Sets the name and the range of the horizontal axis.
    pub(super) fn set_x(&mut self, name: String, range: [f64; 2]) {
        (self.names[0], self.range[0]) = (name, range);
    }

    /// Returns the drawing of the plot in a rectangle: left, top, width, height.
    pub(super) fn items(&self, [left, top, width, height]: [f32; 4], size_px: f32) -> Vec<DrawingItem> {
        let axis = |k: usize| {
            let [low, high] = self.range[k];
            let label = Label::plain(&self.names[k], FontWeight::Regular).ok().filter(|label| !label.is_empty());
            Axis { low, high, label }
        };
        let (mut x, mut y) = (axis(0), axis(1));
        let [a, b, c, d] = Axes::margins(&x, &y, size_px);
        let border = [left + a, top + b, width - a - c, height - b - d];
        if self.one_scale {
            let sides = [(&mut x, border[2]), (&mut y, border[3])].map(|(axis, px)| (axis, f64::from(px.max(1.0))));
            let unit = sides.iter().map(|(axis, px)| (axis.high - axis.low) / px).fold(0.0, f64::max);
            for (axis, px) in sides {
                let more = 0.5 * (unit * px - (axis.high - axis.low));
                (axis.low, axis.high) = (axis.low - more, axis.high + more);
            }
        }
        let axes = Axes { border, x, y, grid: true, size_px };
        let inside = self.marks.iter().flat_map(|marks| marks.items(&axes)).collect();
        let group = Group { shift: [0.0, 0.0], scale: 1.0, clip: Some(border), items: inside };
        let plot = DrawingItem::new("plot", Drawn::Group(group));
        [axes.grid(), plot].into_iter().chain(axes.items()).collect()
    }
}

impl Marks {
    fn items(&self, axes: &Axes) -> Vec<DrawingItem> {
        let places: Vec<Point> = self.points.iter().map(|p| axes.place(*p)).collect();
        match self.kind {
            _ if places.is_empty() => Vec::new(),
            MarkKind::Line => vec![DrawingItem::lines("line", vec![places], Stroke::solid(2.0, self.color))],
            MarkKind::Guide => vec![DrawingItem::lines("guide", vec![places], Stroke::solid(1.0, self.color))],
            MarkKind::Area => vec![DrawingItem::new("band", Drawn::Areas(vec![places], self.color))],
            MarkKind::Dots => vec![self.discs(places)],
            MarkKind::Stems => {
                let foot = |p: &[f64; 2]| axes.place([p[0], 0.0]);
                let stems = self.points.iter().zip(&places).map(|(p, place)| vec![foot(p), *place]).collect();
                vec![DrawingItem::lines("stem", stems, Stroke::solid(1.5, self.color)), self.discs(places)]
            }
        }
    }

    fn discs(&self, centres: Vec<Point>) -> DrawingItem {
        let (radius_px, ring_px) = (4.0, 0.0);
        DrawingItem::new(
            "point",
            Drawn::Discs(Discs { centres, radius_px, ring_px, color: self.color, ring: self.color }),
        )
    }
}
