//! Streaming: blocks of rows are fetched and encoded by all threads, and written in their order.

use std::io::Write;
use std::ops::Range;

use crate::output::bytes::Bytes;
use crate::output::counts::ShapeKind;
use crate::output::error::FormatError;
use crate::output::positions::Positions;
use crate::output::scene::{FaceChunk, MeshSource, OnDemandSource, ranges};
use crate::shape::source::PlaceSource;
use crate::watch::Watch;

/// Number of rows of a block: its bytes, 50 to 300 KB, stay in the cache of the core that makes them until they are
/// written. Half of it hands out work twice as often; twice of it holds twice the memory, and starts threads for larger
/// meshes only.
pub(super) const ROWS_PER_BLOCK: usize = 4_096;

/// Number of blocks per thread that are encoded while earlier blocks are written, so that the threads end at about the
/// same time. Half of it lets them wait for each other twice as often; twice of it holds twice the memory.
const BLOCKS_PER_THREAD: usize = 4;

/// Maximum number of blocks that are encoded while earlier blocks are written: 65,536 rows, as many as a source gives
/// at a time. Half of it leaves work for eight threads only; twice of it holds twice the memory on machines with many
/// threads.
const MAX_BLOCKS: usize = 16;

/// Maximum number of rows of the blocks that are encoded while earlier blocks are written, for sources that make
/// positions on demand, many at a time. Half of it keeps more threads waiting if the patches of a mesh are wide; twice
/// of it holds twice the memory.
const MAX_ROWS: usize = 1 << 20;

/// The way of a result to its reader: writes rows to `out` until `watch` says stop. Holds at most twice `MAX_BLOCKS`
/// blocks, whose memory is reused.
#[expect(missing_debug_implementations, reason = "what bytes go to need not have one")]
pub struct Stream<'a> {
    pub(super) out: &'a mut dyn Write,
    pub(super) watch: &'a Watch,
    /// The blocks that are being encoded, and those that are being written.
    blocks: [Vec<RowBlock>; 2],
}

/// A block of rows between fetching and writing, with its buffers.
#[derive(Default)]
struct RowBlock {
    bytes: Bytes,
    failed: Option<FormatError>,
    points: Vec<[f64; 3]>,
    faces: FaceChunk,
    uv_faces: FaceChunk,
    numbers: Vec<f64>,
    corners: Vec<[[f64; 3]; 4]>,
}

impl<'a> Stream<'a> {
    /// Returns a stream into `out` that ends when `watch` says so.
    pub(super) fn new(out: &'a mut dyn Write, watch: &'a Watch) -> Self {
        Self { out, watch, blocks: [Vec::new(), Vec::new()] }
    }

    /// Writes bytes as they are.
    pub(super) fn bytes(&mut self, bytes: &[u8]) -> Result<(), FormatError> {
        Ok(self.out.write_all(bytes)?)
    }

    /// Writes all vertices: `encode` makes the bytes of consecutive vertices, given the index of the first.
    pub(super) fn positions(
        &mut self,
        positions: &Positions<'_>,
        encode: impl Fn(usize, &[[f64; 3]], &mut Bytes) + Sync,
    ) -> Result<(), FormatError> {
        self.encoded(positions.ranges(ROWS_PER_BLOCK), |range, block| {
            encode(range.start, positions.rows_in(range.clone(), &mut block.points)?, &mut block.bytes);
            Ok(())
        })
    }

    /// Writes vectors of vertices that `make` computes for consecutive ranges.
    pub(super) fn vectors(
        &mut self,
        ranges: impl Iterator<Item = Range<usize>>,
        make: impl Fn(Range<usize>, &mut Vec<[f64; 3]>) + Sync,
        encode: impl Fn(&[[f64; 3]], &mut Bytes) + Sync,
    ) -> Result<(), FormatError> {
        self.encoded(ranges, |range, block| {
            make(range, &mut block.points);
            encode(&block.points, &mut block.bytes);
            Ok(())
        })
    }

    /// Writes rows that are in memory, as [`Stream::positions`] does.
    pub(super) fn rows<T: Sync>(
        &mut self,
        rows: &[T],
        encode: impl Fn(usize, &[T], &mut Bytes) + Sync,
    ) -> Result<(), FormatError> {
        self.encoded(blocks(0..rows.len()), |range, block| {
            encode(range.start, &rows[range], &mut block.bytes);
            Ok(())
        })
    }

    /// Writes all faces: `encode` makes the bytes of consecutive faces, given the index of the first.
    pub(super) fn faces(
        &mut self,
        mesh: &dyn MeshSource,
        encode: impl Fn(usize, &FaceChunk, &mut Bytes) + Sync,
    ) -> Result<(), FormatError> {
        self.faces_in(mesh, 0..mesh.n_faces(), encode)
    }

    /// Writes some consecutive faces, as [`Stream::faces`] does.
    pub(super) fn faces_in(
        &mut self,
        mesh: &dyn MeshSource,
        some: Range<usize>,
        encode: impl Fn(usize, &FaceChunk, &mut Bytes) + Sync,
    ) -> Result<(), FormatError> {
        self.encoded(blocks(some), |range, block| {
            mesh.faces(range.clone(), &mut block.faces);
            encode(range.start, &block.faces, &mut block.bytes);
            Ok(())
        })
    }

    /// Writes all faces of a mesh of quads that makes positions on demand: `encode` makes the bytes of consecutive
    /// faces from the positions of their corners.
    pub(super) fn corners(
        &mut self,
        n_faces: usize,
        source: &dyn OnDemandSource,
        encode: impl Fn(&[[[f64; 3]; 4]], &mut Bytes) + Sync,
    ) -> Result<(), FormatError> {
        self.encoded(ranges(n_faces, |start| source.stretch_of_faces(start)), |range, block| {
            source.corners(range, &mut block.corners);
            encode(&block.corners, &mut block.bytes);
            Ok(())
        })
    }

    /// Writes all faces, as [`Stream::faces`] does, with their places of texture coordinates, if there are any.
    pub(super) fn faces_and_uvs(
        &mut self,
        mesh: &dyn MeshSource,
        encode: impl Fn(usize, [&FaceChunk; 2], &mut Bytes) + Sync,
    ) -> Result<(), FormatError> {
        let uvs = mesh.uvs();
        self.encoded(blocks(0..mesh.n_faces()), |range, block| {
            mesh.faces(range.clone(), &mut block.faces);
            if let Some(uvs) = &uvs {
                uvs.faces(range.clone(), &mut block.uv_faces);
            }
            encode(range.start, [&block.faces, &block.uv_faces], &mut block.bytes);
            Ok(())
        })
    }

    /// Writes the places at the corners of all faces, as [`Stream::faces`] does.
    pub(super) fn place_faces(
        &mut self,
        mesh: &dyn MeshSource,
        places: &dyn PlaceSource,
        encode: impl Fn(usize, &FaceChunk, &mut Bytes) + Sync,
    ) -> Result<(), FormatError> {
        self.encoded(blocks(0..mesh.n_faces()), |range, block| {
            places.faces(range.clone(), &mut block.faces);
            encode(range.start, &block.faces, &mut block.bytes);
            Ok(())
        })
    }

    /// Writes the values of all places: `encode` makes the bytes of consecutive places, given the index of the first.
    pub(super) fn places(
        &mut self,
        places: &dyn PlaceSource,
        encode: impl Fn(usize, &[f64], &mut Bytes) + Sync,
    ) -> Result<(), FormatError> {
        self.encoded(blocks(0..places.n_places()), |range, block| {
            places.values(range.clone(), &mut block.numbers);
            encode(range.start, &block.numbers, &mut block.bytes);
            Ok(())
        })
    }

    /// Writes the texture coordinates of all places, as [`Stream::positions`] does.
    pub(super) fn uvs(
        &mut self,
        mesh: &dyn MeshSource,
        encode: impl Fn(usize, &[[f64; 2]], &mut Bytes) + Sync,
    ) -> Result<(), FormatError> {
        let Some(source) = mesh.uvs() else { return Ok(()) };
        self.places(source.as_ref(), |start, values, out| encode(start, values.as_chunks().0, out))
    }

    /// Writes the numbers of a channel at all vertices: `encode` makes the bytes of consecutive vertices, given the
    /// index of the first.
    pub(super) fn channel(
        &mut self,
        mesh: &dyn MeshSource,
        channel: usize,
        encode: impl Fn(usize, &[f64], &mut Bytes) + Sync,
    ) -> Result<(), FormatError> {
        self.encoded(blocks(0..mesh.n_vertices()), |range, block| {
            mesh.channel(channel, range.clone(), &mut block.numbers);
            encode(range.start, &block.numbers, &mut block.bytes);
            Ok(())
        })
    }

    /// Writes consecutive items: `encode` appends the bytes of one item, given its index.
    pub(super) fn each(
        &mut self,
        range: Range<usize>,
        encode: impl Fn(usize, &mut Vec<u8>) + Sync,
    ) -> Result<(), FormatError> {
        self.encoded(blocks(range), |part, block| {
            block.bytes.append(|out| part.for_each(|i| encode(i, out)));
            Ok(())
        })
    }

    /// Encodes blocks of rows on all threads and writes them in their order, while later blocks are being encoded. A
    /// single block, or a single thread, runs on the calling thread.
    fn encoded(
        &mut self,
        ranges: impl Iterator<Item = Range<usize>>,
        encode: impl Fn(Range<usize>, &mut RowBlock) -> Result<(), FormatError> + Sync,
    ) -> Result<(), FormatError> {
        let Self { out, watch, blocks: [encoding, writing] } = self;
        let mut ranges = ranges;
        let encode = |range, block: &mut RowBlock| {
            watch.check()?;
            block.bytes.clear();
            encode(range, block)?;
            // positions made on demand are invalid after a stop
            Ok(watch.check()?)
        };
        let threads = rayon::current_num_threads();
        let first: Vec<Range<usize>> = ranges.by_ref().take(2).collect();
        let is_one = first.len() < 2;
        let mut ranges = first.into_iter().chain(ranges).peekable();
        if is_one || threads == 1 {
            encoding.resize_with(encoding.len().max(1), RowBlock::default);
            let block = &mut encoding[0];
            return ranges.try_for_each(|range| {
                encode(range, block)?;
                Ok(out.write_all(block.bytes.made())?)
            });
        }
        let at_once = (BLOCKS_PER_THREAD * threads).min(MAX_BLOCKS);
        let mut n_encoded = 0;
        loop {
            let (mut next, mut rows) = (Vec::with_capacity(at_once), 0);
            while let Some(range) = ranges.next_if(|range| rows == 0 || rows + range.len() <= MAX_ROWS) {
                rows += range.len();
                next.push(range);
                if next.len() == at_once {
                    break;
                }
            }
            let (n, encode) = (next.len(), &encode);
            encoding.resize_with(encoding.len().max(n), RowBlock::default);
            rayon::in_place_scope(|scope| {
                for (range, block) in next.into_iter().zip(&mut *encoding) {
                    scope.spawn(move |_| block.failed = encode(range, block).err());
                }
                write(&mut writing[..n_encoded], *out)
            })?;
            if n == 0 {
                return Ok(());
            }
            std::mem::swap(encoding, writing);
            n_encoded = n;
        }
    }
}

/// Returns consecutive blocks of rows.
fn blocks(rows: Range<usize>) -> impl Iterator<Item = Range<usize>> {
    rows.clone().step_by(ROWS_PER_BLOCK).map(move |start| start..rows.end.min(start + ROWS_PER_BLOCK))
}

/// Writes blocks up to the first that could not be encoded, and returns its error.
fn write(blocks: &mut [RowBlock], out: &mut dyn Write) -> Result<(), FormatError> {
    for block in blocks {
        if let Some(error) = block.failed.take() {
            return Err(error);
        }
        out.write_all(block.bytes.made())?;
    }
    Ok(())
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
