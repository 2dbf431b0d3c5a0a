//! Sums over the faces around each vertex, computed by all threads, with the same bits as on one thread.

use std::ops::Range;

use multiversion::multiversion;
use rayon::prelude::*;

use crate::kept::Kept;
use crate::math::vector::plus;
use crate::output::scene::{FaceChunk, MeshSource, ROWS_PER_CHUNK};
use crate::shape::topology::index;
use crate::watch::{Stopped, Watch};

/// Number of faces of a part, which one thread sums at a time; its data stay in the cache of a core. Half of it makes
/// more vertices common to two parts; twice of it no longer fits into half a megabyte.
pub(super) const FACES_PER_PART: usize = 4_096;

/// Maximum number of parts that are summed before their shared sums are added: 65,536 faces, 60 bytes each. Half of it
/// leaves work for eight threads only; twice of it holds twice the memory.
pub(super) const PARTS_PER_SUM: usize = 16;

/// Returns for each vertex what `finish` makes of the sum of the vectors of its faces, added in the order of the faces.
///
/// Vertices inside faces of the input mostly belong to one part of all faces; each part adds the sums of these itself
/// and finishes them, while they are in the cache. Contributions to other vertices are kept, and added part after part.
///
/// # Errors
/// [`Stopped`] when the watch says so.
pub(super) fn sums(
    mesh: &dyn MeshSource,
    of_face: impl Fn(&[u32]) -> [f64; 3] + Sync,
    finish: impl Fn([f64; 3]) -> [f64; 3] + Sync,
    watch: &Watch,
) -> Result<Kept<[f64; 3]>, Stopped> {
    let finish = |sums: &mut [[f64; 3]]| sums.iter_mut().for_each(|sum| *sum = finish(*sum));
    let mut sums = Kept::to_overwrite(mesh.n_vertices());
    let own = own_vertices(mesh, watch)?;
    chunks_between(&mut sums, &own).into_par_iter().for_each(|sums| sums.fill([0.0; 3]));
    let mut parts: Vec<FaceRun> = Vec::new();
    parts.resize_with(PARTS_PER_SUM.min(own.len()), FaceRun::default);
    for (round, own) in own.chunks(PARTS_PER_SUM).enumerate() {
        watch.check()?;
        let (mut rest, mut start) = (&mut *sums, 0);
        let mut work = Vec::with_capacity(own.len());
        for (i, (part, own)) in parts.iter_mut().zip(own).enumerate() {
            let mut slice: &mut [[f64; 3]] = &mut [];
            if !own.is_empty() {
                rest = &mut rest[own.start as usize - start..];
                (slice, rest) = rest.split_at_mut(own.len());
                start = own.end as usize;
            }
            work.push((faces_of(mesh, round * PARTS_PER_SUM + i), part, own.start, slice));
        }
        work.into_par_iter().with_max_len(1).for_each(|(faces, part, first, own)| {
            mesh.faces(faces, &mut part.faces);
            part.add(&of_face, first, own);
            finish(own);
        });
        parts[..own.len()].iter().for_each(|part| part.add_shared(&mut sums));
    }
    chunks_between(&mut sums, &own).into_par_iter().for_each(finish);
    Ok(sums)
}

/// Returns the sums of vertices that are in none of these ascending ranges, in chunks.
fn chunks_between<'a>(sums: &'a mut [[f64; 3]], own: &[Range<u32>]) -> Vec<&'a mut [[f64; 3]]> {
    let n = index(sums.len());
    let (mut rest, mut start, mut chunks) = (sums, 0, Vec::new());
    for own in own.iter().filter(|own| !own.is_empty()).chain([&(n..n)]) {
        let (between, beyond) = rest.split_at_mut((own.start - start) as usize);
        chunks.extend(between.chunks_mut(ROWS_PER_CHUNK));
        (rest, start) = (&mut beyond[own.len()..], own.end);
    }
    chunks
}

/// Returns the faces of a part.
fn faces_of(mesh: &dyn MeshSource, part: usize) -> Range<usize> {
    part * FACES_PER_PART..mesh.n_faces().min((part + 1) * FACES_PER_PART)
}

/// Returns for each part a range of vertices that no other part has, in ascending order: of the vertices inside faces
/// of the input those beyond all vertices of the parts before and below all of the parts after it.
fn own_vertices(mesh: &dyn MeshSource, watch: &Watch) -> Result<Vec<Range<u32>>, Stopped> {
    let n = mesh.n_vertices();
    let is_inside = |v: usize| mesh.vertex_origin(v).dimension == 2;
    let first = partition_point(0..n, |v| !is_inside(v));
    let inside = index(first)..index(partition_point(first..n, is_inside));
    let range = |faces: &mut FaceChunk, part| {
        watch.check()?;
        mesh.faces(faces_of(mesh, part), faces);
        let [low, high] = span(&faces.vertices, inside.start, inside.end - inside.start);
        Ok(inside.start + low..inside.start + high)
    };
    let parts = 0..mesh.n_faces().div_ceil(FACES_PER_PART);
    let ranges: Result<Vec<Range<u32>>, Stopped> = parts.into_par_iter().map_init(FaceChunk::default, range).collect();
    let mut ranges = ranges?;
    let (mut before, mut after) = (inside.start, inside.end);
    let lows: Vec<u32> = ranges.iter().map(|range| range.start).collect();
    for range in &mut ranges {
        let end = range.end;
        range.start = range.start.max(before);
        before = before.max(end);
    }
    for (range, low) in ranges.iter_mut().zip(lows).rev() {
        range.end = range.end.min(after);
        after = after.min(low);
    }
    Ok(ranges)
}

/// Returns the smallest index among those vertices that are less than `n` from `start` on, counted from there, and the
/// largest one plus 1; `[n, 0]` if there are none.
#[multiversion(targets("x86_64+avx2", "x86_64+sse4.1"))]
fn span(vertices: &[u32], start: u32, n: u32) -> [u32; 2] {
    // sixteen vertices side by side and without branches, for vectorisation; vertices outside the range wrap around to
    // large numbers
    let grown = |[low, high]: [u32; 2], v: u32| {
        let v = v.wrapping_sub(start);
        [low.min(v), high.max(if v < n { v + 1 } else { 0 })]
    };
    let (mut low, mut high) = ([n; 16], [0; 16]);
    let (lines, rest) = vertices.as_chunks::<16>();
    for line in lines {
        for k in 0..16 {
            [low[k], high[k]] = grown([low[k], high[k]], line[k]);
        }
    }
    let joined = low.iter().zip(high).fold([n, 0], |[low, high], (&l, h)| [low.min(l), high.max(h)]);
    rest.iter().fold(joined, |ends, &v| grown(ends, v))
}

/// Returns the first number in a range for which `is_before` is false; it must be true for all numbers before.
fn partition_point(range: Range<usize>, is_before: impl Fn(usize) -> bool) -> usize {
    let (mut low, mut high) = (range.start, range.end);
    while low < high {
        let middle = low.midpoint(high);
        if is_before(middle) { low = middle + 1 } else { high = middle }
    }
    low
}

/// Consecutive faces, and memory for their vectors.
#[derive(Default)]
struct FaceRun {
    faces: FaceChunk,
    /// The vector of each face.
    vectors: Vec<[f64; 3]>,
    /// Vertices shared with other parts, each with the index of a face of this part at the vertex.
    shared: Vec<(u32, u32)>,
}

impl FaceRun {
    /// Sets the sums of the vertices that this part alone has, the first of which is `start`, and lists the others.
    fn add(&mut self, of_face: impl Fn(&[u32]) -> [f64; 3], start: u32, own: &mut [[f64; 3]]) {
        let Self { faces, vectors, shared } = self;
        vectors.clear();
        shared.clear();
        own.fill([0.0; 3]);
        match faces.rows::<4>() {
            Some(quads) => vectors.extend(quads.iter().map(|quad| of_face(quad))),
            None => vectors.extend(faces.iter().map(of_face)),
        }
        for ((i, vector), face) in (0..).zip(&*vectors).zip(faces.iter()) {
            for &v in face {
                match own.get_mut(v.wrapping_sub(start) as usize) {
                    Some(sum) => *sum = plus(*sum, *vector),
                    None => shared.push((v, i)),
                }
            }
        }
    }

    /// Adds the vectors of the faces to shared vertices.
    fn add_shared(&self, sums: &mut [[f64; 3]]) {
        for &(v, i) in &self.shared {
            let sum = &mut sums[v as usize];
            *sum = plus(*sum, self.vectors[i as usize]);
        }
    }
}
