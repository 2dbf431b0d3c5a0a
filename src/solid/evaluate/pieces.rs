//! The limit surface as Bezier pieces, and ends: faces at extraordinary vertices, whose pieces are made on demand.

use super::boxes::BoundingBox;
use super::isolated::{IsolatedFace, QUADRANTS, VERTEX_RINGS};
use super::patch::BezierPatch;
use super::place::Place;
use crate::math::vector::{Vector, plus};
use crate::scheme::plan::Plan;
use crate::shape::mesh::Mesh;
use crate::shape::topology::index;
use crate::solid::edges::Edges;
use crate::solid::error::SolidError;
use crate::solid::level::{Level, Refiner};
use crate::solid::net::bezier;

/// A square in the parameters of an input face.
#[derive(Debug, Clone, Copy)]
pub(super) struct Square {
    pub(super) face: u32,
    pub(super) corner: u32,
    from: [f64; 2],
    size: f64,
}

impl Square {
    /// Returns the place with these parameters of the face.
    pub(super) fn place(&self, uv: [f64; 2]) -> Place {
        Place { face: self.face, corner: self.corner, uv }
    }

    /// Returns one of its quarters, counted row by row.
    fn quarter(self, part: usize) -> Self {
        let size = 0.5 * self.size;
        let by = |bit: usize| if bit == 1 { size } else { 0.0 };
        Self { from: [self.from[0] + by(part % 2), self.from[1] + by(part / 2)], size, ..self }
    }

    fn patch(self, level: &Level, half_edge: u32, origin: Vector) -> BezierPatch {
        let net = bezier(&level.net(half_edge)).map(|row| row.map(|point| plus(origin, point)));
        BezierPatch { net, from: self.from, size: self.size }
    }
}

/// A part of the surface.
#[derive(Debug)]
pub(super) enum SurfacePart {
    /// A bicubic piece.
    Leaf(Box<BezierPatch>),
    /// A face with an extraordinary vertex.
    End(Box<ExtraordinaryFace>),
}

/// A face with an extraordinary vertex, starting at some ring.
#[derive(Debug, Clone)]
pub(super) struct ExtraordinaryFace {
    rings: IsolatedFace,
    square: Square,
    /// The parameters and the limit of the vertex.
    pub(super) vertex: ([f64; 2], Vector),
    /// The parameters and the limit of the opposite corner, around which the surface is bicubic.
    pub(super) across: ([f64; 2], Vector),
}

/// A ring of an end.
#[derive(Debug)]
pub(super) struct LeafRing {
    pub(super) patches: Vec<BezierPatch>,
    /// A box around the remaining part at the vertex.
    pub(super) rest: BoundingBox,
}

impl ExtraordinaryFace {
    /// Returns the pieces of the next ring.
    ///
    /// # Errors
    /// If the watch says stop.
    pub(super) fn ring(&mut self, refiner: &Refiner<'_>) -> Result<LeafRing, SolidError> {
        let parts = self.rings.advance(refiner)?;
        let near = QUADRANTS[self.rings.corner];
        let others = (0..4).filter(|&part| part != near);
        let patch = |part: usize| self.square.quarter(part).patch(&self.rings.level, parts[part], self.rings.origin);
        let patches = others.map(patch).collect();
        self.square = self.square.quarter(near);
        Ok(LeafRing { patches, rest: self.bounds() })
    }

    /// Creates the end of the face of a half-edge that starts at its only extraordinary vertex.
    fn of(level: &Level, half_edge: u32, square: Square) -> Result<Self, SolidError> {
        let rings = IsolatedFace::of(level, half_edge, 1.0)?;
        let at = bezier(&level.net(half_edge))[3][3];
        let quadrant = QUADRANTS[rings.corner];
        let bits = [quadrant % 2, quadrant / 2];
        let [near, far] =
            [1, 0].map(|far| [0, 1].map(|k| square.from[k] + if bits[k] == far { square.size } else { 0.0 }));
        let vertex = (near, rings.vertex().at);
        Ok(Self { rings, square, vertex, across: (far, at) })
    }

    /// Returns a box around its surface: around its control points, since each point is a mean of them.
    fn bounds(&self) -> BoundingBox {
        BoundingBox::of(self.rings.level.points.iter().map(|&point| plus(self.rings.origin, point)))
    }
}

/// Maximum number of rings of an end that are examined.
pub(super) const MAX_END_RINGS: usize = VERTEX_RINGS as usize;

/// The parts of the limit surface with their squares and boxes.
#[derive(Debug, Default)]
pub(super) struct SurfaceParts {
    pub(super) all: Vec<(Square, SurfacePart)>,
    pub(super) boxes: Vec<BoundingBox>,
    /// Whether each face of the mesh is shown.
    pub(super) is_shown: Vec<bool>,
}

impl SurfaceParts {
    /// Returns the parts of the shown faces of a mesh.
    ///
    /// # Errors
    /// If the watch says stop.
    pub(super) fn of(mesh: &Mesh, plan: &Plan, refiner: &Refiner<'_>) -> Result<Self, SolidError> {
        let (mut level, mut edges) = Level::of(mesh, plan);
        let mut parts = Self { is_shown: level.wanted.clone(), ..Self::default() };
        let whole = |face: u32| Square { face, corner: 0, from: [0.0; 2], size: 1.0 };
        let shown = (0..index(level.wanted.len())).filter(|&face| level.wanted[face as usize]);
        let mut cells: Vec<(u32, Square)> = shown.map(|face| (face, whole(face))).collect();
        while !cells.is_empty() {
            refiner.watch.check()?;
            let mut split = Vec::new();
            for (face, square) in cells {
                if !parts.take(&level, face, square)? {
                    split.push((face, square));
                }
            }
            (level, cells) = level.quartered(&split, refiner, &mut edges)?;
        }
        Ok(parts)
    }

    /// Takes a face that is bicubic or has a single extraordinary vertex; returns whether it is one.
    fn take(&mut self, level: &Level, face: u32, square: Square) -> Result<bool, SolidError> {
        let (part, bounds) = if level.is_leaf(face) {
            let half_edge = level.topology.half_edges(face as usize).start;
            let patch = square.patch(level, half_edge, [0.0; 3]);
            let bounds = BoundingBox::of(patch.net.iter().flatten().copied());
            (SurfacePart::Leaf(Box::new(patch)), bounds)
        } else if let Some(half_edge) = level.lone_extraordinary(face) {
            let end = ExtraordinaryFace::of(level, half_edge, square)?;
            let bounds = end.bounds();
            (SurfacePart::End(Box::new(end)), bounds)
        } else {
            return Ok(false);
        };
        self.all.push((square, part));
        self.boxes.push(bounds);
        Ok(true)
    }
}

impl Level {
    /// Returns the next level of some faces, ascending, with the squares of their parts.
    fn quartered(
        &self,
        split: &[(u32, Square)],
        refiner: &Refiner<'_>,
        edges: &mut Edges,
    ) -> Result<(Self, Vec<(u32, Square)>), SolidError> {
        let faces: Vec<u32> = split.iter().map(|&(face, _)| face).collect();
        let next = self.refined(&faces, refiner, edges)?;
        let squares = split.iter().flat_map(|&(face, square)| {
            let n = self.topology.half_edges(face as usize).len();
            (0..n).map(move |part| match n {
                4 => square.quarter(part),
                _ => Square { corner: index(part), ..square },
            })
        });
        let wanted = (0..index(next.topology.n_faces())).filter(|&f| next.wanted[f as usize]);
        let cells = wanted.zip(squares).collect();
        Ok((next, cells))
    }
}
