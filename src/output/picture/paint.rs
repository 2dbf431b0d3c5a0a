//! Paints a drawing as pixels.

use tiny_skia::{Color, FillRule, LineCap, LineJoin, Paint, PathBuilder, Pixmap, Stroke, Transform};

use super::drawing::{Drawing, Item};
use crate::output::error::FormatError;
use crate::watch::Watch;

/// Discs painted at once.
const BATCH: usize = 256;

/// Rows of red, green, blue and alpha (straight), from the top.
pub(crate) fn paint(drawing: &Drawing, watch: &Watch) -> Result<Vec<u8>, FormatError> {
    let [width, height] = drawing.size;
    let mut pixmap = Pixmap::new(width, height)
        .ok_or_else(|| FormatError::Unfit(format!("a picture of {width} x {height} pixels cannot be made")))?;
    pixmap.fill(color(drawing.background));
    for item in &drawing.items {
        match item {
            Item::Lines { runs, width_px, color } => {
                for run in runs {
                    watch.check()?;
                    stroke(&mut pixmap, run, *width_px, *color);
                }
            }
            Item::Discs { centres, radius_px, ring_px, color, ring } => {
                for batch in centres.chunks(BATCH) {
                    watch.check()?;
                    for &centre in batch {
                        if *ring_px > 0.0 {
                            disc(&mut pixmap, centre, *radius_px, *ring);
                        }
                        disc(&mut pixmap, centre, radius_px - ring_px, *color);
                    }
                }
            }
        }
    }
    Ok(pixmap.take_demultiplied())
}

fn color([r, g, b, a]: [u8; 4]) -> Color {
    Color::from_rgba8(r, g, b, a)
}

fn ink(rgba: [u8; 4]) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color(color(rgba));
    paint
}

fn stroke(pixmap: &mut Pixmap, run: &[[f32; 2]], width_px: f32, rgba: [u8; 4]) {
    let mut path = PathBuilder::with_capacity(run.len(), run.len());
    for (i, [x, y]) in run.iter().enumerate() {
        if i == 0 { path.move_to(*x, *y) } else { path.line_to(*x, *y) }
    }
    let stroke = Stroke { width: width_px, line_cap: LineCap::Round, line_join: LineJoin::Round, ..Stroke::default() };
    if let Some(path) = path.finish() {
        pixmap.stroke_path(&path, &ink(rgba), &stroke, Transform::identity(), None);
    }
}

fn disc(pixmap: &mut Pixmap, [x, y]: [f32; 2], radius_px: f32, rgba: [u8; 4]) {
    if let Some(path) = PathBuilder::from_circle(x, y, radius_px) {
        pixmap.fill_path(&path, &ink(rgba), FillRule::Winding, Transform::identity(), None);
    }
}
