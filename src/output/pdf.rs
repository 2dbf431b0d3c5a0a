//! PDF: a drawing of curves, or of sections of a mesh, as a page.

use std::io::Write;

use crate::drawing::pdf;
use crate::fault::Fault;
use crate::math::parameter::Values;
use crate::output::counts::{Counts, ShapeKind};
use crate::output::error::FormatError;
use crate::output::format::{Content, Format, FormatFacts};
use crate::output::picture::vector;
use crate::output::scene::Scene;
use crate::output::size::Size;
use crate::shape::attachments::Attachments;
use crate::watch::Watch;

/// The format "pdf".
#[derive(Debug, Clone, Copy)]
pub(super) struct Pdf;

const FACTS: &FormatFacts = &FormatFacts {
    name: "pdf",
    extension: "pdf",
    media_type: "application/pdf",
    content: Content::Packed,
    doc: "The drawing of \"svg\" as a page, as LaTeX wants it.",
    parameters: vector::PARAMETERS,
    holds_frames: false,
    holds: vector::holds,
};

impl Format for Pdf {
    fn facts(&self) -> &'static FormatFacts {
        FACTS
    }

    fn suits(&self, kind: ShapeKind, _: &Attachments, options: &Values) -> Result<(), Fault> {
        vector::suits(kind, options)
    }

    fn size(&self, counts: &Counts, options: &Values) -> Size {
        vector::size(counts, options)
    }

    fn write(&self, scene: &Scene<'_>, values: &Values, out: &mut dyn Write, watch: &Watch) -> Result<(), FormatError> {
        pdf(&vector::draw(scene, values, watch)?, vector::lettering(values), out, watch)?;
        Ok(())
    }
}
