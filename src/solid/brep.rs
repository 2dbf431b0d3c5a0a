//! Faces, edges and vertices that bound a solid, each edge shared by the faces on its two sides.

use super::edges::{Edges, SidePiece};
use super::error::SolidError;
use super::patch::FacePatch;
use super::spline::{BSplineCurve, BSplineSurface};
use crate::math::functions::ratio;
use crate::math::vector::{Vector, length, minus};
use crate::shape::topology::{NONE, index};

/// A face of a solid, bounded by edges.
#[derive(Debug, Clone)]
pub struct Face {
    /// Its surface, oriented as seen from outside.
    pub surface: BSplineSurface,
    /// Its edges counter-clockwise in (u, v), each with whether it runs in this direction.
    pub edges: Vec<(u32, bool)>,
    /// The input faces from which the face arose, ascending.
    pub inputs: Vec<u32>,
    /// Whether the surface is exactly the limit surface, not a cap.
    pub is_exact: bool,
}

/// The use of an edge by a side of a face.
#[derive(Debug, Clone, Copy)]
pub(super) struct EdgeUse {
    pub(super) face: u32,
    pub(super) side: usize,
    /// The parameters of the side at the two ends of the edge, in the direction of the side.
    pub(super) range: [f64; 2],
}

/// An edge of a solid.
#[derive(Debug, Clone)]
pub struct Edge {
    /// The vertices at its two ends.
    pub ends: [u32; 2],
    /// Its curve, from the first vertex to the second.
    pub curve: BSplineCurve,
    /// Whether the surface is infinitely sharp or ends at the edge.
    pub is_sharp: bool,
    pub(super) uses: Vec<EdgeUse>,
}

/// A connected set of faces.
#[derive(Debug, Clone, Default)]
pub struct Shell {
    /// Its faces, ascending.
    pub faces: Vec<u32>,
    /// Whether every edge has a face on both sides.
    pub is_closed: bool,
    /// Whether the control mesh was inside out, so that the faces were reversed.
    pub was_inside_out: bool,
    /// Surface area, in square model units.
    pub area: f64,
    /// The enclosed volume in cubic model units; 0 if the shell is open.
    pub volume: f64,
    /// The Euler characteristic: vertices - edges + faces.
    pub euler: i64,
}

/// The boundary representation of solids.
#[derive(Debug, Clone, Default)]
pub struct Brep {
    /// The faces; exact ones come first.
    pub faces: Vec<Face>,
    /// The edges.
    pub edges: Vec<Edge>,
    /// The positions of the vertices, in model units.
    pub vertices: Vec<Vector>,
    /// The largest distance at an edge between the positions that its two faces give, or between its end and the
    /// vertex, in model units.
    pub gap: f64,
}

/// The vertices of the refinement at which edges of the solid begin and end.
struct Joints {
    /// The patches at each edge of the refinement.
    users: Vec<[u32; 2]>,
    /// Whether each vertex separates edges: more than two edges meet there, two of different faces do, or a face has a
    /// corner there.
    is_joint: Vec<bool>,
}

impl Joints {
    fn of(patches: &[FacePatch], edges: &Edges) -> Result<Self, SolidError> {
        let mut users = vec![[NONE; 2]; edges.len()];
        let mut is_joint = vec![false; edges.n_vertices()];
        for (p, patch) in patches.iter().enumerate() {
            for steps in &patch.sides {
                is_joint[steps[0].ends[0] as usize] = true;
                for step in steps {
                    let places = &mut users[step.edge as usize];
                    let place = usize::from(places[0] != NONE);
                    if places[place] != NONE {
                        return Err(SolidError::at("", "more than two faces meet at an edge; send a manifold mesh"));
                    }
                    places[place] = index(p);
                }
            }
        }
        let mut first = vec![NONE; edges.n_vertices()];
        let mut n_edges = vec![0_u8; edges.n_vertices()];
        let pair = |edge: u32| {
            let [a, b] = users[edge as usize];
            [a.min(b), a.max(b)]
        };
        for (p, patch) in patches.iter().enumerate() {
            // each edge counts once, at its first patch
            for step in patch.sides.iter().flatten().filter(|step| users[step.edge as usize][0] == index(p)) {
                for v in step.ends.map(|v| v as usize) {
                    n_edges[v] = n_edges[v].saturating_add(1);
                    is_joint[v] |= n_edges[v] > 2 || first[v] != NONE && pair(first[v]) != pair(step.edge);
                    first[v] = step.edge;
                }
            }
        }
        for (joint, n) in is_joint.iter_mut().zip(n_edges) {
            *joint |= n == 1;
        }
        Ok(Self { users, is_joint })
    }
}

/// A boundary representation under construction.
struct Assembly<'a> {
    edges: &'a Edges,
    joints: Joints,
    brep: Brep,
    /// The index of each vertex and edge of the refinement in the result, or [`NONE`].
    vertex: Vec<u32>,
    edge: Vec<u32>,
    /// The length of the shortest edge that readers can distinguish from a point, in model units.
    shortest: f64,
}

impl Brep {
    /// Joins patches along their sides. Pieces of edges between the same two faces become one edge.
    pub(super) fn of(patches: Vec<FacePatch>, edges: &Edges, shortest: f64) -> Result<Self, SolidError> {
        let joints = Joints::of(&patches, edges)?;
        let (vertex, edge) = (vec![NONE; edges.n_vertices()], vec![NONE; edges.len()]);
        let mut assembly = Assembly { edges, joints, brep: Self::default(), vertex, edge, shortest };
        for (p, patch) in patches.into_iter().enumerate() {
            let curves = patch.curves();
            let mut around = Vec::new();
            for (side, (steps, curve)) in patch.sides.iter().zip(&curves).enumerate() {
                let mut rest = steps.as_slice();
                while !rest.is_empty() {
                    let is_end = |step: &SidePiece| assembly.joints.is_joint[step.ends[1] as usize];
                    let n = rest.iter().position(is_end).map_or(rest.len(), |at| at + 1);
                    let (run, others) = rest.split_at(n);
                    rest = others;
                    let range = [run[0].range[0], run[n - 1].range[1]];
                    let at = EdgeUse { face: index(p), side, range };
                    around.push(assembly.edge(run, curve.piece(range), at)?);
                }
            }
            let FacePatch { surface, inputs, is_exact, .. } = patch;
            assembly.brep.faces.push(Face { surface, edges: around, inputs, is_exact });
        }
        Ok(assembly.brep)
    }

    /// Reverses faces so that they are seen from their other side.
    pub(super) fn reverse(&mut self, faces: &[u32]) {
        for &f in faces {
            let face = &mut self.faces[f as usize];
            let lengths = [0, 1, 2, 3].map(|s| face.surface.length(s));
            face.surface = face.surface.transposed();
            face.edges.reverse();
            for (edge, along) in &mut face.edges {
                *along = !*along;
                for at in self.edges[*edge as usize].uses.iter_mut().filter(|at| at.face == f) {
                    let ([s, e], length) = (at.range, lengths[at.side]);
                    (at.side, at.range) = (3 - at.side, [length - e, length - s]);
                }
            }
        }
    }

    /// Returns the shells, in the order of their first faces, without their measures.
    pub(super) fn shells(&self) -> Vec<Shell> {
        let mut parent: Vec<u32> = (0..index(self.faces.len())).collect();
        for pair in self.edges.iter().filter_map(|edge| edge.uses.first_chunk::<2>()) {
            let [a, b] = pair.map(|at| root(&mut parent, at.face));
            parent[a.max(b) as usize] = a.min(b);
        }
        let mut number = vec![NONE; self.faces.len()];
        let mut shells: Vec<Shell> = Vec::new();
        for f in 0..index(self.faces.len()) {
            let root = root(&mut parent, f) as usize;
            if number[root] == NONE {
                number[root] = index(shells.len());
                shells.push(Shell { is_closed: true, ..Shell::default() });
            }
            shells[number[root] as usize].faces.push(f);
        }
        let mut seen = vec![false; self.vertices.len()];
        for edge in &self.edges {
            let root = root(&mut parent, edge.uses[0].face) as usize;
            let shell = &mut shells[number[root] as usize];
            shell.is_closed &= edge.uses.len() == 2;
            shell.euler -= 1;
            for v in edge.ends.map(|v| v as usize) {
                shell.euler += i64::from(!std::mem::replace(&mut seen[v], true));
            }
        }
        for shell in &mut shells {
            shell.euler += i64::try_from(shell.faces.len()).unwrap_or(i64::MAX);
        }
        shells
    }
}

fn root(parent: &mut [u32], mut f: u32) -> u32 {
    while parent[f as usize] != f {
        parent[f as usize] = parent[parent[f as usize] as usize];
        f = parent[f as usize];
    }
    f
}

impl Assembly<'_> {
    /// Returns the edge of a run of pieces whose curve lies along the side of a face, and whether it runs in this
    /// direction.
    fn edge(&mut self, run: &[SidePiece], curve: BSplineCurve, at: EdgeUse) -> Result<(u32, bool), SolidError> {
        let last = curve.points.len() - 1;
        let outer = [run[0].ends[0], run[run.len() - 1].ends[1]];
        let ends = [self.vertex(outer[0], curve.points[0]), self.vertex(outer[1], curve.points[last])];
        for (v, point) in ends.into_iter().zip([curve.points[0], curve.points[last]]) {
            self.brep.gap = self.brep.gap.max(length(minus(self.brep.vertices[v as usize], point)));
        }
        let known = self.edge[run[0].edge as usize];
        if let Some(edge) = self.brep.edges.get_mut(known as usize) {
            edge.uses.push(at);
            // the second use runs in the opposite direction, as neighbours are consistently oriented
            let halfway = length(minus(edge.curve.middle(), curve.middle()));
            self.brep.gap = self.brep.gap.max(halfway);
            return Ok((known, false));
        }
        let long = curve.points.windows(2).map(|pair| length(minus(pair[1], pair[0]))).fold(0.0, |sum, x| sum + x);
        if long <= self.shortest {
            let detail = format!(
                "an edge of the surface is {long:.1e} model units long, which readers take for a point (up to {:.1e}); \
                 ask for a coarser tolerance, or send a mesh without collapsed faces, or in a larger unit",
                self.shortest
            );
            return Err(SolidError::at("", detail));
        }
        let number = index(self.brep.edges.len());
        run.iter().for_each(|step| self.edge[step.edge as usize] = number);
        let is_open = self.joints.users[run[0].edge as usize][1] == NONE;
        let is_sharp = is_open || run.iter().any(|step| self.edges.is_sharp(step.edge));
        self.brep.edges.push(Edge { ends, curve, is_sharp, uses: vec![at] });
        Ok((number, true))
    }

    fn vertex(&mut self, v: u32, point: Vector) -> u32 {
        let number = &mut self.vertex[v as usize];
        if *number == NONE {
            *number = index(self.brep.vertices.len());
            self.brep.vertices.push(point);
        }
        *number
    }
}

/// Number of places of an edge at which the normals of its two faces are compared. Half of it may miss the largest
/// angle between the faces, which the certificate reports; twice of it takes twice the time and finds hardly more,
/// since the angle changes slowly along the edge.
const COMPARED_PLACES: usize = 9;

impl EdgeUse {
    /// Returns places of the edge in the surface of the face, in the direction of its side, at some distance from the
    /// ends.
    pub(super) fn places(&self, surface: &BSplineSurface) -> Vec<[f64; 2]> {
        let [s, e] = self.range;
        let at = |k: usize| s + (e - s) * (0.02 + 0.96 * ratio(k, COMPARED_PLACES - 1));
        (0..COMPARED_PLACES).map(|k| surface.on_side(self.side, at(k))).collect()
    }
}
