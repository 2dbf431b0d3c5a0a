//! Builds the topology of faces that pass the checks.

use super::check::{FaceList, FaceSide, NonManifold, Winding, check_edges, check_faces, groups, orient, sides};
use super::topology::{FaceLayout, NONE, Topology, index};
use crate::fault::Fault;
use crate::math::distinct::distinct;

/// A topology, and how the input was changed to obtain it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CheckedTopology {
    /// The topology of the faces.
    pub topology: Topology,
    /// For each vertex appended by splitting fans apart: the vertex it was split from.
    pub split_from: Vec<u32>,
    /// The faces that were reversed.
    pub reversed: Vec<u32>,
}

impl Topology {
    /// Builds the topology of `faces` over `n_vertices` vertices.
    ///
    /// Edges are numbered by first appearance when the faces are scanned in order, corner by corner. A vertex that
    /// joins several fans of faces is split into one vertex a fan; the fan of the lowest corner keeps the number.
    ///
    /// # Errors
    /// Every fault with a pointer `/faces/...`: faces of fewer than three vertices, repeated or missing vertices, edges
    /// with three faces or more, components that cannot be oriented or are wound inconsistently.
    pub fn of_faces(n_vertices: usize, mut faces: FaceList, winding: Winding) -> Result<CheckedTopology, Vec<Fault>> {
        check_faces(n_vertices, &faces, NonManifold::Refuse)?;
        let mut sides = sides(n_vertices, &faces);
        check_edges(&faces, &sides)?;
        let reversed = orient(&mut faces, &sides, winding)?;
        if !reversed.is_empty() {
            sides = self::sides(n_vertices, &faces);
        }
        let opposite = opposites(faces.n_half_edges(), &sides);
        let mut topology = connect(n_vertices, faces, &opposite);
        let split_from = topology.split_fans();
        Ok(CheckedTopology { topology, split_from, reversed })
    }

    /// Returns the topology of some faces, in the given order, and the vertex of this topology for each of its
    /// vertices; these are ascending except for vertices added by splitting fans apart.
    ///
    /// # Errors
    /// None are known, since a part of an oriented manifold is an oriented manifold.
    pub fn submesh(&self, faces: &[u32]) -> Result<(Self, Vec<u32>), Vec<Fault>> {
        let mut vertices = distinct(faces.iter().flat_map(|&f| self.face(f as usize)).copied());
        let number = |v: &u32| vertices.binary_search(v).map_or(NONE, index);
        let faces = faces.iter().map(|&f| self.face(f as usize).iter().map(number)).collect();
        let CheckedTopology { topology, split_from, .. } = Self::of_faces(vertices.len(), faces, Winding::Refuse)?;
        let copies: Vec<u32> = split_from.iter().map(|&v| vertices[v as usize]).collect();
        vertices.extend(copies);
        Ok((topology, vertices))
    }

    /// Finds the first half-edge of each vertex, and splits vertices with several fans; returns the origins of added
    /// vertices.
    pub(super) fn split_fans(&mut self) -> Vec<u32> {
        let mut seen = vec![false; self.n_half_edges()];
        let mut split_from = Vec::new();
        for half_edge in 0..index(self.n_half_edges()) {
            if seen[half_edge as usize] {
                continue;
            }
            let start = self.fan_start(half_edge);
            let fan: Vec<u32> = super::topology::Ring::from(self, start).collect();
            for &c in &fan {
                seen[c as usize] = true;
            }
            let vertex = self.vertex(half_edge);
            if self.outgoing[vertex as usize] == NONE {
                self.outgoing[vertex as usize] = start;
            } else {
                let added = index(self.n_vertices);
                self.n_vertices += 1;
                self.outgoing.push(start);
                split_from.push(vertex);
                for c in fan {
                    self.vertices[c as usize] = added;
                }
            }
        }
        split_from
    }

    /// Returns the first half-edge, counter-clockwise, of the fan of `half_edge`: at the boundary, or `half_edge`
    /// itself.
    fn fan_start(&self, half_edge: u32) -> u32 {
        let mut at = half_edge;
        loop {
            let twin = self.twin(at);
            if twin == NONE {
                return at;
            }
            at = self.next(twin);
            if at == half_edge {
                return half_edge;
            }
        }
    }
}

/// Returns the opposite half-edge of each half-edge of a manifold, or [`NONE`].
fn opposites(n_half_edges: usize, sides: &[FaceSide]) -> Vec<u32> {
    let mut opposite = vec![NONE; n_half_edges];
    for group in groups(sides).filter(|group| group.len() == 2) {
        opposite[group[0].1 as usize] = group[1].1;
        opposite[group[1].1 as usize] = group[0].1;
    }
    opposite
}

/// Builds the topology of checked faces from their opposite half-edges, without the work of [`Topology::split_fans`].
pub(super) fn connect(n_vertices: usize, faces: FaceList, opposite: &[u32]) -> Topology {
    let n_half_edges = faces.vertices.len();
    let mut edge_of = vec![NONE; n_half_edges];
    let mut halves = Vec::with_capacity(n_half_edges);
    for half_edge in 0..n_half_edges {
        let other = opposite[half_edge];
        if other == NONE || (other as usize) > half_edge {
            edge_of[half_edge] = index(halves.len());
            halves.push([index(half_edge), other]);
        } else {
            edge_of[half_edge] = edge_of[other as usize];
        }
    }
    let all = |size: u32| faces.starts.windows(2).all(|pair| pair[1] - pair[0] == size);
    let (quads, triangles) = (all(4), all(3));
    let FaceList { starts, vertices } = faces;
    let layout = if quads {
        FaceLayout::Quads
    } else if triangles {
        FaceLayout::Triangles
    } else {
        let owner = starts.windows(2).enumerate();
        let owner = owner.flat_map(|(f, pair)| std::iter::repeat_n(index(f), (pair[1] - pair[0]) as usize)).collect();
        FaceLayout::Mixed { starts, owner }
    };
    let outgoing = vec![NONE; n_vertices];
    Topology { n_vertices, faces: layout, vertices, edge_of, halves, outgoing }
}
