//! Sheets: the faces around a face, if they are locally a graph over its plane.

use crate::math::vector::{Vector, cross, dot, from_segment, length, minus, plus, times};
use crate::shape::topology::{NONE, Topology};

/// The surroundings of a face, projected along a direction n, the normal of the sheet.
///
/// The surface of the faces is made of bilinear quads and triangles, or of quads cut along either diagonal. If all
/// normals at corners of faces have positive products with n, so do the normals everywhere, which are sums of them with
/// positive weights; then the projection along n is open, and straight paths in the plane can be lifted to the surface
/// as long as they do not meet its boundary. No vertex of the central face is a branch point, around which the faces
/// would wind more than once, so that discs inside have one lift. A lifted path of length r in the plane climbs by at
/// most `slope r`, and so does the plane of a triangle of the surface. So a point that is h above or below the plane of
/// a triangle, along n, and r beside the triangle, seen along n, is within `h + 2 slope r` of the surface.
#[derive(Debug, Clone)]
pub(super) struct ProjectedSheet {
    /// The direction, a unit vector.
    normal: Vector,
    /// The greatest tangent of the angle between the direction and a normal of a face at a corner.
    slope: f64,
    /// The edges at which the faces end, projected.
    boundary: Vec<[Vector; 2]>,
    /// The faces, the central one first.
    faces: Vec<usize>,
    /// The corners of the central face, projected.
    outline: [Vector; 4],
    /// Number of corners of the central face.
    sides: usize,
}

impl ProjectedSheet {
    /// Creates the sheet of a face and the faces at its corners, as far as they belong to the surface; `None` if it
    /// folds over, winds more than once around a corner or has no direction.
    pub(super) fn around(
        topology: &Topology,
        points: &[Vector],
        face: usize,
        belongs: impl Fn(usize) -> bool,
    ) -> Option<Self> {
        let mut faces: Vec<usize> = vec![face];
        for half_edge in topology.face(face).iter().flat_map(|&v| topology.ring(v as usize)) {
            let f = topology.face_of(half_edge);
            if !faces.contains(&f) && belongs(f) {
                faces.push(f);
            }
        }
        let at = |half_edge: u32| points[topology.vertex(half_edge) as usize];
        let normal = |half_edge: u32| normal(topology, points, half_edge);
        let corners = topology.face(face);
        let sum = topology.half_edges(face).map(normal).fold([0.0; 3], plus);
        let size = Some(length(sum)).filter(|&size| size > 0.0)?;
        let n = times(1.0 / size, sum);
        let (mut slope, mut boundary) = (0.0_f64, Vec::new());
        for half_edge in faces.iter().flat_map(|&f| topology.half_edges(f)) {
            let here = normal(half_edge);
            let up = Some(dot(n, here)).filter(|&up| up > 0.0)?;
            slope = slope.max(length(flat(n, here)) / up);
            let twin = topology.twin(half_edge);
            if twin == NONE || !faces.contains(&topology.face_of(twin)) {
                boundary.push([half_edge, topology.next(half_edge)].map(|c| flat(n, at(c))));
            }
        }
        let ends = |half_edge: u32| minus(at(topology.next(half_edge)), at(half_edge));
        if corners.iter().any(|&v| {
            topology.boundary_edges(v as usize).is_none() && windings(n, topology.ring(v as usize).map(ends)) > 1
        }) {
            return None;
        }
        let mut outline = [[0.0; 3]; 4];
        outline.iter_mut().zip(corners).for_each(|(p, &v)| *p = flat(n, points[v as usize]));
        Some(Self { normal: n, slope, boundary, faces, outline, sides: corners.len().min(4) })
    }

    /// Returns the faces, the central one first.
    pub(super) fn faces(&self) -> &[usize] {
        &self.faces
    }

    /// Returns an upper bound of the distance, either from the other, between the central face and the surface if all
    /// faces are displaced by convex combinations of the given vectors; `None` if points could leave the sheet.
    ///
    /// A displaced point of the central face is near the surface, because the path to it can be lifted. Conversely, let
    /// v be the greatest length of a displacement across the normal, less than the distance to the boundary, and y a
    /// point of the face. The disc of radius v around y in the plane can be lifted; the map that takes its point q to y
    /// minus the displacement across the normal of the surface over q maps the disc to itself, so that it has a fixed
    /// point (Brouwer), and the surface over that is displaced to a point above or below y.
    pub(super) fn displaced(&self, displacements: impl Iterator<Item = Vector>) -> Option<f64> {
        let (mut rise, mut along) = (0.0_f64, 0.0_f64);
        for x in displacements {
            rise = rise.max(dot(self.normal, x).abs());
            along = along.max(length(flat(self.normal, x)));
        }
        (along < self.exit()).then_some(rise + self.slope * along)
    }

    /// Returns the greatest tangent of the angle between the normal of the sheet and the normals of its faces.
    pub(super) fn slope(&self) -> f64 {
        self.slope
    }

    /// Returns the distance in the plane between the central face and the boundary of the sheet.
    pub(super) fn exit(&self) -> f64 {
        let [a, b, c, d] = self.outline;
        let halves = [[a, b, c], [a, c, d]];
        let halves = &halves[..self.sides - 2];
        let apart = |&edge: &[Vector; 2]| halves.iter().map(move |&half| self.apart(half, edge));
        self.boundary.iter().flat_map(apart).fold(f64::INFINITY, f64::min)
    }

    /// Returns an upper bound of the distance of all convex combinations of some points from the surface, by way of a
    /// triangle of the central face; `None` if the path to them could leave the sheet.
    pub(super) fn distance(&self, triangle: [Vector; 3], points: &[Vector]) -> Option<f64> {
        let n = self.normal;
        let [a, b, c] = triangle;
        let normal = cross(minus(b, a), minus(c, a));
        let up = Some(dot(n, normal)).filter(|&up| up > 0.0)?;
        let outline = triangle.map(|p| flat(n, p));
        let mut below = [[0.0; 3]; 4];
        let below = &mut below[..points.len().min(4)];
        below.iter_mut().zip(points).for_each(|(q, &p)| *q = flat(n, p));
        let (mut most, mut farthest) = (0.0_f64, 0.0_f64);
        for (&p, &q) in points.iter().zip(&*below) {
            let beside = self.beside(outline, q);
            farthest = farthest.max(beside);
            most = most.max((dot(normal, minus(p, a)) / up).abs() + 2.0 * self.slope * beside);
        }
        let harmless = |edge: &[Vector; 2]| {
            let inside = outline.iter().chain(&*below).all(|&p| self.left(*edge, p) >= 0.0);
            inside || self.apart(outline, *edge) > farthest
        };
        (farthest <= 0.0 || self.boundary.iter().all(harmless)).then_some(most)
    }

    /// Returns the distance in the plane of a point from a triangle.
    fn beside(&self, triangle: [Vector; 3], p: Vector) -> f64 {
        let sides = sides(triangle);
        if sides.iter().all(|&side| self.left(side, p) >= 0.0) {
            return 0.0;
        }
        sides.iter().map(|&side| from_segment(p, side)).fold(f64::INFINITY, f64::min)
    }

    /// Returns the distance in the plane of a segment from a triangle.
    fn apart(&self, triangle: [Vector; 3], [q, r]: [Vector; 2]) -> f64 {
        let crosses = |[a, b]: [Vector; 2]| {
            self.left([a, b], q) * self.left([a, b], r) <= 0.0 && self.left([q, r], a) * self.left([q, r], b) <= 0.0
        };
        if sides(triangle).into_iter().any(crosses) {
            return 0.0;
        }
        let ends = [q, r].map(|p| self.beside(triangle, p));
        triangle.iter().map(|&p| from_segment(p, [q, r])).chain(ends).fold(f64::INFINITY, f64::min)
    }

    /// Returns twice the signed area of the triangle of a side and a point, positive if the point is on the left of the
    /// side, seen along the normal.
    fn left(&self, [q, r]: [Vector; 2], p: Vector) -> f64 {
        dot(self.normal, cross(minus(r, q), minus(p, q)))
    }
}

fn sides([a, b, c]: [Vector; 3]) -> [[Vector; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

/// Returns the normal of a face at the start of a half-edge: the cross product of the two sides that meet there.
pub(super) fn normal(topology: &Topology, points: &[Vector], half_edge: u32) -> Vector {
    let at = |half_edge: u32| points[topology.vertex(half_edge) as usize];
    let here = at(half_edge);
    cross(minus(at(topology.next(half_edge)), here), minus(at(topology.previous(half_edge)), here))
}

/// Returns how often consecutive vectors, each to the left of the one before, wind around, seen along the normal.
pub(super) fn windings(n: Vector, mut around: impl Iterator<Item = Vector>) -> usize {
    let Some(first) = around.next() else { return 0 };
    let mut is_left = true;
    let mut windings = 0;
    for x in around.chain([first]) {
        let was_left = std::mem::replace(&mut is_left, dot(n, cross(first, x)) >= 0.0);
        windings += usize::from(is_left && !was_left);
    }
    windings
}

/// Returns the component of a vector across the unit vector `n`.
pub(super) fn flat(n: Vector, p: Vector) -> Vector {
    minus(p, times(dot(n, p), n))
}
