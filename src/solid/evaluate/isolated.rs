//! Evaluates places in a face with one extraordinary vertex, in the rings of bicubic pieces around it.
//!
//! Source: J. Stam, SIGGRAPH 1998, 395-404 (the rings; here they are refined, which works for every kind of vertex).

use super::jet::Jet;
use crate::math::vector::{Vector, cross, direction, minus, plus, times};
use crate::shape::topology::{NONE, index};
use crate::solid::edges::Edges;
use crate::solid::error::SolidError;
use crate::solid::level::{Level, Refiner};

/// Number of rings after which a place counts as the vertex: 2^-60 of the face is below the spacing of numbers near 1.
/// Half of it would be visible in positions at vertices of high valence, where a ring is two thirds of the one before;
/// twice of it only costs time.
pub(super) const VERTEX_RINGS: u32 = 60;
/// The positions of the corners' quads among the four quads of a split quad, which are ordered row by row.
pub(super) const QUADRANTS: [usize; 4] = [0, 1, 3, 2];

/// A place to evaluate: its index among all places, and its parameters in a face of some level.
#[derive(Debug, Clone, Copy)]
pub(super) struct Query {
    pub(super) number: u32,
    pub(super) uv: [f64; 2],
}

/// Returns the part of a split face that contains a place, row by row, with its parameters there.
pub(super) fn halved(query: Query) -> (usize, Query) {
    let bits = query.uv.map(|x| usize::from(x >= 0.5));
    let uv = [0, 1].map(|k| if bits[k] == 1 { 2.0 * query.uv[k] - 1.0 } else { 2.0 * query.uv[k] });
    (bits[0] + 2 * bits[1], Query { uv, ..query })
}

/// A single face with the neighbourhood that its limit needs; one of its vertices is the origin of all rings.
#[derive(Debug, Clone)]
pub(super) struct IsolatedFace {
    pub(super) level: Level,
    edges: Edges,
    /// The corner of the face at the vertex.
    pub(super) corner: usize,
    /// The position of the origin, in model units.
    pub(super) origin: Vector,
    /// The directions of the coordinate axes, in model units.
    axes: [Vector; 3],
    /// The ratio of the parameters of the face to those at the start.
    pub(super) scale: f64,
}

impl IsolatedFace {
    /// Creates the rings in the face of a half-edge that starts at its only extraordinary vertex; its parameters run
    /// `scale` times as fast as those of the input face.
    ///
    /// # Errors
    /// If the face cannot be extracted.
    pub(super) fn of(level: &Level, half_edge: u32, scale: f64) -> Result<Self, SolidError> {
        let face = level.topology.face_of(half_edge);
        let corner = (half_edge - level.topology.half_edges(face).start) as usize;
        let (level, edges) = level.taken_out(&[index(face)])?;
        let mut rings = Self { level, edges, corner, origin: [0.0; 3], axes: UNIT_AXES, scale };
        rings.recentre();
        Ok(rings)
    }

    /// Returns the half-edge of the face that starts at the vertex.
    fn half_edge(&self) -> u32 {
        let face = self.face();
        self.level.topology.half_edges(face as usize).start + index(self.corner)
    }

    /// Returns the only face whose surface is wanted.
    fn face(&self) -> u32 {
        self.level.wanted.iter().position(|&wanted| wanted).map_or(NONE, index)
    }

    /// Moves the origin to the vertex, so that no digits are lost where all points are close to it.
    fn recentre(&mut self) {
        let by = self.level.start(self.half_edge());
        self.level.points.iter_mut().for_each(|point| *point = minus(*point, by));
        self.origin = plus(self.origin, self.direction(by));
    }

    /// Converts a direction in these coordinates to the model.
    fn direction(&self, by: Vector) -> Vector {
        (0..3).fold([0.0; 3], |sum, k| plus(sum, times(by[k], self.axes[k])))
    }

    /// Rotates the coordinates so that the normal at the vertex becomes the third axis, or its opposite. Near the
    /// vertex, heights above the tangent plane shrink faster than tangential distances, to 0.6 of those per ring at
    /// valence 3, and would be lost in their rounding errors. If no normal is known, that of the face is used, which
    /// converges to it from ring to ring.
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

    /// Returns the normal of the face, from its diagonals.
    fn facet(&self) -> Option<Vector> {
        let corner = |steps| self.level.start(self.level.after(self.half_edge(), steps));
        direction(cross(minus(corner(2), corner(0)), minus(corner(3), corner(1))))
    }

    /// Converts a jet in these coordinates to the model.
    fn in_model(&self, jet: Jet) -> Jet {
        jet.mapped(|at| plus(self.origin, self.direction(at)), |by| self.direction(by))
    }

    /// Returns the jet of the vertex.
    pub(super) fn vertex(&self) -> Jet {
        self.in_model(self.level.vertex_jet(self.half_edge()))
    }

    /// Advances by one ring and returns the half-edges of the four parts of the previous face, row by row; the part at
    /// the vertex becomes the current face. The nets of the others are those of `level`.
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

const UNIT_AXES: [Vector; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Returns the values at places in the face of a half-edge that starts at its only extraordinary vertex.
///
/// # Errors
/// If the watch says stop.
pub(super) fn isolated(
    level: &Level,
    half_edge: u32,
    scale: f64,
    mut queries: Vec<Query>,
    refiner: &Refiner<'_>,
) -> Result<Vec<(u32, Jet)>, SolidError> {
    let mut rings = IsolatedFace::of(level, half_edge, scale)?;
    let quadrant = QUADRANTS[rings.corner];
    let corner = [quadrant % 2, quadrant / 2].map(|bit| if bit == 1 { 1.0 } else { 0.0 });
    let mut found = Vec::with_capacity(queries.len());
    rings.straighten();
    for ring in 0..=VERTEX_RINGS {
        refiner.watch.check()?;
        let is_at_corner = |query: &Query| [0, 1].iter().all(|&k| query.uv[k] - corner[k] == 0.0);
        let is_there = |query: &Query| ring == VERTEX_RINGS || is_at_corner(query);
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
