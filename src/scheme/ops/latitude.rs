//! P along latitude lines.
//!
//! The push-back moves everything with the compensation 1; then each odd point of a latitude line (the point of a
//! latitude edge, or of a face between two longitude edges) follows its even neighbours a, b on the line, and those
//! beyond them, aa and bb. With the displacements d of even points and `w = omega / (8 (1 + f))`:
//! * by differences, `p + (1/2 + w) (d[a] + d[b]) - w (d[aa] + d[bb])`;
//! * by places, the same rule on the moved points themselves.
//!
//! Both keep what is constant along the line and what turns with it, so that circles stay circles.

use std::sync::Arc;

use crate::math::functions::ratio;
use crate::math::rows::{Rows, RowsBy};
use crate::scheme::anchor::Anchor;
use crate::scheme::local_mesh::MeshLocal;
use crate::scheme::stencil::FourPoint;
use crate::scheme::step::Action;
use crate::shape::directions::{Direction, Directions};
use crate::shape::topology::{NONE, Topology, index};

/// An even point: a vertex, or the point of a longitude edge.
#[derive(Debug, Clone, Copy)]
enum Even {
    Vertex(u32),
    Edge(u32),
}

/// The latitude lines of a net: what stands where on them.
#[derive(Debug)]
pub(super) struct Lines {
    topology: Arc<Topology>,
    directions: Arc<Directions>,
    /// The two latitude edges of each vertex.
    latitude: Vec<Option<[u32; 2]>>,
    /// The two longitude edges of each face.
    longitude: Vec<Option<[u32; 2]>>,
    local: Arc<MeshLocal>,
}

impl Lines {
    /// The lines of what entered the last U; `None` where nothing is tagged.
    pub(super) fn of(anchor: &Anchor, local: &Arc<MeshLocal>) -> Option<Self> {
        let directions = anchor.directions.clone()?;
        let topology = anchor.topology.clone();
        let latitude = directions.latitude_pairs(&topology);
        let longitude = (0..topology.n_faces()).map(|f| {
            let edges = topology.half_edges(f).map(|half_edge| topology.edge(half_edge));
            let mut tagged = edges.filter(|&e| directions.of(e) == Direction::Longitude);
            match (tagged.next(), tagged.next(), tagged.next()) {
                (Some(a), Some(b), None) => Some([a, b]),
                _ => None,
            }
        });
        let longitude = longitude.collect();
        Some(Self { topology, directions, latitude, longitude, local: local.clone() })
    }

    /// The even neighbours of an odd point, and those beyond them; `None` where the point is on no line.
    fn around(&self, row: usize) -> Option<[(Even, Option<Even>); 2]> {
        let topology = &self.topology;
        let (n_v, n_e) = (topology.n_vertices(), topology.n_edges());
        if row < n_v {
            return None;
        }
        if row < n_v + n_e {
            let e = index(row - n_v);
            let on_line = self.directions.of(e) == Direction::Latitude;
            return on_line.then(|| topology.ends(e as usize).map(|v| (Even::Vertex(v), self.beyond_vertex(v, e))));
        }
        let f = row - n_v - n_e;
        self.longitude[f].map(|edges| edges.map(|e| (Even::Edge(e), self.beyond_edge(e, f))))
    }

    /// The vertex at the other end of the other latitude edge of `v`.
    fn beyond_vertex(&self, v: u32, e: u32) -> Option<Even> {
        let pair = self.latitude[v as usize]?;
        let other = if pair[0] == e { pair[1] } else { pair[0] };
        let [a, b] = self.topology.ends(other as usize);
        Some(Even::Vertex(if a == v { b } else { a }))
    }

    /// The point of the other longitude edge of the face beyond `e`.
    fn beyond_edge(&self, e: u32, f: usize) -> Option<Even> {
        let faces = self.topology.halves(e as usize);
        let beyond = faces.into_iter().filter(|&c| c != NONE).map(|c| self.topology.face_of(c)).find(|&g| g != f)?;
        let pair = self.longitude[beyond]?;
        Some(Even::Edge(if pair[0] == e { pair[1] } else { pair[0] }))
    }

    /// Calls `add` with the even points that an odd one follows, and their weights; `false` where it is on no line.
    fn follow(&self, row: usize, mut add: impl FnMut(Even, f64)) -> bool {
        let Some(sides) = self.around(row) else { return false };
        let rule = FourPoint::new(self.local.curve_weight[row - self.topology.n_vertices()]);
        let [(a, aa), (b, bb)] = sides;
        for (here, there, beyond) in [(a, b, aa), (b, a, bb)] {
            add(here, rule.near);
            // where the line ends it goes on by reflection
            rule.beyond(here, there, beyond, &mut add);
        }
        true
    }

    /// The displacements of all points, over those of the vertices.
    pub(super) fn displacements(self: &Arc<Self>, deltas: Arc<[f64]>) -> RowsBy<impl Fn(usize, &mut Rows) + use<>> {
        let topology = &self.topology;
        let (n_v, n_e) = (topology.n_vertices(), topology.n_edges());
        let lines = self.clone();
        RowsBy::new(n_v + n_e + topology.n_faces(), n_v, move |row, out: &mut Rows| {
            let push = |v: u32, weight: f64, out: &mut Rows| out.add(v, weight * deltas[v as usize]);
            let topology = &lines.topology;
            let even = |even: Even, weight: f64, out: &mut Rows| match even {
                Even::Vertex(v) => push(v, weight, out),
                Even::Edge(e) => topology.ends(e as usize).iter().for_each(|&v| push(v, 0.5 * weight, out)),
            };
            if lines.follow(row, |point, weight| even(point, weight, out)) {
                return;
            }
            if row < n_v {
                push(index(row), 1.0, out);
            } else if row < n_v + n_e {
                even(Even::Edge(index(row - n_v)), 1.0, out);
            } else {
                let face = topology.face(row - n_v - n_e);
                let weight = ratio(1, face.len());
                face.iter().for_each(|&v| push(v, weight, out));
            }
        })
    }

    /// Odd points where the curve rule has them among the even ones; all others stay.
    pub(super) fn follows(self: &Arc<Self>) -> Action {
        let topology = &self.topology;
        let n_v = topology.n_vertices();
        let n = n_v + topology.n_edges() + topology.n_faces();
        let lines = self.clone();
        let rows = RowsBy::new(n, n, move |row, out: &mut Rows| {
            let number = |even: Even| match even {
                Even::Vertex(v) => v,
                Even::Edge(e) => index(n_v) + e,
            };
            if !lines.follow(row, |point, weight| out.add(number(point), weight)) {
                out.add(index(row), 1.0);
            }
        });
        Action::Blend(Box::new(rows))
    }
}
