//! Control meshes.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Arc;

use super::attachments::{Attachments, AttachmentsInput};
use super::attributes::Attributes;
use super::check::{FaceList, NonManifold, Winding};
use super::creases::{CreaseTags, INFINITE_SHARPNESS, Pairs, Sharp, check_corners};
use super::directions::Directions;
use super::indices::check_indices;
use super::repairs::{AffectedFaces, Repair};
use super::topology::{Topology, index};
use crate::fault::{Fault, under};

/// A checked control mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// Coordinates of the vertices, `n_vertices x 3`, in model units.
    pub positions: Vec<f64>,
    /// Positions of the same vertices in other frames, each `n_vertices x 3`, in model units: frame 0 is `positions`,
    /// frame `k` is entry `k - 1`.
    pub frames: Arc<[Vec<f64>]>,
    /// The connectivity of the faces.
    pub topology: Arc<Topology>,
    /// Corners: infinitely sharp vertices, which keep their position; ascending.
    pub corners: Vec<u32>,
    /// Sharpness of the semi-sharp vertices.
    pub semi_sharp_corners: Sharp,
    /// Sharpness of interior edges.
    pub creases: Sharp,
    /// Faces that are refined but not shown, ascending.
    pub holes: Vec<u32>,
    /// Vertex parameters.
    pub attributes: Option<Attributes>,
    /// Directions of the edges along latitude and longitude lines.
    pub directions: Option<Directions>,
    /// What the mesh carries besides its shape.
    pub attachments: Arc<Attachments>,
    /// For each of the last vertices, which were added by splitting: the vertex of the input that it was split from.
    pub split_from: Arc<[u32]>,
    /// The repairs of the mesh, and notes on it.
    pub repairs: Vec<Repair>,
}

/// A mesh as a client gives it, unchecked.
#[derive(Debug, Clone, Default)]
pub struct MeshInput {
    /// Positions of the vertices.
    pub positions: Vec<[f64; 3]>,
    /// Positions of the same vertices in other frames.
    pub frames: Vec<Vec<[f64; 3]>>,
    /// Faces.
    pub faces: FaceList,
    /// Sharp vertices and their sharpness.
    pub corners: Vec<(u64, f64)>,
    /// The ends of sharp edges, and their sharpness.
    pub creases: Vec<([u64; 2], f64)>,
    /// Faces that are refined but not shown.
    pub holes: Vec<u64>,
    /// Vertex parameters.
    pub attributes: Option<Attributes>,
    /// The ends of edges along latitude lines.
    pub latitude: Vec<[u64; 2]>,
    /// The ends of edges along longitude lines.
    pub longitude: Vec<[u64; 2]>,
    /// How to treat inconsistent winding.
    pub winding: Winding,
    /// How to treat faces that do not form a manifold.
    pub non_manifold: NonManifold,
    /// What the mesh carries besides its shape.
    pub attachments: AttachmentsInput,
    /// Notes of the file reader, as sentences.
    pub notes: Vec<String>,
    /// Repairs made before the check.
    pub repairs: Vec<Repair>,
}

impl Mesh {
    /// Returns the repairs and notes as sentences.
    pub fn warnings(&self) -> Vec<String> {
        self.repairs.iter().map(Repair::to_string).collect()
    }

    /// Returns the mesh at one of its frames, without the others; without a frame, the mesh itself.
    ///
    /// # Panics
    /// If there is no such frame.
    pub fn at_frame(&self, frame: Option<usize>) -> Cow<'_, Self> {
        let Some(frame) = frame.filter(|_| !self.frames.is_empty()) else { return Cow::Borrowed(self) };
        let mut alone = Self { frames: Arc::default(), ..self.clone() };
        if let Some(other) = frame.checked_sub(1) {
            alone.positions.clone_from(&self.frames[other]);
        }
        Cow::Owned(alone)
    }

    /// Returns the sharp edges and vertices of the mesh.
    pub fn tags(&self) -> CreaseTags {
        let creases = self.creases.iter().map(|&(e, sharpness)| (self.topology.ends(e as usize), sharpness));
        let fixed = self.corners.iter().map(|&v| (v, INFINITE_SHARPNESS));
        let mut corners: Sharp = fixed.chain(self.semi_sharp_corners.iter().copied()).collect();
        corners.sort_unstable_by_key(|&(v, _)| v);
        CreaseTags { creases: creases.collect(), corners }
    }

    /// Checks and builds a mesh.
    ///
    /// # Errors
    /// Every fault found, with a pointer below the mesh.
    pub fn new(input: MeshInput) -> Result<Self, Vec<Fault>> {
        let n = input.positions.len();
        let n_faces = input.faces.len();
        let mut faults = under("/positions", check_positions(&input.positions));
        faults.extend(check_frames(&input.frames, n));
        if n_faces == 0 {
            faults.push(Fault::new("/faces", "there is no face; a mesh has at least one"));
        }
        let corners = check_corners(&input.corners, n, &mut faults);
        let pairs = Pairs::check(&input.creases, n, &mut faults);
        let holes = check_indices("/holes", "face", &input.holes, ("mesh", n_faces), &mut faults);
        let (checked, cut) = match Topology::of_any_faces(n, input.faces, input.winding, input.non_manifold) {
            Ok(checked) => checked,
            Err(found) => {
                faults.extend(found);
                return Err(faults);
            }
        };
        let creases = pairs.edges(&checked.topology, n, &checked.split_from).unwrap_or_else(|found| {
            faults.extend(found);
            Sharp::new()
        });
        let (topology, split_from) = (&checked.topology, &checked.split_from);
        let directions = Directions::new(topology, &input.latitude, &input.longitude, n, split_from);
        faults.extend(directions.as_ref().err().into_iter().flatten().cloned());
        let attributes = input.attributes.as_ref().map(|given| check_attributes(given, n, split_from)).transpose();
        faults.extend(attributes.as_ref().err().into_iter().flatten().cloned());
        let attachments = Attachments::new(input.attachments, n, &checked);
        faults.extend(attachments.as_ref().err().into_iter().flatten().cloned());
        let (Ok(attachments), Ok(directions), Ok(attributes)) = (attachments, directions, attributes) else {
            return Err(faults);
        };
        if !faults.is_empty() {
            return Err(faults);
        }
        let coordinates = |points: Vec<[f64; 3]>| {
            // reserves the memory at once, since growing lists take up to three times their size
            let mut all: Vec<f64> = Vec::with_capacity(3 * (points.len() + checked.split_from.len()));
            all.extend(points.into_iter().flatten().map(|x| x + 0.0));
            let parts = checked.split_from.iter().map(|&from| 3 * from as usize);
            parts.for_each(|start| all.extend_from_within(start..start + 3));
            all
        };
        let (positions, frames) = (coordinates(input.positions), input.frames.into_iter().map(coordinates).collect());
        let mut repairs: Vec<Repair> = input.notes.into_iter().map(Repair::Read).chain(input.repairs).collect();
        repairs.extend(cut.into_iter().chain(Repair::split(n, &checked.split_from)));
        repairs.extend(AffectedFaces::some(checked.reversed.iter().copied()).map(Repair::Turned));
        let (fixed, semi_sharp_corners): (Sharp, Sharp) = on_all_parts(corners, n, &checked.split_from)
            .into_iter()
            .partition(|&(_, sharpness)| sharpness >= INFINITE_SHARPNESS);
        let corners = fixed.into_iter().map(|(v, _)| v).collect();
        let topology = Arc::new(checked.topology);
        let attachments = Arc::new(attachments);
        Ok(Self {
            positions,
            frames,
            topology,
            corners,
            semi_sharp_corners,
            creases,
            holes,
            attributes,
            directions,
            attachments,
            split_from: checked.split_from.into(),
            repairs,
        })
    }
}

/// Extends the sharpness of vertices to the copies that were split from them, which have the indices from `n` on.
fn on_all_parts(mut corners: Sharp, n: usize, split_from: &[u32]) -> Sharp {
    let known: BTreeMap<u32, f64> = corners.iter().copied().collect();
    let sharp = |(part, from)| known.get(from).map(|&sharpness| (index(part), sharpness));
    corners.extend((n..).zip(split_from).filter_map(sharp));
    corners
}

/// Checks the vertex parameters and extends them to the copies of vertices that were split.
fn check_attributes(attributes: &Attributes, n: usize, split_from: &[u32]) -> Result<Attributes, Vec<Fault>> {
    attributes.check(n).map_err(|faults| under("/parameters", faults))?;
    Ok(attributes.changed(|array| {
        let parts = split_from.iter().map(|&v| array[v as usize]);
        array.iter().copied().chain(parts).collect()
    }))
}

/// Maximum number of frames of a mesh: each takes some hundred bytes of a document that describes it, and a morph
/// target in viewers.
pub const MAX_MESH_FRAMES: usize = 1024;

fn check_frames(frames: &[Vec<[f64; 3]>], n: usize) -> Vec<Fault> {
    if frames.len() >= MAX_MESH_FRAMES {
        let detail = format!("{} frames beside the first; a mesh has at most {MAX_MESH_FRAMES} in all", frames.len());
        return vec![Fault::new("/frames", detail)];
    }
    let found = frames.iter().enumerate().flat_map(|(i, frame)| {
        let place = format!("/frames/{i}");
        if frame.len() == n {
            under(&place, check_positions(frame))
        } else {
            vec![Fault::new(place, format!("{} positions for {n} vertices; give one a vertex", frame.len()))]
        }
    });
    found.take(20).collect()
}

fn check_positions(positions: &[[f64; 3]]) -> Vec<Fault> {
    let wrong = positions.iter().enumerate().filter_map(|(i, p)| Some((i, p.iter().position(|x| !x.is_finite())?, p)));
    let faults = wrong.map(|(i, j, p)| Fault::new(format!("/{i}/{j}"), format!("{} is not a finite number", p[j])));
    faults.take(20).collect()
}
