//! The view that writers have of a refined net: a source of vertices and faces, chunk by chunk, in the documented
//! order.

use std::borrow::Cow;
use std::fmt;
use std::mem;
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use crate::math::parameter::Values;
use crate::scheme::plan::Plan;
pub use crate::shape::coordinate_system::CoordinateSystem;
use crate::shape::labels::Labels;
use crate::shape::mesh::Mesh;
pub use crate::shape::source::{Curve, FaceChunk, MeshSource, OnDemandSource, Origin};
use crate::shape::weights::Weights;
use crate::watch::{Stopped, Watch};

/// Maximum number of rows in a chunk; writers request ranges no longer than this.
pub const ROWS_PER_CHUNK: usize = 65_536;

/// Everything that a writer may draw or write.
#[derive(Debug, Clone, Copy)]
pub struct Scene<'a> {
    /// The refined shape.
    pub shape: Shape<'a>,
    /// The shape as it was given, for overlays.
    pub control: &'a dyn Control,
    /// Warnings about the result for the client, in sentences.
    pub warnings: &'a [String],
    /// The unit and the up axis of coordinates.
    pub coordinate_system: CoordinateSystem,
    /// Warnings that writers add while they write.
    pub notes: &'a Notes,
    /// The weights by which points are made, for formats that write them.
    pub weights: Option<&'a Weights>,
    /// The shape at the levels to whose results the writer refers, the coarsest first.
    pub details: &'a [Detail<'a>],
}

/// Sentences that a writer adds to the warnings of a result.
#[derive(Debug, Default)]
pub struct Notes(Mutex<Vec<String>>);

impl Notes {
    /// Adds a sentence.
    pub fn add(&self, sentence: String) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push(sentence);
    }

    /// Removes and returns the sentences, in the order in which they were added.
    pub fn take(&self) -> Vec<String> {
        mem::take(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// A shape at some level, whose result is a separate artifact.
#[derive(Debug, Clone)]
pub struct Detail<'a> {
    /// The shape.
    pub shape: Shape<'a>,
    /// The options of its result, which may have other defaults than those of the document that refers to it.
    pub options: &'a Values,
    /// The URI of its result, relative to the document that refers to it.
    pub uri: String,
}

/// The shape as it was given, made when a writer requests it.
pub trait Control: fmt::Debug + Sync {
    /// Returns the shape.
    fn shape(&self) -> Shape<'_>;

    /// Returns the shape from which distances are measured: this one, unless the job names another.
    fn measured_from(&self) -> Shape<'_> {
        self.shape()
    }

    /// Returns the mesh of the input with its tags, if the input is a mesh.
    fn mesh(&self) -> Option<&Mesh> {
        None
    }

    /// Returns the plan that refines the mesh.
    fn plan(&self) -> Option<&Plan> {
        None
    }
}

impl Control for Shape<'_> {
    fn shape(&self) -> Shape<'_> {
        *self
    }
}

/// Curves or a mesh.
#[derive(Debug, Clone, Copy)]
pub enum Shape<'a> {
    /// Polygons, one after another.
    Curves(&'a [Curve]),
    /// A mesh of polygons.
    Mesh(&'a dyn MeshSource),
}

/// Returns the triangles of a polygon: quads are cut along the diagonal from corner 0 to 2, larger faces as a fan from
/// corner 0.
pub fn triangles(face: &[u32]) -> impl Iterator<Item = [u32; 3]> + '_ {
    face.windows(2).skip(1).map(|pair| [face[0], pair[0], pair[1]])
}

/// Returns consecutive ranges that cover `0..n`; `end` maps the start of a range to its end, which must be greater.
pub fn ranges(n: usize, end: impl Fn(usize) -> usize) -> impl Iterator<Item = Range<usize>> {
    let mut at = 0;
    std::iter::from_fn(move || {
        let start = at;
        at = if start < n { end(start).min(n) } else { n };
        (start < n).then_some(start..at)
    })
}

/// Returns the positions of all vertices: borrowed if the mesh holds them, otherwise read at once.
///
/// # Errors
/// [`Stopped`] when the watch says so.
pub fn positions<'a>(mesh: &'a dyn MeshSource, watch: &Watch) -> Result<Cow<'a, [[f64; 3]]>, Stopped> {
    if let Some(held) = mesh.held_positions() {
        return Ok(held.into());
    }
    let mut all = Vec::with_capacity(mesh.n_vertices());
    let mut chunk = Vec::new();
    in_chunks(mesh.n_vertices(), |range| {
        watch.check()?;
        mesh.positions(range, &mut chunk);
        all.extend_from_slice(&chunk);
        Ok(())
    })?;
    Ok(all.into())
}

/// Calls `each` with the vertices of every shown face, one after another.
///
/// # Errors
/// [`Stopped`] when the watch says so.
pub fn each_face(mesh: &dyn MeshSource, watch: &Watch, mut each: impl FnMut(&[u32])) -> Result<(), Stopped> {
    each_chunk(mesh, watch, |_, chunk| chunk.iter().for_each(&mut each))
}

/// Visits all faces, some thousand at a time, with their indices.
///
/// # Errors
/// A stopped watch.
pub(super) fn each_chunk(
    mesh: &dyn MeshSource,
    watch: &Watch,
    mut each: impl FnMut(Range<usize>, &FaceChunk),
) -> Result<(), Stopped> {
    let mut chunk = FaceChunk::default();
    in_chunks(mesh.n_faces(), |range| {
        watch.check()?;
        mesh.faces(range.clone(), &mut chunk);
        each(range, &chunk);
        Ok(())
    })
}

/// Calls `each` with consecutive ranges of at most [`ROWS_PER_CHUNK`] that cover `0..n`.
///
/// # Errors
/// The first error of `each`.
pub fn in_chunks<E>(n: usize, mut each: impl FnMut(Range<usize>) -> Result<(), E>) -> Result<(), E> {
    (0..n).step_by(ROWS_PER_CHUNK).try_for_each(|start| each(start..n.min(start + ROWS_PER_CHUNK)))
}

/// Returns for each name the ranges of shown faces that have it, none of them empty.
pub(super) fn labelled_ranges(mesh: &dyn MeshSource, labels: &Labels) -> Vec<Vec<Range<usize>>> {
    let mut ranges = vec![Vec::new(); labels.names.len()];
    for face in 0..mesh.input_cells()[2] {
        let label = u32::try_from(face).ok().and_then(|face| labels.number(face));
        let range = mesh.faces_of(face);
        if let Some(label) = label.filter(|_| !range.is_empty()) {
            ranges[label].push(range);
        }
    }
    ranges
}
