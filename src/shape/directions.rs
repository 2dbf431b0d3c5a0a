//! Which edges of a mesh run along latitude lines, and which along longitude lines.

use std::collections::BTreeMap;

use super::indices::MAX_REPORTED;
use super::topology::{NONE, Topology, index};
use crate::fault::Fault;

/// The direction of an edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub enum Direction {
    /// No direction.
    #[default]
    Untagged,
    /// Along a latitude line: around the axis.
    Latitude,
    /// Along a longitude line: from one latitude line to the next.
    Longitude,
}

impl Direction {
    /// The name of the tag.
    pub fn name(self) -> &'static str {
        match self {
            Self::Untagged => "untagged",
            Self::Latitude => "latitude",
            Self::Longitude => "longitude",
        }
    }
}

/// The directions of all edges of a topology.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Directions(Vec<Direction>);

/// A latitude line: vertices one after another along latitude edges.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LatitudeLine {
    /// The vertices of the line, in order.
    pub vertices: Vec<u32>,
    /// Whether the last one is joined to the first.
    pub closed: bool,
}

impl Directions {
    /// Builds directions from tagged pairs of vertices; `None` if there are no tags. A tag on a vertex that was split
    /// (`split_from`, for vertices from `n` on) applies to all of its copies.
    ///
    /// # Errors
    /// Every fault, with a pointer below the mesh: vertices out of range, pairs that are no edge, edges of both
    /// directions.
    pub fn new(
        topology: &Topology,
        latitude: &[[u64; 2]],
        longitude: &[[u64; 2]],
        n: usize,
        split_from: &[u32],
    ) -> Result<Option<Self>, Vec<Fault>> {
        if latitude.is_empty() && longitude.is_empty() {
            return Ok(None);
        }
        let original = |v: u32| if (v as usize) < n { v } else { split_from[v as usize - n] };
        let mut edges: BTreeMap<(u32, u32), Vec<u32>> = BTreeMap::new();
        for e in 0..topology.n_edges() {
            let [a, b] = topology.ends(e).map(original);
            edges.entry((a.min(b), a.max(b))).or_default().push(index(e));
        }
        let mut directions = vec![Direction::Untagged; topology.n_edges()];
        let mut faults = Vec::new();
        for (direction, pairs) in [(Direction::Latitude, latitude), (Direction::Longitude, longitude)] {
            for (i, pair) in pairs.iter().enumerate() {
                if faults.len() >= MAX_REPORTED {
                    break;
                }
                let place = format!("/{}/{i}", direction.name());
                let ends = pair.map(|v| u32::try_from(v).unwrap_or(NONE));
                let Some(found) = edges.get(&(ends[0].min(ends[1]), ends[0].max(ends[1]))) else {
                    let detail = format!("there is no edge from vertex {} to vertex {}", pair[0], pair[1]);
                    faults.push(Fault::new(place, detail));
                    continue;
                };
                for &e in found {
                    let known = std::mem::replace(&mut directions[e as usize], direction);
                    if known != Direction::Untagged && known != direction {
                        let detail = format!(
                            "the edge from vertex {} to vertex {} is a {} edge, too; give it one direction",
                            pair[0],
                            pair[1],
                            known.name()
                        );
                        faults.push(Fault::new(&place, detail));
                    }
                }
            }
        }
        faults.truncate(MAX_REPORTED);
        if faults.is_empty() { Ok(Some(Self(directions))) } else { Err(faults) }
    }

    /// Creates directions from those of all edges, in order.
    pub fn of_edges(directions: Vec<Direction>) -> Self {
        Self(directions)
    }

    /// The direction of edge `e`.
    #[inline]
    pub fn of(&self, e: u32) -> Direction {
        self.0[e as usize]
    }

    /// Returns whether any edge runs along a latitude line.
    pub fn any_latitude(&self) -> bool {
        self.0.contains(&Direction::Latitude)
    }

    /// The edges of a direction, ascending.
    pub fn edges(&self, direction: Direction) -> Vec<u32> {
        (0..index(self.0.len())).filter(|&e| self.of(e) == direction).collect()
    }

    /// Returns the directions after an upsampling of arity 2: both halves of an edge inherit its direction; the edge
    /// from the edge point of a longitude edge to the face point is a latitude edge, and vice versa.
    ///
    /// Source: Zhang and Wang 2002, section 3, rules (1) to (3).
    #[must_use]
    pub fn split(&self, topology: &Topology) -> Self {
        let halves = self.0.iter().flat_map(|&direction| [direction; 2]);
        let spokes = (0..index(topology.n_half_edges())).map(|half_edge| match self.of(topology.edge(half_edge)) {
            Direction::Untagged => Direction::Untagged,
            Direction::Latitude => Direction::Longitude,
            Direction::Longitude => Direction::Latitude,
        });
        Self(halves.chain(spokes).collect())
    }

    /// Returns, for each vertex with exactly two latitude edges, these edges.
    pub fn latitude_pairs(&self, topology: &Topology) -> Vec<Option<[u32; 2]>> {
        let mut found = vec![(0, [NONE; 2]); topology.n_vertices()];
        for e in self.edges(Direction::Latitude) {
            for v in topology.ends(e as usize) {
                let (count, pair) = &mut found[v as usize];
                if *count < 2 {
                    pair[*count] = e;
                }
                *count += 1;
            }
        }
        found.into_iter().map(|(count, pair)| (count == 2).then_some(pair)).collect()
    }

    /// Returns the latitude lines, each found from its lowest edge; lines end at vertices whose number of latitude
    /// edges is not two.
    pub fn lines(&self, topology: &Topology) -> Vec<LatitudeLine> {
        let pairs = self.latitude_pairs(topology);
        let mut seen = vec![false; self.0.len()];
        let onward = |e: u32, v: u32| {
            let pair = pairs[v as usize]?;
            let next = if pair[0] == e { pair[1] } else { pair[0] };
            Some((next, topology.other_end(next as usize, v as usize)))
        };
        // the vertices beyond the end `v` of edge `start`, and whether the walk returned to that edge
        let walk = |seen: &mut [bool], start: u32, v: u32| {
            let (mut vertices, mut at) = (Vec::new(), (start, v));
            while let Some((edge, v)) = onward(at.0, at.1) {
                if std::mem::replace(&mut seen[edge as usize], true) {
                    return (vertices, edge == start);
                }
                vertices.push(v);
                at = (edge, v);
            }
            (vertices, false)
        };
        let mut lines = Vec::new();
        for start in self.edges(Direction::Latitude) {
            if std::mem::replace(&mut seen[start as usize], true) {
                continue;
            }
            let [first, second] = topology.ends(start as usize);
            let (mut after, closed) = walk(&mut seen, start, second);
            let mut before = Vec::new();
            if closed {
                // the walk reached the first vertex again before it met the first edge
                after.pop();
            } else {
                before = walk(&mut seen, start, first).0;
            }
            lines.push(LatitudeLine {
                vertices: before.into_iter().rev().chain([first, second]).chain(after).collect(),
                closed,
            });
        }
        lines
    }
}
