//! What every format declares, and what it does.

use std::fmt;
use std::io::Write;

use super::counts::{Counts, ShapeKind};
use super::error::FormatError;
use super::options::IDS;
use super::picture::outline::Outline;
use super::scene::{Frame, Scene};
use super::size::Size;
use crate::fault::Fault;
use crate::math::parameter::{Parameter, Values};
use crate::scheme::plan::Plan;
use crate::shape::attachments::Attachments;
use crate::shape::mesh::Mesh;
use crate::shape::tile::Tile;
use crate::watch::Watch;

/// What a format declares.
#[derive(Debug)]
pub struct FormatFacts {
    /// Name in requests.
    pub name: &'static str,
    /// File extension without the dot.
    pub extension: &'static str,
    /// Media type of the bytes.
    pub media_type: &'static str,
    /// What the bytes are, for the description of the service.
    pub content: Content,
    /// One sentence for the catalogue.
    pub doc: &'static str,
    /// Options that the format knows.
    pub parameters: &'static [Parameter],
    /// What the bytes are made of.
    pub made_of: MadeOf,
    /// Whether the bytes depend on the plan even where none of its levels was applied.
    pub tells_plan: bool,
    /// What pictures of several scenes are put together on, where the format can hold them.
    pub paper: Option<Paper>,
    /// Whether the format holds several frames of a mesh.
    pub holds_frames: bool,
    /// Whether the format holds a mesh but not which of its edges and vertices are sharp.
    pub has_no_tags: bool,
    /// Whether the format can hold what these options make of a shape of this kind; else a sentence that says why not,
    /// and which formats can.
    pub holds: fn(ShapeKind, &Values) -> Result<(), String>,
}

impl FormatFacts {
    /// The facts of a format that says nothing else; its name, extension, media type and documentation are still to be
    /// given.
    pub const USUAL: Self = Self {
        name: "",
        extension: "",
        media_type: "",
        content: Content::Binary,
        doc: "",
        parameters: &[],
        made_of: MadeOf::Points,
        tells_plan: false,
        paper: None,
        holds_frames: false,
        has_no_tags: false,
        holds: |_, _| Ok(()),
    };
}

/// What the bytes of a format are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Content {
    /// A JSON object.
    Json,
    /// Text that is no JSON, whatever the options.
    Text,
    /// Other bytes.
    Binary,
    /// Bytes that the format has compressed.
    Packed,
}

/// What the bytes of a format are made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MadeOf {
    /// The points of a level.
    Points,
    /// The input and its limit surface under a plan, whatever the number of levels.
    Limit,
    /// The weights by which points are made; nothing is refined for them.
    Weights,
}

/// What pictures are put together on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Paper {
    /// Pixels.
    Png,
    /// Lines and pixels, as SVG.
    Svg,
    /// Lines and pixels, as PDF.
    Pdf,
}

/// Results that other bytes refer to: the same shape at some levels.
#[derive(Debug)]
pub struct Details {
    /// The format of these results.
    pub format: &'static dyn Format,
    /// The option that asks for them.
    pub option: &'static str,
    /// Levels, in ascending order, the last of which is that of the job.
    pub levels: Vec<u32>,
}

/// Values of a parameter of a plan, one a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    /// The place of the parameter in the job.
    pub pointer: String,
    /// Its values.
    pub values: Vec<f64>,
}

/// A way to write a scene as bytes: what it declares, what it asks of a job, what it costs, and the writing itself.
pub trait Format: Requirements + Costs + fmt::Debug + Send + Sync {
    /// Returns what the format declares.
    fn facts(&self) -> &'static FormatFacts;

    /// Returns the kinds of face for which the format can write a mesh that is refined while it is written: it asks
    /// for no range of positions twice, and only in the order of the vertices or of the faces.
    fn streams(&self, _mesh: &Mesh, _options: &Values) -> &'static [Tile] {
        &[]
    }

    /// Returns the levels whose results the bytes refer to, and the format of these results, which takes all options
    /// but the one that asks for them.
    fn details(&self, _options: &Values) -> Option<Details> {
        None
    }

    /// Returns the parameter of the plan that changes from frame to frame of a moving picture, if the options name one.
    fn sweep(&self, _options: &Values) -> Option<Sweep> {
        None
    }

    /// Returns the mean length, in pixels, of the edges of an input in the picture; `None` for formats that are no
    /// pictures.
    fn side_px(&self, _outline: &Outline, _frame: Frame, _options: &Values) -> Option<f64> {
        None
    }

    /// Writes the scene.
    ///
    /// # Errors
    /// When the scene cannot be held after all, the writer fails, or the watch says stop.
    fn write(&self, scene: &Scene<'_>, options: &Values, out: &mut dyn Write, watch: &Watch)
    -> Result<(), FormatError>;
}

/// What a format asks of a job before anything is computed, and what it leaves out.
pub trait Requirements {
    /// Checks the options against the kind of shape and what the shape carries.
    ///
    /// # Errors
    /// The fault, with a pointer below the output.
    fn suits(&self, _kind: ShapeKind, _carried: &Attachments, _options: &Values) -> Result<(), Fault> {
        Ok(())
    }

    /// Checks that the format can count what there will be. Whether it can hold the coordinates shows only when they
    /// are computed.
    ///
    /// # Errors
    /// The fault, with a pointer below the output.
    fn fits(&self, _counts: &Counts, _options: &Values) -> Result<(), Fault> {
        Ok(())
    }

    /// Checks that the format can hold what a plan makes of a mesh.
    ///
    /// # Errors
    /// The fault, with a pointer below the output.
    fn admits(&self, _mesh: &Mesh, _plan: &Plan, _options: &Values) -> Result<(), Fault> {
        Ok(())
    }

    /// Returns, in sentences, what the format leaves out of what a mesh carries.
    fn leaves_out(&self, _carried: &Attachments, _options: &Values) -> Vec<String> {
        Vec::new()
    }

    /// Returns the option that refers to single faces, edges or vertices of the input, if one is set. Schemes that
    /// make faces of their own cannot answer it.
    fn refers(&self, options: &Values) -> Option<&'static str> {
        options.flag(IDS.name).then_some(IDS.name)
    }
}

/// What writing costs, told before anything is computed.
pub trait Costs {
    /// Returns the bytes that shapes of these counts take.
    fn size(&self, counts: &Counts, options: &Values) -> Size;

    /// Returns the bytes of memory that the options cost while the scene is written, beyond those that every result of
    /// such a shape needs.
    fn memory(&self, _counts: &Counts, _options: &Values) -> u128 {
        0
    }

    /// Returns the work beyond refining the shape and encoding its bytes, in rows of a table (100 ns each). `mesh` is
    /// the input, where that is a mesh.
    fn work(&self, _mesh: Option<&Mesh>, _counts: &Counts, _options: &Values) -> u128 {
        0
    }

    /// Tells whether these options have the limit surface built as a solid.
    fn makes_solid(&self, _options: &Values) -> bool {
        false
    }
}

impl dyn Format + '_ {
    /// Name in requests.
    pub fn name(&self) -> &'static str {
        self.facts().name
    }

    /// File extension without the dot.
    pub fn extension(&self) -> &'static str {
        self.facts().extension
    }

    /// Media type of the bytes.
    pub fn media_type(&self) -> &'static str {
        self.facts().media_type
    }

    /// What pictures of several scenes are put together on, where the format can hold them.
    pub fn paper(&self) -> Option<Paper> {
        self.facts().paper
    }

    /// Whether the bytes are made of the input and its limit surface, whatever the number of levels.
    pub fn is_of_limit(&self) -> bool {
        self.facts().made_of == MadeOf::Limit
    }

    /// Whether the bytes tell how points are made, and not where they are: then nothing is refined.
    pub fn is_of_weights(&self) -> bool {
        self.facts().made_of == MadeOf::Weights
    }

    /// Whether the format can hold a shape of this kind, whatever the options.
    ///
    /// # Errors
    /// A sentence that says why not, and which formats can.
    pub fn holds(&self, kind: ShapeKind) -> Result<(), String> {
        (self.facts().holds)(kind, &Values::default())
    }
}
