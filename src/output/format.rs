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
    /// Whether the format holds several frames of a mesh.
    pub holds_frames: bool,
    /// Whether the format can hold what these options make of a shape of this kind; else a sentence that says why not,
    /// and which formats can.
    pub holds: fn(ShapeKind, &Values) -> Result<(), String>,
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

/// A way to write a scene as bytes.
pub trait Format: fmt::Debug + Send + Sync {
    /// What the format declares.
    fn facts(&self) -> &'static FormatFacts;

    /// Whether the options make sense for a shape of this kind that carries this.
    ///
    /// # Errors
    /// The fault, with a pointer below the output.
    fn suits(&self, _kind: ShapeKind, _carried: &Attachments, _options: &Values) -> Result<(), Fault> {
        Ok(())
    }

    /// Whether the format can count what there will be; what coordinates it can hold shows only when they are there.
    ///
    /// # Errors
    /// The fault, with a pointer below the output.
    fn fits(&self, _counts: &Counts, _options: &Values) -> Result<(), Fault> {
        Ok(())
    }

    /// Whether the bytes are made of the input and its limit surface under a plan, whatever the number of levels.
    fn is_of_limit(&self) -> bool {
        false
    }

    /// Whether the bytes tell of the plan, even where none of its levels was applied.
    fn tells_plan(&self) -> bool {
        self.is_of_limit()
    }

    /// Whether the solid of the input is made for these options.
    fn makes_solid(&self, _options: &Values) -> bool {
        self.is_of_limit()
    }

    /// Whether the format can hold what a plan makes of a mesh.
    ///
    /// # Errors
    /// The fault, with a pointer below the output.
    fn admits(&self, _mesh: &Mesh, _plan: &Plan, _options: &Values) -> Result<(), Fault> {
        Ok(())
    }

    /// What the format leaves out of what a mesh carries although it may be missed, as a sentence.
    fn leaves_out(&self, _carried: &Attachments, _options: &Values) -> Option<String> {
        None
    }

    /// Bytes that `counts` will take.
    fn size(&self, counts: &Counts, options: &Values) -> Size;

    /// What the options tell of single faces, edges or vertices of the input, if anything: schemes that make faces of
    /// their own cannot.
    fn refers(&self, options: &Values) -> Option<&'static str> {
        options.flag(IDS.name).then_some(IDS.name)
    }

    /// Bytes of memory that the options cost while the scene is written, besides those that every picture of such a
    /// mesh and its bytes need.
    fn memory(&self, _counts: &Counts, _options: &Values) -> u128 {
        0
    }

    /// Work that the scene takes besides refining it and making its bytes, in rows of a table, 100 ns each; `mesh` is
    /// the input, where that is one.
    fn work(&self, _mesh: Option<&Mesh>, _counts: &Counts, _options: &Values) -> u128 {
        0
    }

    /// The faces of meshes of whose positions none is held, and all are asked for in the order of the vertices or of
    /// the faces: then they can be made while they are written.
    fn streams(&self, _mesh: &Mesh, _options: &Values) -> &'static [Tile] {
        &[]
    }

    /// The levels of refinement whose results the bytes refer to, and the format of these, which takes all options but
    /// the one that asks for them.
    fn details(&self, _options: &Values) -> Option<Details> {
        None
    }

    /// Whether it writes how points are made, and not where they are: then nothing is refined.
    fn weighs(&self) -> bool {
        false
    }

    /// What pictures of several scenes are put together on, if the format can.
    fn paper(&self) -> Option<Paper> {
        None
    }

    /// The parameter of the plan that changes from frame to frame of a moving picture, if the options name one.
    fn sweep(&self, _options: &Values) -> Option<Sweep> {
        None
    }

    /// The mean length of the edges of an input in the picture, pixels; `None` of formats that are no pictures.
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

    /// Whether the format can hold a shape of this kind, whatever the options.
    ///
    /// # Errors
    /// A sentence that says why not, and which formats can.
    pub fn holds(&self, kind: ShapeKind) -> Result<(), String> {
        (self.facts().holds)(kind, &Values::default())
    }
}
