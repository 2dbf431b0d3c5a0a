//! The distance of points and small pieces of surfaces from the faces of nets, however these are triangulated.

use std::sync::{Arc, OnceLock};

use rayon::prelude::*;

use super::bend::{Box3, around};
use super::budget::Budget;
use super::cut::twist;
use super::sheet::ProjectedSheet;
use crate::math::functions::sqrt;
use crate::math::vector::{Vector, mean, minus, plus, square_from_triangle, times};
use crate::shape::topology::Topology;

/// Number of tree nodes and faces that are visited in the time of one unit of work, a table row, about 100 ns.
/// It only determines the share of the budget that a visit takes: with twice of it searches may do twice as much.
const VISITS_A_ROW: u64 = 4;
/// Maximum number of faces of a leaf.
/// Half of it doubles the nodes of the tree; twice of it tests up to 8 faces where one box would do. Distances are the
/// same.
const FACES_PER_LEAF: usize = 4;
/// The triangles of a quad cut along either diagonal: the number of the diagonal, and the corners.
const QUAD: [(usize, [usize; 3]); 4] = [(0, [0, 1, 2]), (0, [0, 2, 3]), (1, [1, 2, 3]), (1, [1, 3, 0])];
/// The single triangle of a triangular face, which is not cut, in the form of [`QUAD`]: listed once for either number
/// of a diagonal.
const TRIANGLE: [(usize, [usize; 3]); 2] = [(0, [0, 1, 2]), (1, [0, 1, 2])];

/// Triangles and quads of a net.
pub(super) struct NetFaces {
    topology: Arc<Topology>,
    points: Vec<Vector>,
    /// The faces, ascending; the index of a face here is its slot.
    shown: Vec<u32>,
    /// For each slot an upper bound of the distance between the bilinear face and the surface that it approximates.
    beyond: Vec<f64>,
    /// Whether quads may be cut along either diagonal; then the distance is the greatest one for all cuts.
    cuttable: bool,
    /// For each slot its sheet, once it is needed.
    sheets: Vec<OnceLock<Option<ProjectedSheet>>>,
}

/// The faces of several nets in one tree of bounding boxes.
pub(super) struct FaceTree {
    nets: Vec<NetFaces>,
    /// Net and slot of each face, leaf after leaf.
    order: Vec<(usize, usize)>,
    /// The boxes of the faces, in the same order.
    boxes: Vec<Box3>,
    nodes: Vec<FaceNode>,
    /// Counts the nodes and faces that are visited; once it is over, no distance is found.
    budget: Budget,
}

/// A node of the tree: a box and the faces inside.
struct FaceNode {
    bounds: Box3,
    inside: Inside,
}

enum Inside {
    /// The faces of a leaf: from the first place in the order to the second, exclusive.
    Places(usize, usize),
    /// The indices of two child nodes.
    Halves(usize, usize),
}

/// The triangle nearest to a point.
#[derive(Clone, Copy)]
struct Hit {
    /// The square of the distance.
    square: f64,
    net: usize,
    slot: usize,
    corners: [usize; 3],
}

/// The distance of a piece from a surface.
#[derive(Clone, Copy)]
pub(super) struct Away {
    /// An upper bound for all points of the piece.
    pub(super) most: f64,
    /// An upper bound for the middle of the piece.
    pub(super) middle: f64,
}

impl Away {
    /// The distance of a piece of which nothing is known.
    pub(super) const UNKNOWN: Self = Self { most: f64::INFINITY, middle: f64::INFINITY };
}

impl NetFaces {
    /// Creates the faces `shown` of a net, ascending. If `cuttable` is set, distances hold however quads are cut;
    /// otherwise faces are bilinear, and approximate a surface within `beyond`, which has an entry per face.
    pub(super) fn of(
        topology: &Arc<Topology>,
        points: &[Vector],
        shown: &[u32],
        beyond: Vec<f64>,
        cuttable: bool,
    ) -> Self {
        let sheets = shown.iter().map(|_| OnceLock::new()).collect();
        Self { topology: topology.clone(), points: points.to_vec(), shown: shown.to_vec(), beyond, cuttable, sheets }
    }

    /// Returns the number of slots.
    pub(super) fn len(&self) -> usize {
        self.shown.len()
    }

    /// Returns the slot of a face, if it has one.
    pub(super) fn slot(&self, face: u32) -> Option<usize> {
        self.shown.binary_search(&face).ok()
    }

    /// Returns an upper bound of the distance between a quad and the quad cut along a diagonal; 0 unless quads may be
    /// cut.
    pub(super) fn cut(&self, slot: usize) -> f64 {
        if self.cuttable { self.twist(slot) } else { 0.0 }
    }

    /// Returns an upper bound of the distance between a bilinear quad and the quad cut along a diagonal.
    fn twist(&self, slot: usize) -> f64 {
        twist(&self.topology, self.shown[slot] as usize, &self.points)
    }

    fn triangle(&self, slot: usize, corners: [usize; 3]) -> [Vector; 3] {
        let face = self.topology.face(self.shown[slot] as usize);
        corners.map(|j| self.points[face[j] as usize])
    }

    /// Returns the box around a face.
    fn boxed(&self, slot: usize) -> Box3 {
        let corners = self.topology.face(self.shown[slot] as usize).iter().map(|&v| self.points[v as usize]);
        corners.map(|p| [p, p]).reduce(around).unwrap_or_default()
    }

    /// Returns the triangles of a face cut along either diagonal, each with the number of the diagonal.
    fn triangles(&self, slot: usize) -> &'static [(usize, [usize; 3])] {
        if self.topology.face(self.shown[slot] as usize).len() == 4 { &QUAD } else { &TRIANGLE }
    }

    /// Returns the sheet around a face, if its surroundings are one.
    pub(super) fn sheet(&self, slot: usize) -> Option<&ProjectedSheet> {
        let is_shown = |face: usize| u32::try_from(face).is_ok_and(|face| self.slot(face).is_some());
        let around = || ProjectedSheet::around(&self.topology, &self.points, self.shown[slot] as usize, is_shown);
        self.sheets[slot].get_or_init(around).as_ref()
    }

    /// Returns the slots of the faces in the sheet of a face, itself first.
    pub(super) fn around(&self, slot: usize) -> Option<Vec<usize>> {
        let slots =
            self.sheet(slot)?.faces().iter().map(|&face| u32::try_from(face).ok().and_then(|face| self.slot(face)));
        slots.collect()
    }

    /// Returns an upper bound of the distance of all convex combinations of some points from the surface near a
    /// triangle.
    fn most(&self, hit: &Hit, points: &[Vector]) -> f64 {
        let triangle = self.triangle(hit.slot, hit.corners);
        let plain = sqrt(points.iter().map(|&p| square_from_triangle(p, triangle)).fold(0.0, f64::max));
        let sheet = self.sheet(hit.slot);
        sheet.and_then(|sheet| sheet.distance(triangle, points)).map_or(plain, |over| over.min(plain))
    }
}

impl FaceTree {
    /// Builds the tree of the faces of some nets. Distances are valid only if the budget is not over afterwards.
    pub(super) fn of(nets: Vec<NetFaces>, budget: &Budget) -> Self {
        let slots = |(net, faces): (usize, &NetFaces)| (0..faces.len()).map(move |slot| (net, slot));
        let all: Vec<(usize, usize)> = nets.iter().enumerate().flat_map(slots).collect();
        let boxed = |&(net, slot): &(usize, usize)| nets[net].boxed(slot);
        let boxes: Vec<Box3> = all.par_iter().with_min_len(1024).map(boxed).collect();
        let mut nodes = Vec::new();
        let mut order: Vec<usize> = (0..all.len()).collect();
        if !order.is_empty() {
            grow(&mut nodes, &boxes, &mut order, 0);
        }
        budget.advance(all.len() as u64);
        let boxes = order.iter().map(|&i| boxes[i]).collect();
        let order = order.into_iter().map(|i| all[i]).collect();
        Self { nets, order, boxes, nodes, budget: budget.clone() }
    }

    /// Returns the faces of the first net.
    pub(super) fn first(&self) -> &NetFaces {
        &self.nets[0]
    }

    /// Returns an upper bound of the distance of a point. The search begins with the face `near`, a slot of the first
    /// net.
    pub(super) fn from(&self, point: Vector, near: Option<usize>) -> f64 {
        let Some(hits) = self.nearest(point, near) else { return f64::INFINITY };
        self.joined(hits.map(|hit| (hit, sqrt(hit.square))), |_| 0.0)
    }

    /// Returns upper bounds of the distance of all convex combinations of some points. The search begins with the face
    /// `near`, a slot of the first net.
    ///
    /// The distance from a triangle and the bound of a [`ProjectedSheet`] are convex functions of the point, so
    /// that they are greatest at a corner.
    pub(super) fn over(&self, corners: &[Vector], near: Option<usize>) -> Away {
        let Some(hits) = self.nearest(mean(corners.iter().copied()), near) else { return Away::UNKNOWN };
        let beyond = |hit: &Hit| self.nets[hit.net].beyond[hit.slot];
        let middle = self.joined(hits.map(|hit| (hit, sqrt(hit.square))), beyond);
        let most = self.joined(hits.map(|hit| (hit, self.nets[hit.net].most(&hit, corners))), beyond);
        Away { most, middle }
    }

    /// Returns the greatest distance for all shapes that the surface may have: bilinear or, if cuttable, cut along
    /// either diagonal. `hits` are the nearest triangles for each diagonal, with distances from them.
    fn joined(&self, hits: [(Hit, f64); 2], beyond: impl Fn(&Hit) -> f64) -> f64 {
        let bilinear = |(hit, distance): (Hit, f64)| distance + self.nets[hit.net].twist(hit.slot) + beyond(&hit);
        let bilinear = hits.map(bilinear).into_iter().fold(f64::INFINITY, f64::min);
        let cuttable = hits.iter().filter(|(hit, _)| self.nets[hit.net].cuttable);
        cuttable.fold(bilinear, |most, &(_, distance)| most.max(distance))
    }

    /// Returns for each of the two diagonals the triangle nearest to a point. The search begins with the face `near`, a
    /// slot of the first net. `None` if there are no faces or the budget is over.
    fn nearest(&self, point: Vector, near: Option<usize>) -> Option<[Hit; 2]> {
        if self.budget.is_over() {
            return None;
        }
        let mut visited = 0;
        let mut best = [Hit { square: f64::INFINITY, net: 0, slot: usize::MAX, corners: [0, 1, 2] }; 2];
        if let Some(slot) = near {
            self.compare((0, slot), point, &mut best);
        }
        if !self.nodes.is_empty() {
            self.search(0, point, &mut best, &mut visited);
        }
        self.budget.advance(visited / VISITS_A_ROW + 1);
        best.iter().all(|hit| hit.slot != usize::MAX).then_some(best)
    }

    fn search(&self, node: usize, point: Vector, best: &mut [Hit; 2], visited: &mut u64) {
        *visited += 1;
        let is_near = |square: f64, best: &[Hit; 2]| square < best[0].square.max(best[1].square);
        match self.nodes[node].inside {
            Inside::Places(from, to) => {
                for place in from..to {
                    if is_near(to_box(point, &self.boxes[place]), best) {
                        *visited += 1;
                        self.compare(self.order[place], point, best);
                    }
                }
            }
            Inside::Halves(left, right) => {
                let away = |node: usize| to_box(point, &self.nodes[node].bounds);
                let mut halves = [(away(left), left), (away(right), right)];
                if halves[1].0 < halves[0].0 {
                    halves.swap(0, 1);
                }
                for (square, half) in halves {
                    if is_near(square, best) {
                        self.search(half, point, best, visited);
                    }
                }
            }
        }
    }

    fn compare(&self, (net, slot): (usize, usize), point: Vector, best: &mut [Hit; 2]) {
        let faces = &self.nets[net];
        for &(cut, corners) in faces.triangles(slot) {
            let square = square_from_triangle(point, faces.triangle(slot, corners));
            if square < best[cut].square {
                best[cut] = Hit { square, net, slot, corners };
            }
        }
    }
}

/// Adds the node of some faces, whose places in the order begin at `start`, and the nodes below it; sorts the faces
/// accordingly. Returns the index of the node.
fn grow(nodes: &mut Vec<FaceNode>, boxes: &[Box3], faces: &mut [usize], start: usize) -> usize {
    let bounds = faces.iter().map(|&face| boxes[face]).reduce(around).unwrap_or_default();
    let here = nodes.len();
    nodes.push(FaceNode { bounds, inside: Inside::Places(start, start + faces.len()) });
    if faces.len() > FACES_PER_LEAF {
        let size = minus(bounds[1], bounds[0]);
        let longest = (1..3).fold(0, |k, other| if size[other] > size[k] { other } else { k });
        let at = |face: usize| boxes[face][0][longest] + boxes[face][1][longest];
        let half = faces.len() / 2;
        faces.select_nth_unstable_by(half, |&a, &b| at(a).total_cmp(&at(b)).then(a.cmp(&b)));
        let (left, right) = faces.split_at_mut(half);
        let left = grow(nodes, boxes, left, start);
        let right = grow(nodes, boxes, right, start + half);
        nodes[here].inside = Inside::Halves(left, right);
    }
    here
}

/// A part of a piece of surface; all its points are convex combinations of its corners.
#[derive(Clone, Copy)]
struct Fragment {
    sides: usize,
    corners: [Vector; 4],
    away: Away,
}

impl Fragment {
    fn of(corners: &[Vector], away: &impl Fn(&[Vector]) -> Away) -> Self {
        let mut four = [[0.0; 3]; 4];
        four.iter_mut().zip(corners).for_each(|(p, &corner)| *p = corner);
        Self { sides: corners.len().min(4), corners: four, away: away(corners) }
    }

    /// Returns the corners of the four quarters of the fragment; those of a triangle are followed by a repetition.
    fn quarters(&self) -> [[Vector; 4]; 4] {
        let middle = |a: Vector, b: Vector| times(0.5, plus(a, b));
        let [a, b, c, d] = self.corners;
        if self.sides == 3 {
            let [e, f, g] = [middle(a, b), middle(b, c), middle(c, a)];
            return [[a, e, g], [b, f, e], [c, g, f], [e, f, g]].map(|[p, q, r]| [p, q, r, r]);
        }
        let sides = [middle(a, b), middle(b, c), middle(c, d), middle(d, a)];
        let centre = middle(sides[0], sides[2]);
        [0, 1, 2, 3].map(|j| [self.corners[j], sides[j], centre, sides[(j + 3) % 4]])
    }
}

/// Returns an upper bound of the distance of a piece, whose points are convex combinations of its corners, from a
/// surface, and the number of cuts made. As long as the bound is above `enough`, the fragment with the greatest one is
/// cut into quarters, up to `cuts` times, unless its middle is itself farther than `enough`. `away` bounds the distance
/// of a fragment from its corners.
pub(super) fn farthest(
    corners: &[Vector],
    cuts: usize,
    enough: f64,
    away: &impl Fn(&[Vector]) -> Away,
) -> (f64, usize) {
    let mut fragments = vec![Fragment::of(corners, away)];
    let first = fragments[0].away.most;
    let most = |fragment: &Fragment| fragment.away.most;
    for cut in 0..=cuts {
        let farthest =
            (1..fragments.len()).fold(0, |far, i| if most(&fragments[i]) > most(&fragments[far]) { i } else { far });
        let fragment = fragments[farthest];
        if cut == cuts || most(&fragment) <= enough || fragment.away.middle > enough {
            return (most(&fragment).min(first), cut);
        }
        let mut quarters =
            fragment.quarters().into_iter().map(|quarter| Fragment::of(&quarter[..fragment.sides], away));
        fragments[farthest] = quarters.next().unwrap_or(fragment);
        fragments.extend(quarters);
    }
    (first, cuts)
}

/// Returns the square of the distance of a point from a box.
fn to_box(p: Vector, [low, high]: &Box3) -> f64 {
    let [x, y, z] = [0, 1, 2].map(|k| (low[k] - p[k]).max(p[k] - high[k]).max(0.0));
    x * x + y * y + z * z
}
