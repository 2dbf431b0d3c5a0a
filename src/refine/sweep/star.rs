//! Refines the faces around a vertex where the grid is not regular, by tables of their own.

use std::collections::HashMap;
use std::sync::Arc;

use super::lanes::Lanes;
use super::lattice::{last, sector};
use super::line::softened;
use super::sample::{TableUse, steps};
use crate::math::rows::{RowSource, Rows};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::plan::{Plan, Scheduled};
use crate::scheme::sharpness::Sharpness;
use crate::scheme::tags::Boundary;
use crate::shape::check::{FaceList, Winding};
use crate::shape::tile::Tile;
use crate::shape::topology::{Topology, index};

/// The properties of a vertex that decide how the faces around it are refined.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct StarKind {
    /// Number of faces around the vertex.
    pub(super) faces: usize,
    /// Whether the faces surround the vertex completely.
    pub(super) closed: bool,
    /// The sharp edges at the vertex, by their index in the ring, with the bits of their sharpness.
    pub(super) sharp: Vec<(usize, u64)>,
    /// The bits of the sharpness of the vertex, which is infinite at corners.
    pub(super) corner: u64,
    /// The tags of the net, as seen from the first edge of the ring.
    pub(super) lanes: Option<Lanes>,
}

impl StarKind {
    /// Returns the kind of the vertex after so many rounds.
    pub(super) fn after(&self, rounds: usize) -> Self {
        let left = |bits: u64| softened(f64::from_bits(bits), rounds).map(f64::to_bits);
        let sharp = self.sharp.iter().filter_map(|&(edge, sharpness)| Some((edge, left(sharpness)?))).collect();
        Self { sharp, corner: left(self.corner).unwrap_or(0), ..*self }
    }
}

/// The numbering of the points of a star: the vertex, then for each face of the ring the points of its [`sector`], `a`
/// steps along the face's first edge and `b` along its last one, and, if the faces do not close, the points of the last
/// edge.
#[derive(Debug, Clone, Copy)]
pub(super) struct StarShape {
    pub(super) tile: Tile,
    pub(super) faces: usize,
    pub(super) closed: bool,
    /// Number of cells around the vertex.
    pub(super) reach: usize,
}

impl StarShape {
    /// Returns the number of points.
    pub(super) fn len(self) -> usize {
        let last = if self.closed { 0 } else { self.reach };
        1 + self.faces * self.sector() + last
    }

    /// Returns the number of points of a face.
    fn sector(self) -> usize {
        self.column(self.reach + 1)
    }

    /// Returns the number of points of a face in the columns before column `a`.
    fn column(self, a: usize) -> usize {
        match self.tile {
            Tile::Quad => (a - 1) * (self.reach + 1),
            // column `a` has `reach + 1 - a` points
            Tile::Triangle => (a - 1) * (2 * self.reach + 2 - a) / 2,
        }
    }

    /// Returns the next face of the ring counter-clockwise, or the previous one; `None` beyond a boundary.
    pub(super) fn neighbour(self, face: usize, next: bool) -> Option<usize> {
        match next {
            true if face + 1 < self.faces => Some(face + 1),
            true => self.closed.then_some(0),
            false if face > 0 => Some(face - 1),
            false => self.closed.then(|| self.faces - 1),
        }
    }

    /// Returns the index of the point `[a, b]` of a face of the ring.
    pub(super) fn point(self, face: usize, [a, b]: [usize; 2]) -> usize {
        let inside = |face: usize, a: usize, b: usize| 1 + face * self.sector() + self.column(a) + b;
        match (a, b) {
            (0, 0) => 0,
            (0, b) if face + 1 < self.faces => inside(face + 1, b, 0),
            (0, b) if self.closed => inside(0, b, 0),
            (0, b) => 1 + self.faces * self.sector() + b - 1,
            (a, b) => inside(face, a, b),
        }
    }

    /// Returns all points in order, as face and `[a, b]`; the vertex is the first.
    pub(super) fn points(self) -> impl Iterator<Item = (usize, [usize; 2])> {
        let inside =
            (0..self.faces).flat_map(move |face| sector(self.tile, self.reach).map(move |place| (face, place)));
        let last = if self.closed { 0 } else { self.reach };
        let on_last = (1..=last).map(move |b| (self.faces - 1, [0, b]));
        std::iter::once((0, [0, 0])).chain(inside).chain(on_last)
    }
}

/// The tables of one round for the points of a star.
#[derive(Debug)]
pub(super) struct StarRound {
    stages: Vec<StarStep>,
}

/// One step, restricted to the points that later steps need and renumbered accordingly.
#[derive(Debug)]
enum StarStep {
    /// Rows over the points of the star before the round.
    Up(Rows),
    /// Rows over the points before the step.
    Blend(Rows),
    /// Rows over differences, which are added to the points; the points keep their indices.
    Push {
        /// For each difference the point of the star and its child before the step.
        differences: Vec<[u32; 2]>,
        rows: Rows,
    },
}

impl StarRound {
    /// Returns the tables of a round around a vertex of this kind, with `before` rounds before it; `None` if the
    /// operators cannot be applied there.
    pub(super) fn of(
        kind: &StarKind,
        (tile, reach): (Tile, usize),
        before: usize,
        plan: &Plan,
        round: &[Scheduled],
    ) -> Option<Self> {
        let kind = kind.after(before);
        let disc = StarMesh::new(&kind, tile, reach)?;
        let tables = steps(disc.net(&kind, plan), plan, round)?;
        let mut needed = Needed::of(disc.next());
        let mut stages = Vec::new();
        for (is, rows) in tables.iter().rev() {
            let rows = &**rows;
            let (stage, before) = match is {
                TableUse::Up => (StarStep::Up(needed.rows(rows, |i| i)), Needed::default()),
                TableUse::Blend => {
                    let mut before = Needed::default();
                    (StarStep::Blend(needed.rows(rows, |i| before.number(i))), before)
                }
                TableUse::Push => {
                    let (mut before, mut anchors) = (Needed::of(needed.order.clone()), Needed::default());
                    let made = needed.rows(rows, |i| anchors.number(i));
                    // each vertex keeps its index in the refined net, so it is its own child
                    let differences = anchors.order.iter().map(|&v| [v, before.number(v)]).collect();
                    (StarStep::Push { differences, rows: made }, before)
                }
            };
            stages.push(stage);
            needed = before;
        }
        stages.reverse();
        Some(Self { stages })
    }

    /// Returns an upper bound of the factor by which values grow in the round.
    pub(super) fn growth(&self) -> f64 {
        let largest = |rows: &Rows| {
            let total = |row: usize| rows.row(row).1.iter().map(|weight| weight.abs()).sum();
            (0..rows.len()).map(total).fold(1.0, f64::max)
        };
        let of = |stage: &StarStep| match stage {
            StarStep::Up(rows) | StarStep::Blend(rows) => largest(rows),
            StarStep::Push { rows, .. } => 1.0 + 2.0 * largest(rows),
        };
        self.stages.iter().map(of).product::<f64>()
    }

    /// Computes the points of the star after the round, in `work.now`, from those before it.
    pub(super) fn apply<const W: usize>(&self, star: &[[f64; W]], work: &mut StarWork<W>) {
        let StarWork { now, next, differences } = work;
        for stage in &self.stages {
            match stage {
                StarStep::Up(rows) => fill(rows, star, next),
                StarStep::Blend(rows) => fill(rows, now, next),
                StarStep::Push { differences: pairs, rows } => {
                    differences.clear();
                    differences.extend(pairs.iter().map(|&[anchor, child]| -> [f64; W] {
                        std::array::from_fn(|c| star[anchor as usize][c] - now[child as usize][c])
                    }));
                    fill(rows, differences, next);
                    for (x, before) in next.iter_mut().zip(&*now) {
                        *x = std::array::from_fn(|c| before[c] + x[c]);
                    }
                }
            }
            std::mem::swap(now, next);
        }
    }
}

/// Buffers for the refinement of stars.
#[derive(Debug, Default)]
pub(super) struct StarWork<const W: usize> {
    /// The points after the last step.
    pub(super) now: Vec<[f64; W]>,
    next: Vec<[f64; W]>,
    differences: Vec<[f64; W]>,
}

fn fill<const W: usize>(rows: &Rows, from: &[[f64; W]], to: &mut Vec<[f64; W]>) {
    to.resize(rows.len(), [0.0; W]);
    rows.apply(from, to);
}

/// The points of a net that later steps need, numbered in the order in which they were requested.
#[derive(Default)]
struct Needed {
    order: Vec<u32>,
    numbers: HashMap<u32, u32>,
}

impl Needed {
    fn of(order: Vec<u32>) -> Self {
        let numbers = order.iter().zip(0..).map(|(&i, number)| (i, number)).collect();
        Self { order, numbers }
    }

    fn number(&mut self, i: u32) -> u32 {
        *self.numbers.entry(i).or_insert_with(|| {
            self.order.push(i);
            index(self.order.len() - 1)
        })
    }

    /// Returns the rows of the needed points, with columns renumbered by `number`.
    fn rows(&self, source: &dyn RowSource, mut number: impl FnMut(u32) -> u32) -> Rows {
        let (mut made, mut row) = (Rows::default(), Rows::default());
        for &i in &self.order {
            row.clear();
            source.make(i as usize..i as usize + 1, &mut row);
            for term in row.terms(0) {
                made.group(|made| {
                    let entries = term.indices.iter().zip(term.weights);
                    entries.for_each(|(&i, &weight)| made.add(number(i), weight));
                });
            }
            made.end_row();
        }
        made
    }
}

/// The faces around a vertex as a separate mesh, whose vertices are numbered as the points of the star.
pub(super) struct StarMesh {
    shape: StarShape,
    topology: Arc<Topology>,
    /// The face index of each ring face and cell; quads only.
    cells: HashMap<(usize, [usize; 2]), usize>,
}

impl StarMesh {
    /// Creates the faces around a vertex of this kind, `reach` cells wide; `None` if they are not a manifold.
    pub(super) fn new(kind: &StarKind, tile: Tile, reach: usize) -> Option<Self> {
        let shape = StarShape { tile, faces: kind.faces, closed: kind.closed, reach };
        let mut faces = FaceList::default();
        let mut cells = HashMap::new();
        for face in 0..kind.faces {
            let vertex = |[a, b]: [usize; 2]| index(shape.point(face, [a, b]));
            for (b, a) in (0..reach).flat_map(|b| (0..last(tile, reach, b)).map(move |a| (b, a))) {
                match tile {
                    Tile::Quad => {
                        cells.insert((face, [a, b]), cells.len());
                        faces.push([[a, b], [a + 1, b], [a + 1, b + 1], [a, b + 1]].map(vertex));
                    }
                    Tile::Triangle => {
                        faces.push([[a, b], [a + 1, b], [a, b + 1]].map(vertex));
                        if a + b + 1 < reach {
                            faces.push([[a + 1, b + 1], [a, b + 1], [a + 1, b]].map(vertex));
                        }
                    }
                }
            }
        }
        let checked = Topology::of_faces(shape.len(), faces, Winding::Refuse).ok()?;
        checked.split_from.is_empty().then(|| Self { shape, topology: Arc::new(checked.topology), cells })
    }

    /// Returns the numbering of the vertices.
    pub(super) fn shape(&self) -> StarShape {
        self.shape
    }

    /// Returns the net under a plan.
    pub(super) fn net(&self, kind: &StarKind, plan: &Plan) -> MeshNet {
        let on_edge = |edge: usize, at: usize| -> u32 {
            let (face, place) = if edge < kind.faces { (edge, [at, 0]) } else { (edge - 1, [0, at]) };
            index(self.shape.point(face, place))
        };
        let edges = self.edges();
        let pieces = kind.sharp.iter().flat_map(|&(edge, bits)| (0..self.shape.reach).map(move |at| (edge, at, bits)));
        let mut sharp: Vec<(u32, f64)> = pieces
            .map(|(edge, at, bits)| (index(edges[&[on_edge(edge, at), on_edge(edge, at + 1)]]), f64::from_bits(bits)))
            .collect();
        sharp.sort_unstable_by_key(|&(e, _)| e);
        let own = f64::from_bits(kind.corner);
        let corners: &[u32] = if own == f64::INFINITY { &[0] } else { &[] };
        let semi_sharp = (own > 0.0 && own < f64::INFINITY).then_some((0, own)).into_iter().collect();
        let net = MeshNet::new(self.topology.clone(), corners, &[], Boundary::EdgeOnly);
        let net = kind.lanes.map_or_else(|| net.clone(), |lanes| lanes.carried(net.clone(), self.on_odd_spokes()));
        net.with_sharpness(Sharpness::of(&sharp, &semi_sharp), plan.rules)
    }

    /// Returns a predicate that tells whether an edge runs along a spoke with an odd index in the ring of the vertex.
    fn on_odd_spokes(&self) -> impl Fn(usize) -> bool + use<> {
        let edges = self.edges();
        let mut odd = vec![false; self.topology.n_edges()];
        let mut mark = |face: usize, ends: [[usize; 2]; 2], spoke: usize| {
            odd[edges[&ends.map(|place| index(self.shape.point(face, place)))]] = spoke % 2 == 1;
        };
        for &(face, [a, b]) in self.cells.keys() {
            for along in [b, b + 1] {
                mark(face, [[a, along], [a + 1, along]], face);
            }
            for along in [a, a + 1] {
                mark(face, [[along, b], [along, b + 1]], face + 1);
            }
        }
        move |e| odd[e]
    }

    fn edges(&self) -> HashMap<[u32; 2], usize> {
        let ends = (0..self.topology.n_edges()).map(|e| (e, self.topology.ends(e)));
        ends.flat_map(|(e, [a, b])| [([a, b], e), ([b, a], e)]).collect()
    }

    /// Returns the points of the refined disc that are the points of the star after the round.
    fn next(&self) -> Vec<u32> {
        let (n_v, n_e) = (self.topology.n_vertices(), self.topology.n_edges());
        let edges = self.edges();
        let fine = |(face, [a, b]): (usize, [usize; 2])| {
            let vertex = |i, j| index(self.shape.point(face, [i, j]));
            let (i, j) = (a / 2, b / 2);
            match (a % 2, b % 2) {
                (0, 0) => vertex(i, j),
                (1, 0) => index(n_v + edges[&[vertex(i, j), vertex(i + 1, j)]]),
                (0, _) => index(n_v + edges[&[vertex(i, j), vertex(i, j + 1)]]),
                _ if self.shape.tile == Tile::Triangle => index(n_v + edges[&[vertex(i + 1, j), vertex(i, j + 1)]]),
                _ => index(n_v + n_e + self.cells[&(face, [i, j])]),
            }
        };
        self.shape.points().map(fine).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_points_of_a_star_are_numbered_in_their_order() {
        for (faces, closed, reach) in [(3, true, 1), (5, true, 2), (1, false, 1), (3, false, 3)] {
            for tile in [Tile::Quad, Tile::Triangle] {
                let shape = StarShape { tile, faces, closed, reach };
                let numbers: Vec<usize> = shape.points().map(|(face, place)| shape.point(face, place)).collect();
                assert!(numbers.iter().copied().eq(0..shape.len()), "{shape:?}: {numbers:?}");
            }
        }
    }
}
