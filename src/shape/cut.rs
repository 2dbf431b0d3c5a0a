//! Cuts faces that do not form a manifold into manifold pieces.
//!
//! The rule. The faces of each edge are paired in the order of their indices: each face with the first earlier one that
//! is still unpaired and runs along the edge in the other direction, but never with itself. Unpaired sides become
//! boundaries. Then each vertex is split into one vertex per fan of faces that stay connected around it.
//!
//! Faces that wind around an edge or a vertex may still meet themselves there. So if more than two sides join the same
//! two vertices after the split, all of them become boundaries; if a face visits a vertex again, so do its two sides at
//! each later visit; then vertices are split again. Two sides that afterwards join the same two vertices are paired. As
//! a result, no two edges join the same two vertices, so the faces alone determine the pieces.

use super::check::{
    FaceList, FaceSide, NonManifold, Winding, check_faces, faces_to_reverse, forward, groups, orient, owner, sides,
};
use super::connect::{CheckedTopology, connect};
use super::repairs::{AffectedEdges, AffectedFaces, Repair};
use super::topology::{NONE, Topology, index};
use crate::fault::Fault;

impl Topology {
    /// Builds the topology of faces that need not form a manifold, and records what was cut. For a manifold, and always
    /// under [`NonManifold::Refuse`], the result is that of [`Topology::of_faces`].
    ///
    /// # Errors
    /// As [`Topology::of_faces`]; under [`NonManifold::Split`] those of faces of fewer than three vertices and of
    /// missing vertices only, under [`NonManifold::SplitCrowded`] all but those of edges with more than two faces.
    pub fn of_any_faces(
        n_vertices: usize,
        faces: FaceList,
        winding: Winding,
        non_manifold: NonManifold,
    ) -> Result<(CheckedTopology, Vec<Repair>), Vec<Fault>> {
        if non_manifold == NonManifold::Refuse {
            return Self::of_faces(n_vertices, faces, winding).map(|checked| (checked, Vec::new()));
        }
        if let Ok(checked) = Self::of_faces(n_vertices, faces.clone(), winding) {
            return Ok((checked, Vec::new()));
        }
        if non_manifold == NonManifold::SplitCrowded {
            check_faces(n_vertices, &faces, NonManifold::Refuse)?;
            orient(&mut faces.clone(), &sides(n_vertices, &faces), winding)?;
        }
        cut(n_vertices, faces, winding)
    }
}

/// Number of vertices that a cut may add per face, in addition to [`MAX_ADDED_VERTICES`]. Meshes with local defects
/// need far less than one per face; with three, faces over the same few vertices would take more memory than is booked
/// for their text.
const MAX_ADDED_A_FACE: usize = 2;
/// Number of vertices that a cut may add to a mesh of any size, in addition to [`MAX_ADDED_A_FACE`] per face.
const MAX_ADDED_VERTICES: usize = 1000;

fn cut(n_vertices: usize, mut faces: FaceList, winding: Winding) -> Result<(CheckedTopology, Vec<Repair>), Vec<Fault>> {
    check_faces(n_vertices, &faces, NonManifold::Split)?;
    let mut all = sides(n_vertices, &faces);
    let reversed = if winding == Winding::Repair { faces_to_reverse(&faces, &all).0 } else { Vec::new() };
    if !reversed.is_empty() {
        reversed.iter().for_each(|&f| faces.reverse(f as usize));
        all = sides(n_vertices, &faces);
    }
    let repairs = misfits(&faces, &all);
    let mut opposite = pairs(&faces, &all);
    drop(all);
    let build = |opposite: &[u32]| {
        let mut topology = connect(n_vertices, faces.clone(), opposite);
        let split_from = topology.split_fans();
        (topology, split_from)
    };
    let (mut topology, mut split_from) = build(&opposite);
    let (added, n_faces) = (split_from.len(), faces.len());
    if added > MAX_ADDED_A_FACE * n_faces + MAX_ADDED_VERTICES {
        let most = MAX_ADDED_A_FACE * n_faces + MAX_ADDED_VERTICES;
        let detail = format!("a cut into manifold pieces adds {added} vertices; {n_faces} faces may take {most}");
        return Err(vec![Fault::new("/faces", detail + ", as they are no surface otherwise")]);
    }
    let split = faces.with_vertices(topology.vertices.clone());
    let mut all = sides(topology.n_vertices(), &split);
    let is_cut = cut_remaining(&split, &all, &mut opposite);
    if is_cut {
        (topology, _) = build(&opposite);
        all = sides(topology.n_vertices(), &faces.with_vertices(topology.vertices.clone()));
    }
    if rejoin(&all, &mut opposite) || is_cut {
        (topology, split_from) = build(&opposite);
    }
    Ok((CheckedTopology { topology, split_from, reversed }, repairs))
}

/// Records why the faces do not form a manifold, by kind of defect.
fn misfits(faces: &FaceList, sides: &[FaceSide]) -> Vec<Repair> {
    let ends = |group: &[FaceSide]| [group[0].0.0, group[0].0.1];
    let opposed = |group: &&[FaceSide]| group.len() == 2 && forward(faces, &group[0]) == forward(faces, &group[1]);
    let crowded = AffectedEdges::some(groups(sides).filter(|group| group.len() > 2).map(ends));
    let opposed = AffectedEdges::some(groups(sides).filter(opposed).map(ends));
    let repeats = |&f: &u32| {
        let mut face = faces.face(f as usize).to_vec();
        face.sort_unstable();
        face.windows(2).any(|pair| pair[0] == pair[1])
    };
    let repeating = AffectedFaces::some((0..index(faces.len())).filter(repeats)).map(Repair::Repeating);
    crowded.map(Repair::Crowded).into_iter().chain(opposed.map(Repair::Opposed)).chain(repeating).collect()
}

/// Returns the half-edge that each half-edge is paired with along its edge, or [`NONE`].
fn pairs(faces: &FaceList, sides: &[FaceSide]) -> Vec<u32> {
    let mut opposite = vec![NONE; faces.n_half_edges()];
    for group in groups(sides) {
        // the sides that wait for a partner, all in one direction, and how many of them have been paired
        let (mut waiting, mut taken): (Vec<&FaceSide>, usize) = (Vec::new(), 0);
        for side in group {
            match waiting.get(taken) {
                Some(first) if forward(faces, first) != forward(faces, side) => {
                    // if the first waiting side is of the same face, so are all the others
                    if owner(faces, first.1) != owner(faces, side.1) {
                        join(&mut opposite, first.1, side.1);
                        taken += 1;
                    }
                }
                _ => waiting.push(side),
            }
        }
    }
    opposite
}

fn join(opposite: &mut [u32], a: u32, b: u32) {
    opposite[a as usize] = b;
    opposite[b as usize] = a;
}

/// Pairs the two unpaired sides that join the same two vertices after the split; returns whether there are any.
fn rejoin(sides: &[FaceSide], opposite: &mut [u32]) -> bool {
    let mut is_joined = false;
    for group in groups(sides) {
        if let [a, b] = group
            && opposite[a.1 as usize] == NONE
            && opposite[b.1 as usize] == NONE
        {
            join(opposite, a.1, b.1);
            is_joined = true;
        }
    }
    is_joined
}

/// Turns the sides at which faces still meet themselves after the split into boundaries; returns whether there are
/// any.
fn cut_remaining(faces: &FaceList, sides: &[FaceSide], opposite: &mut [u32]) -> bool {
    let mut at_cut = Vec::new();
    for group in groups(sides).filter(|group| group.len() > 2) {
        at_cut.extend(group.iter().map(|side| side.1));
    }
    let mut start = 0;
    for f in 0..faces.len() {
        let face = faces.face(f);
        let mut visits: Vec<(u32, usize)> = face.iter().copied().zip(0..).collect();
        visits.sort_unstable();
        for pair in visits.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
            let at = pair[1].1;
            let before = (at + face.len() - 1) % face.len();
            at_cut.extend([index(start + at), index(start + before)]);
        }
        start += face.len();
    }
    for &half_edge in &at_cut {
        let other = std::mem::replace(&mut opposite[half_edge as usize], NONE);
        if other != NONE {
            opposite[other as usize] = NONE;
        }
    }
    !at_cut.is_empty()
}
