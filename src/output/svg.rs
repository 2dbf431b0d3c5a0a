//! SVG: a drawing of curves, or of sections of a mesh, as paths.

use std::io::Write;

use crate::drawing::svg;
use crate::fault::Fault;
use crate::math::parameter::Values;
use crate::output::counts::{Counts, ShapeKind};
use crate::output::error::FormatError;
use crate::output::format::{Content, Format, FormatFacts};
use crate::output::picture::options::Options;
use crate::output::picture::outline::{self, Outline};
use crate::output::picture::vector;
use crate::output::scene::{Frame, Scene};
use crate::output::size::Size;
use crate::shape::attachments::Attachments;
use crate::watch::Watch;

/// The format "svg".
#[derive(Debug, Clone, Copy)]
pub(super) struct Svg;

const FACTS: &FormatFacts = &FormatFacts {
    name: "svg",
    extension: "svg",
    media_type: "image/svg+xml",
    content: Content::Text,
    doc: "A drawing of curves with their control polygons, or of plane sections of a mesh, in paths that scale.",
    parameters: vector::PARAMETERS,
    holds_frames: false,
    holds: vector::holds,
};

impl Format for Svg {
    fn facts(&self) -> &'static FormatFacts {
        FACTS
    }

    fn suits(&self, kind: ShapeKind, _: &Attachments, options: &Values) -> Result<(), Fault> {
        vector::suits(kind, options)
    }

    fn size(&self, counts: &Counts, options: &Values) -> Size {
        vector::size(counts, options)
    }

    fn side_px(&self, outline: &Outline, frame: Frame, options: &Values) -> Option<f64> {
        Some(outline::side_px(outline, &Options::new(options, frame)))
    }

    fn write(&self, scene: &Scene<'_>, values: &Values, out: &mut dyn Write, watch: &Watch) -> Result<(), FormatError> {
        svg(&vector::draw(scene, values, watch)?, vector::lettering(values), out, watch)?;
        Ok(())
    }
}
