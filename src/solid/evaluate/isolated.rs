//! Values in a face one of whose vertices is not regular: in the rings of bicubic pieces around it.
//!
//! Source: J. Stam, SIGGRAPH 1998, 395-404 (the rings; here they are refined, which works for every kind of vertex).

use super::jet::Jet;
use crate::math::vector::{Vector, cross, direction, minus, plus, times};
use crate::shape::topology::{NONE, index};
use crate::solid::edges::Edges;
use crate::solid::error::SolidError;
use crate::solid::level::{Level, Refiner};

/// Rings after which a place counts as the vertex: 2^-60 of the face is below the spacing of numbers next to 1. Half of
/// it would show in positions at vertices of high valence, where a ring is two thirds of the one before; twice of it
/// only costs time.
pub(super) const RINGS: u32 = 60;
/// Where the quads of a corner stand among the four that a quad is split into, row by row.
pub(super) const QUADRANTS: [usize; 4] = [0, 1, 3, 2];

/// What is asked of a place: its number among all, and where it is in a face of some level.
#[derive(Debug, Clone, Copy)]
pub(super) struct Query {
    pub(super) number: u32,
    pub(super) uv: [f64; 2],
}

/// The part of a face that splitting it once puts a place in, row by row, and where it is there.
pub(super) fn halved(query: Query) -> (usize, Query) {
    let bits = query.uv.map(|x| usize::from(x >= 0.5));
    let uv = [0, 1].map(|k| if bits[k] == 1 { 2.0 * query.uv[k] - 1.0 } else { 2.0 * query.uv[k] });
    (bits[0] + 2 * bits[1], Query { uv, ..query })
}

/// A face alone with what its limit needs, about one of its vertices, which is the origin of all rings.
#[derive(Debug, Clone)]
pub(super) struct Rings {
    pub(super) level: Level,
    edges: Edges,
    /// Which of the four corners of the face the vertex is.
    pub(super) corner: usize,
    /// Where the origin is, model units.
    pub(super) origin: Vector,
    /// The directions of the coordinates, model units.
    axes: [Vector; 3],
    /// How many times as fast the parameters of the face run as those at the start.
    pub(super) scale: f64,
}

impl Rings {
    /// Of the face of a half-edge that starts at its only vertex that is not regular; its parameters run `scale` times
    /// as fast as those of the input face.
    ///
    /// # Errors
    /// When the face cannot be taken out.
    pub(super) fn of(level: &Level, half_edge: u32, scale: f64) -> Result<Self, SolidError> {
        let face = level.topology.face_of(half_edge);
        let corner = (half_edge - level.topology.half_edges(face).start) as usize;
        let (level, edges) = level.taken_out(&[index(face)])?;
        let mut rings = Self { level, edges, corner, origin: [0.0; 3], axes: AXES, scale };
        rings.recentre();
        Ok(rings)
    }

    /// The half-edge of the face that starts at the vertex.
    fn half_edge(&self) -> u32 {
        let face = self.face();
        self.level.topology.half_edges(face as usize).start + index(self.corner)
    }

    /// The one face that is looked at.
    fn face(&self) -> u32 {
        self.level.wanted.iter().position(|&wanted| wanted).map_or(NONE, index)
    }

    /// Moves the origin to the vertex, so that no digits are lost where all points are close to it.
    fn recentre(&mut self) {
        let by = self.level.start(self.half_edge());
        self.level.points.iter_mut().for_each(|point| *point = minus(*point, by));
        self.origin = plus(self.origin, self.direction(by));
    }

    /// A direction of these coordinates in the model.
    fn direction(&self, by: Vector) -> Vector {
        (0..3).fold([0.0; 3], |sum, k| plus(sum, times(by[k], self.axes[k])))
    }

    /// Turns the coordinates so that the normal at the vertex becomes the third axis, or its opposite. Next to the
    /// vertex heights over the tangent plane shrink faster than what runs along it, to 0.6 of that a ring at valence 3,
    /// and would be lost in its rounding. Where no normal is known, that of the face comes closer to it from ring to
    /// ring.
    fn straighten(&mut self) {
        let normal = self.level.vertex_normal(self.half_edge()).or_else(|| self.facet());
        let Some([x, y, z]) = normal else { return };
        let sign = if z < 0.0 { -1.0 } else { 1.0 };
        let [x, y, z] = [sign * x, sign * y, sign * z];
        let turned = |[a, b, c]: Vector| {
            let along = x * a + y * b;
            let lift = c + along / (1.0 + z);
            [a - x * lift, b - y * lift, along + z * c]
        };
        self.level.points.iter_mut().for_each(|point| *point = turned(*point));
        let rows = [0, 1, 2].map(|d| turned(self.axes.map(|axis| axis[d])));
        self.axes = [0, 1, 2].map(|k| rows.map(|row| row[k]));
    }

    /// The normal of the face that is looked at, of its diagonals.
    fn facet(&self) -> Option<Vector> {
        let corner = |steps| self.level.start(self.level.after(self.half_edge(), steps));
        direction(cross(minus(corner(2), corner(0)), minus(corner(3), corner(1))))
    }

    /// A jet of these coordinates in the model.
    fn in_model(&self, jet: Jet) -> Jet {
        jet.mapped(|at| plus(self.origin, self.direction(at)), |by| self.direction(by))
    }

    /// The vertex.
    pub(super) fn vertex(&self) -> Jet {
        self.in_model(self.level.vertex_jet(self.half_edge()))
    }

    /// Goes one ring on: the half-edges of the four parts of the face before, row by row, of which that at the vertex
    /// is the face now. The nets of the others are those of `level`.
    pub(super) fn advance(&mut self, refiner: &Refiner<'_>) -> Result<[u32; 4], SolidError> {
        let mut next = self.level.refined(&[self.face()], refiner, &mut self.edges)?;
        let mut parts = [0; 4];
        let wanted = (0..index(next.topology.n_faces())).filter(|&f| next.wanted[f as usize]);
        parts.iter_mut().zip(wanted).for_each(|(part, face)| *part = face);
        let near = parts[QUADRANTS[self.corner]] as usize;
        next.wanted = (0..next.topology.n_faces()).map(|f| f == near).collect();
        self.level = next;
        self.scale *= 2.0;
        self.recentre();
        Ok(parts.map(|face| self.level.topology.half_edges(face as usize).start))
    }
}

const AXES: [Vector; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// The values at places of the face of a half-edge that starts at its only vertex that is not regular.
///
/// # Errors
/// When the watch says stop.
pub(super) fn isolated(
    level: &Level,
    half_edge: u32,
    scale: f64,
    mut queries: Vec<Query>,
    refiner: &Refiner<'_>,
) -> Result<Vec<(u32, Jet)>, SolidError> {
    let mut rings = Rings::of(level, half_edge, scale)?;
    let quadrant = QUADRANTS[rings.corner];
    let corner = [quadrant % 2, quadrant / 2].map(|bit| if bit == 1 { 1.0 } else { 0.0 });
    let mut found = Vec::with_capacity(queries.len());
    rings.straighten();
    for ring in 0..=RINGS {
        refiner.watch.check()?;
        let is_at_corner = |query: &Query| [0, 1].iter().all(|&k| query.uv[k] - corner[k] == 0.0);
        let is_there = |query: &Query| ring == RINGS || is_at_corner(query);
        let (there, rest): (Vec<_>, Vec<_>) = queries.into_iter().partition(is_there);
        if !there.is_empty() {
            let jet = rings.vertex();
            found.extend(there.iter().map(|query| (query.number, jet)));
        }
        if rest.is_empty() {
            break;
        }
        let parts = rings.advance(refiner)?;
        rings.straighten();
        let nets = parts.map(|part| rings.level.net(part));
        queries = Vec::new();
        for (part, query) in rest.into_iter().map(halved) {
            if part == quadrant {
                queries.push(query);
            } else {
                found.push((query.number, rings.in_model(Jet::of(&nets[part], rings.scale, query.uv))));
            }
        }
    }
    Ok(found)
}
