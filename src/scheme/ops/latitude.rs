//! The push-back P along latitude lines.
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

/// An even point: a vertex, or the point of a longitude edge, given by one of its half-edges.
#[derive(Debug, Clone, Copy)]
enum Even {
    Vertex(u32),
    Edge(u32),
}

/// The stencil of an odd point: its even neighbours, and those beyond them if the line continues.
struct OddStencil {
    rule: FourPoint,
    near: [Even; 2],
    beyond: [Option<Even>; 2],
}

/// The latitude lines of a net, and the points on them.
#[derive(Debug)]
pub(super) struct LatitudeLines {
    topology: Arc<Topology>,
    directions: Arc<Directions>,
    /// The two latitude edges of each vertex.
    latitude: Vec<Option<[u32; 2]>>,
    /// The half-edges of each face on its two longitude edges.
    longitude: Vec<Option<[u32; 2]>>,
    local: Arc<MeshLocal>,
}

impl LatitudeLines {
    /// Returns the lines of the net that entered the last U; `None` if it has no tags.
    pub(super) fn of(anchor: &Anchor, local: &Arc<MeshLocal>) -> Option<Self> {
        let directions = anchor.directions.clone()?;
        let topology = anchor.topology.clone();
        let latitude = directions.latitude_pairs(&topology);
        let is_longitude = |&half_edge: &u32| directions.of(topology.edge(half_edge)) == Direction::Longitude;
        let longitude = (0..topology.n_faces()).map(|f| {
            let mut tagged = topology.half_edges(f).filter(is_longitude);
            match (tagged.next(), tagged.next(), tagged.next()) {
                (Some(a), Some(b), None) => Some([a, b]),
                _ => None,
            }
        });
        let longitude = longitude.collect();
        Some(Self { topology, directions, latitude, longitude, local: local.clone() })
    }

    /// Returns the stencil of the odd point `row`; `None` if the point is on no line.
    fn around(&self, row: usize) -> Option<OddStencil> {
        let topology = &self.topology;
        let (n_v, n_e) = (topology.n_vertices(), topology.n_edges());
        let made = row.checked_sub(n_v)?;
        let (near, beyond) = if made < n_e {
            let e = index(made);
            if self.directions.of(e) != Direction::Latitude {
                return None;
            }
            let ends = topology.ends(made);
            (ends.map(Even::Vertex), ends.map(|v| self.beyond_vertex(v, e)))
        } else {
            let half_edges = self.longitude[made - n_e]?;
            (half_edges.map(Even::Edge), half_edges.map(|half_edge| self.beyond_edge(half_edge)))
        };
        Some(OddStencil { rule: FourPoint::new(self.local.curve_weight[made]), near, beyond })
    }

    /// Returns the vertex at the other end of the other latitude edge of `v`.
    fn beyond_vertex(&self, v: u32, e: u32) -> Option<Even> {
        let pair = self.latitude[v as usize]?;
        let other = if pair[0] == e { pair[1] } else { pair[0] };
        Some(Even::Vertex(self.topology.other_end(other as usize, v as usize)))
    }

    /// Returns the point of the other longitude edge of the face across a half-edge.
    fn beyond_edge(&self, half_edge: u32) -> Option<Even> {
        let twin = self.topology.twin(half_edge);
        if twin == NONE {
            return None;
        }
        let pair = self.longitude[self.topology.face_of(twin)]?;
        Some(Even::Edge(if pair[0] == twin { pair[1] } else { pair[0] }))
    }

    /// Returns the displacements of all points as rows over those of the vertices.
    pub(super) fn displacements(self: &Arc<Self>, deltas: Arc<[f64]>) -> RowsBy<impl Fn(usize, &mut Rows) + use<>> {
        let topology = &self.topology;
        let (n_v, n_e) = (topology.n_vertices(), topology.n_edges());
        let lines = self.clone();
        RowsBy::new(n_v + n_e + topology.n_faces(), n_v, move |row, out: &mut Rows| {
            let topology = &lines.topology;
            let push = |v: u32, weight: f64, out: &mut Rows| out.add(v, weight * deltas[v as usize]);
            let even = |even: Even, weight: f64, out: &mut Rows| match even {
                Even::Vertex(v) => push(v, weight, out),
                // in the direction of the faces, so that the vertices of two edges are in the order of a ring
                Even::Edge(h) => {
                    [h, topology.next(h)].iter().for_each(|&h| push(topology.vertex(h), 0.5 * weight, out));
                }
            };
            if let Some(around) = lines.around(row) {
                around.follow(even, out);
            } else if row < n_v {
                push(index(row), 1.0, out);
            } else if row < n_v + n_e {
                out.group(|out| topology.ends(row - n_v).iter().for_each(|&v| push(v, 0.5, out)));
            } else {
                let face = topology.face(row - n_v - n_e);
                let weight = ratio(1, face.len());
                out.group(|out| face.iter().for_each(|&v| push(v, weight, out)));
            }
        })
    }

    /// Moves odd points by the curve rule over even ones; all others stay.
    pub(super) fn follows(self: &Arc<Self>) -> Action {
        let topology = &self.topology;
        let n_v = topology.n_vertices();
        let n = n_v + topology.n_edges() + topology.n_faces();
        let lines = self.clone();
        let rows = RowsBy::new(n, n, move |row, out: &mut Rows| {
            let number = |even: Even| match even {
                Even::Vertex(v) => v,
                Even::Edge(half_edge) => index(n_v) + lines.topology.edge(half_edge),
            };
            match lines.around(row) {
                Some(around) => around.follow(|even, weight, out| out.add(number(even), weight), out),
                None => out.add(index(row), 1.0),
            }
        });
        Action::Blend(Box::new(rows))
    }
}

impl OddStencil {
    /// Adds the row of an odd point, as symmetric sums if the line continues at both ends; otherwise it is extended by
    /// reflection.
    fn follow(&self, add: impl Fn(Even, f64, &mut Rows), out: &mut Rows) {
        let Self { rule, near: [a, b], beyond } = *self;
        let each = |points: [Even; 2], weight: f64, out: &mut Rows| {
            out.group(|out| points.into_iter().for_each(|point| add(point, weight, out)));
        };
        each([a, b], rule.near, out);
        if let [Some(aa), Some(bb)] = beyond {
            return each([aa, bb], rule.far, out);
        }
        for (here, there, beyond) in [(a, b, beyond[0]), (b, a, beyond[1])] {
            rule.beyond(here, there, beyond, |point, weight| add(point, weight, out));
        }
    }
}
