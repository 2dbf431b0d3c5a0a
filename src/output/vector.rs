//! SVG and PDF: one drawing of curves, of a mesh or of its sections, as paths or as a page.

use crate::drawing::{pdf, svg};
use crate::fault::Fault;
use crate::math::parameter::Values;
use crate::output::counts::{Counts, ShapeKind};
use crate::output::description::DescriptionPlace;
use crate::output::error::FormatError;
use crate::output::format::{Content, Costs, Format, FormatFacts, Paper, Requirements};
use crate::output::picture::options::Options;
use crate::output::picture::outline::{self, Outline};
use crate::output::picture::vector;
use crate::output::scene::{CoordinateSystem, Scene};
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
    holds: vector::holds,
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
    holds: vector::holds,
    ..FormatFacts::USUAL
};

impl Format for VectorFormat {
    fn facts(&self) -> &'static FormatFacts {
        self.facts
    }

    fn side_px(&self, outline: &Outline, coordinate_system: CoordinateSystem, options: &Values) -> Option<f64> {
        Some(outline::side_px(outline, &Options::new(options, coordinate_system)))
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
        vector::suits(kind, options)
    }

    fn fits(&self, counts: &Counts, options: &Values) -> Result<(), Fault> {
        vector::fits(counts, options)
    }

    fn refers(&self, options: &Values) -> Option<&'static str> {
        vector::refers(options)
    }
}

impl Costs for VectorFormat {
    fn size(&self, counts: &Counts, options: &Values) -> Size {
        vector::size(counts, options)
    }

    fn memory(&self, counts: &Counts, options: &Values) -> u128 {
        vector::memory(counts, options)
    }

    fn work(&self, _: Option<&Mesh>, counts: &Counts, options: &Values) -> u128 {
        vector::work(counts, options)
    }
}
