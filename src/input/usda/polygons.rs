//! One mesh: its points and faces, and its subdivision tags.

use super::tree::Prim;
use crate::input::collect::{MeshBuilder, whole};
use crate::input::room::{GROWN, MemoryBudget};
use crate::input::text::quoted;
use crate::input::transform::Transform;
use crate::scheme::tags::Boundary;
use crate::shape::topology::index;

/// Bytes of memory of a vertex, of a corner of a face, of a face and of a tag, each kept in lists that grow.
const USDA_POSITION_BYTES: usize = GROWN * 24;
const USDA_CORNER_BYTES: usize = GROWN * 8;
const USDA_FACE_BYTES: usize = GROWN * 8;
const USDA_TAG_BYTES: usize = GROWN * 24;

/// The ranges of one mesh within the combined mesh.
#[derive(Debug)]
pub(super) struct MeshRanges {
    pub(super) first_vertex: usize,
    pub(super) n_vertices: usize,
    pub(super) first_face: usize,
    pub(super) n_faces: usize,
    pub(super) first_corner: usize,
    /// The index in the file of each stored corner; reversed faces have theirs in another order.
    pub(super) corners: Vec<u32>,
}

/// Converts a number to an index below `n`; `what` names the number in messages.
pub(super) fn below(x: f64, n: usize, what: &str) -> Result<u32, String> {
    let refused = || format!("{what}: {x} is no whole number below {n}");
    whole(x).filter(|&k| (k as usize) < n).ok_or_else(refused)
}

/// Converts the number of indices of a face or crease, which is at most the number of indices left.
fn taken(x: f64, left: usize, what: &str) -> Result<usize, String> {
    let refused = |_| format!("{what}: {x} indices of {left} that are left; give so many, or another number");
    below(x, left + 1, what).map(|n| n as usize).map_err(refused)
}

/// Adds the points and faces of a mesh.
///
/// # Errors
/// The lists do not fit together, or the mesh takes more than is allowed.
pub(super) fn faces(
    prim: &Prim<'_>,
    transform: &Transform,
    room: &mut MemoryBudget,
    all: &mut MeshBuilder,
) -> Result<MeshRanges, String> {
    let points = prim.numbers("points");
    let (points, rest) = points.as_chunks::<3>();
    if !rest.is_empty() {
        return Err("the numbers of points are no multiple of 3".to_owned());
    }
    let counts = prim.numbers("faceVertexCounts");
    let indices = prim.numbers("faceVertexIndices");
    room.take(points.len() * USDA_POSITION_BYTES + indices.len() * USDA_CORNER_BYTES + counts.len() * USDA_FACE_BYTES)?;
    let mesh = &all.mesh;
    let (first_vertex, first_face) = (mesh.positions.len(), mesh.faces.len());
    let first_corner = mesh.faces.n_half_edges();
    for (i, &point) in points.iter().enumerate() {
        let at = transform.point(point);
        if at.iter().any(|x| !x.is_finite()) {
            return Err(format!("point {i} comes to a place that is not finite"));
        }
        all.vertex(at)?;
    }
    let is_turned = (prim.word("orientation") == Some("leftHanded")) != transform.is_mirror();
    let mut corners = Vec::with_capacity(indices.len());
    let (mut face, mut at) = (Vec::new(), 0);
    for (f, &count) in counts.iter().enumerate() {
        let what = format!("faceVertexCounts, {f}");
        let end = at + taken(count, indices.len() - at, &what)?;
        let first = corners.len();
        corners.extend(index(at)..index(end));
        if is_turned && end > at {
            corners[first + 1..].reverse();
        }
        face.clear();
        for &corner in &corners[first..] {
            let v = below(indices[corner as usize], points.len(), "faceVertexIndices")?;
            face.push(index(first_vertex) + v);
        }
        all.face(&face).map_err(|detail| format!("face {f}: {detail}"))?;
        at = end;
    }
    if at < indices.len() {
        return Err(format!("faceVertexCounts come to {at}, and faceVertexIndices are {}", indices.len()));
    }
    let (n_vertices, n_faces) = (points.len(), counts.len());
    Ok(MeshRanges { first_vertex, n_vertices, first_face, n_faces, first_corner, corners })
}

/// Adds the creases, corners and holes of a mesh whose faces were added.
///
/// # Errors
/// The lists do not fit together, a vertex or face does not exist, or a sharpness is negative.
pub(super) fn tags(
    prim: &Prim<'_>,
    part: &MeshRanges,
    room: &mut MemoryBudget,
    all: &mut MeshBuilder,
) -> Result<(), String> {
    let sharp = |name: &str, i: usize| {
        let x = prim.numbers(name).get(i).copied().unwrap_or(f64::NAN);
        if x >= 0.0 { Ok(x) } else { Err(format!("{name}, {i}: {x} is no sharpness, which is 0 or more")) }
    };
    let vertex =
        |x: f64, what: &str| Ok::<_, String>(u64::from(below(x, part.n_vertices, what)?) + part.first_vertex as u64);
    let [indices, lengths] = ["creaseIndices", "creaseLengths"].map(|name| prim.numbers(name));
    let corners = prim.numbers("cornerIndices");
    let holes = prim.numbers("holeIndices");
    room.take((indices.len() + corners.len() + holes.len()) * USDA_TAG_BYTES)?;
    let n_edges = indices.len().saturating_sub(lengths.len());
    let n_given = prim.numbers("creaseSharpnesses").len();
    if n_given != lengths.len() && n_given != n_edges {
        let detail = format!("{n_given}; it is one for each of {} creases or of {n_edges} edges", lengths.len());
        return Err(format!("creaseSharpnesses are {detail}"));
    }
    let (mut at, mut edge) = (0, 0);
    for (i, &length) in lengths.iter().enumerate() {
        let length = taken(length, indices.len() - at, &format!("creaseLengths, {i}"))?;
        for pair in indices[at..at + length].windows(2) {
            let sharpness = sharp("creaseSharpnesses", if n_given == lengths.len() { i } else { edge })?;
            let ends = [vertex(pair[0], "creaseIndices")?, vertex(pair[1], "creaseIndices")?];
            all.mesh.creases.push((ends, sharpness));
            edge += 1;
        }
        at += length;
    }
    for (i, &corner) in corners.iter().enumerate() {
        all.mesh.corners.push((vertex(corner, "cornerIndices")?, sharp("cornerSharpnesses", i)?));
    }
    for &hole in holes {
        let face = below(hole, part.n_faces, "holeIndices")?;
        all.mesh.holes.push(u64::from(face) + part.first_face as u64);
    }
    Ok(())
}

/// Returns the boundary rule of a subdivision surface; `None` for polygons.
///
/// # Errors
/// The rule is unknown.
pub(super) fn boundary(prim: &Prim<'_>) -> Result<Option<Boundary>, String> {
    if !is_subdivided(prim) {
        return Ok(None);
    }
    match prim.word("interpolateBoundary") {
        None | Some("edgeAndCorner") => Ok(Some(Boundary::EdgeAndCorner)),
        Some("edgeOnly") => Ok(Some(Boundary::EdgeOnly)),
        Some("none") => Ok(Some(Boundary::None)),
        Some(other) => Err(format!("interpolateBoundary is {}; it is none, edgeOnly or edgeAndCorner", quoted(other))),
    }
}

/// Whether a mesh is a subdivision surface, which is the default.
pub(super) fn is_subdivided(prim: &Prim<'_>) -> bool {
    prim.word("subdivisionScheme") != Some("none")
}
