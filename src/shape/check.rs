//! Face lists and their checks.

use rayon::prelude::*;

use super::indices::MAX_REPORTED;
use super::topology::index;
use crate::fault::Fault;
use crate::math::sharing::is_small;

/// A face list: face `f` has the vertices `vertices[starts[f]..starts[f + 1]]`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FaceList {
    pub(super) starts: Vec<u32>,
    pub(super) vertices: Vec<u32>,
}

impl Default for FaceList {
    fn default() -> Self {
        Self { starts: vec![0], vertices: Vec::new() }
    }
}

impl<F: IntoIterator<Item = u32>> FromIterator<F> for FaceList {
    fn from_iter<I: IntoIterator<Item = F>>(faces: I) -> Self {
        let mut list = Self::default();
        faces.into_iter().for_each(|face| list.push(face));
        list
    }
}

impl FaceList {
    /// Appends a face.
    pub fn push(&mut self, vertices: impl IntoIterator<Item = u32>) {
        self.vertices.extend(vertices);
        self.starts.push(index(self.vertices.len()));
    }

    /// Appends the faces of another list.
    pub fn append(&mut self, other: &Self) {
        let before = self.starts[self.len()];
        self.starts.extend(other.starts[1..].iter().map(|start| before + start));
        self.vertices.extend_from_slice(&other.vertices);
    }

    /// Number of faces.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Whether there is no face.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of half-edges: the sum of the sizes of all faces.
    pub fn n_half_edges(&self) -> usize {
        self.vertices.len()
    }

    /// The vertices of face `f`.
    pub fn face(&self, f: usize) -> &[u32] {
        &self.vertices[self.starts[f] as usize..self.starts[f + 1] as usize]
    }

    /// The vertices of all faces, face after face.
    pub fn vertices(&self) -> &[u32] {
        &self.vertices
    }

    /// Returns the same faces with other vertices at their corners, given face after face.
    pub(super) fn with_vertices(&self, vertices: Vec<u32>) -> Self {
        Self { starts: self.starts.clone(), vertices }
    }

    pub(super) fn reverse(&mut self, f: usize) {
        self.vertices[self.starts[f] as usize..self.starts[f + 1] as usize].reverse();
    }
}

/// How to treat faces whose winding disagrees with that of their neighbours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Winding {
    /// Faces whose winding disagrees are refused.
    #[default]
    Refuse,
    /// Faces whose winding disagrees are reversed to agree with the lowest face of their component.
    Repair,
}

/// How to treat faces that do not form a manifold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum NonManifold {
    /// Faces that do not form a manifold are refused.
    #[default]
    Refuse,
    /// Faces that do not form a manifold are cut into manifold pieces.
    Split,
    /// Edges with more than two faces are cut, as where welding joins bodies that touch; all else is a fault.
    SplitCrowded,
}

/// Reverses faces so that neighbours run along their common edge in opposite directions, and returns the reversed
/// faces. Under [`NonManifold::Split`], conflicts that remain are left for the cut.
///
/// # Errors
/// As [`Topology::of_faces`](super::topology::Topology::of_faces).
pub fn oriented(
    n_vertices: usize,
    faces: &mut FaceList,
    winding: Winding,
    non_manifold: NonManifold,
) -> Result<Vec<u32>, Vec<Fault>> {
    check_faces(n_vertices, faces, non_manifold)?;
    let sides = sides(n_vertices, faces);
    if non_manifold == NonManifold::Refuse {
        check_edges(faces, &sides)?;
        return orient(faces, &sides, winding);
    }
    let reversed = if winding == Winding::Repair { faces_to_reverse(faces, &sides).0 } else { Vec::new() };
    reversed.iter().for_each(|&f| faces.reverse(f as usize));
    Ok(reversed)
}

/// Reports the first of some faults, and the number of the others, which are not kept: their messages would be longer
/// than the input.
fn report(mut faults: impl Iterator<Item = Fault>) -> Result<(), Vec<Fault>> {
    let first: Vec<Fault> = faults.by_ref().take(MAX_REPORTED).collect();
    let more = faults.count();
    let mut faults = first;
    if faults.is_empty() {
        return Ok(());
    }
    if more > 0 {
        faults.push(Fault::new("/faces", format!("and {more} more faults like these")));
    }
    Err(faults)
}

/// Checks the vertices of each face; a face that will be cut later may visit a vertex more than once.
pub(super) fn check_faces(n_vertices: usize, faces: &FaceList, non_manifold: NonManifold) -> Result<(), Vec<Fault>> {
    let check = |f: usize| -> Option<Fault> {
        let face = faces.face(f);
        let place = || format!("/faces/{f}");
        if face.len() < 3 {
            return Some(Fault::new(place(), format!("a face of {} vertices; a face has at least 3", face.len())));
        }
        if let Some(j) = face.iter().position(|&v| v as usize >= n_vertices) {
            let detail = format!("there is no vertex {}; the mesh has {n_vertices}, counted from 0", face[j]);
            return Some(Fault::new(format!("{}/{j}", place()), detail));
        }
        if non_manifold == NonManifold::Split {
            return None;
        }
        let mut sorted = face.to_vec();
        sorted.sort_unstable();
        let repeated = sorted.windows(2).find(|pair| pair[0] == pair[1])?;
        Some(Fault::new(
            place(),
            format!(
                "vertex {} occurs twice; a face visits each of its vertices once; \"non_manifold\": \"split\" parts it",
                repeated[0]
            ),
        ))
    };
    let all = 0..index(faces.len());
    let is_wrong = |f: &u32| check(*f as usize).is_some();
    let wrong: Vec<u32> = if is_small(faces.len()) {
        all.filter(is_wrong).collect()
    } else {
        all.into_par_iter().filter(is_wrong).collect()
    };
    report(wrong.into_iter().filter_map(|f| check(f as usize)))
}

/// A side of a face: its edge as (lower vertex, higher vertex), then its half-edge.
pub(super) type FaceSide = ((u32, u32), u32);

/// Returns all sides, grouped by edge and ascending by half-edge, by a bucket sort over the lower vertices.
pub(super) fn sides(n_vertices: usize, faces: &FaceList) -> Vec<FaceSide> {
    let all = || {
        (0..faces.len()).flat_map(|f| {
            let face = faces.face(f);
            (0..face.len()).map(move |j| {
                let (a, b) = (face[j], face[(j + 1) % face.len()]);
                ((a.min(b), a.max(b)), faces.starts[f] + index(j))
            })
        })
    };
    let mut places = vec![0; n_vertices + 1];
    all().for_each(|side| places[side.0.0 as usize + 1] += 1);
    (0..n_vertices).for_each(|v| places[v + 1] += places[v]);
    let mut sides = vec![((0, 0), 0); faces.n_half_edges()];
    for side in all() {
        let place = &mut places[side.0.0 as usize];
        sides[*place] = side;
        *place += 1;
    }
    let same_vertex = |a: &FaceSide, b: &FaceSide| a.0.0 == b.0.0;
    if is_small(sides.len()) {
        sides.chunk_by_mut(same_vertex).for_each(<[FaceSide]>::sort_unstable);
    } else {
        sides.par_chunk_by_mut(same_vertex).for_each(<[FaceSide]>::sort_unstable);
    }
    sides
}

/// Returns the sides of each edge as one slice.
pub(super) fn groups(sides: &[FaceSide]) -> impl Iterator<Item = &[FaceSide]> {
    sides.chunk_by(|a, b| a.0 == b.0)
}

/// Returns whether a side runs from the lower vertex to the higher one.
pub(super) fn forward(faces: &FaceList, side: &FaceSide) -> bool {
    faces.vertices[side.1 as usize] == side.0.0
}

/// Returns the face of a half-edge.
pub(super) fn owner(faces: &FaceList, half_edge: u32) -> usize {
    faces.starts.partition_point(|&start| start <= half_edge) - 1
}

/// Checks that each edge has at most two faces.
pub(super) fn check_edges(faces: &FaceList, sides: &[FaceSide]) -> Result<(), Vec<Fault>> {
    let crowded = groups(sides).filter(|group| group.len() > 2).map(|group| {
        let ((a, b), half_edge) = group[2];
        let all: Vec<String> = group.iter().take(8).map(|side| owner(faces, side.1).to_string()).collect();
        let (n, all) = (group.len(), all.join(", "));
        let remedy = "\"non_manifold\": \"split\" cuts the mesh there";
        let detail = format!("edge ({a}, {b}) has {n} faces ({all}); at most 2 are allowed; {remedy}");
        Fault::new(format!("/faces/{}", owner(faces, half_edge)), detail)
    });
    report(crowded)
}

/// Reverses faces so that neighbours agree, or reports why they do not; returns the reversed faces.
pub(super) fn orient(faces: &mut FaceList, sides: &[FaceSide], winding: Winding) -> Result<Vec<u32>, Vec<Fault>> {
    let disagree = |group: &[FaceSide]| group.len() == 2 && forward(faces, &group[0]) == forward(faces, &group[1]);
    let wrong: Vec<&[FaceSide]> = groups(sides).filter(|group| disagree(group)).collect();
    if wrong.is_empty() {
        return Ok(Vec::new());
    }
    let (reversed, conflict) = faces_to_reverse(faces, sides);
    if let Some(conflict) = conflict {
        return Err(vec![conflict]);
    }
    if winding == Winding::Refuse {
        let faults = wrong.iter().map(|group| {
            let ((a, b), half_edge) = group[1];
            let (f, g) = (owner(faces, group[0].1), owner(faces, half_edge));
            let detail = format!(
                "faces {f} and {g} run along edge ({a}, {b}) in the same direction; turn one of them, or set \
                 \"orient\": \"repair\""
            );
            Fault::new(format!("/faces/{g}"), detail)
        });
        report(faults)?;
    }
    for &f in &reversed {
        faces.reverse(f as usize);
    }
    Ok(reversed)
}

/// A neighbouring face, whether it runs along the common edge in the same direction, and that edge.
type Neighbour = (usize, bool, (u32, u32));

/// Returns the faces to reverse so that all agree with the lowest face of their component, found by a search over
/// neighbours, and a fault for the first two neighbours that cannot agree.
pub(super) fn faces_to_reverse(faces: &FaceList, sides: &[FaceSide]) -> (Vec<u32>, Option<Fault>) {
    let mut neighbours: Vec<Vec<Neighbour>> = vec![Vec::new(); faces.len()];
    for group in groups(sides).filter(|group| group.len() == 2) {
        let [f, g] = [owner(faces, group[0].1), owner(faces, group[1].1)];
        let same = faces.vertices[group[0].1 as usize] == faces.vertices[group[1].1 as usize];
        neighbours[f].push((g, same, group[0].0));
        neighbours[g].push((f, same, group[0].0));
    }
    let mut is_reversed: Vec<Option<bool>> = vec![None; faces.len()];
    let mut conflict = None;
    for first in 0..faces.len() {
        if is_reversed[first].is_some() {
            continue;
        }
        is_reversed[first] = Some(false);
        let mut waiting = vec![first];
        while let Some(f) = waiting.pop() {
            for &(g, same, (a, b)) in &neighbours[f] {
                let wanted = is_reversed[f].map(|reversed| reversed != same);
                if is_reversed[g].is_none() {
                    is_reversed[g] = wanted;
                    waiting.push(g);
                } else if is_reversed[g] != wanted && conflict.is_none() {
                    let detail = format!(
                        "the faces cannot be oriented: around edge ({a}, {b}) they form a one-sided strip; cut the \
                         mesh along it, or set \"non_manifold\": \"split\""
                    );
                    conflict = Some(Fault::new(format!("/faces/{g}"), detail));
                }
            }
        }
    }
    ((0..index(faces.len())).filter(|&f| is_reversed[f as usize] == Some(true)).collect(), conflict)
}
