//! Edges, valences, boundary loops and components of a mesh, found by sorting.

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::output::disjoint_sets::DisjointSets;
use crate::output::scene::{MeshSource, each_face};
use crate::shape::topology::index;
use crate::watch::{Stopped, Watch};

/// The properties of a mesh that follow from its faces alone.
#[derive(Debug)]
pub(super) struct Connectivity {
    /// Number of edges.
    pub(super) edges: usize,
    /// Number of edges with one face.
    pub(super) boundary_edges: usize,
    /// Number of connected pieces of the boundary; loops that touch in a vertex are one piece.
    pub(super) boundary_loops: usize,
    /// Number of connected pieces of the mesh, isolated vertices included.
    pub(super) components: usize,
    /// Vertices without an edge.
    pub(super) isolated: Vec<u32>,
    /// Whether there are faces and each edge has exactly two.
    pub(super) closed: bool,
    /// Number of vertices by valence, off the boundary.
    pub(super) interior_valences: BTreeMap<u32, u64>,
    /// Number of vertices by valence, on the boundary.
    pub(super) boundary_valences: BTreeMap<u32, u64>,
    /// Number of faces by number of corners.
    pub(super) face_sizes: BTreeMap<u32, u64>,
}

impl Connectivity {
    /// Analyses all faces of a mesh.
    pub(super) fn of(mesh: &dyn MeshSource, watch: &Watch) -> Result<Self, Stopped> {
        let n = mesh.n_vertices();
        let (mut keys, face_sizes) = keys(mesh, watch)?;
        watch.check()?;
        keys.par_sort_unstable();
        watch.check()?;
        let mut valences = vec![0_u32; n];
        let mut on_boundary = vec![false; n];
        let (mut pieces, mut boundary) = (DisjointSets::new(n), DisjointSets::new(n));
        let (mut edges, mut boundary_edges, mut closed) = (0, 0, !keys.is_empty());
        for run in keys.chunk_by(|a, b| a == b) {
            let [a, b] = ends(run[0]);
            edges += 1;
            valences[a as usize] += 1;
            valences[b as usize] += 1;
            pieces.join(a, b);
            closed &= run.len() == 2;
            if run.len() == 1 {
                boundary_edges += 1;
                on_boundary[a as usize] = true;
                on_boundary[b as usize] = true;
                boundary.join(a, b);
            }
        }
        let (mut interior_valences, mut boundary_valences) = (BTreeMap::new(), BTreeMap::new());
        for (&valence, &boundary) in valences.iter().zip(&on_boundary).filter(|(valence, _)| **valence > 0) {
            *if boundary { &mut boundary_valences } else { &mut interior_valences }.entry(valence).or_default() += 1;
        }
        let isolated = (0_u32..).zip(&valences).filter(|(_, valence)| **valence == 0).map(|(vertex, _)| vertex);
        let isolated = isolated.collect();
        // each vertex off the boundary is a set of its own in `boundary`
        let boundary_loops = boundary.n - on_boundary.iter().filter(|boundary| !**boundary).count();
        Ok(Self {
            edges,
            boundary_edges,
            boundary_loops,
            components: pieces.n,
            isolated,
            closed,
            interior_valences,
            boundary_valences,
            face_sizes,
        })
    }
}

/// Returns the edges of all faces, an entry for each face at an edge: the smaller end in the upper half of the bits.
fn keys(mesh: &dyn MeshSource, watch: &Watch) -> Result<(Vec<u64>, BTreeMap<u32, u64>), Stopped> {
    let mut keys = Vec::with_capacity(mesh.n_half_edges());
    let mut face_sizes = BTreeMap::new();
    each_face(mesh, watch, |face| {
        *face_sizes.entry(index(face.len())).or_default() += 1;
        let after = face.iter().skip(1).chain(face.first());
        keys.extend(face.iter().zip(after).map(|(&a, &b)| u64::from(a.min(b)) << 32 | u64::from(a.max(b))));
    })?;
    Ok((keys, face_sizes))
}

fn ends(key: u64) -> [u32; 2] {
    let low = key & u64::from(u32::MAX);
    [key >> 32, low].map(|end| u32::try_from(end).expect("a 32-bit number"))
}
