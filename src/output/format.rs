//! The traits of formats: what a format declares, requires, costs and writes.

use std::fmt;
use std::io::Write;

use super::counts::{Counts, ShapeKind};
use super::description::DescriptionPlace;
use super::error::FormatError;
use super::options::IDS;
use super::picture::options::Options;
use super::picture::outline::{self, Outline};
use super::scene::{CoordinateSystem, Scene};
use super::size::Size;
use super::solid_options;
use super::stream::Stream;
use crate::fault::Fault;
use crate::math::parameter::{Parameter, Values};
use crate::scheme::plan::Plan;
use crate::shape::attachments::Attachments;
use crate::shape::mesh::Mesh;
use crate::shape::tile::Tile;
use crate::watch::Watch;

/// The declaration of a format.
#[derive(Debug)]
pub struct FormatFacts {
    /// Name in requests.
    pub name: &'static str,
    /// File extension without the dot.
    pub extension: &'static str,
    /// Media type of the bytes.
    pub media_type: &'static str,
    /// Kind of the bytes, for the description of the service.
    pub content: Content,
    /// One sentence for the catalogue.
    pub doc: &'static str,
    /// Options of the format.
    pub parameters: &'static [Parameter],
    /// The data from which the bytes are made.
    pub made_of: MadeOf,
    /// Whether the bytes depend on the plan even if none of its levels was applied.
    pub tells_plan: bool,
    /// The place of the description of a job in the bytes, if they can hold one.
    pub description: Option<DescriptionPlace>,
    /// The kind of figure that can be composed of pictures in this format, if any.
    pub paper: Option<Paper>,
    /// Whether the format holds several frames of a mesh.
    pub holds_frames: bool,
    /// Whether the format holds a mesh but not the sharpness of its edges and vertices.
    pub has_no_tags: bool,
    /// Accepts a shape of this kind under these options, or returns a sentence that says why the format cannot hold it,
    /// and which formats can.
    pub holds: fn(ShapeKind, &Values) -> Result<(), String>,
}

impl FormatFacts {
    /// The default facts of a format, without its name, extension, media type and documentation.
    pub const USUAL: Self = Self {
        name: "",
        extension: "",
        media_type: "",
        content: Content::Binary,
        doc: "",
        parameters: &[],
        made_of: MadeOf::Points,
        tells_plan: false,
        description: None,
        paper: None,
        holds_frames: false,
        has_no_tags: false,
        holds: |_, _| Ok(()),
    };
}

/// The kind of the bytes of a format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Content {
    /// A JSON object.
    Json,
    /// Text that is not JSON, whatever the options.
    Text,
    /// Other bytes.
    Binary,
    /// Bytes that the format has compressed.
    Packed,
}

/// The data from which the bytes of a format are made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MadeOf {
    /// The points of a level.
    Points,
    /// The input and its limit surface under a plan, whatever the number of levels.
    Limit,
    /// The weights by which points are made; nothing is refined for them.
    Weights,
}

/// The kinds of figures composed of several pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Paper {
    /// Pixels.
    Png,
    /// Lines and pixels, as SVG.
    Svg,
    /// Lines and pixels, as PDF.
    Pdf,
}

/// Results to which other bytes refer: the same shape at several levels.
#[derive(Debug)]
pub struct Details {
    /// The format of these results.
    pub format: &'static dyn Format,
    /// The option that requests them.
    pub option: &'static str,
    /// Levels, in ascending order; the last one is that of the job.
    pub levels: Vec<u32>,
}

/// Values of a parameter of a plan, one a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterRange {
    /// The JSON pointer of the parameter in the job.
    pub pointer: String,
    /// The values of the parameter.
    pub values: Vec<f64>,
}

/// A way to write a scene as bytes: its declaration, its requirements of a job, its costs, and the writing itself.
pub trait Format: Costs + fmt::Debug + Send + Sync {
    /// Returns the declaration of the format.
    fn facts(&self) -> &'static FormatFacts;

    /// Returns the kinds of face for which the format can write a mesh while it is refined: the format reads no range
    /// of positions twice, and ranges only in the order of the vertices or of the faces.
    fn streams(&self, _mesh: &Mesh, _options: &Values) -> &'static [Tile] {
        &[]
    }

    /// Returns the levels to whose results the bytes refer, and the format of these results, which takes all options
    /// but the one that requests them.
    fn details(&self, _options: &Values) -> Option<Details> {
        None
    }

    /// Returns the parameter of the plan that changes from frame to frame of a moving picture, if the options name one.
    fn parameter_range(&self, _options: &Values) -> Option<ParameterRange> {
        None
    }

    /// Returns the mean length, in pixels, of the edges of an input in the picture; `None` for formats that are not
    /// pictures.
    fn side_px(&self, outline: &Outline, coordinate_system: CoordinateSystem, options: &Values) -> Option<f64> {
        self.facts().paper.map(|_| outline::side_px(outline, &Options::new(options, coordinate_system)))
    }

    /// Writes the scene.
    ///
    /// # Errors
    /// If the scene cannot be held after all, the writer fails, or the watch says stop.
    fn encode(&self, scene: &Scene<'_>, options: &Values, stream: &mut Stream<'_>) -> Result<(), FormatError>;
}

/// The requirements of a format, checked before anything is computed, and what the format leaves out.
pub trait Requirements {
    /// Checks the options against the kind of shape and its attachments.
    ///
    /// # Errors
    /// The fault, with a pointer below the output.
    fn suits(&self, _kind: ShapeKind, _carried: &Attachments, _options: &Values) -> Result<(), Fault> {
        Ok(())
    }

    /// Checks that the counts of the result are within the limits of the format. Coordinates are checked only when they
    /// are computed.
    ///
    /// # Errors
    /// The fault, with a pointer below the output.
    fn fits(&self, _counts: &Counts, _options: &Values) -> Result<(), Fault> {
        Ok(())
    }

    /// Checks that the format can hold the result of a plan on a mesh.
    ///
    /// # Errors
    /// The fault, with a pointer below the output.
    fn admits(&self, mesh: &Mesh, plan: &Plan, options: &Values) -> Result<(), Fault> {
        if self.makes_solid(options) { solid_options::admits(mesh, plan, options) } else { Ok(()) }
    }

    /// Returns whether these options require the limit surface as a solid.
    fn makes_solid(&self, _options: &Values) -> bool {
        false
    }

    /// Returns sentences about the attachments of a mesh that the format leaves out.
    fn leaves_out(&self, _carried: &Attachments, _options: &Values) -> Vec<String> {
        Vec::new()
    }

    /// Returns the option that refers to single faces, edges or vertices of the input, if one is set. Schemes that make
    /// new faces independent of these do not support such options.
    fn refers(&self, options: &Values) -> Option<&'static str> {
        options.flag(IDS.name).then_some(IDS.name)
    }
}

/// The costs of writing, forecast before anything is computed.
pub trait Costs: Requirements {
    /// Returns the size of the bytes for shapes of these counts.
    fn size(&self, counts: &Counts, options: &Values) -> Size;

    /// Returns the memory in bytes that the options cost while the scene is written, beyond what every result of such a
    /// shape needs.
    fn memory(&self, counts: &Counts, options: &Values) -> u128 {
        if self.makes_solid(options) { solid_options::forecast(counts, options).bytes() } else { 0 }
    }

    /// Returns the work beyond refining the shape and encoding its bytes, in rows of a table (100 ns each). `mesh` is
    /// the input, if it is a mesh.
    fn work(&self, mesh: Option<&Mesh>, _counts: &Counts, options: &Values) -> u128 {
        if self.makes_solid(options) { solid_options::work(mesh, options) } else { 0 }
    }
}

impl dyn Format + '_ {
    /// Writes the scene to `out`, as [`Format::encode`] does.
    ///
    /// # Errors
    /// If the scene cannot be held after all, the writer fails, or the watch says stop.
    pub fn write(
        &self,
        scene: &Scene<'_>,
        options: &Values,
        out: &mut dyn Write,
        watch: &Watch,
    ) -> Result<(), FormatError> {
        self.encode(scene, options, &mut Stream::new(out, watch))
    }

    /// Returns the name in requests.
    pub fn name(&self) -> &'static str {
        self.facts().name
    }

    /// Returns the file extension without the dot.
    pub fn extension(&self) -> &'static str {
        self.facts().extension
    }

    /// Returns the media type of the bytes.
    pub fn media_type(&self) -> &'static str {
        self.facts().media_type
    }

    /// Returns the kind of figure that can be composed of pictures in this format, if any.
    pub fn paper(&self) -> Option<Paper> {
        self.facts().paper
    }

    /// Returns whether the bytes are made of the input and its limit surface, whatever the number of levels.
    pub fn is_of_limit(&self) -> bool {
        self.facts().made_of == MadeOf::Limit
    }

    /// Returns whether the bytes are the weights of points and not the points; then nothing is refined.
    pub fn is_of_weights(&self) -> bool {
        self.facts().made_of == MadeOf::Weights
    }

    /// Checks that the format can hold a shape of this kind, whatever the options.
    ///
    /// # Errors
    /// A sentence that says why not, and which formats can.
    pub fn holds(&self, kind: ShapeKind) -> Result<(), String> {
        (self.facts().holds)(kind, &Values::default())
    }
}
