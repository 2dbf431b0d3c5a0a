//! SVG: a drawing of curves, or of sections of a mesh, as paths.

use std::io::{self, Write};

use crate::fault::Fault;
use crate::math::parameter::{Default, Kind, Parameter, Values};
use crate::output::counts::{Counts, ShapeKind};
use crate::output::error::FormatError;
use crate::output::format::{Content, Format, FormatFacts};
use crate::output::options::POSITIONS;
use crate::output::picture::drawing::{Drawing, Item};
use crate::output::picture::options::{self, BACKGROUND, CAMERA, COLOR, HEIGHT, Options, WIDTH};
use crate::output::picture::outline::{self, Outline};
use crate::output::picture::sections;
use crate::output::scene::{Frame, Scene, Shape};
use crate::output::sections::{SECTIONS, asked, planes};
use crate::output::size::Size;
use crate::output::surface::NORMALS;
use crate::shape::attachments::Attachments;
use crate::watch::Watch;

/// The format "svg".
#[derive(Debug, Clone, Copy)]
pub(super) struct Svg;

const PARAMETERS: &[Parameter] = &[
    WIDTH,
    HEIGHT,
    BACKGROUND,
    Parameter {
        name: "show",
        kind: Kind::Choices(&["curve", "control", "points"]),
        unit: "",
        default: Default::Texts(&["curve", "control", "points"]),
        doc: "What is drawn: the refined curve, the control polygon, the control points. Of a mesh only its sections \
              are.",
    },
    COLOR,
    CAMERA,
    SECTIONS,
    POSITIONS,
    Parameter {
        doc: "Known as by all outputs of meshes; lines have no normals, and the drawing is the same.",
        ..NORMALS
    },
];

fn holds(kind: ShapeKind, options: &Values) -> Result<(), String> {
    match kind {
        ShapeKind::Mesh if asked(options) => Ok(()),
        ShapeKind::Mesh => {
            Err("svg draws curves, and of a mesh only sections; name planes in \"sections\", or ask for \
                                \"png\" to see the mesh"
                .into())
        }
        ShapeKind::Curves { .. } => options::drawable(kind),
    }
}

const FACTS: &FormatFacts = &FormatFacts {
    name: "svg",
    extension: "svg",
    media_type: "image/svg+xml",
    content: Content::Text,
    doc: "A drawing of curves with their control polygons, or of plane sections of a mesh, in paths that scale.",
    parameters: PARAMETERS,
    holds_frames: false,
    holds,
};

impl Format for Svg {
    fn facts(&self) -> &'static FormatFacts {
        FACTS
    }

    fn suits(&self, kind: ShapeKind, _: &Attachments, options: &Values) -> Result<(), Fault> {
        match kind {
            ShapeKind::Mesh if options.unusual().any(|(name, _)| name == "show") => {
                Err(Fault::new("/show", "of a mesh only its sections are drawn; leave it out"))
            }
            ShapeKind::Mesh => options::opaque(options),
            ShapeKind::Curves { .. } if asked(options) => {
                Err(Fault::new("/sections", "planes cut meshes, curves have no sections; leave it out"))
            }
            ShapeKind::Curves { .. } => options::shows_only(&["control", "points", "curve"], kind, options),
        }
    }

    /// A point costs at most 51 bytes in the curve (when each segment is a path of its own), 51 in the control polygon
    /// and 49 as a disc. Each triangle gives a segment of a section at most, two points.
    fn size(&self, counts: &Counts, options: &Values) -> Size {
        let points = match counts.kind {
            ShapeKind::Mesh => {
                let planes = options.groups(SECTIONS.name).len() as u128;
                planes.saturating_mul(counts.triangles().saturating_mul(2).saturating_add(1))
            }
            ShapeKind::Curves { .. } => counts.vertices.saturating_add(counts.control).saturating_add(counts.polygons),
        };
        Size::AtMost(points.saturating_mul(160).saturating_add(2048))
    }

    fn side_px(&self, outline: &Outline, frame: Frame, options: &Values) -> Option<f64> {
        Some(outline::side_px(outline, &Options::new(options, frame)))
    }

    fn write(&self, scene: &Scene<'_>, values: &Values, out: &mut dyn Write, watch: &Watch) -> Result<(), FormatError> {
        if let Shape::Curves(curves) = scene.shape {
            let dimension = curves.iter().map(|c| c.dimension).max().unwrap_or(1);
            options::drawable(ShapeKind::Curves { dimension }).map_err(FormatError::Unfit)?;
        }
        options::check_extent(scene)?;
        let options = Options::new(values, scene.frame);
        let drawing = match scene.shape {
            Shape::Mesh(mesh) => sections::drawing(mesh, &planes(values), &options, watch)?,
            Shape::Curves(_) => Drawing::of(scene, &options, watch)?,
        };
        let mut page = Page { text: String::new(), out };
        page.head(&drawing)?;
        for item in &drawing.items {
            watch.check()?;
            page.item(item, watch)?;
        }
        page.text.push_str("</svg>\n");
        page.flush()?;
        Ok(())
    }
}

/// Text on its way out.
struct Page<'a> {
    text: String,
    out: &'a mut dyn Write,
}

impl Page<'_> {
    fn flush(&mut self) -> io::Result<()> {
        self.out.write_all(self.text.as_bytes())?;
        self.text.clear();
        Ok(())
    }

    fn head(&mut self, drawing: &Drawing) -> io::Result<()> {
        let [width, height] = drawing.size;
        let view = format!("width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\"");
        writeln!(self.out, "<svg xmlns=\"http://www.w3.org/2000/svg\" {view}>")?;
        if drawing.background[3] > 0 {
            self.text += "<rect width=\"100%\" height=\"100%\"";
            self.color("fill", drawing.background);
            self.text += "/>\n";
        }
        self.flush()
    }

    fn item(&mut self, item: &Item, watch: &Watch) -> Result<(), FormatError> {
        match item {
            Item::Lines { runs, width_px, color } => {
                self.text += "<g fill=\"none\" stroke-linejoin=\"round\" stroke-linecap=\"round\"";
                self.color("stroke", *color);
                self.number(" stroke-width=\"", *width_px);
                self.text += "\">\n";
                for run in runs {
                    watch.check()?;
                    self.path(run)?;
                }
            }
            Item::Discs { centres, radius_px, ring_px, color, ring } => {
                self.text += "<g";
                self.color("fill", *color);
                self.color("stroke", *ring);
                self.number(" stroke-width=\"", *ring_px);
                self.text += "\">\n";
                for [x, y] in centres {
                    self.number("<circle cx=\"", *x);
                    self.number("\" cy=\"", *y);
                    self.number("\" r=\"", radius_px - 0.5 * ring_px);
                    self.text += "\"/>\n";
                    if self.text.len() > 65_536 {
                        watch.check()?;
                        self.flush()?;
                    }
                }
            }
        }
        self.text += "</g>\n";
        self.flush()?;
        Ok(())
    }

    fn path(&mut self, run: &[[f32; 2]]) -> io::Result<()> {
        for (i, [x, y]) in run.iter().enumerate() {
            let before = match i {
                0 => "<path d=\"M",
                1 => "L",
                _ => " ",
            };
            self.number(before, *x);
            self.number(" ", *y);
        }
        self.text += "\"/>\n";
        self.flush()
    }

    fn color(&mut self, name: &str, [r, g, b, a]: [u8; 4]) {
        for part in [" ", name, "=\"#"] {
            self.text.push_str(part);
        }
        for digit in [r >> 4, r & 15, g >> 4, g & 15, b >> 4, b & 15] {
            self.text.push(char::from(b"0123456789abcdef"[usize::from(digit)]));
        }
        self.text.push('"');
        if a < 255 {
            self.number(&format!(" {name}-opacity=\""), f32::from(a) / 255.0);
            self.text.push('"');
        }
    }

    /// Writes `before`, then the value to the nearest hundredth without needless digits.
    fn number(&mut self, before: &str, value: f32) {
        self.text.push_str(before);
        let scaled = f64::from(value) * 100.0;
        #[expect(clippy::cast_possible_truncation, reason = "places lie within some thousand pixels")]
        let hundredths = (scaled + if scaled < 0.0 { -0.5 } else { 0.5 }) as i64;
        if hundredths < 0 {
            self.text.push('-');
        }
        let (whole, rest) = (hundredths.unsigned_abs() / 100, hundredths.unsigned_abs() % 100);
        self.text.push_str(itoa::Buffer::new().format(whole));
        if rest > 0 {
            self.text.push('.');
            self.text.push(char::from(b'0' + u8::try_from(rest / 10).expect("a digit")));
            if rest % 10 > 0 {
                self.text.push(char::from(b'0' + u8::try_from(rest % 10).expect("a digit")));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_hundredths_and_no_needless_digits() {
        let mut out = Vec::new();
        let mut page = Page { text: String::new(), out: &mut out };
        for value in [0.0, 0.004, 1.5, -0.25, 10.05, -2048.996, 8192.0] {
            page.number(" ", value);
        }
        assert_eq!(page.text, " 0 0 1.5 -0.25 10.05 -2049 8192");
    }
}
