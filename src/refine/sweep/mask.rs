//! The masks of a round on a grid of quads, read off the rows of the operators on small nets.

use std::collections::HashMap;
use std::sync::Arc;

use crate::math::rows::{RowSource, Rows};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::plan::{Plan, Scheduled};
use crate::scheme::sharpness::Sharpness;
use crate::scheme::step::Action;
use crate::scheme::stepper::Stepper;
use crate::scheme::tags::Boundary;
use crate::shape::check::{FaceList, Winding};
use crate::shape::creases::INFINITE_SHARPNESS;
use crate::shape::topology::{Topology, index};

/// The four planes of a refined grid: vertices, points of edges along the first and the second axis, points of faces.
pub(super) const PLANES: usize = 4;

/// A weight and the points whose symmetric sum it belongs to: the plane of each, and its cell counted from that of the
/// point that is made.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct MaskGroup {
    pub(super) weight: f64,
    pub(super) members: Vec<(usize, [isize; 2])>,
}

/// What a point is made of, group after group.
pub(super) type Mask = Vec<MaskGroup>;

/// How one step makes the points of the planes.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Pass {
    /// All planes from the coarse grid, which is the first plane.
    Up([Mask; PLANES]),
    /// All planes from all planes, and on sharp lines the vertices and the points of edges, which see nothing beside
    /// the line.
    Blend {
        /// Where everything is smooth.
        planes: [Mask; PLANES],
        /// Along boundaries and creases: masks of vertices and of points of edges, with members in the first two
        /// planes, as on a line along the first axis.
        lines: [[Mask; 2]; 2],
    },
    /// The mask of the differences between the coarse grid and its children is added to each plane.
    Push([Mask; PLANES]),
}

/// What a side of a patch is, where it is not smooth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Line {
    /// An edge with one face.
    Boundary,
    /// An infinitely sharp edge between two faces.
    Crease,
}

/// Quads in each direction of the nets that masks are read off: one around each side of the middle, and one to spare.
const SIDE: usize = 4;

/// The passes of a round, or none where its rows are not those of masks.
pub(super) fn passes(plan: &Plan, round: &[Scheduled]) -> Option<Vec<Pass>> {
    let [smooth, boundary, crease] =
        [Sample::new(None), Sample::new(Some(Line::Boundary)), Sample::new(Some(Line::Crease))]
            .map(|sample| sample.tables(plan, round));
    let lines = boundary?.into_iter().zip(crease?);
    smooth?.into_iter().zip(lines).map(|(smooth, (boundary, crease))| Pass::of(smooth, [boundary, crease])).collect()
}

/// How a step uses a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Use {
    Up,
    Blend,
    Push,
}

/// The masks of one step on one net.
struct Table {
    is: Use,
    masks: [Mask; PLANES],
}

impl Pass {
    fn of(smooth: Table, lines: [Table; 2]) -> Option<Self> {
        // away from the line: vertices and points of edges along the first axis
        let on_line = |table: Table| table.masks.into_iter().take(2).collect::<Vec<_>>();
        let alike = |lines: &[Vec<Mask>; 2]| {
            lines.iter().all(|line| line.iter().zip(&smooth.masks).all(|(line, smooth)| same(line, smooth)))
        };
        let lines = lines.map(on_line);
        match smooth.is {
            Use::Up => {
                let stays = [MaskGroup { weight: 1.0, members: vec![(0, [0, 0])] }];
                (smooth.masks[0] == stays && alike(&lines)).then_some(Self::Up(smooth.masks))
            }
            Use::Push => {
                let simple = smooth.masks.iter().all(|mask| mask.len() == 1);
                (simple && alike(&lines)).then_some(Self::Push(smooth.masks))
            }
            Use::Blend => {
                let narrow = |mask: &Mask| {
                    mask.iter().flat_map(|group| &group.members).all(|&(plane, at)| plane < 2 && at[1] == 0)
                };
                let [boundary, crease] = lines.map(|line| <[Mask; 2]>::try_from(line).ok());
                let lines = [boundary?, crease?];
                let narrow = lines.iter().flatten().all(narrow);
                narrow.then_some(Self::Blend { planes: smooth.masks, lines })
            }
        }
    }

    /// By how many points of the refined grid a point looks around at most, where that does not begin anew.
    pub(super) fn radius(&self) -> Option<isize> {
        let Self::Blend { planes, lines } = self else { return None };
        let masks = planes.iter().enumerate().chain(lines.iter().flat_map(|line| line.iter().enumerate()));
        let distances = masks.flat_map(|(to, mask)| {
            let members = mask.iter().flat_map(|group| &group.members);
            members.flat_map(move |&(from, at)| [0, 1].map(|axis| fine(from, at, axis) - fine(to, [0, 0], axis)))
        });
        distances.map(isize::abs).max()
    }
}

/// Whether two masks are the same but for the order of the members of their groups, which are of one or two.
fn same(a: &Mask, b: &Mask) -> bool {
    let sorted = |mask: &Mask| {
        let mut mask = mask.clone();
        mask.iter_mut().for_each(|group| group.members.sort_unstable());
        mask
    };
    sorted(a) == sorted(b)
}

/// A coordinate of a point of a plane on the refined grid.
fn fine(plane: usize, cell: [isize; 2], axis: usize) -> isize {
    2 * cell[axis] + (plane >> axis & 1).cast_signed()
}

/// How many cells beyond a patch are to be known so that as many points are known there after a round: the least such
/// number, if it is a small one.
pub(super) fn halo(passes: &[Pass]) -> Option<usize> {
    (1..=MAX_HALO).find(|&halo| {
        let mut reach = 2 * halo.cast_signed();
        for pass in passes {
            match pass {
                Pass::Up(_) => {}
                Pass::Blend { .. } => reach -= pass.radius().unwrap_or(0),
                // a difference is known where a child is; points of edges and faces lie between them
                Pass::Push(_) => reach = reach.div_euclid(2) * 2,
            }
        }
        reach >= halo.cast_signed()
    })
}

/// The widest halo: that of four averages. A round with five would need five cells, and its first three levels would be
/// refined elsewhere before it pays.
const MAX_HALO: usize = 4;

/// A small net of quads with a point in its middle, which may lie on a line.
struct Sample {
    line: Option<Line>,
    topology: Arc<Topology>,
    middle: [isize; 2],
}

impl Sample {
    fn new(line: Option<Line>) -> Self {
        let rows = if line == Some(Line::Boundary) { SIDE / 2 } else { SIDE };
        let vertex = |i: usize, j: usize| index(j * (SIDE + 1) + i);
        let mut faces = FaceList::default();
        for j in 0..rows {
            for i in 0..SIDE {
                faces.push([vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)]);
            }
        }
        let checked = Topology::of_faces((SIDE + 1) * (rows + 1), faces, Winding::Refuse);
        let topology = Arc::new(checked.expect("a grid of quads is a mesh").topology);
        let middle = (SIDE / 2).cast_signed();
        Self { line, topology, middle: [middle, if line == Some(Line::Boundary) { 0 } else { middle }] }
    }

    fn coarse(v: usize) -> [isize; 2] {
        [v % (SIDE + 1), v / (SIDE + 1)].map(usize::cast_signed)
    }

    fn net(&self, plan: &Plan) -> MeshNet {
        let on_line = |e: usize| self.topology.ends(e).iter().all(|&v| Self::coarse(v as usize)[1] == self.middle[1]);
        let sharp = (0..self.topology.n_edges()).filter(|&e| self.line == Some(Line::Crease) && on_line(e));
        let sharp = sharp.map(|e| (index(e), INFINITE_SHARPNESS)).collect();
        let net = MeshNet::new(self.topology.clone(), &[], &[], Boundary::EdgeOnly);
        net.with_sharpness(Sharpness::of(&sharp, &Vec::new()), plan.rules)
    }

    /// Where each point of the refined net lies on the refined grid.
    fn places(&self) -> Vec<[isize; 2]> {
        let topology = &self.topology;
        let sum = |vertices: &[u32]| {
            vertices.iter().map(|&v| Self::coarse(v as usize)).fold([0, 0], |s, p| [s[0] + p[0], s[1] + p[1]])
        };
        let vertices = (0..topology.n_vertices()).map(|v| Self::coarse(v).map(|x| 2 * x));
        let edges = (0..topology.n_edges()).map(|e| sum(&topology.ends(e)));
        let faces = (0..topology.n_faces()).map(|f| sum(topology.face(f)).map(|x| x / 2));
        vertices.chain(edges).chain(faces).collect()
    }

    /// The masks of each step of a round around the middle.
    fn tables(&self, plan: &Plan, round: &[Scheduled]) -> Option<Vec<Table>> {
        let places = self.places();
        let find: HashMap<[isize; 2], usize> = places.iter().enumerate().map(|(i, &place)| (place, i)).collect();
        let steps = steps(self.net(plan), plan, round)?;
        let table = |(is, rows): &(Use, Box<dyn RowSource>)| {
            let mask = |plane: usize| {
                let cell = [0, 1].map(|axis| fine(plane, self.middle, axis));
                self.mask(&**rows, find[&cell], if *is == Use::Blend { Some(&places) } else { None })
            };
            Some(Table { is: *is, masks: [mask(0)?, mask(1)?, mask(2)?, mask(3)?] })
        };
        steps.iter().map(table).collect()
    }

    /// The mask of one row, over the refined net where `places` are given, else over the coarse one.
    fn mask(&self, rows: &dyn RowSource, row: usize, places: Option<&[[isize; 2]]>) -> Option<Mask> {
        let mut table = Rows::default();
        rows.make(row..row + 1, &mut table);
        let member = |i: u32| match places {
            None => (0, Self::coarse(i as usize)),
            Some(places) => {
                let place = places[i as usize];
                let plane = (place[0] & 1) + 2 * (place[1] & 1);
                (plane.unsigned_abs(), place.map(|x| x.div_euclid(2)))
            }
        };
        let relative =
            |(plane, cell): (usize, [isize; 2])| (plane, std::array::from_fn(|axis| cell[axis] - self.middle[axis]));
        let groups = table.terms(0).map(|term| {
            let members = term.indices.iter().map(|&i| relative(member(i))).collect();
            term.alike.then_some(MaskGroup { weight: term.weights[0], members })
        });
        groups.collect()
    }
}

/// How the steps of a round make their points, one table each; none where one of them does otherwise.
pub(super) fn steps(mut net: MeshNet, plan: &Plan, round: &[Scheduled]) -> Option<Vec<(Use, Box<dyn RowSource>)>> {
    let mut tables = Vec::new();
    for step in round {
        let next = Stepper::new(plan).next_from(&net, step, None).ok()?;
        tables.push(used(next.action)?);
        net = next.net;
    }
    let ups = tables.iter().filter(|(is, _)| *is == Use::Up).count();
    (ups == 1 && tables[0].0 == Use::Up && net.mesh.halved().is_some()).then_some(tables)
}

fn used(action: Action) -> Option<(Use, Box<dyn RowSource>)> {
    match action {
        Action::BlendFromAnchor(rows) => Some((Use::Up, rows)),
        Action::Blend(rows) => Some((Use::Blend, rows)),
        Action::PushBack { rows, children } => {
            let same = children.iter().enumerate().all(|(v, &child)| child as usize == v);
            same.then_some((Use::Push, rows))
        }
        Action::Map(_) | Action::Sequence(_) => None,
    }
}
