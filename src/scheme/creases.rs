//! The rules for vertices and edges that are not smooth: creases, corners, and the decay of sharpness.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::mesh_net::MeshNet;
use super::sharpness::Sharpness;
use super::tags::Tags;
use crate::math::distinct::distinct;
use crate::shape::topology::{Topology, index};

/// The rule that gives a vertex its new position.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    /// The scheme's rule for smooth vertices; also used for darts, the ends of single creases.
    Smooth,
    /// The curve rule along these two edges.
    Crease([u32; 2]),
    /// The vertex keeps its position.
    Corner,
}

/// The rules of a vertex before and after a level, and the weight of the first one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Blend {
    /// The rule according to the sharpness before the level.
    pub before: Rule,
    /// The rule according to the sharpness after the level.
    pub after: Rule,
    /// Weight of `before`, from 0 to 1; `after` has the remaining weight.
    pub weight: f64,
}

impl Blend {
    /// Returns a blend of one rule only.
    fn one(rule: Rule) -> Self {
        Self { before: rule, after: rule, weight: 1.0 }
    }

    /// Returns the rules of vertex `v` of a topology, according to creases, tags and the boundary.
    #[inline]
    pub(super) fn of(v: usize, topology: &Topology, tags: &Tags, creases: Option<&Creases>) -> Self {
        if tags.is_corner(v) || topology.is_isolated(v) {
            return Self::one(Rule::Corner);
        }
        let usual = || Self::one(topology.boundary_edges(v).map_or(Rule::Smooth, Rule::Crease));
        creases.and_then(|creases| creases.vertex(v)).unwrap_or_else(usual)
    }

    /// Returns the rules with their weights; a single one if both agree.
    #[inline]
    pub fn rules(&self) -> impl Iterator<Item = (Rule, f64)> + use<> {
        let blended = self.before != self.after && self.weight < 1.0;
        let first = (self.before, if blended { self.weight } else { 1.0 });
        let second = blended.then_some((self.after, 1.0 - self.weight));
        std::iter::once(first).chain(second).filter(|&(_, weight)| weight > 0.0)
    }
}

/// The vertices and edges of a topology whose rules differ because of sharpness.
///
/// Source: DeRose, Kass and Truong, SIGGRAPH 1998, 85-94; fractional sharpness and blended rules as in OpenSubdiv 3.5.
#[derive(Debug, Clone)]
pub struct Creases {
    vertices: Vec<(u32, Blend)>,
    before: Arc<Sharpness>,
    /// Edges of a sharpness below 1 both of whose halves stay sharp because of their neighbours; ascending.
    kept: Vec<u32>,
}

impl Creases {
    /// Returns the creases of the net that entered the last upsampling; `None` if it is smooth.
    pub fn of_parent(net: &MeshNet) -> Option<Self> {
        let anchor = net.since.anchor.as_ref()?;
        let before = anchor.sharpness.as_ref()?;
        let after = After { sharpness: net.sharpness.as_deref(), pieces: Some(anchor.pieces_of_an_edge()) };
        Some(Self::of(&anchor.topology, before, &after))
    }

    /// Returns the creases of a net whose explicit topology is `topology`; `None` if it is smooth.
    pub fn of_net(net: &MeshNet, topology: &Topology) -> Option<Self> {
        let sharpness = net.sharpness.as_ref()?;
        Some(Self::of(topology, sharpness, &After { sharpness: Some(sharpness), pieces: None }))
    }

    fn of(topology: &Topology, before: &Arc<Sharpness>, after: &After<'_>) -> Self {
        let ends = before.edges().iter().flat_map(|&(e, _)| topology.ends(e as usize));
        let tagged = ends.chain(before.vertices().iter().map(|&(v, _)| v));
        let around = |v: u32| SharpEdges::of(topology, before, v as usize, after);
        let followers: BTreeMap<u32, u32> = before.followers().iter().copied().collect();
        let apart = distinct(tagged.chain(followers.keys().copied()));
        let blend = |v: u32| {
            let blend = match followers.get(&v) {
                Some(&other) => around(v).following(&around(other), after.is_sharp_beside(other)),
                None => around(v).blend(),
            };
            let smooth = [blend.before, blend.after] == [Rule::Smooth; 2];
            (!smooth).then_some((v, blend))
        };
        let stays = |e: u32| [0, 1].iter().all(|&end| after.edge(e, end) > 0.0);
        let kept = before.edges().iter().filter(|&&(e, sharpness)| sharpness < 1.0 && stays(e)).map(|&(e, _)| e);
        let kept = kept.collect();
        Self { vertices: apart.into_iter().filter_map(blend).collect(), before: before.clone(), kept }
    }

    /// Returns the rules of vertex `v`, or `None` for the usual one: smooth inside, the curve rule on the boundary.
    pub fn vertex(&self, v: usize) -> Option<Blend> {
        let at = self.vertices.binary_search_by_key(&index(v), |&(v, _)| v).ok()?;
        Some(self.vertices[at].1)
    }

    /// Returns the weight of the curve rule at edge `e`, from 0 to 1: 1 if both halves stay sharp, else the sharpness,
    /// at most 1.
    pub fn edge(&self, e: usize) -> f64 {
        if self.kept.binary_search(&index(e)).is_ok() { 1.0 } else { self.before.edge(e).min(1.0) }
    }

    /// Returns the vertices with rules of their own, ascending.
    pub fn vertices(&self) -> &[(u32, Blend)] {
        &self.vertices
    }
}

/// The sharpness after a level.
struct After<'a> {
    /// The sharpness after the level; `None` if everything is smooth.
    sharpness: Option<&'a Sharpness>,
    /// Number of pieces into which the level divides each edge, in order; `None` if edges stay whole.
    pieces: Option<usize>,
}

impl After<'_> {
    /// Returns the sharpness of the piece of edge `e` at its end 0 or 1.
    fn edge(&self, e: u32, end: usize) -> f64 {
        let piece = self.pieces.map_or(e as usize, |d| d * e as usize + end * (d - 1));
        self.sharpness.map_or(0.0, |sharpness| sharpness.edge(piece))
    }

    /// Returns whether semi-sharp edges outside the net end at vertex `v`.
    fn is_sharp_beside(&self, v: u32) -> bool {
        self.sharpness.is_some_and(|sharpness| sharpness.is_sharp_beside(v))
    }

    /// Returns the sharpness of vertex `v`.
    fn vertex(&self, v: usize) -> f64 {
        self.sharpness.map_or(0.0, |sharpness| sharpness.vertex(v))
    }
}

/// The sharp edges around a vertex.
#[derive(Default)]
struct SharpEdges {
    /// Sharp edges before and after the level, at most three of each.
    sharp: [Vec<u32>; 2],
    /// Whether the vertex itself is sharp before and after the level.
    corner: [bool; 2],
    /// Sum and number of the sharpness values that vanish in the level.
    vanishing: (f64, f64),
}

impl SharpEdges {
    fn of(topology: &Topology, before: &Sharpness, v: usize, after: &After<'_>) -> Self {
        let mut around = Self::default();
        let values = [before.vertex(v), after.vertex(v)];
        around.corner = values.map(|sharpness| sharpness > 0.0);
        around.vanish(values);
        for e in topology.edges_at(v) {
            let values = if topology.is_boundary_edge(e as usize) {
                [f64::INFINITY; 2]
            } else {
                let end = usize::from(topology.ends(e as usize)[0] as usize != v);
                [before.edge(e as usize), after.edge(e, end)]
            };
            around.vanish(values);
            for (sharp, value) in around.sharp.iter_mut().zip(values) {
                if value > 0.0 && sharp.len() < 3 {
                    sharp.push(e);
                }
            }
        }
        around
    }

    fn vanish(&mut self, [before, after]: [f64; 2]) {
        if before > 0.0 && after <= 0.0 {
            let (sum, n) = self.vanishing;
            self.vanishing = (sum + before, n + 1.0);
        }
    }

    fn rule(&self, when: usize) -> Rule {
        match (self.corner[when], self.sharp[when].as_slice()) {
            (true, _) | (_, [_, _, _, ..]) => Rule::Corner,
            (false, &[a, b]) => Rule::Crease([a, b]),
            (false, _) => Rule::Smooth,
        }
    }

    /// The two rules, and as weight of the first the mean of the sharpnesses that vanish, at most 1.
    fn blend(&self) -> Blend {
        let (sum, n) = self.vanishing;
        let weight = if n > 0.0 { (sum / n).min(1.0) } else { 1.0 };
        Blend { before: self.rule(0), after: self.rule(1), weight }
    }

    /// The two rules of a vertex that stays while another one does, with the weight that holds there; it stays wholly
    /// where `beside` the edges of the net others stay sharp after the level.
    fn following(&self, other: &Self, beside: bool) -> Blend {
        let rule = |when| if other.rule(when) == Rule::Corner { Rule::Corner } else { self.rule(when) };
        Blend { before: rule(0), after: rule(1), weight: if beside { 1.0 } else { other.blend().weight } }
    }
}
