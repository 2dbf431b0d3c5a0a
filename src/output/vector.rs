//! SVG and PDF: one drawing of curves, of a mesh or of its sections, as paths or as a page.

use crate::drawing::{pdf, svg};
use crate::fault::Fault;
use crate::math::parameter::Values;
use crate::output::counts::{Counts, ShapeKind};
use crate::output::description::DescriptionPlace;
use crate::output::error::FormatError;
use crate::output::format::{Content, Costs, Format, FormatFacts, Paper, Requirements};
use crate::output::hard_edges;
use crate::output::options::ISOLINES;
use crate::output::picture::drawing::CURVE_ITEMS;
use crate::output::picture::hidden_lines::{self, MESH_ITEMS};
use crate::output::picture::options;
use crate::output::picture::plot::{self, TITLE};
use crate::output::picture::{framing, vector};
use crate::output::scene::Scene;
use crate::output::sections::{SECTIONS, asked};
use crate::output::size::Size;
use crate::output::stream::Stream;
use crate::shape::attachments::Attachments;
use crate::shape::mesh::Mesh;

/// A format of drawings; these formats differ only in how a drawing is written.
#[derive(Debug, Clone, Copy)]
pub(super) struct VectorFormat {
    facts: &'static FormatFacts,
}

/// The format "svg".
pub(super) const SVG: VectorFormat = VectorFormat { facts: SVG_FACTS };
/// The format "pdf".
pub(super) const PDF: VectorFormat = VectorFormat { facts: PDF_FACTS };

const SVG_FACTS: &FormatFacts = &FormatFacts {
    name: "svg",
    extension: "svg",
    media_type: "image/svg+xml",
    content: Content::Text,
    doc: "A drawing in paths that scale: of curves with their control polygons, of a mesh without its hidden lines, or \
          of plane sections of a mesh.",
    parameters: vector::VECTOR_OPTIONS,
    description: Some(DescriptionPlace::Svg),
    paper: Some(Paper::Svg),
    holds: |kind, _| options::drawable(kind),
    ..FormatFacts::USUAL
};

const PDF_FACTS: &FormatFacts = &FormatFacts {
    name: "pdf",
    extension: "pdf",
    media_type: "application/pdf",
    content: Content::Packed,
    doc: "The drawing of \"svg\" as a page, as LaTeX wants it.",
    parameters: vector::VECTOR_OPTIONS,
    paper: Some(Paper::Pdf),
    holds: |kind, _| options::drawable(kind),
    ..FormatFacts::USUAL
};

impl Format for VectorFormat {
    fn facts(&self) -> &'static FormatFacts {
        self.facts
    }

    fn encode(&self, scene: &Scene<'_>, values: &Values, stream: &mut Stream<'_>) -> Result<(), FormatError> {
        let Stream { out, watch, .. } = stream;
        let (drawing, lettering) = (vector::draw(scene, values, watch)?, vector::lettering(values));
        if self.facts.paper == Some(Paper::Pdf) {
            pdf(&drawing, lettering, out, watch)?;
        } else {
            svg(&drawing, lettering, out, watch)?;
        }
        Ok(())
    }
}

impl Requirements for VectorFormat {
    fn suits(&self, kind: ShapeKind, _: &Attachments, options: &Values) -> Result<(), Fault> {
        if !asked(options) {
            framing::check(kind, options)?;
        }
        plot::check(kind, options)?;
        match kind {
            ShapeKind::Mesh if asked(options) && options.unusual().any(|(name, _)| name == "show") => {
                Err(Fault::new("/show", "only the sections are drawn; leave it out, or the sections"))
            }
            ShapeKind::Mesh => options::shows_only(MESH_ITEMS, kind, options),
            ShapeKind::Curves { .. } if asked(options) => {
                Err(Fault::new("/sections", "planes cut meshes, curves have no sections; leave it out"))
            }
            ShapeKind::Curves { .. } => options::shows_only(CURVE_ITEMS, kind, options),
        }
    }

    fn fits(&self, counts: &Counts, options: &Values) -> Result<(), Fault> {
        if is_lines(counts, options) { hidden_lines::fits(counts) } else { Ok(()) }
    }

    fn refers(&self, options: &Values) -> Option<&'static str> {
        options.has("show", ISOLINES).then_some(ISOLINES)
    }
}

impl Costs for VectorFormat {
    /// Returns the maximum number of bytes of a drawing in lines.
    ///
    /// A point costs at most 51 bytes in the curve (when each segment is a path of its own), 51 in the control polygon,
    /// 20 in a filled area, twice 51 in a comb, and 49 as a disc (230 in PDF, which is packed afterwards). Drawings
    /// with letters (at most 70 labels) hold a font of at most a megabyte and some kilobytes besides. A curve with a
    /// style of its own costs 200 bytes more. Each triangle gives at most one segment of a section, which is two points
    /// and is drawn in lines only: 160 bytes are three times as much as a point takes.
    fn size(&self, counts: &Counts, options: &Values) -> Size {
        if is_lines(counts, options) {
            return hidden_lines::size(counts, options);
        }
        let (points, point, curves) = match counts.kind {
            ShapeKind::Mesh => {
                let planes = options.groups(SECTIONS.name).len() as u128;
                (planes.saturating_mul(counts.triangles().saturating_mul(2).saturating_add(1)), 160, planes)
            }
            ShapeKind::Curves { .. } => {
                let points = counts.vertices.saturating_add(counts.control).saturating_add(counts.polygons);
                (points, 560, counts.polygons)
            }
        };
        let plain =
            ["vertices", "comb", "tangents", "axes", "grid", "legend"].iter().all(|item| !options.has("show", item));
        let around = if plain && options.name(TITLE.name).is_none() { 4096 } else { 2 << 20 };
        Size::AtMost(points.saturating_mul(point).saturating_add(curves.saturating_mul(512)).saturating_add(around))
    }

    fn memory(&self, counts: &Counts, options: &Values) -> u128 {
        let lines = if is_lines(counts, options) { hidden_lines::memory(counts, options) } else { 0 };
        lines.saturating_add(hard_edges::memory(counts, options))
    }

    fn work(&self, _: Option<&Mesh>, counts: &Counts, options: &Values) -> u128 {
        if is_lines(counts, options) { hidden_lines::work(counts) } else { 0 }
    }
}

/// Returns whether a mesh is drawn in lines without those hidden by its faces.
fn is_lines(counts: &Counts, options: &Values) -> bool {
    counts.kind == ShapeKind::Mesh && !asked(options)
}
