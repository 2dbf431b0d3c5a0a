//! Results as sources for writers: curves as a whole, meshes chunk by chunk in the documented order.

use std::ops::Range;

use super::attachments::Attachments;
use super::creases::CreaseTags;
use super::grid::QuadGrid;
pub use super::origin::Origin;
use super::topology::index;

/// One polygon: `points` holds `n x dimension` coordinates, point after point, in model units.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Coordinates, `n x dimension`.
    pub points: Vec<f64>,
    /// Number of coordinates per point, 1 to 4.
    pub dimension: usize,
    /// Whether the last point is joined to the first.
    pub closed: bool,
    /// Unit tangents, `n x dimension`, if they are known; a row of zeros where there is none.
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
/// Methods that fill `out` replace its content.
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

    /// Returns the positions of all vertices if they are in memory in this order, so that nothing has to be copied.
    fn held_positions(&self) -> Option<&[[f64; 3]]> {
        None
    }

    /// Returns this mesh as a source that computes positions on demand, if it is one.
    fn on_demand(&self) -> Option<&dyn OnDemandSource> {
        None
    }

    /// Returns the order of the vertices and of the faces, hidden ones included, if all faces were split into grids of
    /// quads and were quads before.
    fn quad_grid(&self) -> Option<&QuadGrid> {
        None
    }

    /// Returns the mesh at its other frames, which differ in positions and normals only.
    fn frames(&self) -> Vec<&dyn MeshSource> {
        Vec::new()
    }
}

/// What a mesh carries besides vertices and faces; a mesh that carries nothing needs no method of this trait.
pub trait CarriedSource {
    /// Returns the normals of the mesh, if it has any; otherwise they are left to the writer.
    fn normals(&self) -> Option<&dyn NormalSource> {
        None
    }

    /// Returns the names, looks and channels that the mesh carries; names belong to input faces.
    fn attachments(&self) -> &Attachments {
        Attachments::none()
    }

    /// Fills `out` with the values of the vertices in `range` in channel `channel`, vertex after vertex; empty if the
    /// channel has seams.
    fn channel(&self, _channel: usize, _range: Range<usize>, out: &mut Vec<f64>) {
        out.clear();
    }

    /// Returns the values of channel `channel` at its places, if it has seams.
    fn channel_places(&self, _channel: usize) -> Option<Box<dyn PlaceSource + '_>> {
        None
    }

    /// Returns the texture coordinates, two values per place.
    fn uvs(&self) -> Option<Box<dyn PlaceSource + '_>> {
        None
    }

    /// Returns the mesh with one vertex per place of all seams together, so that all attributes are indexed like the
    /// vertices; `None` if they are already.
    fn unfolded(&self) -> Option<Box<dyn MeshSource + '_>> {
        None
    }

    /// Returns the ends of inner edges that are still sharp or, if the mesh has limit normals, of those that stay
    /// sharp.
    fn sharp_edges(&self) -> Vec<[u32; 2]> {
        Vec::new()
    }

    /// Returns the tags of a mesh that is still as it was given; empty for a refined mesh.
    fn tags(&self) -> CreaseTags {
        CreaseTags::default()
    }
}

/// A mesh whose positions are computed on demand. Some are computed together: ranges that end where `stretch` proposes
/// compute each only once. The methods for faces require that all faces are quads.
pub trait OnDemandSource: Sync {
    /// Returns the best end of a range of vertices that starts at `vertex`.
    fn stretch(&self, vertex: usize) -> usize;

    /// Returns the best end of a range of shown faces that starts at `face`.
    fn stretch_of_faces(&self, face: usize) -> usize;

    /// Fills `out` with the positions (model units) at the corners of the shown faces in `range`.
    fn corners(&self, range: Range<usize>, out: &mut Vec<[[f64; 3]; 4]>);

    /// Fills `out`, for each vertex in `range`, with the sum of `of_face` over the shown faces around it, in the order
    /// of the faces; `of_face` maps the corner positions of a face to a vector.
    fn sums(&self, range: Range<usize>, of_face: &dyn Fn([[f64; 3]; 4]) -> [f64; 3], out: &mut Vec<[f64; 3]>);
}

/// Unit normals of vertices; zero where undefined.
pub trait NormalSource {
    /// Fills `out` with the normals of the vertices in `range`.
    fn of_vertices(&self, range: Range<usize>, out: &mut Vec<[f64; 3]>);

    /// Returns the normal of a vertex on the side of the face in which `next` follows it, if normals differ by side.
    fn on_side(&self, vertex: u32, next: u32) -> Option<[f64; 3]>;
}

/// Values of face corners, indexed by place: a vertex on a seam has several places.
pub trait PlaceSource: Sync {
    /// Returns the number of places.
    fn n_places(&self) -> usize;

    /// Fills `out` with the values of the places in `range`, place after place.
    fn values(&self, range: Range<usize>, out: &mut Vec<f64>);

    /// Fills `out` with the places at the half-edges of the faces in `range`.
    fn faces(&self, range: Range<usize>, out: &mut FaceChunk);

    /// Returns whether places are indexed like the vertices.
    fn follow_vertices(&self) -> bool {
        false
    }
}

/// The input cells from which the vertices and faces of a mesh arose. The default methods are those of the input
/// itself.
pub trait OriginSource {
    /// Returns the numbers of vertices, edges and faces of the input, hidden ones included.
    fn input_cells(&self) -> [usize; 3];

    /// Returns the input cell from which vertex `vertex` arose.
    fn vertex_origin(&self, vertex: usize) -> Origin {
        Origin { dimension: 0, cell: index(vertex) }
    }

    /// Returns the input face from which shown face `face` arose.
    fn face_origin(&self, face: usize) -> u32 {
        index(face)
    }

    /// Returns the shown faces that arose from input face `face`: a range, empty if the face is hidden.
    fn faces_of(&self, face: usize) -> Range<usize> {
        face..face + 1
    }

    /// Fills `out` with the vertices along input edge `edge`, from its start to its end, and returns whether a face
    /// next to it is shown. An edge that refinement did not keep has no vertices.
    fn isoline(&self, _edge: usize, out: &mut Vec<u32>) -> bool {
        out.clear();
        false
    }
}

/// Consecutive faces, stored one after another in `vertices`. If all have the same size, as after every split, no
/// further data per face is stored.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct FaceChunk {
    /// The number of vertices of every face if all faces have the same size; otherwise, and without faces, 0.
    size: u32,
    /// The number of vertices of each face if sizes differ.
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

    /// Returns the number of vertices of face `i`.
    pub fn size(&self, i: usize) -> usize {
        self.sizes.get(i).copied().unwrap_or(self.size) as usize
    }

    /// Returns the number of vertices of the largest face, 0 if there is none.
    pub fn largest(&self) -> usize {
        self.sizes.iter().copied().max().unwrap_or(self.size) as usize
    }

    /// Removes all faces and keeps the memory.
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

    /// Resizes to `n` faces of `size` vertices each and returns their slots, whose content is unspecified and must be
    /// overwritten.
    pub fn places(&mut self, size: usize, n: usize) -> &mut [u32] {
        self.sizes.clear();
        self.size = if n == 0 { 0 } else { u32::try_from(size).expect("a face has fewer than 2^32 vertices") };
        // only newly allocated slots are filled with zeros
        self.vertices.resize(size * n, 0);
        &mut self.vertices
    }

    /// Returns the faces, one slice each.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[u32]> {
        let mut rest = self.vertices.as_slice();
        (0..self.len()).map(move |i| {
            let (face, after) = rest.split_at(self.size(i));
            rest = after;
            face
        })
    }

    /// Returns the faces as rows of `N` vertices, if all have that size.
    pub fn rows<const N: usize>(&self) -> Option<&[[u32; N]]> {
        (self.size as usize == N).then(|| self.vertices.as_chunks().0)
    }
}
