//! Morph targets of glTF: displacements of the vertices of a mesh from the first frame to its other frames.

use std::ops::Range;

use rayon::prelude::*;

use crate::kept::Kept;
use crate::output::bounds::CoordinateBounds;
use crate::output::bytes::Bytes;
use crate::output::error::FormatError;
use crate::output::normals;
use crate::output::numbers::rounded;
use crate::output::positions::Positions;
use crate::output::scene::{MeshSource, ROWS_PER_CHUNK, Shape};
use crate::output::stream::Stream;
use crate::output::vertex_sides::SplitSides;
use crate::watch::{Stopped, Watch};

/// A frame of a mesh after the first, with its vertices split as those of the first.
pub(super) struct MorphTarget<'a> {
    mesh: &'a dyn MeshSource,
    /// The mesh with whole vertices, if seams split those of `mesh`.
    smooth: Option<&'a dyn MeshSource>,
    positions: Positions<'a>,
    /// The box around all displacements, each of which is an f32.
    pub(super) bounds: CoordinateBounds<3>,
}

/// Returns the displacement to add to a position stored as an f32: `to - f32(from)`, rounded to f32 once.
fn displacement(from: [f64; 3], to: [f64; 3], center: [f64; 3]) -> [f32; 3] {
    [0, 1, 2].map(|k| rounded((to[k] - center[k]) - f64::from(rounded(from[k] - center[k]))) + 0.0)
}

/// Encodes the displacements of rows.
fn encode(
    from: impl Iterator<Item = [f64; 3]>,
    to: impl ExactSizeIterator<Item = [f64; 3]>,
    center: [f64; 3],
    out: &mut Bytes,
) {
    for ((slot, from), to) in out.rows::<12>(to.len()).iter_mut().zip(from).zip(to) {
        slot.copy_from_slice(displacement(from, to, center).map(f32::to_le_bytes).as_flattened());
    }
}

impl<'a> MorphTarget<'a> {
    /// Returns the target of a frame, given the positions of the first frame and the offset subtracted from stored
    /// positions, model units.
    ///
    /// # Errors
    /// Displacements that f32 cannot hold, or a stopped watch.
    pub(super) fn of(
        sides: &'a SplitSides<'a>,
        from: &[[f64; 3]],
        center: [f64; 3],
        watch: &Watch,
    ) -> Result<Option<Self>, FormatError> {
        let Shape::Mesh(mesh) = sides.shape() else { return Ok(None) };
        let positions = Positions::of_mesh(mesh).held(watch)?;
        let block = |range: Range<usize>| {
            watch.check()?;
            let mut bounds = CoordinateBounds::EMPTY;
            for (&from, &to) in from[range.clone()].iter().zip(&positions.rows()[range]) {
                bounds.add(&[displacement(from, to, center).map(f64::from)]);
            }
            Ok::<_, Stopped>(bounds)
        };
        let starts: Vec<usize> = (0..from.len()).step_by(ROWS_PER_CHUNK).collect();
        let blocks: Result<Vec<_>, Stopped> =
            starts.into_par_iter().map(|start| block(start..from.len().min(start + ROWS_PER_CHUNK))).collect();
        let bounds = blocks?.iter().fold(CoordinateBounds::EMPTY, CoordinateBounds::joined);
        if !bounds.is_empty() && ![bounds.min, bounds.max].as_flattened().iter().all(|x| x.is_finite()) {
            let most = f32::MAX;
            let detail =
                format!("a frame is farther from the first than {most:e}, the most that glTF holds; ask for obj");
            return Err(FormatError::Unfit(detail));
        }
        Ok(Some(Self { mesh, smooth: sides.smooth(), positions, bounds }))
    }

    /// Writes the displacements of positions.
    pub(super) fn write_positions(
        &self,
        from: &[[f64; 3]],
        center: [f64; 3],
        stream: &mut Stream<'_>,
    ) -> Result<(), FormatError> {
        stream.positions(&self.positions, |start, rows, out| {
            encode(from[start..].iter().copied(), rows.iter().copied(), center, out);
        })
    }

    /// Writes the displacements of normals from those of [`normals_of`] for the first frame.
    pub(super) fn write_normals(&self, from: &[[f64; 3]], stream: &mut Stream<'_>) -> Result<(), FormatError> {
        let to = normals_of(self.mesh, self.smooth, (&self.positions, None), stream.watch)?;
        stream.rows(&to, |start, rows, out| {
            let from = from[start..].iter().copied().map(normals::or_up);
            encode(from, rows.iter().copied().map(normals::or_up), [0.0; 3], out);
        })
    }
}

/// Returns the unit normals of all vertices of a mesh with these positions, zero where they are undefined; if seams
/// split vertices, those of the whole vertices. The box around the positions is given if it is known.
///
/// # Errors
/// Positions that f32 cannot hold, or a stopped watch.
pub(super) fn normals_of(
    mesh: &dyn MeshSource,
    smooth: Option<&dyn MeshSource>,
    (positions, bounds): (&Positions<'_>, Option<&CoordinateBounds<3>>),
    watch: &Watch,
) -> Result<Kept<[f64; 3]>, FormatError> {
    Ok(match smooth {
        None => normals::of_within(mesh, positions.rows(), bounds, watch)?,
        Some(smooth) => {
            let positions = Positions::of_mesh(smooth).held(watch)?;
            normals::split_vertices(mesh, smooth, positions.rows(), watch)?
        }
    })
}
