//! Values of face corners, such as texture coordinates: a mesh of their own, whose vertices are the places that corners
//! share and whose boundaries are the seams.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::check::{FaceList, Winding};
use super::pair::Diagonal;
use super::topology::{NONE, Topology, index};
use super::weld::Welded;
use crate::fault::Fault;

/// Where face-corner values are interpolated linearly, in the terms of OpenSubdiv.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Interpolation {
    /// Nowhere: the values are smooth everywhere.
    None,
    /// At corners, that is, places with one face.
    CornersOnly,
    /// At corners, and where three or more regions meet; where two meet, both are as sharp as the sharper one.
    CornersPlus1,
    /// Where [`Self::CornersPlus1`] does, and where a seam ends inside, and next to a corner where two regions meet.
    CornersPlus2,
    /// Along all boundaries and seams.
    Boundaries,
    /// Everywhere.
    #[default]
    All,
}

/// Which values the corners of faces have, as a client gives them, unchecked.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SeamsInput {
    /// For each face of the mesh the indices of the values at its corners, in order.
    pub faces: FaceList,
    /// Where the values are interpolated linearly.
    pub interpolation: Interpolation,
}

/// Texture coordinates as a client gives them, unchecked.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct UvsInput {
    /// The texture coordinates, `n x 2`.
    pub values: Vec<[f64; 2]>,
    /// The corners that have them.
    pub seams: SeamsInput,
}

impl SeamsInput {
    /// Assigns the values of vertices to the corners of faces.
    pub(super) fn of_vertices(faces: &FaceList) -> Self {
        Self { faces: faces.clone(), interpolation: Interpolation::None }
    }

    /// Returns whether there is a value for each corner of these faces.
    pub(super) fn fits(&self, faces: &FaceList) -> bool {
        let sizes = |faces: &FaceList| (0..faces.len()).map(|f| faces.face(f).len()).collect::<Vec<_>>();
        sizes(&self.faces) == sizes(faces)
    }

    /// Joins equal values, `n x width`, at merged vertices; where they differ, a seam stays. `faces` have the vertices
    /// from before the merging.
    pub(super) fn join(&mut self, width: usize, values: &[f64], faces: &FaceList, welded: &Welded) {
        let n = values.len() / width;
        if !self.fits(faces) || self.faces.vertices().iter().any(|&value| value as usize >= n) {
            return;
        }
        let mut n_merged = vec![0_u32; welded.kept.len()];
        welded.image.iter().for_each(|&new| n_merged[new as usize] += 1);
        let mut known: BTreeMap<(u32, Vec<u64>), u32> = BTreeMap::new();
        let joined = faces.vertices().iter().zip(self.faces.vertices()).map(|(&v, &value)| {
            let new = welded.image[v as usize];
            if n_merged[new as usize] < 2 {
                return value;
            }
            let start = value as usize * width;
            let bits = values[start..start + width].iter().map(|x| (x + 0.0).to_bits()).collect();
            *known.entry((new, bits)).or_insert(value)
        });
        self.faces = self.faces.with_vertices(joined.collect());
    }

    /// Reverses the values of faces that were reversed. Values that do not fit are left for [`Seams::new`] to refuse.
    pub(super) fn reverse(&mut self, faces: &FaceList, reversed: &[u32]) {
        if self.fits(faces) {
            reversed.iter().for_each(|&f| self.faces.reverse(f as usize));
        }
    }

    /// Adapts the values to new faces; `corners` names the old corner of each new corner.
    pub(super) fn follow(&mut self, before: &FaceList, after: &FaceList, corners: &[u32]) {
        if !self.fits(before) {
            return;
        }
        let mut new = corners.iter().map(|&half_edge| self.faces.vertices()[half_edge as usize]);
        self.faces = (0..after.len()).map(|f| new.by_ref().take(after.face(f).len()).collect::<Vec<_>>()).collect();
    }

    /// Returns whether two faces have the same values at both ends of the edge between them.
    pub(super) fn joins(&self, diagonal: Diagonal) -> bool {
        let value = |f: u32, j: u32| self.faces.face(f as usize)[j as usize];
        let [f, g] = diagonal.faces;
        let same = |i: usize| value(f, diagonal.lower[i]) == value(g, diagonal.higher[i]);
        same(0) && same(1)
    }
}

/// The places of checked face-corner values; faces and their corners are those of the mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Seams {
    /// The topology with the places as vertices; an edge is inner if both faces have the same values at both ends.
    pub topology: Arc<Topology>,
    /// Places that keep their value in any case, ascending.
    pub corners: Vec<u32>,
    /// Both places of each vertex with two places, under rules by which creases in the region of one sharpen the
    /// other.
    pub pairs: Vec<[u32; 2]>,
    /// Whether the values are linear everywhere.
    pub linear: bool,
}

/// Checked texture coordinates, by place.
#[derive(Debug, Clone, PartialEq)]
pub struct Uvs {
    /// The texture coordinates of the places, `n_places x 2`.
    pub values: Vec<f64>,
    /// The places.
    pub seams: Seams,
}

impl Seams {
    /// Checks the face-corner values of a mesh, `n x width`, and returns the values of places, `n_places x width`.
    /// `reversed` are the faces whose vertices were reversed since they were given.
    ///
    /// # Errors
    /// Numbers of faces and corners that differ from those of the mesh, values that do not exist or are not finite,
    /// with pointers below the two.
    pub fn new(
        input: &SeamsInput,
        (width, given): (usize, &[f64]),
        mesh: &Topology,
        reversed: &[u32],
    ) -> Result<(Self, Vec<f64>), Vec<Fault>> {
        let corner_values = corner_values(&input.faces, (width, given), mesh, reversed)?;
        let value = |half_edge: u32| corner_values[half_edge as usize];
        let joined = |half_edge: u32| {
            let twin = mesh.twin(half_edge);
            value(half_edge) == value(mesh.next(twin)) && value(mesh.next(half_edge)) == value(twin)
        };
        let (topology, place_of_corner) = CornerRuns { mesh, joined }.topology()?;
        let n_places = topology.n_vertices();
        let mut values = vec![0.0; width * n_places];
        let (mut vertex_of, mut value_of) = (vec![0; n_places], vec![0; n_places]);
        for (half_edge, &place) in (0..).zip(&place_of_corner) {
            let (place, from) = (place as usize, value(half_edge) as usize);
            let row = given[width * from..width * (from + 1)].iter().map(|x| x + 0.0);
            values[width * place..width * (place + 1)].iter_mut().zip(row).for_each(|(slot, x)| *slot = x);
            (vertex_of[place], value_of[place]) = (mesh.vertex(half_edge), value(half_edge));
        }
        let linear = input.interpolation == Interpolation::All;
        let mut at_vertex: Vec<Vec<u32>> = vec![Vec::new(); mesh.n_vertices()];
        for (place, &vertex) in (0..).zip(&vertex_of) {
            at_vertex[vertex as usize].push(place);
        }
        let corners =
            if linear { Vec::new() } else { corners(&topology, mesh, &at_vertex, &value_of, input.interpolation) };
        let paired = matches!(input.interpolation, Interpolation::CornersPlus1 | Interpolation::CornersPlus2);
        let pairs = at_vertex.iter().filter_map(|places| places.as_slice().try_into().ok().filter(|_| paired));
        let pairs = pairs.collect();
        Ok((Self { topology: Arc::new(topology), corners, pairs, linear }, values))
    }

    /// Returns where the values are linear, as the first term that has this meaning on the given mesh.
    pub fn interpolation(&self, mesh: &Topology) -> Interpolation {
        const INTERPOLATIONS: [Interpolation; 5] = [
            Interpolation::None,
            Interpolation::CornersOnly,
            Interpolation::CornersPlus1,
            Interpolation::CornersPlus2,
            Interpolation::Boundaries,
        ];
        if self.linear {
            return Interpolation::All;
        }
        let n_places = self.topology.n_vertices();
        let mut at_vertex: Vec<Vec<u32>> = vec![Vec::new(); mesh.n_vertices()];
        for place in 0..index(n_places) {
            let vertex = self.vertex(place, mesh);
            vertex.into_iter().for_each(|vertex| at_vertex[vertex as usize].push(place));
        }
        // each place counts as a value of its own here
        let value_of: Vec<u32> = (0..index(n_places)).collect();
        let differing = |word: &Interpolation| {
            let kept = corners(&self.topology, mesh, &at_vertex, &value_of, *word);
            let missing = kept.iter().filter(|place| self.corners.binary_search(place).is_err()).count();
            let other = self.corners.iter().filter(|place| kept.binary_search(place).is_err()).count();
            let is_paired = matches!(word, Interpolation::CornersPlus1 | Interpolation::CornersPlus2);
            (missing + other, !self.pairs.is_empty() && !is_paired)
        };
        INTERPOLATIONS.into_iter().min_by_key(differing).unwrap_or_default()
    }

    /// Returns the vertex of the mesh at a place.
    pub fn vertex(&self, place: u32, mesh: &Topology) -> Option<u32> {
        self.topology.ring(place as usize).next().map(|half_edge| mesh.vertex(half_edge))
    }

    /// Returns the edges of the mesh across which the values differ, ascending.
    pub fn edges(&self, mesh: &Topology) -> Vec<u32> {
        let differs = |&e: &usize| {
            let [first, second] = mesh.halves(e);
            second != NONE && self.topology.is_boundary_edge(self.topology.edge(first) as usize)
        };
        (0..mesh.n_edges()).filter(differs).map(index).collect()
    }
}

/// Returns the topology with one vertex per place of all given seams together: an edge is inner if it is inner in
/// each.
///
/// # Errors
/// Never, as its places have no more faces than those of each.
pub fn joint(sets: &[&Seams], mesh: &Topology) -> Result<Arc<Topology>, Vec<Fault>> {
    if let [one] = sets {
        return Ok(one.topology.clone());
    }
    let is_inner =
        |seams: &&Seams, half_edge| !seams.topology.is_boundary_edge(seams.topology.edge(half_edge) as usize);
    let joined = |half_edge: u32| sets.iter().all(|seams| is_inner(seams, half_edge));
    CornerRuns { mesh, joined }.topology().map(|(topology, _)| Arc::new(topology))
}

/// Returns the index of the value at each corner.
fn corner_values(
    faces: &FaceList,
    (width, values): (usize, &[f64]),
    mesh: &Topology,
    reversed: &[u32],
) -> Result<Vec<u32>, Vec<Fault>> {
    let wrong = values.iter().enumerate().filter(|(_, x)| !x.is_finite());
    let place =
        |k: usize| if width > 1 { format!("/values/{}/{}", k / width, k % width) } else { format!("/values/{k}") };
    let mut faults: Vec<Fault> =
        wrong.take(20).map(|(k, x)| Fault::new(place(k), format!("{x} is not a finite number"))).collect();
    if faces.len() != mesh.n_faces() {
        let detail = format!("{} faces; give one for each of the {} of the mesh", faces.len(), mesh.n_faces());
        faults.push(Fault::new("/faces", detail));
        return Err(faults);
    }
    let n = values.len() / width;
    let mut found = Vec::with_capacity(mesh.n_half_edges());
    for f in 0..faces.len() {
        let face = faces.face(f);
        let size = mesh.face(f).len();
        if face.len() != size {
            let detail = format!("{} corners; the face of the mesh has {size}", face.len());
            faults.push(Fault::new(format!("/faces/{f}"), detail));
        } else if let Some(j) = face.iter().position(|&value| value as usize >= n) {
            let detail = format!("there is no value {}; there are {n}, counted from 0", face[j]);
            faults.push(Fault::new(format!("/faces/{f}/{j}"), detail));
        }
        if faults.len() >= 20 {
            return Err(faults);
        }
        let start = found.len();
        found.extend_from_slice(face);
        if reversed.binary_search(&index(f)).is_ok() {
            found[start..].reverse();
        }
    }
    if faults.is_empty() { Ok(found) } else { Err(faults) }
}

/// Runs of adjacent corners around a vertex that share a place.
struct CornerRuns<'a, J> {
    mesh: &'a Topology,
    /// Whether both faces at an inner edge share their places there.
    joined: J,
}

impl<J: Fn(u32) -> bool> CornerRuns<'_, J> {
    fn joined(&self, half_edge: u32) -> bool {
        self.mesh.twin(half_edge) != NONE && (self.joined)(half_edge)
    }

    /// Returns the topology whose vertices are the places, and the place of each corner.
    fn topology(&self) -> Result<(Topology, Vec<u32>), Vec<Fault>> {
        let (place_of_corner, n_places) = self.places();
        let places = |f: usize| self.mesh.half_edges(f).map(|half_edge| place_of_corner[half_edge as usize]);
        let faces = (0..self.mesh.n_faces()).map(places).collect();
        let checked = Topology::of_faces(n_places, faces, Winding::Refuse)?;
        Ok((checked.topology, place_of_corner))
    }

    /// Returns the place of each corner, and the number of places. Places are numbered by vertex, then by first
    /// appearance, so that without seams they have the indices of the vertices with faces.
    fn places(&self) -> (Vec<u32>, usize) {
        let mut places = vec![NONE; self.mesh.n_half_edges()];
        let mut order: Vec<u32> = (0..index(places.len())).collect();
        order.sort_by_key(|&half_edge| self.mesh.vertex(half_edge));
        let mut n = 0;
        for half_edge in order {
            if places[half_edge as usize] != NONE {
                continue;
            }
            let mut at = half_edge;
            while self.joined(at) {
                at = self.mesh.next(self.mesh.twin(at));
                if at == half_edge {
                    break;
                }
            }
            loop {
                places[at as usize] = n;
                let before = self.mesh.previous(at);
                if !self.joined(before) {
                    break;
                }
                at = self.mesh.twin(before);
                if places[at as usize] != NONE {
                    break;
                }
            }
            n += 1;
        }
        (places, n as usize)
    }
}

/// Returns the places that an interpolation keeps, and those where one value occurs in two fans of a vertex.
///
/// Source: OpenSubdiv 3.5, checked by comparing values. It differs where two values alternate around a vertex:
/// OpenSubdiv takes the second one as new when it recurs, and so splits the value that comes second in its order of
/// faces.
fn corners(
    topology: &Topology,
    mesh: &Topology,
    at_vertex: &[Vec<u32>],
    value_of: &[u32],
    interpolation: Interpolation,
) -> Vec<u32> {
    let size = |place: u32| topology.ring(place as usize).count();
    let on_boundary = |place: u32| topology.boundary_edges(place as usize).is_some();
    let is_corner = |place: u32| on_boundary(place) && size(place) == 1;
    let value = |place: u32| value_of[place as usize];
    let mut kept = Vec::new();
    for (vertex, places) in at_vertex.iter().enumerate() {
        let inside = mesh.boundary_edges(vertex).is_none();
        let all = match (interpolation, places.as_slice()) {
            (Interpolation::CornersPlus1 | Interpolation::CornersPlus2, [_, _, _, ..]) => true,
            (Interpolation::CornersPlus2, [one]) => inside && on_boundary(*one),
            (Interpolation::CornersPlus2, [a, b]) => is_corner(*a) || is_corner(*b),
            _ => false,
        };
        let keeps = |&&place: &&u32| {
            let again = places.iter().any(|&other| other != place && value(other) == value(place));
            all || again
                || match interpolation {
                    Interpolation::None | Interpolation::All => false,
                    Interpolation::Boundaries => on_boundary(place),
                    _ => is_corner(place),
                }
        };
        kept.extend(places.iter().filter(keeps));
    }
    kept.sort_unstable();
    kept
}
