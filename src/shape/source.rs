//! Results as sources: curves as they are, meshes chunk by chunk in the documented order.

use std::ops::Range;

use super::attachments::Attachments;
use super::creases::Tags;
use super::topology::index;

/// One polygon: `points` holds `n x dimension` coordinates, point after point, in model units.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Coordinates, `n x dimension`.
    pub points: Vec<f64>,
    /// Coordinates a point, 1 to 4.
    pub dimension: usize,
    /// Whether the last point is joined to the first.
    pub closed: bool,
    /// Unit tangents, `n x dimension`, where they are known; a row of zeros where there is none.
    pub tangents: Option<Vec<f64>>,
}

impl Curve {
    /// Number of points.
    pub fn len(&self) -> usize {
        self.points.len() / self.dimension
    }

    /// Whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }
}

/// A mesh as a source: vertices and faces in the documented order. Hidden faces (holes) are already left out.
///
/// What is filled into `out` replaces what it held before.
pub trait MeshSource: CarriedSource + OriginSource + std::fmt::Debug + Sync {
    /// Returns the number of vertices.
    fn n_vertices(&self) -> usize;

    /// Returns the number of shown faces.
    fn n_faces(&self) -> usize;

    /// Returns the number of half-edges of the shown faces: the sum of their sizes.
    fn n_half_edges(&self) -> usize;

    /// Fills `out` with the positions (model units) of the vertices in `range`.
    fn positions(&self, range: Range<usize>, out: &mut Vec<[f64; 3]>);

    /// Fills `out` with the faces in `range`, counter-clockwise seen from outside.
    fn faces(&self, range: Range<usize>, out: &mut FaceChunk);

    /// Returns the positions of all vertices where they are in memory in this order, so that nothing has to be copied.
    fn held_positions(&self) -> Option<&[[f64; 3]]> {
        None
    }

    /// Returns the same mesh as a source that makes positions when they are asked for, if it is one.
    fn on_demand(&self) -> Option<&dyn OnDemandSource> {
        None
    }

    /// Returns the same mesh in its other frames, which differ in positions and normals only.
    fn frames(&self) -> Vec<&dyn MeshSource> {
        Vec::new()
    }
}

/// What a mesh carries besides vertices and faces; a mesh that carries nothing implements none of it.
pub trait CarriedSource {
    /// Returns the normals that the mesh brings; without them they are left to the writer.
    fn normals(&self) -> Option<&dyn NormalSource> {
        None
    }

    /// Returns the names, looks and channels that the mesh carries; names belong to input faces.
    fn attachments(&self) -> &Attachments {
        Attachments::none()
    }

    /// Fills `out` with the numbers that the vertices in `range` carry in channel number `channel`, vertex after
    /// vertex; with none where the channel has seams.
    fn channel(&self, _channel: usize, _range: Range<usize>, out: &mut Vec<f64>) {
        out.clear();
    }

    /// Returns the numbers of channel number `channel` where it has seams, so that they do not stand at vertices.
    fn channel_places(&self, _channel: usize) -> Option<Box<dyn PlaceSource + '_>> {
        None
    }

    /// Returns the texture coordinates, two numbers a place.
    fn uvs(&self) -> Option<Box<dyn PlaceSource + '_>> {
        None
    }

    /// Returns the same mesh with a vertex for each place of all that has seams together, so that all of it is numbered
    /// like the vertices; `None` where it is already.
    fn unfolded(&self) -> Option<Box<dyn MeshSource + '_>> {
        None
    }

    /// Returns the ends of the interior edges that are still sharp, where the mesh brings normals those that stay so.
    fn sharp_edges(&self) -> Vec<[u32; 2]> {
        Vec::new()
    }

    /// Returns what is sharp of a mesh that stands as it was given; nothing of what a plan has refined.
    fn tags(&self) -> Tags {
        Tags::default()
    }
}

/// A mesh whose positions are made whenever they are asked for. Some are made together: who asks for ranges that end
/// where this says has each made once. What is said of faces holds where all are quads.
pub trait OnDemandSource: Sync {
    /// Where a range of vertices that starts at `vertex` ends best.
    fn stretch(&self, vertex: usize) -> usize;

    /// Where a range of shown faces that starts at `face` ends best.
    fn stretch_of_faces(&self, face: usize) -> usize;

    /// Fills `out` with the positions (model units) at the corners of the shown faces in `range`.
    fn corners(&self, range: Range<usize>, out: &mut Vec<[[f64; 3]; 4]>);

    /// Fills `out` with the sum of what the shown faces around each vertex in `range` give, in the order of the faces;
    /// `of_face` gives it for the positions at the corners of a face.
    fn sums(&self, range: Range<usize>, of_face: &dyn Fn([[f64; 3]; 4]) -> [f64; 3], out: &mut Vec<[f64; 3]>);
}

/// Unit normals of vertices, zero where they are undefined.
pub trait NormalSource {
    /// Fills `out` with the normals of the vertices in `range`.
    fn of_vertices(&self, range: Range<usize>, out: &mut Vec<[f64; 3]>);

    /// The normal of a vertex on the side of the face in which `next` follows it, where normals differ from side to
    /// side.
    fn on_side(&self, vertex: u32, next: u32) -> Option<[f64; 3]>;
}

/// Values of face corners: they stand at places of their own, as a vertex on a seam has several.
pub trait PlaceSource: Sync {
    /// Number of places.
    fn n_places(&self) -> usize;

    /// Fills `out` with the values of the places in `range`, place after place.
    fn values(&self, range: Range<usize>, out: &mut Vec<f64>);

    /// Fills `out` with the places at the half-edges of the faces in `range`.
    fn faces(&self, range: Range<usize>, out: &mut FaceChunk);

    /// Whether places are numbered like the vertices.
    fn follow_vertices(&self) -> bool {
        false
    }
}

/// The cells of the input that the vertices and faces of a mesh came of. A mesh that stands as it was given has the
/// cells of the input for its own.
pub trait OriginSource {
    /// Numbers of vertices, edges and faces of the input, hidden ones included.
    fn input_cells(&self) -> [usize; 3];

    /// The cell of the input that vertex `vertex` came of.
    fn vertex_origin(&self, vertex: usize) -> Origin {
        Origin { dimension: 0, cell: index(vertex) }
    }

    /// The input face that shown face `face` came of.
    fn face_origin(&self, face: usize) -> u32 {
        index(face)
    }

    /// The shown faces that came of input face `face`: consecutive ones, none where it is hidden.
    fn faces_of(&self, face: usize) -> Range<usize> {
        face..face + 1
    }

    /// Fills `out` with the vertices along edge `edge` of the input, from its start to its end, and says whether a face
    /// beside it is shown; what it held before is dropped. Edges that did not stay have no vertices.
    fn isoline(&self, _edge: usize, out: &mut Vec<u32>) -> bool {
        out.clear();
        false
    }
}

/// The cell of the input in which a vertex arose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Origin {
    /// 0 for a vertex, 1 for an edge, 2 for a face.
    pub dimension: u8,
    /// Its number; edges are numbered by first appearance when faces are scanned in order, half-edge by half-edge.
    pub cell: u32,
}

/// Some consecutive faces, one after another in `vertices`. Where all have equally many vertices, as after every split,
/// nothing is kept for each of them besides these.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct FaceChunk {
    /// Vertices of every face, as long as all have equally many; 0 where they have not, or where there is none.
    size: u32,
    /// Vertices of each face, where they have not equally many.
    sizes: Vec<u32>,
    /// Vertex indices, face after face.
    pub vertices: Vec<u32>,
}

impl FaceChunk {
    /// Number of faces.
    pub fn len(&self) -> usize {
        if self.size > 0 { self.vertices.len() / self.size as usize } else { self.sizes.len() }
    }

    /// Whether there are no faces.
    pub fn is_empty(&self) -> bool {
        self.vertices.is_empty()
    }

    /// Number of vertices of face `i` of these.
    pub fn size(&self, i: usize) -> usize {
        self.sizes.get(i).copied().unwrap_or(self.size) as usize
    }

    /// Vertices of the largest face, 0 where there is none.
    pub fn largest(&self) -> usize {
        self.sizes.iter().copied().max().unwrap_or(self.size) as usize
    }

    /// Drops all faces, keeps the memory.
    pub fn clear(&mut self) {
        self.size = 0;
        self.sizes.clear();
        self.vertices.clear();
    }

    /// Appends one face.
    pub fn push(&mut self, vertices: &[u32]) {
        let size = u32::try_from(vertices.len()).expect("a face has fewer than 2^32 vertices");
        if self.is_empty() {
            self.size = size;
        } else if self.size != size {
            self.sizes.resize(self.len(), self.size);
            self.sizes.push(size);
            self.size = 0;
        }
        self.vertices.extend_from_slice(vertices);
    }

    /// Makes it `n` faces of `size` vertices each and gives their places, which are to be written: what stands there is
    /// of no meaning.
    pub fn places(&mut self, size: usize, n: usize) -> &mut [u32] {
        self.sizes.clear();
        self.size = if n == 0 { 0 } else { u32::try_from(size).expect("a face has fewer than 2^32 vertices") };
        // only what was never there is filled with zeros
        self.vertices.resize(size * n, 0);
        &mut self.vertices
    }

    /// The faces, one slice each.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[u32]> {
        let mut rest = self.vertices.as_slice();
        (0..self.len()).map(move |i| {
            let (face, after) = rest.split_at(self.size(i));
            rest = after;
            face
        })
    }

    /// The faces as rows of `N` vertices, where all have so many.
    pub fn rows<const N: usize>(&self) -> Option<&[[u32; N]]> {
        (self.size as usize == N).then(|| self.vertices.as_chunks().0)
    }
}
