//! The canonical name of places that several faces share.

use super::place::{Place, squares};
use crate::shape::topology::{Topology, index};

impl Place {
    /// Returns the same place in the lowest shown face, and there in the lowest corner.
    pub(super) fn lowest(self, topology: &Topology, is_shown: &[bool]) -> Self {
        let shared = self.on_side(topology).and_then(|(half_edge, t)| {
            let sharing: Vec<(u32, f64)> = if t <= 0.0 {
                topology.ring(topology.vertex(half_edge) as usize).map(|other| (other, 0.0)).collect()
            } else {
                let twin = topology.halves(topology.edge(half_edge) as usize);
                let turned = |&other: &u32| if other == half_edge { (other, t) } else { (other, 1.0 - t) };
                let inner = !topology.is_boundary_edge(topology.edge(half_edge) as usize);
                if inner { twin.iter().map(turned).collect() } else { vec![(half_edge, t)] }
            };
            let shown = sharing.into_iter().filter(|&(other, _)| is_shown[topology.face_of(other)]);
            shown.min_by_key(|&(other, _)| topology.face_of(other))
        });
        shared.map_or(self, |(half_edge, t)| Self::on_half_edge(topology, half_edge, t)).in_lowest_corner(topology)
    }

    /// Returns the half-edge on which the place lies, and its parameter there, less than 1; `None` inside a face.
    fn on_side(self, topology: &Topology) -> Option<(u32, f64)> {
        let range = topology.half_edges(self.face as usize);
        let [u, v] = self.uv;
        let n = index(range.len());
        let found = if squares(topology, self.face) == 1 {
            let sides = [(v <= 0.0, u), (u >= 1.0, v), (v >= 1.0, 1.0 - u), (u <= 0.0, 1.0 - v)];
            (0..4).zip(sides).find(|&(_, (is_on, t))| is_on && t < 1.0).map(|(side, (_, t))| (side, t))
        } else if v <= 0.0 {
            Some((self.corner, 0.5 * u))
        } else {
            (u <= 0.0).then_some(((self.corner + n - 1) % n, 1.0 - 0.5 * v))
        };
        found.map(|(side, t)| (range.start + side, t))
    }

    fn on_half_edge(topology: &Topology, half_edge: u32, t: f64) -> Self {
        let face = topology.face_of(half_edge);
        let range = topology.half_edges(face);
        let (side, n) = (half_edge - range.start, index(range.len()));
        let (corner, uv) = match side {
            0 if n == 4 => (0, [t, 0.0]),
            1 if n == 4 => (0, [1.0, t]),
            2 if n == 4 => (0, [1.0 - t, 1.0]),
            _ if n == 4 => (0, [0.0, 1.0 - t]),
            _ if t <= 0.5 => (side, [2.0 * t, 0.0]),
            _ => ((side + 1) % n, [0.0, 2.0 * (1.0 - t)]),
        };
        Self { face: index(face), corner, uv }
    }

    /// Names a place shared by several squares of one face by the first of them.
    fn in_lowest_corner(self, topology: &Topology) -> Self {
        let (n, [u, v], corner) = (squares(topology, self.face), self.uv, self.corner);
        match n {
            1 => self,
            _ if u >= 1.0 && v >= 1.0 => Self { corner: 0, ..self },
            _ if u >= 1.0 && corner == n - 1 => Self { corner: 0, uv: [v, 1.0], ..self },
            _ if v >= 1.0 && corner > 0 => Self { corner: corner - 1, uv: [1.0, u], ..self },
            _ => self,
        }
    }
}
