//! Small nets from which the masks of regular grids are read.

use std::collections::HashMap;
use std::sync::Arc;

use super::lanes::Lanes;
use super::lattice::{LATTICE_AXES, after, cell, fine};
use super::line::SharpSide;
use super::planes::{MaskGroup, PLANES, PlaneMask};
use crate::math::rows::{RowSource, Rows};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::plan::{Plan, Scheduled};
use crate::scheme::sharpness::Sharpness;
use crate::scheme::step::Action;
use crate::scheme::stepper::Stepper;
use crate::scheme::tags::Boundary;
use crate::shape::check::{FaceList, Winding};
use crate::shape::tile::Tile;
use crate::shape::topology::{Topology, index};

/// Cells on each side of the middle of the nets from which masks are read: two cells, the reach of masks, and one more.
/// With half as many, butterfly schemes would have the masks of a boundary; twice as many would only take longer.
pub(super) const SAMPLE_RADIUS: usize = 3;

/// How a step uses a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TableUse {
    /// All points are computed from the coarse grid.
    Up,
    /// All points are computed from the points before the step.
    Blend,
    /// Rows of the differences between the coarse grid and its children are added.
    Push,
}

/// The masks of one step on one net.
pub(super) struct MaskTable {
    pub(super) is: TableUse,
    /// Planes and masks of the four points that belong to the cell in the middle; if there is a line, those of the
    /// vertex in the middle and of the point that follows it along the line.
    pub(super) masks: Vec<(usize, PlaneMask)>,
    /// Planes and masks of points next to the line.
    pub(super) beside: Vec<(usize, PlaneMask)>,
}

/// A small net with a vertex in its middle, which may lie on a line along an axis.
pub(super) struct Sample {
    /// Number of cells on each side of the middle; also each coordinate of the middle.
    radius: isize,
    line: Option<(SharpSide, usize)>,
    lanes: Option<Lanes>,
    topology: Arc<Topology>,
    /// The place of each vertex.
    coarse: Vec<[isize; 2]>,
}

/// Returns how far a place lies to the left of the line along an axis through `[through, through]`.
fn side(axis: usize, through: isize, [i, j]: [isize; 2]) -> isize {
    let [a, b] = LATTICE_AXES[axis];
    a * (j - through) - b * (i - through)
}

impl Sample {
    /// Creates a net with `radius` cells on each side of the middle.
    pub(super) fn new(tile: Tile, line: Option<(SharpSide, usize)>, radius: usize) -> Self {
        let radius = radius.cast_signed();
        let cells = (0..2 * radius).flat_map(|j| (0..2 * radius).map(move |i| [i, j]));
        let corners = |[i, j]: [isize; 2]| match tile {
            Tile::Quad => vec![vec![[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]]],
            Tile::Triangle => {
                vec![vec![[i, j], [i + 1, j], [i, j + 1]], vec![[i + 1, j + 1], [i, j + 1], [i + 1, j]]]
            }
        };
        let cut = line.and_then(|(line, axis)| (line == SharpSide::Boundary).then_some(axis));
        let is_kept =
            |face: &Vec<[isize; 2]>| cut.is_none_or(|axis| face.iter().all(|&at| side(axis, radius, at) >= 0));
        let (mut numbers, mut coarse, mut faces) = (HashMap::new(), Vec::new(), FaceList::default());
        for face in cells.flat_map(corners).filter(is_kept) {
            let vertices = face.into_iter().map(|at| {
                *numbers.entry(at).or_insert_with(|| {
                    coarse.push(at);
                    index(coarse.len() - 1)
                })
            });
            faces.push(vertices.collect::<Vec<_>>());
        }
        let checked = Topology::of_faces(coarse.len(), faces, Winding::Refuse).expect("a grid is a mesh");
        Self { radius, line, lanes: None, topology: Arc::new(checked.topology), coarse }
    }

    /// Returns the sample with the tags of lanes.
    pub(super) fn with_lanes(self, lanes: Option<Lanes>) -> Self {
        Self { lanes, ..self }
    }

    /// Returns the vertex in the middle.
    pub(super) fn middle(&self) -> u32 {
        index(self.coarse.iter().position(|&place| place == [self.radius; 2]).unwrap_or(0))
    }

    /// Returns the place of a vertex relative to the middle.
    pub(super) fn off_middle(&self, v: u32) -> [isize; 2] {
        self.coarse[v as usize].map(|x| x - self.radius)
    }

    /// Returns the net under a plan.
    pub(super) fn net(&self, plan: &Plan) -> MeshNet {
        let net = MeshNet::new(self.topology.clone(), &[], &[], Boundary::EdgeOnly);
        let is_odd = |e: usize| {
            let [a, b] = self.topology.ends(e).map(|v| self.coarse[v as usize]);
            a[0] == b[0]
        };
        let net = self.lanes.map_or_else(|| net.clone(), |lanes| lanes.carried(net.clone(), is_odd));
        let Some((SharpSide::Crease(sharpness), axis)) = self.line else { return net.with_sharpness(None, plan.rules) };
        let on_line =
            |e: usize| self.topology.ends(e).iter().all(|&v| side(axis, self.radius, self.coarse[v as usize]) == 0);
        let sharp = (0..self.topology.n_edges()).filter(|&e| on_line(e)).map(|e| (index(e), sharpness)).collect();
        net.with_sharpness(Sharpness::of(&sharp, &Vec::new()), plan.rules)
    }

    /// Returns the place of each point of the refined net on the refined grid.
    fn places(&self, n: usize) -> Vec<[isize; 2]> {
        let topology = &self.topology;
        let sum = |vertices: &[u32]| {
            vertices.iter().map(|&v| self.coarse[v as usize]).fold([0, 0], |s, p| [s[0] + p[0], s[1] + p[1]])
        };
        let vertices = self.coarse.iter().map(|place| place.map(|x| 2 * x));
        let edges = (0..topology.n_edges()).map(|e| sum(&topology.ends(e)));
        let faces = (0..topology.n_faces()).map(|f| sum(topology.face(f)).map(|x| x / 2));
        vertices.chain(edges).chain(faces).take(n).collect()
    }

    /// Returns the masks of each step of a round around the middle, or `None` if masks cannot express one of them.
    pub(super) fn tables(&self, plan: &Plan, round: &[Scheduled]) -> Option<Vec<MaskTable>> {
        let steps = steps(self.net(plan), plan, round)?;
        let places = self.places(steps.first()?.1.n_rows());
        let find: HashMap<[isize; 2], usize> = places.iter().enumerate().map(|(i, &place)| (place, i)).collect();
        let table = |(is, rows): &(TableUse, Box<dyn RowSource>)| {
            let mask = |plane: usize, at: [isize; 2]| {
                self.mask(&**rows, *find.get(&fine(plane, at))?, at, (*is == TableUse::Blend).then_some(&places))
            };
            let masks = |points: Vec<(usize, [isize; 2])>| {
                points.into_iter().map(|(plane, at)| Some((plane, mask(plane, at)?))).collect::<Option<Vec<_>>>()
            };
            let middle = match self.line {
                None => (0..PLANES).map(|plane| (plane, [self.radius; 2])).collect(),
                Some((_, axis)) => vec![(0, [self.radius; 2]), after(axis, [self.radius; 2])],
            };
            Some(MaskTable { is: *is, masks: masks(middle)?, beside: masks(self.beside())? })
        };
        steps.iter().map(table).collect()
    }

    /// Returns planes and cells of points next to the line, up to a cell away, on the side on which a boundary has its
    /// faces.
    fn beside(&self) -> Vec<(usize, [isize; 2])> {
        let Some((_, axis)) = self.line else { return Vec::new() };
        let middle = 2 * self.radius;
        let near = (-2..=2).flat_map(|j| (-2..=2).map(move |i| [middle + i, middle + j]));
        near.filter(|&place| (1..=2).contains(&side(axis, middle, place))).map(cell).collect()
    }

    /// Returns the mask of one row for a point of cell `at`, over the refined net if `places` are given, else over the
    /// coarse one.
    fn mask(
        &self,
        rows: &dyn RowSource,
        row: usize,
        at: [isize; 2],
        places: Option<&Vec<[isize; 2]>>,
    ) -> Option<PlaneMask> {
        let mut table = Rows::default();
        rows.make(row..row + 1, &mut table);
        let member = |i: u32| match places {
            None => (0, self.coarse[i as usize]),
            Some(places) => cell(places[i as usize]),
        };
        let relative = |(plane, cell): (usize, [isize; 2])| (plane, [cell[0] - at[0], cell[1] - at[1]]);
        let groups = table.terms(0).map(|term| {
            let members = term.indices.iter().map(|&i| relative(member(i))).collect();
            term.alike.then_some(MaskGroup { weight: term.weights[0], members })
        });
        groups.collect()
    }
}

/// Returns the rows of each step of a round and how they are used, or `None` if a step does not fit this form.
pub(super) fn steps(mut net: MeshNet, plan: &Plan, round: &[Scheduled]) -> Option<Vec<(TableUse, Box<dyn RowSource>)>> {
    let mut tables = Vec::new();
    for step in round {
        let next = Stepper::new(plan).next(&net, step).ok()?;
        tables.push(used(next.action)?);
        net = next.net;
    }
    let ups = tables.iter().filter(|(is, _)| *is == TableUse::Up).count();
    (ups == 1 && tables[0].0 == TableUse::Up).then_some(tables)
}

fn used(action: Action) -> Option<(TableUse, Box<dyn RowSource>)> {
    match action {
        Action::BlendFromAnchor(rows) => Some((TableUse::Up, rows)),
        Action::Blend(rows) => Some((TableUse::Blend, rows)),
        Action::PushBack { rows, children } => {
            let same = children.iter().enumerate().all(|(v, &child)| child as usize == v);
            same.then_some((TableUse::Push, rows))
        }
        Action::Map(_) | Action::Sequence(_) => None,
    }
}
