//! A mesh whose vertices on sharp and hard edges are split into copies, so that each side can have a normal of its own.

use std::ops::Range;

use rayon::prelude::*;

use crate::output::hard_edges::HardEdges;
use crate::output::scene::{FaceChunk, MeshSource, Shape, each_chunk};
use crate::shape::attachments::Attachments;
use crate::shape::source::{CarriedSource, NormalSource, Origin, OriginSource, PlaceSource};
use crate::watch::{Stopped, Watch};

/// A mesh with a copy of each vertex for every sector but one between the sharp and hard edges that meet at the vertex.
///
/// The sector of the lowest face keeps the vertex; copies follow all vertices, by vertex, then by the lowest face of
/// their sector. A sharp edge that ends inside the mesh splits nothing. The faces are the same, in the same order.
#[derive(Debug)]
pub(super) struct SplitVertices<'a> {
    mesh: &'a dyn MeshSource,
    /// The original vertex of each copy.
    origins: Vec<u32>,
    /// The faces that have a copy in place of a vertex, as (face, vertex, copy), ascending.
    moved: Vec<(usize, u32, u32)>,
    /// The normal of each copy, and in `kept` the normals of the split vertices, ascending, if the mesh has normals.
    normals: Vec<[f64; 3]>,
    kept: Vec<(u32, [f64; 3])>,
}

/// A face at a vertex, with the vertices before and after it in the face: counter-clockwise from `next` to `before`.
#[derive(Debug, Clone, Copy)]
struct FaceAtVertex {
    vertex: u32,
    face: usize,
    next: u32,
    before: u32,
}

impl<'a> SplitVertices<'a> {
    /// Splits the mesh of a shape at its sharp and hard edges. Returns `None` if no vertex is split.
    ///
    /// # Errors
    /// [`Stopped`] when the watch says so.
    pub(super) fn of(shape: Shape<'a>, hard: &HardEdges, watch: &Watch) -> Result<Option<Self>, Stopped> {
        let Shape::Mesh(mesh) = shape else { return Ok(None) };
        let sharp = hard.and(mesh.sharp_edges());
        if sharp.is_empty() {
            return Ok(None);
        }
        let corners = corners(mesh, &sharp, watch)?;
        let mut split = Self { mesh, origins: Vec::new(), moved: Vec::new(), normals: Vec::new(), kept: Vec::new() };
        for around in corners.chunk_by(|a, b| a.vertex == b.vertex) {
            split.split(around, &sharp);
        }
        split.moved.par_sort_unstable();
        Ok((!split.origins.is_empty()).then_some(split))
    }

    /// Returns the vertex of the mesh that vertex `v` is, or is a copy of.
    pub(super) fn origin(&self, v: u32) -> u32 {
        let copy = (v as usize).checked_sub(self.mesh.n_vertices());
        copy.and_then(|copy| self.origins.get(copy)).copied().unwrap_or(v)
    }

    /// Fills `out` with the values that `rows` gives for the vertices in `range`; a copy has the values of its vertex.
    fn with_copies<T: Clone>(&self, range: Range<usize>, out: &mut Vec<T>, rows: impl Fn(Range<usize>, &mut Vec<T>)) {
        let n = self.mesh.n_vertices();
        rows(range.start.min(n)..range.end.min(n), out);
        let mut one = Vec::new();
        for copy in range.start.max(n)..range.end.max(n) {
            let origin = self.origins[copy - n] as usize;
            rows(origin..origin + 1, &mut one);
            out.extend_from_slice(&one);
        }
    }

    /// Splits a vertex, given its corners by face.
    fn split(&mut self, around: &[FaceAtVertex], sharp: &[[u32; 2]]) {
        let vertex = around[0].vertex;
        let sectors = sectors(around, |other| sharp.binary_search(&[vertex.min(other), vertex.max(other)]).is_ok());
        let first = self.mesh.n_vertices() + self.origins.len();
        let n = sectors.iter().copied().max().unwrap_or(0);
        self.origins.extend(std::iter::repeat_n(vertex, n));
        for (corner, &sector) in around.iter().zip(&sectors).filter(|(_, sector)| **sector > 0) {
            let copy = u32::try_from(first + sector - 1).unwrap_or(u32::MAX);
            self.moved.push((corner.face, vertex, copy));
        }
        if let Some(source) = self.mesh.normals().filter(|_| n > 0) {
            let mut one = Vec::new();
            source.of_vertices(vertex as usize..vertex as usize + 1, &mut one);
            let normal = |sector| {
                let corner = around.iter().zip(&sectors).find(|(_, other)| **other == sector).map(|(corner, _)| corner);
                let side = corner.and_then(|corner| source.on_side(vertex, corner.next));
                side.or_else(|| one.first().copied()).unwrap_or_default()
            };
            self.kept.push((vertex, normal(0)));
            let normals: Vec<[f64; 3]> = (1..=n).map(normal).collect();
            self.normals.extend(normals);
        }
    }
}

/// Returns the corners at the ends of sharp edges, by vertex, then by face.
fn corners(mesh: &dyn MeshSource, sharp: &[[u32; 2]], watch: &Watch) -> Result<Vec<FaceAtVertex>, Stopped> {
    let mut ends = vec![false; mesh.n_vertices()];
    sharp.iter().flatten().for_each(|&v| ends[v as usize] = true);
    let mut all = Vec::new();
    each_chunk(mesh, watch, |range, chunk| {
        let faces: Vec<&[u32]> = chunk.iter().collect();
        let found = faces.par_iter().zip(range).flat_map_iter(|(&face, f)| {
            let n = face.len();
            let here = (0..n).filter(|&j| ends[face[j] as usize]);
            here.map(move |j| FaceAtVertex {
                vertex: face[j],
                face: f,
                next: face[(j + 1) % n],
                before: face[(j + n - 1) % n],
            })
        });
        all.par_extend(found);
    })?;
    all.par_sort_unstable_by_key(|corner: &FaceAtVertex| (corner.vertex, corner.face));
    Ok(all)
}

/// Returns the sector of each corner around a vertex, numbered by first appearance; neighbours are in one sector unless
/// the edge between them is sharp.
fn sectors(around: &[FaceAtVertex], is_sharp: impl Fn(u32) -> bool) -> Vec<usize> {
    let mut by_next: Vec<usize> = (0..around.len()).collect();
    by_next.sort_unstable_by_key(|&i| around[i].next);
    let mut by_before: Vec<usize> = (0..around.len()).collect();
    by_before.sort_unstable_by_key(|&i| around[i].before);
    let find = |order: &[usize], key: &dyn Fn(&FaceAtVertex) -> u32, other: u32| {
        let at = order.binary_search_by_key(&other, |&i| key(&around[i])).ok()?;
        (!is_sharp(other)).then_some(order[at])
    };
    let clockwise = |i: usize| find(&by_before, &|corner| corner.before, around[i].next);
    let counter_clockwise = |i: usize| find(&by_next, &|corner| corner.next, around[i].before);
    let mut sectors = vec![usize::MAX; around.len()];
    let mut n = 0;
    for start in 0..around.len() {
        if sectors[start] != usize::MAX {
            continue;
        }
        sectors[start] = n;
        for step in [&clockwise as &dyn Fn(usize) -> Option<usize>, &counter_clockwise] {
            let mut at = start;
            while let Some(i) = step(at).filter(|&i| sectors[i] == usize::MAX) {
                sectors[i] = n;
                at = i;
            }
        }
        n += 1;
    }
    sectors
}

impl MeshSource for SplitVertices<'_> {
    fn n_vertices(&self) -> usize {
        self.mesh.n_vertices() + self.origins.len()
    }

    fn n_faces(&self) -> usize {
        self.mesh.n_faces()
    }

    fn n_half_edges(&self) -> usize {
        self.mesh.n_half_edges()
    }

    fn positions(&self, range: Range<usize>, out: &mut Vec<[f64; 3]>) {
        self.with_copies(range, out, |range, out| self.mesh.positions(range, out));
    }

    fn faces(&self, range: Range<usize>, out: &mut FaceChunk) {
        self.mesh.faces(range.clone(), out);
        let first = self.moved.partition_point(|&(face, ..)| face < range.start);
        let last = self.moved.partition_point(|&(face, ..)| face < range.end);
        let mut moved = self.moved[first..last].iter().peekable();
        let mut start = 0;
        for (i, face) in range.enumerate() {
            if moved.peek().is_none() {
                break;
            }
            let end = start + out.size(i);
            while let Some(&(_, vertex, copy)) = moved.next_if(|&&(f, ..)| f == face) {
                out.vertices[start..end].iter_mut().filter(|v| **v == vertex).for_each(|v| *v = copy);
            }
            start = end;
        }
    }
}

impl CarriedSource for SplitVertices<'_> {
    fn normals(&self) -> Option<&dyn NormalSource> {
        self.mesh.normals().is_some().then_some(self)
    }

    fn uvs(&self) -> Option<Box<dyn PlaceSource + '_>> {
        let uvs = self.mesh.uvs()?;
        Some(if uvs.follow_vertices() { Box::new(SplitUvs(self, uvs)) } else { uvs })
    }

    fn channel_places(&self, channel: usize) -> Option<Box<dyn PlaceSource + '_>> {
        self.mesh.channel_places(channel)
    }

    fn attachments(&self) -> &Attachments {
        self.mesh.attachments()
    }

    fn channel(&self, channel: usize, range: Range<usize>, out: &mut Vec<f64>) {
        self.with_copies(range, out, |range, out| self.mesh.channel(channel, range, out));
    }
}

impl NormalSource for SplitVertices<'_> {
    fn of_vertices(&self, range: Range<usize>, out: &mut Vec<[f64; 3]>) {
        let n = self.mesh.n_vertices();
        out.clear();
        if let Some(normals) = self.mesh.normals() {
            normals.of_vertices(range.start.min(n)..range.end.min(n), out);
        }
        let first = self.kept.partition_point(|&(v, _)| (v as usize) < range.start);
        let here = self.kept[first..].iter().take_while(|&&(v, _)| (v as usize) < range.end);
        here.for_each(|&(v, normal)| out[v as usize - range.start] = normal);
        out.extend_from_slice(&self.normals[range.start.max(n) - n..range.end.max(n) - n]);
    }

    /// Returns `None`: after splitting, each vertex has one side only.
    fn on_side(&self, _vertex: u32, _next: u32) -> Option<[f64; 3]> {
        None
    }
}

/// Texture coordinates that are numbered like the vertices.
struct SplitUvs<'a>(&'a SplitVertices<'a>, Box<dyn PlaceSource + 'a>);

impl PlaceSource for SplitUvs<'_> {
    fn n_places(&self) -> usize {
        self.0.n_vertices()
    }

    fn values(&self, range: Range<usize>, out: &mut Vec<f64>) {
        self.0.with_copies(range, out, |range, out| self.1.values(range, out));
    }

    fn faces(&self, range: Range<usize>, out: &mut FaceChunk) {
        self.0.faces(range, out);
    }

    fn follow_vertices(&self) -> bool {
        true
    }
}

impl OriginSource for SplitVertices<'_> {
    fn input_cells(&self) -> [usize; 3] {
        self.mesh.input_cells()
    }

    fn vertex_origin(&self, vertex: usize) -> Origin {
        let copy = vertex.checked_sub(self.mesh.n_vertices());
        self.mesh.vertex_origin(copy.map_or(vertex, |copy| self.origins[copy] as usize))
    }

    fn face_origin(&self, face: usize) -> u32 {
        self.mesh.face_origin(face)
    }

    fn faces_of(&self, face: usize) -> Range<usize> {
        self.mesh.faces_of(face)
    }
}
