//! Streaming: rows are asked for chunk by chunk, encoded by all threads, and written in their order.

use std::io::Write;
use std::ops::Range;

use rayon::prelude::*;

use crate::output::counts::ShapeKind;
use crate::output::error::FormatError;
use crate::output::scene::{CHUNK, Curve, FaceChunk, MeshSource, in_chunks};
use crate::watch::Watch;

/// Rows that one thread encodes at a time.
const BLOCK: usize = 4_096;

/// Writes rows to `out`; holds the bytes of one chunk at most.
pub(super) struct Stream<'a> {
    out: &'a mut dyn Write,
    watch: &'a Watch,
    blocks: Vec<Vec<u8>>,
}

impl<'a> Stream<'a> {
    /// A stream into `out` that ends when `watch` says so.
    pub(super) fn new(out: &'a mut dyn Write, watch: &'a Watch) -> Self {
        Self { out, watch, blocks: vec![Vec::new(); CHUNK.div_ceil(BLOCK)] }
    }

    /// Writes bytes as they are.
    pub(super) fn bytes(&mut self, bytes: &[u8]) -> Result<(), FormatError> {
        Ok(self.out.write_all(bytes)?)
    }

    /// Writes all vertices: `encode` appends the bytes of some consecutive ones, the first of which has that index.
    pub(super) fn positions(
        &mut self,
        positions: &Positions<'_>,
        encode: impl Fn(usize, &[[f64; 3]], &mut Vec<u8>) + Sync,
    ) -> Result<(), FormatError> {
        positions.each_chunk(self.watch, |start, rows| self.rows(start, rows, &encode))
    }

    /// Writes rows that are in memory, as [`Stream::positions`] does; `start` is the index of the first one.
    pub(super) fn rows<T: Sync>(
        &mut self,
        start: usize,
        rows: &[T],
        encode: impl Fn(usize, &[T], &mut Vec<u8>) + Sync,
    ) -> Result<(), FormatError> {
        in_chunks(rows.len(), |range| {
            self.watch.check()?;
            let blocks: Vec<(usize, &[T])> = rows[range.clone()]
                .chunks(BLOCK)
                .enumerate()
                .map(|(i, block)| (start + range.start + i * BLOCK, block))
                .collect();
            self.encoded(&blocks, |(first, block), out| encode(*first, block, out))
        })
    }

    /// Writes all faces: `encode` appends the bytes of one of them, given with its index.
    pub(super) fn faces(
        &mut self,
        mesh: &dyn MeshSource,
        encode: impl Fn(usize, &[u32], &mut Vec<u8>) + Sync,
    ) -> Result<(), FormatError> {
        self.faces_in(mesh, 0..mesh.n_faces(), encode)
    }

    /// Writes some consecutive faces, as [`Stream::faces`] does.
    pub(super) fn faces_in(
        &mut self,
        mesh: &dyn MeshSource,
        some: Range<usize>,
        encode: impl Fn(usize, &[u32], &mut Vec<u8>) + Sync,
    ) -> Result<(), FormatError> {
        let mut chunk = FaceChunk::default();
        in_chunks(some.len(), |range| {
            self.watch.check()?;
            let range = some.start + range.start..some.start + range.end;
            mesh.faces(range.clone(), &mut chunk);
            self.encoded(&face_blocks(&chunk), |block, out| {
                for (i, face) in block.iter().enumerate() {
                    encode(range.start + block.first + i, face, out);
                }
            })
        })
    }

    /// Writes all faces, as [`Stream::faces`] does, with their places of texture coordinates (none where there are
    /// none).
    pub(super) fn faces_and_uvs(
        &mut self,
        mesh: &dyn MeshSource,
        encode: impl Fn(usize, &[u32], &[u32], &mut Vec<u8>) + Sync,
    ) -> Result<(), FormatError> {
        let Some(source) = mesh.uvs() else {
            return self.faces(mesh, |index, face, out| encode(index, face, &[], out));
        };
        let (mut faces, mut uvs) = (FaceChunk::default(), FaceChunk::default());
        in_chunks(mesh.n_faces(), |range| {
            self.watch.check()?;
            mesh.faces(range.clone(), &mut faces);
            source.faces(range.clone(), &mut uvs);
            // the faces have the same sizes, so that they are cut alike
            let blocks: Vec<_> = face_blocks(&faces).into_iter().zip(face_blocks(&uvs)).collect();
            self.encoded(&blocks, |(block, uvs), out| {
                for (i, (face, uvs)) in block.iter().zip(uvs.iter()).enumerate() {
                    encode(range.start + block.first + i, face, uvs, out);
                }
            })
        })
    }

    /// Writes the texture coordinates of all places: `encode` appends the bytes of those of one, given with its index.
    pub(super) fn uvs(
        &mut self,
        mesh: &dyn MeshSource,
        encode: impl Fn(usize, [f64; 2], &mut Vec<u8>) + Sync,
    ) -> Result<(), FormatError> {
        let Some(source) = mesh.uvs() else { return Ok(()) };
        let mut values = Vec::new();
        in_chunks(source.n_points(), |range| {
            source.values(range.clone(), &mut values);
            self.rows(range.start, &values, |start, rows, out| {
                for (i, &row) in rows.iter().enumerate() {
                    encode(start + i, row, out);
                }
            })
        })
    }

    /// Writes the numbers that all vertices carry in a channel: `encode` appends the bytes of those of one vertex,
    /// given with its index.
    pub(super) fn channel(
        &mut self,
        mesh: &dyn MeshSource,
        channel: usize,
        encode: impl Fn(usize, &[f64], &mut Vec<u8>) + Sync,
    ) -> Result<(), FormatError> {
        let width = mesh.attachments().channels[channel].width;
        let mut values = Vec::new();
        in_chunks(mesh.n_vertices(), |range| {
            self.watch.check()?;
            mesh.channel(channel, range.clone(), &mut values);
            let blocks: Vec<(usize, &[f64])> =
                values.chunks(width * BLOCK).enumerate().map(|(i, block)| (range.start + i * BLOCK, block)).collect();
            self.encoded(&blocks, |(first, block), out| {
                for (i, row) in block.chunks_exact(width).enumerate() {
                    encode(first + i, row, out);
                }
            })
        })
    }

    /// Writes the numbers of some consecutive things: `encode` appends the bytes of one of them, given with its index.
    pub(super) fn each(
        &mut self,
        range: Range<usize>,
        encode: impl Fn(usize, &mut Vec<u8>) + Sync,
    ) -> Result<(), FormatError> {
        in_chunks(range.len(), |part| {
            self.watch.check()?;
            let start = range.start + part.start;
            let blocks: Vec<Range<usize>> = (start..range.start + part.end)
                .step_by(BLOCK)
                .map(|first| first..(first + BLOCK).min(range.start + part.end))
                .collect();
            self.encoded(&blocks, |block, out| block.clone().for_each(|i| encode(i, out)))
        })
    }

    fn encoded<T: Sync>(&mut self, blocks: &[T], encode: impl Fn(&T, &mut Vec<u8>) + Sync) -> Result<(), FormatError> {
        blocks.par_iter().zip(&mut self.blocks).for_each(|(block, out)| {
            out.clear();
            encode(block, out);
        });
        for bytes in &self.blocks[..blocks.len()] {
            self.out.write_all(bytes)?;
        }
        Ok(())
    }
}

/// Some consecutive faces of a chunk.
#[derive(Clone, Copy)]
pub(super) struct FaceBlock<'a> {
    /// Index of the first one in its chunk.
    first: usize,
    sizes: &'a [u32],
    vertices: &'a [u32],
}

impl<'a> FaceBlock<'a> {
    /// The faces, one slice each.
    pub(super) fn iter(&self) -> impl Iterator<Item = &'a [u32]> + use<'a> {
        let mut rest = self.vertices;
        self.sizes.iter().map(move |&size| {
            let (face, after) = rest.split_at(size as usize);
            rest = after;
            face
        })
    }
}

/// The faces of a chunk, cut into pieces for the threads; where the cuts are depends on the faces only.
pub(super) fn face_blocks(chunk: &FaceChunk) -> Vec<FaceBlock<'_>> {
    let mut rest = chunk.vertices.as_slice();
    let blocks = chunk.sizes.chunks(BLOCK).enumerate().map(|(i, sizes)| {
        let (vertices, after) = rest.split_at(sizes.iter().map(|&size| size as usize).sum());
        rest = after;
        FaceBlock { first: i * BLOCK, sizes, vertices }
    });
    blocks.collect()
}

/// Where the positions of vertices come from, and how large a coordinate may be.
pub(super) struct Positions<'a> {
    source: Source<'a>,
    largest: f64,
}

enum Source<'a> {
    Mesh(&'a dyn MeshSource),
    Curve(&'a Curve),
    Held(Vec<[f64; 3]>),
}

impl<'a> Positions<'a> {
    /// The vertices of a mesh, asked for whenever they are needed.
    pub(super) fn of_mesh(mesh: &'a dyn MeshSource) -> Self {
        Self { source: Source::Mesh(mesh), largest: f64::MAX }
    }

    /// The points of a polygon with at most three coordinates, the missing ones being zero.
    pub(super) fn of_curve(curve: &'a Curve) -> Self {
        Self { source: Source::Curve(curve), largest: f64::MAX }
    }

    /// Refuses positions with a coordinate beyond the range of f32.
    pub(super) fn within_f32(self) -> Self {
        Self { largest: f64::from(f32::MAX), ..self }
    }

    /// Holds the positions in memory.
    pub(super) fn held(self, watch: &Watch) -> Result<Self, FormatError> {
        if let Source::Held(_) = self.source {
            return Ok(self);
        }
        let mut rows = Vec::with_capacity(self.len());
        self.each_chunk(watch, |_, chunk| {
            rows.extend_from_slice(chunk);
            Ok(())
        })?;
        Ok(Self { source: Source::Held(rows), largest: self.largest })
    }

    /// The positions in memory: all after [`Positions::held`], none before.
    pub(super) fn rows(&self) -> &[[f64; 3]] {
        if let Source::Held(rows) = &self.source { rows } else { &[] }
    }

    /// Number of vertices.
    pub(super) fn len(&self) -> usize {
        match &self.source {
            Source::Mesh(mesh) => mesh.n_vertices(),
            Source::Curve(curve) => curve.len(),
            Source::Held(rows) => rows.len(),
        }
    }

    /// Calls `each` with the index of the first row and the rows, chunk after chunk.
    pub(super) fn each_chunk(
        &self,
        watch: &Watch,
        mut each: impl FnMut(usize, &[[f64; 3]]) -> Result<(), FormatError>,
    ) -> Result<(), FormatError> {
        let mut buffer = Vec::new();
        in_chunks(self.len(), |range| {
            watch.check()?;
            let rows = self.fetch(range.clone(), &mut buffer);
            self.check(range.start, rows)?;
            each(range.start, rows)
        })
    }

    fn fetch<'b>(&'b self, range: Range<usize>, buffer: &'b mut Vec<[f64; 3]>) -> &'b [[f64; 3]] {
        match &self.source {
            Source::Held(rows) => return &rows[range],
            Source::Mesh(mesh) => mesh.positions(range, buffer),
            Source::Curve(curve) => {
                let d = curve.dimension;
                let point = |p: &[f64]| [0, 1, 2].map(|k| p.get(k).copied().unwrap_or(0.0));
                buffer.clear();
                buffer.extend(curve.points[range.start * d..range.end * d].chunks_exact(d).map(point));
            }
        }
        buffer
    }

    fn check(&self, start: usize, rows: &[[f64; 3]]) -> Result<(), FormatError> {
        let fits = |x: &f64| x.abs() <= self.largest;
        let Some(i) = rows.iter().position(|p| !p.iter().all(fits)) else { return Ok(()) };
        let x = rows[i].iter().copied().find(|x| !fits(x)).unwrap_or(f64::NAN);
        Err(unfit(start + i, x))
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
    in_chunks(source.n_points(), |range| {
        watch.check()?;
        source.values(range, &mut uvs);
        let Some(x) = uvs.iter().flatten().find(|x| x.abs() > f64::from(f32::MAX)) else { return Ok(()) };
        let most = f32::MAX;
        let detail =
            format!("{x:e} is among the texture coordinates, this format holds at most {most:e}; ask for json");
        Err(FormatError::Unfit(detail))
    })
}

/// The refusal of a coordinate `x` that the format cannot hold.
pub(super) fn unfit(vertex: usize, x: f64) -> FormatError {
    FormatError::Unfit(if x.is_finite() {
        let most = f32::MAX;
        format!("vertex {vertex} has the coordinate {x:e}, this format holds at most {most:e}; ask for obj or json")
    } else {
        format!("vertex {vertex} has the coordinate {x}, only finite numbers can be written; ask for fewer levels")
    })
}

/// Accepts meshes, and curves with at most three coordinates a point.
pub(super) fn holds_space(format: &str, kind: ShapeKind) -> Result<(), String> {
    match kind {
        ShapeKind::Curves { dimension: 4.. } => {
            Err(format!("{format} holds points with at most 3 coordinates, these have more; ask for json"))
        }
        ShapeKind::Curves { .. } | ShapeKind::Mesh => Ok(()),
    }
}
