//! Positions of vertices for writers: block by block, with coordinates that are known to fit the format.

use std::borrow::Cow;
use std::ops::Range;

use rayon::prelude::*;

use crate::output::bounds::CoordinateBounds;
use crate::output::error::FormatError;
use crate::output::scene::{Curve, MeshSource, ROWS_PER_CHUNK, in_chunks, ranges};
use crate::watch::Watch;

/// A source of positions of vertices, and the largest coordinate allowed.
pub(super) struct Positions<'a> {
    source: PositionSource<'a>,
    largest: f64,
    /// Whether all coordinates are known to fit.
    is_checked: bool,
}

enum PositionSource<'a> {
    Mesh(&'a dyn MeshSource),
    Curve(&'a Curve),
    Held(Cow<'a, [[f64; 3]]>),
}

impl<'a> Positions<'a> {
    /// Reads the vertices of a mesh; they are fetched on each use unless the mesh holds them in order.
    pub(super) fn of_mesh(mesh: &'a dyn MeshSource) -> Self {
        let held = mesh.held_positions().map(|rows| PositionSource::Held(rows.into()));
        Self { source: held.unwrap_or(PositionSource::Mesh(mesh)), largest: f64::MAX, is_checked: false }
    }

    /// Reads the points of a polygon with at most three coordinates; missing coordinates are zero.
    pub(super) fn of_curve(curve: &'a Curve) -> Self {
        Self { source: PositionSource::Curve(curve), largest: f64::MAX, is_checked: false }
    }

    /// Restricts coordinates to the range of f32.
    pub(super) fn within_f32(self) -> Self {
        Self { largest: f64::from(f32::MAX), is_checked: false, ..self }
    }

    /// Reads all positions into memory, and refuses coordinates that do not fit.
    pub(super) fn held(self, watch: &Watch) -> Result<Self, FormatError> {
        if let PositionSource::Held(rows) = &self.source {
            let check = |(i, rows): (usize, &[[f64; 3]])| {
                watch.check()?;
                self.check(i * ROWS_PER_CHUNK, rows)
            };
            let unfit = rows.par_chunks(ROWS_PER_CHUNK).enumerate().map(check).find_first(Result::is_err);
            return unfit.unwrap_or(Ok(())).map(|()| Self { is_checked: true, ..self });
        }
        let (mut rows, mut buffer) = (Vec::with_capacity(self.len()), Vec::new());
        in_chunks(self.len(), |range| {
            watch.check()?;
            rows.extend_from_slice(self.rows_in(range, &mut buffer)?);
            Ok::<_, FormatError>(())
        })?;
        Ok(Self { source: PositionSource::Held(rows.into()), is_checked: true, ..self })
    }

    /// Returns the positions in memory: all after [`Positions::held`], otherwise possibly none.
    pub(super) fn rows(&self) -> &[[f64; 3]] {
        if let PositionSource::Held(rows) = &self.source { rows } else { &[] }
    }

    /// Returns the number of vertices.
    pub(super) fn len(&self) -> usize {
        match &self.source {
            PositionSource::Mesh(mesh) => mesh.n_vertices(),
            PositionSource::Curve(curve) => curve.len(),
            PositionSource::Held(rows) => rows.len(),
        }
    }

    /// Returns consecutive ranges that cover all vertices: of `rows` each, or as given by a mesh that makes them on
    /// demand.
    pub(super) fn ranges(&self, rows: usize) -> impl Iterator<Item = Range<usize>> {
        let (n, on_demand) =
            (self.len(), if let PositionSource::Mesh(mesh) = &self.source { mesh.on_demand() } else { None });
        ranges(n, move |start| on_demand.map_or(start + rows, |source| source.stretch(start)))
    }

    /// Returns the box around all positions.
    pub(super) fn bounds(&self, watch: &Watch) -> Result<CoordinateBounds<3>, FormatError> {
        let ranges: Vec<Range<usize>> = self.ranges(ROWS_PER_CHUNK).collect();
        let chunk = |buffer: &mut Vec<[f64; 3]>, range: Range<usize>| {
            watch.check()?;
            let mut bounds = CoordinateBounds::EMPTY;
            bounds.add(self.rows_in(range, buffer)?);
            Ok(bounds)
        };
        // collected in order, so that the error names the first position that does not fit
        let chunks: Vec<Result<_, FormatError>> =
            ranges.into_par_iter().map_init(Vec::new, |buffer, range| chunk(buffer, range)).collect();
        chunks.into_iter().try_fold(CoordinateBounds::EMPTY, |all, chunk| Ok(all.joined(&chunk?)))
    }

    /// Returns the positions in `range` and refuses coordinates that do not fit; `buffer` is scratch memory.
    pub(super) fn rows_in<'b>(
        &'b self,
        range: Range<usize>,
        buffer: &'b mut Vec<[f64; 3]>,
    ) -> Result<&'b [[f64; 3]], FormatError> {
        let rows = self.fetch(range.clone(), buffer);
        self.check(range.start, rows)?;
        Ok(rows)
    }

    fn fetch<'b>(&'b self, range: Range<usize>, buffer: &'b mut Vec<[f64; 3]>) -> &'b [[f64; 3]] {
        match &self.source {
            PositionSource::Held(rows) => return &rows[range],
            PositionSource::Mesh(mesh) => mesh.positions(range, buffer),
            PositionSource::Curve(curve) => {
                let d = curve.dimension;
                let point = |p: &[f64]| [0, 1, 2].map(|k| p.get(k).copied().unwrap_or(0.0));
                buffer.clear();
                buffer.extend(curve.points[range.start * d..range.end * d].chunks_exact(d).map(point));
            }
        }
        buffer
    }

    fn check(&self, start: usize, rows: &[[f64; 3]]) -> Result<(), FormatError> {
        if self.is_checked {
            return Ok(());
        }
        let fits = |x: f64| x.abs() <= self.largest;
        // without an early exit, so that the loop is vectorised
        if rows.as_flattened().iter().fold(true, |all, &x| all & fits(x)) {
            return Ok(());
        }
        let (i, x) = (0..).zip(rows.as_flattened()).find(|(_, x)| !fits(**x)).map_or((0, f64::NAN), |(i, &x)| (i, x));
        Err(unfit(start + i / 3, x))
    }
}

/// Refuses meshes with channels or texture coordinates beyond the range of f32.
pub(super) fn channels_within_f32(mesh: &dyn MeshSource, watch: &Watch) -> Result<(), FormatError> {
    let mut values = Vec::new();
    for (i, channel) in mesh.attachments().channels.iter().enumerate() {
        in_chunks(mesh.n_vertices(), |range| {
            watch.check()?;
            mesh.channel(i, range.clone(), &mut values);
            let Some(k) = values.iter().position(|x| x.abs() > f64::from(f32::MAX)) else { return Ok(()) };
            let (name, vertex, x) = (&channel.name, range.start + k / channel.width, values[k]);
            let most = f32::MAX;
            let detail = format!(
                "vertex {vertex} has {x:e} in the channel \"{name}\", this format holds at most {most:e}; ask for json"
            );
            Err(FormatError::Unfit(detail))
        })?;
    }
    let Some(source) = mesh.uvs() else { return Ok(()) };
    let mut uvs = Vec::new();
    in_chunks(source.n_places(), |range| {
        watch.check()?;
        source.values(range, &mut uvs);
        let Some(x) = uvs.iter().find(|x| x.abs() > f64::from(f32::MAX)) else { return Ok(()) };
        let most = f32::MAX;
        let detail =
            format!("{x:e} is among the texture coordinates, this format holds at most {most:e}; ask for json");
        Err(FormatError::Unfit(detail))
    })
}

/// Returns the error for a coordinate `x` that the format cannot hold.
pub(super) fn unfit(vertex: usize, x: f64) -> FormatError {
    FormatError::Unfit(if x.is_finite() {
        let most = f32::MAX;
        format!("vertex {vertex} has the coordinate {x:e}, this format holds at most {most:e}; ask for obj or json")
    } else {
        format!("vertex {vertex} has the coordinate {x}, only finite numbers can be written; ask for fewer levels")
    })
}
