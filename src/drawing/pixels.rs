//! Paints a drawing as pixels.

mod dash;

use tiny_skia::{
    Color as Ink, ColorU8, FillRule, FilterQuality, IntSize, LineCap, LineJoin, Mask, Paint, Path, PathBuilder, Pixmap,
    PixmapPaint, Rect, Stroke as Pen, Transform,
};
use ttf_parser::OutlineBuilder;

use super::error::DrawError;
use super::scene::{
    Cap, Color, Discs, Drawing, DrawingItem, Group, Mark, Picture, Point, PolylinePoints, Stroke, Text,
};
use crate::kept::Kept;
use crate::watch::Watch;

/// Number of discs painted between two checks of the watch. A check takes far less time than a disc, so that half of it
/// costs little and gains little; twice of it notices a stop later where discs are large.
const DISCS_PER_BATCH: usize = 256;

/// Returns rows of red, green, blue and alpha (straight), from the top.
///
/// # Errors
/// When the watch says stop, or there is no room for the pixels.
pub fn pixels(drawing: &Drawing, watch: &Watch) -> Result<Kept<u8>, DrawError> {
    let [width, height] = drawing.size;
    let mut pixmap = Pixmap::new(width, height)
        .ok_or_else(|| DrawError::Unfit(format!("a picture of {width} x {height} pixels cannot be made")))?;
    pixmap.fill(ink(drawing.background));
    let mut canvas = Canvas { pixmap, watch };
    canvas.items(&drawing.items, GroupView { transform: Transform::identity(), mask: None })?;
    let straight = canvas.pixmap.take_demultiplied();
    // memory that was not taken from what is kept would be added to it at the end
    let mut pixels = Kept::to_overwrite(straight.len());
    pixels.copy_from_slice(&straight);
    Ok(pixels)
}

/// The canvas that is painted.
struct Canvas<'a> {
    pixmap: Pixmap,
    watch: &'a Watch,
}

/// The transform and the clip of the items of a group.
#[derive(Clone, Copy)]
struct GroupView<'a> {
    /// Maps the group's pixels to those of the drawing.
    transform: Transform,
    /// The area that may be painted; if `None`, everything.
    mask: Option<&'a Mask>,
}

impl Canvas<'_> {
    fn items(&mut self, items: &[DrawingItem], view: GroupView<'_>) -> Result<(), DrawError> {
        for item in items {
            self.watch.check()?;
            match &item.mark {
                Mark::Lines(runs, stroke) => self.lines(runs, stroke, view)?,
                Mark::Areas(outlines, color) => self.areas(outlines, *color, view)?,
                Mark::Discs(discs) => self.discs(discs, view)?,
                Mark::Text(text) => self.text(text, view),
                Mark::Picture(picture) => self.picture(picture, view)?,
                Mark::Group(group) => self.group(group, view)?,
            }
        }
        Ok(())
    }

    fn lines(&mut self, runs: &[PolylinePoints], stroke: &Stroke, view: GroupView<'_>) -> Result<(), DrawError> {
        if stroke.dash.is_empty() {
            return self.solid(runs, stroke, view);
        }
        let seen = dash::visible(&self.pixmap, view.transform, stroke.width_px);
        for run in runs {
            self.solid(&dash::dashes(run, &stroke.dash, seen), stroke, view)?;
        }
        Ok(())
    }

    fn solid(&mut self, runs: &[PolylinePoints], stroke: &Stroke, view: GroupView<'_>) -> Result<(), DrawError> {
        let line_cap = match stroke.cap {
            Cap::Round => LineCap::Round,
            Cap::Butt => LineCap::Butt,
        };
        let pen = Pen { width: stroke.width_px, line_cap, line_join: LineJoin::Round, ..Pen::default() };
        for run in runs {
            self.watch.check()?;
            let mut path = PathBuilder::with_capacity(run.len(), run.len());
            trace(&mut path, run);
            if let Some(path) = path.finish() {
                self.pixmap.stroke_path(&path, &paint(stroke.color), &pen, view.transform, view.mask);
            }
        }
        Ok(())
    }

    fn areas(&mut self, outlines: &[PolylinePoints], color: Color, view: GroupView<'_>) -> Result<(), DrawError> {
        let mut path = PathBuilder::new();
        for outline in outlines {
            self.watch.check()?;
            trace(&mut path, outline);
            path.close();
        }
        self.fill(path.finish(), FillRule::EvenOdd, color, view);
        Ok(())
    }

    fn fill(&mut self, path: Option<Path>, rule: FillRule, color: Color, view: GroupView<'_>) {
        if let Some(path) = path {
            self.pixmap.fill_path(&path, &paint(color), rule, view.transform, view.mask);
        }
    }

    fn discs(&mut self, discs: &Discs, view: GroupView<'_>) -> Result<(), DrawError> {
        for batch in discs.centres.chunks(DISCS_PER_BATCH) {
            self.watch.check()?;
            for &[x, y] in batch {
                if discs.ring_px > 0.0 {
                    self.fill(PathBuilder::from_circle(x, y, discs.radius_px), FillRule::Winding, discs.ring, view);
                }
                self.fill(
                    PathBuilder::from_circle(x, y, discs.radius_px - discs.ring_px),
                    FillRule::Winding,
                    discs.color,
                    view,
                );
            }
        }
        Ok(())
    }

    fn text(&mut self, text: &Text, view: GroupView<'_>) {
        let mut contours = PixelContours(PathBuilder::new());
        text.outline(&mut contours);
        let [a, b, c, d, e, f] = text.frame();
        let transform = view.transform.pre_concat(Transform::from_row(a, b, c, d, e, f));
        self.fill(contours.0.finish(), FillRule::Winding, text.color, GroupView { transform, ..view });
    }

    fn picture(&mut self, picture: &Picture, view: GroupView<'_>) -> Result<(), DrawError> {
        let [columns, rows] = picture.size;
        let premultiplied = picture.pixels.chunks_exact(4).flat_map(|p| {
            let color = ColorU8::from_rgba(p[0], p[1], p[2], p[3]).premultiply();
            [color.red(), color.green(), color.blue(), color.alpha()]
        });
        let made = IntSize::from_wh(columns, rows).and_then(|size| Pixmap::from_vec(premultiplied.collect(), size));
        let source = made.ok_or_else(|| {
            DrawError::Unfit(format!("{} bytes are no picture of {columns} x {rows} pixels", picture.pixels.len()))
        })?;
        #[expect(clippy::cast_precision_loss, reason = "pictures have some thousand pixels a side")]
        let [sx, sy] = [picture.extent[0] / columns as f32, picture.extent[1] / rows as f32];
        let transform = view.transform.pre_concat(Transform::from_row(sx, 0.0, 0.0, sy, picture.at[0], picture.at[1]));
        // pixels that fall on pixels stay as they are
        #[expect(clippy::float_cmp, reason = "any other scale does need a filter")]
        let exact = transform.sx == 1.0 && transform.sy == 1.0;
        let quality = if exact { FilterQuality::Nearest } else { FilterQuality::Bilinear };
        let paint = PixmapPaint { quality, ..PixmapPaint::default() };
        self.pixmap.draw_pixmap(0, 0, source.as_ref(), &paint, transform, view.mask);
        Ok(())
    }

    fn group(&mut self, group: &Group, view: GroupView<'_>) -> Result<(), DrawError> {
        let [x, y] = group.shift;
        let transform = view.transform.pre_concat(Transform::from_row(group.scale, 0.0, 0.0, group.scale, x, y));
        let Some([x, y, width, height]) = group.clip else {
            return self.items(&group.items, GroupView { transform, ..view });
        };
        let path = Rect::from_xywh(x, y, width, height).map(PathBuilder::from_rect);
        let Some(path) = path else { return Ok(()) };
        let cut = self.cut(&path, transform, view.mask);
        self.items(&group.items, GroupView { transform, mask: cut.as_ref() })
    }

    /// Returns the intersection of the inside of a path with a mask.
    fn cut(&self, path: &Path, transform: Transform, mask: Option<&Mask>) -> Option<Mask> {
        let mut cut = mask.cloned().or_else(|| {
            let mut all = Mask::new(self.pixmap.width(), self.pixmap.height())?;
            all.data_mut().fill(255);
            Some(all)
        })?;
        cut.intersect_path(path, FillRule::Winding, true, transform);
        Some(cut)
    }
}

fn ink([r, g, b, a]: Color) -> Ink {
    Ink::from_rgba8(r, g, b, a)
}

fn paint(color: Color) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color(ink(color));
    paint
}

fn trace(path: &mut PathBuilder, run: &[Point]) {
    for (i, [x, y]) in run.iter().enumerate() {
        if i == 0 { path.move_to(*x, *y) } else { path.line_to(*x, *y) }
    }
}

/// Collects the outlines of letters as a path.
struct PixelContours(PathBuilder);

impl OutlineBuilder for PixelContours {
    fn move_to(&mut self, x: f32, y: f32) {
        self.0.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.0.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.0.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.0.cubic_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.0.close();
    }
}
