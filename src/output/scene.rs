//! What the writers see of a refined net: a source of vertices and faces, chunk by chunk, in the documented order.

use std::borrow::Cow;
use std::fmt;
use std::mem;
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use crate::math::parameter::Values;
use crate::scheme::plan::Plan;
pub use crate::shape::frame::Frame;
use crate::shape::mesh::Mesh;
pub use crate::shape::source::{Curve, FaceChunk, MeshSource, OnDemandSource, Origin};
use crate::shape::weights::Weights;
use crate::watch::{Stopped, Watch};

/// Rows that one chunk holds at most; writers ask for ranges no longer than this.
pub const CHUNK: usize = 65_536;

/// Everything a writer may draw or write.
#[derive(Debug, Clone, Copy)]
pub struct Scene<'a> {
    /// The refined shape.
    pub shape: Shape<'a>,
    /// The shape as it was given, for overlays.
    pub control: &'a dyn Control,
    /// What the client should know about the result, in sentences.
    pub warnings: &'a [String],
    /// What its coordinates mean.
    pub frame: Frame,
    /// What writers find out that the client should know, too.
    pub notes: &'a Notes,
    /// How points are made, for formats that write that.
    pub weights: Option<&'a Weights>,
    /// The shape at levels whose results the writer refers to, the coarsest first.
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

    /// The sentences, in the order in which they were added; none are left.
    pub fn take(&self) -> Vec<String> {
        mem::take(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// A shape at some level, whose result is found elsewhere.
#[derive(Debug, Clone)]
pub struct Detail<'a> {
    /// The shape.
    pub shape: Shape<'a>,
    /// The options of its result, which may have other defaults than those of the one that refers to it.
    pub options: &'a Values,
    /// Where its result is, relative to the one that refers to it.
    pub uri: String,
}

/// The shape as it was given, made when a writer asks for it.
pub trait Control: fmt::Debug + Sync {
    /// The shape.
    fn shape(&self) -> Shape<'_>;

    /// The shape from which distances are measured: this one, unless the job names another.
    fn measured_from(&self) -> Shape<'_> {
        self.shape()
    }

    /// The mesh of the input with its tags, where it is one.
    fn mesh(&self) -> Option<&Mesh> {
        None
    }

    /// The plan that refines that mesh.
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
    /// One polygon after another.
    Curves(&'a [Curve]),
    /// A mesh of polygons.
    Mesh(&'a dyn MeshSource),
}

/// Triangles of one polygon: quads along the diagonal from corner 0 to 2, larger faces as a fan from corner 0.
pub fn triangles(face: &[u32]) -> impl Iterator<Item = [u32; 3]> + '_ {
    face.windows(2).skip(1).map(|pair| [face[0], pair[0], pair[1]])
}

/// Consecutive ranges that cover `0..n`, each of which ends at `end` of its start, which lies beyond it.
pub fn ranges(n: usize, end: impl Fn(usize) -> usize) -> impl Iterator<Item = Range<usize>> {
    let mut at = 0;
    std::iter::from_fn(move || {
        let start = at;
        at = if start < n { end(start).min(n) } else { n };
        (start < n).then_some(start..at)
    })
}

/// The positions of all vertices: those that the mesh holds, or read at once.
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
    let mut chunk = FaceChunk::default();
    in_chunks(mesh.n_faces(), |range| {
        watch.check()?;
        mesh.faces(range, &mut chunk);
        chunk.iter().for_each(&mut each);
        Ok(())
    })
}

/// Calls `each` with consecutive ranges of at most [`CHUNK`] that cover `0..n`.
///
/// # Errors
/// The first error of `each`.
pub fn in_chunks<E>(n: usize, mut each: impl FnMut(Range<usize>) -> Result<(), E>) -> Result<(), E> {
    (0..n).step_by(CHUNK).try_for_each(|start| each(start..n.min(start + CHUNK)))
}
