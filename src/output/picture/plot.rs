//! The surroundings of curves in a drawing: axes, a legend, a title.

use super::easel::{Easel, PixelRect};
use super::options::{COMB_SCALE, FILL, Options, POINT_SIZE};
use super::styles::STYLES;
use crate::drawing::{
    Axes, Axis, Color, Drawing, DrawingItem, FontWeight, Group, HorizontalAlign, Label, Legend, LegendEntry,
    LegendSample, Mark, Text, VerticalAlign,
};
use crate::fault::Fault;
use crate::math::parameter::{Default, Parameter, ParameterKind, Values};
use crate::output::counts::ShapeKind;
use crate::output::error::FormatError;
use crate::output::numbers::rounded;
use crate::output::scene::Curve;
use crate::raster::View;

/// The title of the drawing.
pub(crate) const TITLE: Parameter = Parameter::optional(
    "title",
    ParameterKind::Name,
    "What stands above the drawing, with markup as labels have. Curves only.",
);

/// The label of the numbers from left to right.
pub(crate) const X_LABEL: Parameter = Parameter::optional(
    "x_label",
    ParameterKind::Name,
    "What stands below the axis from left to right, where axes are shown.",
);

/// The label of the numbers from the bottom to the top.
pub(crate) const Y_LABEL: Parameter = Parameter::optional(
    "y_label",
    ParameterKind::Name,
    "What stands beside the axis from the bottom to the top, where axes are shown.",
);

/// The position of the legend.
pub(crate) const LEGEND: Parameter = Parameter::choice(
    "legend",
    &["top-right", "top-left", "bottom-right", "bottom-left"],
    "Where the legend stands, where it is shown.",
);

/// The size of letters.
pub(crate) const TEXT_SIZE: Parameter = Parameter::number(
    "text_size",
    [0.2, 10.0],
    Default::Number(1.0),
    "By what the usual size of letters is multiplied, which keeps its proportion to the picture.",
);

/// Minimum default size of letters, pixels, at which they can be read in panels of figures and other small pictures. At
/// half of it they cannot; twice of it leaves no room for curves there.
const LEAST_TEXT_PX: f32 = 9.0;

/// Factor by which curves shrink beside their combs, so that usual teeth stay in the picture: they are an eighth of it
/// long on each side. Longer teeth may leave it. Half of what it leaves free cuts usual teeth; twice of that leaves a
/// quarter of the picture empty.
const COMB_ZOOM: f64 = 0.8;
/// Colour of titles.
const TITLE_INK: Color = [15, 23, 42, 255];

/// Refuses labels that cannot be typeset.
fn check_labels(options: &Values) -> Result<(), Fault> {
    for name in [TITLE.name, X_LABEL.name, Y_LABEL.name] {
        if let Some(text) = options.name(name) {
            Label::parse(text, FontWeight::Regular).map_err(|reason| Fault::new(format!("/{name}"), reason))?;
        }
    }
    for (i, style) in options.groups(STYLES.name).iter().enumerate() {
        if let Some(text) = style.name("label") {
            let place = format!("/{}/{i}/label", STYLES.name);
            Label::parse(text, FontWeight::Regular).map_err(|reason| Fault::new(place, reason))?;
        }
    }
    Ok(())
}

/// Refuses options of curves for meshes, and items that curves of this dimension do not have.
pub(crate) fn check(kind: ShapeKind, options: &Values) -> Result<(), Fault> {
    check_labels(options)?;
    match kind {
        ShapeKind::Mesh => {
            let given = |name: &&str| options.unusual().any(|(unusual, _)| unusual == *name);
            let Some(name) = CURVES_ONLY.iter().find(|name| given(name)) else { return Ok(()) };
            Err(Fault::new(format!("/{name}"), "only drawings of curves have it; leave it out"))
        }
        ShapeKind::Curves { dimension } => {
            let shown = |item: &&&str| options.has("show", item);
            let alien: &[&str] = match dimension {
                1 => &["comb"],
                2 => &[],
                _ => &["axes", "grid"],
            };
            let Some(item) = alien.iter().find(shown) else { return Ok(()) };
            let what = if dimension == 1 { "functions have no" } else { "curves in space have no" };
            Err(Fault::new("/show", format!("{what} \"{item}\" to show; leave it out")))
        }
    }
}

/// Options that only drawings of curves have.
const CURVES_ONLY: [&str; 9] = [
    STYLES.name,
    TITLE.name,
    X_LABEL.name,
    Y_LABEL.name,
    LEGEND.name,
    TEXT_SIZE.name,
    POINT_SIZE.name,
    FILL.name,
    COMB_SCALE.name,
];

/// The drawn items, and the entries of the legend for them.
#[derive(Default)]
pub(super) struct PlotItems {
    pub(super) items: Vec<DrawingItem>,
    entries: Vec<LegendEntry>,
}

impl PlotItems {
    /// Adds lines and their entry in the legend.
    pub(super) fn line(&mut self, item: DrawingItem, label: &str) -> Result<(), FormatError> {
        if let Mark::Lines(_, stroke) = &item.mark {
            self.entry(LegendSample::Line(stroke.clone()), label)?;
        }
        self.items.push(item);
        Ok(())
    }

    /// Adds an entry to the legend.
    pub(super) fn entry(&mut self, key: LegendSample, label: &str) -> Result<(), FormatError> {
        let label = Label::parse(label, FontWeight::Regular).map_err(FormatError::Unfit)?;
        self.entries.push(LegendEntry { key, label });
        Ok(())
    }
}

/// The part of the picture in which curves are drawn, and its surroundings.
pub(super) struct PlotArea {
    pub(super) easel: Easel,
    /// The part of the picture in which curves are visible.
    part: PixelRect,
    axes: Option<Axes>,
    title: Option<Label>,
    size_px: f32,
}

fn label(options: &Options<'_>, name: &str, weight: FontWeight) -> Result<Option<Label>, FormatError> {
    let text = options.values.name(name);
    text.map(|text| Label::parse(text, weight).map_err(FormatError::Unfit)).transpose()
}

impl PlotArea {
    /// Lays out the sheet for these curves.
    pub(super) fn new(shown: &[&Curve], control: &[Curve], options: &Options<'_>) -> Result<Self, FormatError> {
        let usual_px = (15.0 * options.unit_px()).max(LEAST_TEXT_PX);
        let size_px = usual_px * options.values.number(TEXT_SIZE.name).map_or(1.0, rounded);
        let title = label(options, TITLE.name, FontWeight::Bold)?;
        let head = if title.is_some() { 2.2 * size_px } else { 0.0 };
        let plain = Self {
            easel: easel(shown, options, whole(options, head)),
            part: whole(options, head),
            axes: None,
            title,
            size_px,
        };
        if !["axes", "grid"].iter().any(|item| options.shows(item, &[])) {
            return Ok(plain);
        }
        let (x_label, y_label) =
            (label(options, X_LABEL.name, FontWeight::Regular)?, label(options, Y_LABEL.name, FontWeight::Regular)?);
        let steps = steps(shown, control);
        let axes = |easel: &Easel, part: PixelRect| {
            let [left, right, bottom, top] = easel.ranges(part, steps);
            let x = Axis { low: left, high: right, label: x_label.clone() };
            let y = Axis { low: bottom, high: top, label: y_label.clone() };
            Axes { border: part, x, y, grid: options.shows("grid", &[]), size_px }
        };
        // the numbers decide the width of the margins, and the margins decide the numbers
        let around = axes(&plain.easel, plain.part);
        let [left, top, right, bottom] = Axes::margins(&around.x, &around.y, size_px);
        let [_, start, width, height] = plain.part;
        let part =
            [left, start + top, (width - left - right).max(1.0), (height - top - bottom).max(1.0)].map(f32::round);
        let easel = easel(shown, options, part);
        let axes = axes(&easel, part);
        Ok(Self { easel, part, axes: Some(axes), ..plain })
    }

    /// Returns the smaller side of the visible part, pixels.
    pub(super) fn side_px(&self) -> f64 {
        f64::from(self.part[2].min(self.part[3]))
    }

    /// Returns the drawing with axes, legend and title.
    pub(super) fn finish(self, plot: PlotItems, options: &Options<'_>) -> Drawing {
        let mut items = plot.items;
        if let Some(axes) = &self.axes {
            let group = Group { shift: [0.0; 2], scale: 1.0, clip: Some(self.part), items };
            items = vec![axes.grid(), DrawingItem::new("plot", Mark::Group(group))];
            items.extend(axes.items());
        }
        if options.shows("legend", &[]) {
            items.extend(self.legend(plot.entries, options));
        }
        let title = options.values.name(TITLE.name).unwrap_or("Subdivision curves").to_owned();
        let spoken = self.title.as_ref().map_or(title, Label::text);
        if let Some(label) = self.title {
            #[expect(clippy::cast_precision_loss, reason = "pictures have some thousand pixels a side")]
            let at = [0.5 * options.size[0] as f32, 1.5 * self.size_px];
            let (anchor, level) = (HorizontalAlign::Middle, VerticalAlign::Baseline);
            let text = Text { label, at, size_px: 1.1 * self.size_px, anchor, level, turn_deg: 0.0, color: TITLE_INK };
            items.push(DrawingItem::new("title", Mark::Text(text)));
        }
        Drawing { size: options.size, background: options.background, title: spoken, items }
    }

    fn legend(&self, entries: Vec<LegendEntry>, options: &Options<'_>) -> Vec<DrawingItem> {
        let legend = Legend { entries, size_px: self.size_px };
        let [width, height] = legend.extent();
        let [left, top, w, h] = self.part;
        let gap = 0.8 * self.size_px;
        let place = options.values.choice(LEGEND.name).unwrap_or("top-right");
        let x = if place.ends_with("left") { left + gap } else { left + w - gap - width };
        let y = if place.starts_with("top") { top + gap } else { top + h - gap - height };
        legend.items([x, y])
    }
}

/// Returns the part of the picture below its title.
fn whole(options: &Options<'_>, head: f32) -> PixelRect {
    #[expect(clippy::cast_precision_loss, reason = "pictures have some thousand pixels a side")]
    let [width, height] = options.size.map(|side| side as f32);
    [0.0, head.round(), width, (height - head.round()).max(1.0)]
}

fn easel(shown: &[&Curve], options: &Options<'_>, [left, top, width, height]: PixelRect) -> Easel {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole numbers of pixels")]
    let size = [width, height].map(|side| side as u32);
    let view = options.view();
    let zoom = if options.shows("comb", &[]) { COMB_ZOOM * view.zoom } else { view.zoom };
    Easel::within(shown, View { zoom, ..view }, (size, options.corners()), [left, top].map(f64::from))
}

/// Returns the number of steps of the control polygon that the picture of functions spans, 1 if polygons differ in it;
/// `None` for curves that are not functions.
fn steps(shown: &[&Curve], control: &[Curve]) -> Option<f64> {
    let graph = shown.iter().any(|curve| curve.dimension == 1);
    let count = |curve: &Curve| if curve.closed { curve.len() } else { curve.len().saturating_sub(1) };
    let n = control.first().map_or(1, count);
    #[expect(clippy::cast_precision_loss, reason = "fewer than 2^52 points")]
    let steps = if control.iter().all(|curve| count(curve) == n) { n.max(1) as f64 } else { 1.0 };
    graph.then_some(steps)
}
