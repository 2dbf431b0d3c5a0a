//! Draws curves in lines, with their control polygons, points, combs and tangents.

use super::comb::{combs, tangents};
use super::easel::Easel;
use super::options::{COMB_SCALE, CONTROL_COLOR, FILL, Options, POINT_COLOR};
use super::plot::{PlotArea, PlotItems};
use super::styles::{Style, styles};
use crate::drawing::{Color, Discs, Drawing, DrawingItem, FontWeight, Label, LegendSample, Mark, Point};
use crate::output::error::FormatError;
use crate::output::scene::{Curve, Scene, Shape};
use crate::watch::Watch;

/// The items that a drawing shows by default.
const DEFAULT_DRAWING_ITEMS: &[&str] = &["curve", "control", "points"];
/// All items that a drawing of curves can show.
pub(crate) const CURVE_ITEMS: &[&str] =
    &["curve", "control", "points", "vertices", "comb", "tangents", "axes", "grid", "legend"];
/// Colour of curves.
pub(super) const CURVE_INK: Color = [37, 99, 235, 255];
const POLYGON_INK: Color = [160, 170, 184, 255];
const POINT_INK: Color = [71, 85, 105, 255];
const RING: Color = [255; 4];
const COMB: Color = [148, 163, 184, 255];
const COMB_ENDS: Color = [185, 28, 28, 255];
const TANGENT_INK: Color = [180, 83, 9, 255];

/// Draws the curves of a scene.
pub(crate) fn drawing(scene: &Scene<'_>, options: &Options<'_>, watch: &Watch) -> Result<Drawing, FormatError> {
    let (Shape::Curves(curves), Shape::Curves(control)) = (scene.shape, scene.control.shape()) else {
        return Err(FormatError::Unfit("only curves can be drawn as lines; ask for \"png\" instead".into()));
    };
    let shows = |item| options.shows(item, DEFAULT_DRAWING_ITEMS);
    let mut shown: Vec<&Curve> = Vec::new();
    let refined = ["curve", "vertices", "comb", "tangents"].iter().any(|item| shows(item));
    shown.extend(curves.iter().filter(|_| refined));
    shown.extend(control.iter().filter(|_| shows("control") || shows("points")));
    let sheet = PlotArea::new(&shown, control, options)?;
    let artist = Artist { easel: &sheet.easel, options, side_px: sheet.side_px(), watch };
    let mut plot = PlotItems::default();
    if shows("control") {
        artist.control(control, &mut plot)?;
    }
    if shows("comb") {
        artist.comb(curves, &mut plot)?;
    }
    if shows("curve") {
        artist.curves(curves, &mut plot)?;
    }
    if shows("tangents") {
        let runs = tangents(artist.easel, curves, control, artist.side_px, watch)?;
        plot.line(
            DrawingItem::lines("tangents", runs, options.stroke(1.8, TANGENT_INK)).titled("tangents"),
            "tangents",
        )?;
    }
    if shows("vertices") {
        artist.points(curves, 3.1, 0.8, options.color(CURVE_INK), "vertices", &mut plot)?;
    }
    if shows("points") {
        artist.points(control, 5.2, 1.5, options.ink(&POINT_COLOR, POINT_INK), "points", &mut plot)?;
    }
    Ok(sheet.finish(plot, options))
}

/// Draws the parts of a drawing.
struct Artist<'a> {
    easel: &'a Easel,
    options: &'a Options<'a>,
    /// Smaller side of the visible part, pixels.
    side_px: f64,
    watch: &'a Watch,
}

impl Artist<'_> {
    /// Returns a solid stroke `width` units of line width wide.
    fn control(&self, control: &[Curve], plot: &mut PlotItems) -> Result<(), FormatError> {
        let runs = self.easel.runs(control, self.watch)?;
        let stroke = self.options.stroke(1.5, self.options.ink(&CONTROL_COLOR, POLYGON_INK));
        plot.line(DrawingItem::lines("control", runs, stroke).titled("control polygon"), "control polygon")
    }

    fn comb(&self, curves: &[Curve], plot: &mut PlotItems) -> Result<(), FormatError> {
        let comb = combs(
            self.easel,
            curves,
            self.options.values.number(COMB_SCALE.name).unwrap_or(1.0),
            self.side_px,
            self.watch,
        )?;
        plot.items
            .push(DrawingItem::lines("comb", comb.teeth, self.options.stroke(0.8, COMB)).titled("curvature comb"));
        let ends = DrawingItem::lines("comb", comb.ends, self.options.stroke(1.4, COMB_ENDS));
        plot.line(ends.titled("curvature comb"), "curvature")
    }

    /// Adds the curves, all as one item if they have no styles of their own.
    fn curves(&self, curves: &[Curve], plot: &mut PlotItems) -> Result<(), FormatError> {
        let stroke = self.options.stroke(3.4, self.options.color(CURVE_INK));
        let styles = styles(self.options, stroke.width_px);
        if styles.is_empty() {
            if let Some(color) = self.options.values.color(FILL.name) {
                self.fill(curves, color, plot)?;
            }
            let runs = self.easel.runs(curves, self.watch)?;
            return plot.line(DrawingItem::lines("curve", runs, stroke).titled("curve"), "curve");
        }
        for (curve, style) in curves.iter().zip(styles.iter().cycle()) {
            if let Some(color) = style.fill.or(self.options.values.color(FILL.name)) {
                self.fill(std::slice::from_ref(curve), color, plot)?;
            }
        }
        for (i, (curve, style)) in curves.iter().zip(styles.iter().cycle()).enumerate() {
            let Style { stroke, label, .. } = style;
            let runs = self.easel.runs(std::slice::from_ref(curve), self.watch)?;
            let item = DrawingItem::lines("curve", runs, stroke.clone());
            match label {
                Some(label) if i < styles.len() => plot.line(
                    item.titled(Label::parse(label, FontWeight::Regular).map_err(FormatError::Unfit)?.text()),
                    label,
                )?,
                _ => plot.items.push(item),
            }
        }
        Ok(())
    }

    /// Fills the areas around which closed curves wind an odd number of times.
    fn fill(&self, curves: &[Curve], color: Color, plot: &mut PlotItems) -> Result<(), FormatError> {
        let mut outlines = Vec::new();
        for curve in curves.iter().filter(|curve| curve.closed && curve.dimension > 1) {
            outlines.push(self.easel.outline(curve, self.watch)?);
        }
        plot.items.push(DrawingItem::new("fill", Mark::Areas(outlines, color)));
        Ok(())
    }

    /// Adds points of curves as discs with a radius of `radius` and a ring of `ring` units of line width.
    fn points(
        &self,
        curves: &[Curve],
        radius: f32,
        ring: f32,
        color: Color,
        class: &'static str,
        plot: &mut PlotItems,
    ) -> Result<(), FormatError> {
        let centres = self.easel.centres(curves, self.watch)?;
        let size = self.options.point_size();
        let unit = self.options.unit_px();
        let scale = size.unwrap_or_else(|| crowded(&centres, unit));
        let ring_px = if size.is_none() && scale < 0.5 { 0.0 } else { ring * unit * scale };
        let radius_px = radius * unit * scale + ring_px;
        let discs = Discs { centres, radius_px, ring_px, color, ring: RING };
        let title = if class == "points" { "control points" } else { "points of the curve" };
        plot.entry(LegendSample::Disc(Discs { centres: Vec::new(), ..discs.clone() }), title)?;
        plot.items.push(DrawingItem::new(class, Mark::Discs(discs)).titled(title));
        Ok(())
    }
}

/// Returns the factor by which discs shrink where they would hide each other and the curve.
fn crowded(centres: &[Point], unit: f32) -> f32 {
    let steps = centres.windows(2).map(|pair| {
        let (dx, dy) = (f64::from(pair[1][0] - pair[0][0]), f64::from(pair[1][1] - pair[0][1]));
        (dx * dx + dy * dy).sqrt()
    });
    #[expect(clippy::cast_precision_loss, reason = "fewer than 2^52 points")]
    let mean = if centres.len() > 1 { steps.sum::<f64>() / (centres.len() - 1) as f64 } else { f64::INFINITY };
    #[expect(clippy::cast_possible_truncation, reason = "a size needs no last digit")]
    let scale = (0.5 * mean as f32 / (5.6 * unit)).clamp(0.4, 1.0);
    scale
}
