//! Boundary vertices of nets that are regular elsewhere, and vertices on creases: the rows of the points around a
//! child, read off the weights of the operators.
//!
//! A fan of m faces has the sectors 0 to m - 1 with their points (i, j), i >= 1 and j >= 0, and the points (i, 0) on
//! the last ray, which belong to a sector m.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::layout;
use super::local::{Applied, FollowedNet, rows, with_margin};
use super::sectors::{LatticePoint, NetKind, WEIGHT_ROUNDING};
use super::star::{SectorPoint, Star};
use crate::analysis::limit::{Centre, Unlimited};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::operator::Follows;
use crate::scheme::sharpness::Sharpness;
use crate::shape::check::Winding;
use crate::shape::creases::INFINITE_SHARPNESS;
use crate::shape::topology::{NONE, Topology, index};
use crate::watch::Watch;

/// A place in a fan; `None` for the centre.
pub(super) type FanPlace = Option<SectorPoint>;

/// What lies beyond the outer rays of a fan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FanBoundary {
    /// Nothing: the outer rays are the boundary.
    Nothing,
    /// Other faces: the outer rays are a crease that stays sharp for ever.
    Faces,
}

/// The weights of each point around the child of a vertex.
#[derive(Debug, Clone)]
pub(super) struct FanRows {
    /// The number of faces m.
    pub(super) faces: usize,
    /// The weights of the old places in each new place.
    pub(super) rows: BTreeMap<FanPlace, BTreeMap<FanPlace, f64>>,
}

impl FanRows {
    /// Returns the radius of the farthest point that has a weight in the rows of the points up to a radius.
    pub(super) fn reach_of(&self, kind: NetKind, farthest: i32) -> i32 {
        let near = self.rows.iter().filter(|(place, _)| radius(kind, **place) <= farthest);
        near.flat_map(|(_, row)| row.keys()).map(|&place| radius(kind, place)).max().unwrap_or(0)
    }
}

/// A net around a vertex, and the place of each of its vertices.
struct Fan {
    net: MeshNet,
    places: Vec<FanPlace>,
}

/// Returns all places up to a radius, the centre first.
pub(super) fn places(kind: NetKind, m: usize, radius: i32) -> Vec<FanPlace> {
    let inside = (0..m).flat_map(|s| kind.points(radius).into_iter().map(move |p| Some((s, p))));
    std::iter::once(None).chain(inside).chain((1..=radius).map(|i| Some((m, [i, 0])))).collect()
}

/// Returns the radius of a place.
pub(super) fn radius(kind: NetKind, place: FanPlace) -> i32 {
    place.map_or(0, |(_, point)| kind.radius(point))
}

/// Returns the faces up to a radius.
pub(super) fn faces(kind: NetKind, m: usize, radius: i32) -> Vec<Vec<FanPlace>> {
    let at = |s: usize, point: LatticePoint| match point {
        [0, 0] => None,
        [0, j] => Some((s + 1, [j, 0])),
        inside => Some((s, inside)),
    };
    let cells = kind.faces(radius);
    (0..m).flat_map(|s| cells.iter().map(move |face| face.iter().map(|&point| at(s, point)).collect())).collect()
}

/// Returns the mirror image of a place under the reflection that exchanges the outer rays.
pub(super) fn mirrored(m: usize, place: FanPlace) -> FanPlace {
    place.map(|(s, [i, j])| if j == 0 { (m - s, [i, 0]) } else { (m - 1 - s, [j, i]) })
}

impl Fan {
    /// Creates a net with m faces around a boundary vertex, of points up to a radius.
    fn open(applied: &Applied, m: usize, radius: i32) -> Self {
        let kind = applied.kind;
        let places = places(kind, m, radius);
        let numbers: BTreeMap<FanPlace, u32> = places.iter().copied().zip(0..).collect();
        let faces = faces(kind, m, radius).iter().map(|face| face.iter().map(|place| numbers[place])).collect();
        let checked = Topology::of_faces(places.len(), faces, Winding::Refuse).expect("sectors side by side fit");
        let net = MeshNet::new(Arc::new(checked.topology), &[], &[], applied.plan.boundary);
        Self { net: net.with_sharpness(None, applied.plan.rules), places }
    }

    /// Creates a net with a crease through its centre, m faces on one side of it and half a regular net on the other.
    fn creased(applied: &Applied, m: usize, radius: i32) -> Self {
        let kind = applied.kind;
        let Star { net, places, .. } = Star::new(kind, m + kind.regular() / 2, radius);
        let topology = net.mesh.base.clone();
        let on_ray = |ray: usize, v: u32| places[v as usize].is_none_or(|(s, [_, j])| s == ray && j == 0);
        let is_sharp = |e: &usize| [0, m].iter().any(|&ray| topology.ends(*e).iter().all(|&v| on_ray(ray, v)));
        let edges: Vec<_> = (0..topology.n_edges()).filter(is_sharp).map(|e| (index(e), INFINITE_SHARPNESS)).collect();
        let net = net.with_sharpness(Sharpness::of(&edges, &Vec::new()), applied.plan.rules);
        Self { net, places }
    }
}

impl Applied {
    /// Returns whether all operators respect infinitely sharp edges.
    fn follows_creases(&self) -> bool {
        self.steps.iter().all(|step| step.letter.facts().follows >= Follows::Creases)
    }

    /// Returns whether the rules of a fan of faces also apply to one side of a crease.
    pub(super) fn is_side_of_crease(&self, of: &FanRows, radius: i32, watch: &Watch) -> Result<bool, Unlimited> {
        if !self.follows_creases() {
            return Ok(false);
        }
        let creased = self.fan(of.faces, radius, FanBoundary::Faces, watch)?;
        let close = |(a, b): (&BTreeMap<FanPlace, f64>, &BTreeMap<FanPlace, f64>)| {
            let all: BTreeSet<&FanPlace> = a.keys().chain(b.keys()).collect();
            let at = |row: &BTreeMap<FanPlace, f64>, place| row.get(place).copied().unwrap_or(0.0);
            all.into_iter().all(|place| (at(a, place) - at(b, place)).abs() <= WEIGHT_ROUNDING)
        };
        Ok(creased.rows.len() == of.rows.len() && creased.rows.values().zip(of.rows.values()).all(close))
    }

    /// Returns the rows around a vertex with m faces between the outer rays, up to a radius, from a net that is large
    /// enough for them.
    pub(super) fn fan(&self, m: usize, radius: i32, beyond: FanBoundary, watch: &Watch) -> Result<FanRows, Unlimited> {
        with_margin(|margin| self.fan_within(m, radius, beyond, margin, watch))
    }

    fn fan_within(
        &self,
        m: usize,
        radius: i32,
        beyond: FanBoundary,
        margin: i32,
        watch: &Watch,
    ) -> Result<FanRows, Unlimited> {
        let (kind, side) = (self.kind, self.side(radius, margin, m + 3, watch)?);
        let Fan { net, places: old } = match beyond {
            FanBoundary::Nothing => Fan::open(self, m, side),
            FanBoundary::Faces => Fan::creased(self, m, side),
        };
        let FollowedNet { topology, centre, record, layout } = self.followed(net, Centre::Vertex(0), watch)?;
        let Centre::Vertex(middle) = centre else { return Err(Unlimited::Lost) };
        let mut starts: Vec<u32> = topology.ring(middle as usize).collect();
        if beyond == FanBoundary::Faces {
            let n = starts.len();
            let end = topology.vertex(topology.next(starts[0]));
            let (turned, _) = layout::turned(&layout, kind, n, &old, end)?.ok_or(Unlimited::Unsettled)?;
            starts.rotate_left((n - turned) % n);
        }
        let mut wanted: BTreeMap<FanPlace, u32> = BTreeMap::from([(None, middle)]);
        for (s, &start) in starts.iter().take(m).enumerate() {
            for ([i, j], v) in grid(&topology, kind, start, radius) {
                match (i, j) {
                    (0, 0) => {}
                    (0, j) => _ = wanted.insert(Some((s + 1, [j, 0])), v),
                    point => _ = wanted.insert(Some((s, point.into())), v),
                }
            }
        }
        if starts.len() < m || wanted.len() != places(kind, m, radius).len() {
            return Err(Unlimited::Reach);
        }
        let vertices: Vec<u32> = wanted.values().copied().collect();
        let rows: Vec<BTreeMap<FanPlace, f64>> = rows(&record, &old, &vertices)?;
        let farthest = rows.iter().flat_map(BTreeMap::keys).map(|&place| self::radius(kind, place)).max();
        // rows that the rim of the net influences are not rules of its interior
        if farthest.unwrap_or(0) + 1 >= side {
            return Err(Unlimited::Reach);
        }
        Ok(FanRows { faces: m, rows: wanted.into_keys().zip(rows).collect() })
    }
}

/// Returns the vertices at the points of the sector that begins at a half-edge, including both rays, as far as the net
/// reaches. It walks from cell to cell and needs nothing beyond the rays.
fn grid(topology: &Topology, kind: NetKind, start: u32, radius: i32) -> BTreeMap<LatticePoint, u32> {
    let known = |half_edge: u32| (half_edge != NONE).then_some(half_edge);
    let across = |half_edge: u32| known(topology.twin(topology.next(half_edge)));
    let triangles = kind == NetKind::Triangles;
    // the half-edges along the first side of the next cells in both directions
    let right = |half_edge: u32| {
        let over = across(half_edge)?;
        let over = if triangles { across(over)? } else { over };
        Some(topology.next(over))
    };
    let up = |half_edge: u32| {
        if triangles {
            known(topology.twin(topology.previous(across(half_edge)?)))
        } else {
            across(topology.next(half_edge))
        }
    };
    let mut found = BTreeMap::new();
    let (mut row, mut j) = (Some(start), 0);
    while let Some(first) = row.filter(|_| j < radius) {
        let (mut along, mut i) = (Some(first), 0);
        while let Some(side) = along.filter(|_| kind.radius([i, j]) < radius) {
            let corners = [[i, j], [i + 1, j], [i + 1, j + 1]].into_iter().filter(|p| !triangles || p[1] == j);
            let mut at = side;
            for point in corners {
                found.insert(point, topology.vertex(at));
                at = topology.next(at);
            }
            found.insert([i, j + 1], topology.vertex(at));
            along = right(side);
            i += 1;
        }
        row = up(first);
        j += 1;
    }
    found
}
