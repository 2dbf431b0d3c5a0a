//! The rules at vertices and edges that are not smooth: along creases, at corners, and while sharpness becomes less.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::mesh_net::MeshNet;
use super::sharpness::{Sharpness, edges_at};
use super::tags::Tags;
use crate::shape::topology::{Topology, index};

/// How a vertex comes about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    /// By the scheme's rule for smooth vertices; so do darts, the ends of single creases.
    Smooth,
    /// By the curve rule along these two edges.
    Crease([u32; 2]),
    /// It stays.
    Corner,
}

/// The rule of a vertex before a level, that after it, and the weight of the first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Blend {
    /// By the sharpness that enters the level.
    pub before: Rule,
    /// By the sharpness that leaves it.
    pub after: Rule,
    /// Weight of `before`, from 0 to 1; that of `after` is what is missing to 1.
    pub weight: f64,
}

impl Blend {
    /// One rule alone.
    fn one(rule: Rule) -> Self {
        Self { before: rule, after: rule, weight: 1.0 }
    }

    /// How vertex `v` of a topology comes about, be it set apart by creases, tagged, on the boundary, or none of these.
    #[inline]
    pub(super) fn of(v: usize, topology: &Topology, tags: &Tags, creases: Option<&Creases>) -> Self {
        if tags.is_corner(v) || topology.is_isolated(v) {
            return Self::one(Rule::Corner);
        }
        let usual = || Self::one(topology.boundary_edges(v).map_or(Rule::Smooth, Rule::Crease));
        creases.and_then(|creases| creases.vertex(v)).unwrap_or_else(usual)
    }

    /// The rules with their weights; one alone where both agree.
    #[inline]
    pub fn rules(&self) -> impl Iterator<Item = (Rule, f64)> + use<> {
        let blended = self.before != self.after && self.weight < 1.0;
        let first = (self.before, if blended { self.weight } else { 1.0 });
        let second = blended.then_some((self.after, 1.0 - self.weight));
        std::iter::once(first).chain(second).filter(|&(_, weight)| weight > 0.0)
    }
}

/// The vertices and edges of a topology that sharpness sets apart.
///
/// Source: DeRose, Kass and Truong, SIGGRAPH 1998, 85-94; fractional sharpness and the blend of rules as
/// OpenSubdiv 3.5 has them.
#[derive(Debug, Clone)]
pub struct Creases {
    vertices: Vec<(u32, Blend)>,
    before: Arc<Sharpness>,
    /// Edges of a sharpness below 1 both of whose halves stay sharp, as their neighbours sharpen them; ascending.
    kept: Vec<u32>,
}

impl Creases {
    /// What sets the vertices and edges apart that entered the last U of a net; `None` when nothing does.
    pub fn of_parent(net: &MeshNet) -> Option<Self> {
        let anchor = net.since.anchor.as_ref()?;
        let before = anchor.sharpness.as_ref()?;
        let after = After { sharpness: net.sharpness.as_deref(), pieces: Some(anchor.pieces_of_an_edge()) };
        Some(Self::of(&anchor.topology, before, &after))
    }

    /// What sets the vertices and edges of a net apart whose explicit topology this is; `None` when nothing does.
    pub fn of_net(net: &MeshNet, topology: &Topology) -> Option<Self> {
        let sharpness = net.sharpness.as_ref()?;
        Some(Self::of(topology, sharpness, &After { sharpness: Some(sharpness), pieces: None }))
    }

    fn of(topology: &Topology, before: &Arc<Sharpness>, after: &After<'_>) -> Self {
        let ends = before.edges().iter().flat_map(|&(e, _)| topology.ends(e as usize));
        let mut apart: Vec<u32> = ends.chain(before.vertices().iter().map(|&(v, _)| v)).collect();
        let around = |v: u32| Around::of(topology, before, v as usize, after);
        let followers: BTreeMap<u32, u32> = before.followers().iter().copied().collect();
        apart.extend(followers.keys());
        apart.sort_unstable();
        apart.dedup();
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

    /// The rules of vertex `v`; `None` where the usual one applies: smooth inside, the curve rule on the boundary.
    pub fn vertex(&self, v: usize) -> Option<Blend> {
        let at = self.vertices.binary_search_by_key(&index(v), |&(v, _)| v).ok()?;
        Some(self.vertices[at].1)
    }

    /// How far edge `e` follows the curve rule: 0 not at all, 1 alone. That is 1 where both halves stay sharp, else its
    /// sharpness, at most 1.
    pub fn edge(&self, e: usize) -> f64 {
        if self.kept.binary_search(&index(e)).is_ok() { 1.0 } else { self.before.edge(e).min(1.0) }
    }

    /// The vertices that are set apart, ascending.
    pub fn vertices(&self) -> &[(u32, Blend)] {
        &self.vertices
    }
}

/// What is sharp after a level.
struct After<'a> {
    /// The sharpness there; `None` when all is smooth.
    sharpness: Option<&'a Sharpness>,
    /// Pieces that the level makes of each edge, in order; `None` where edges stay as they are.
    pieces: Option<usize>,
}

impl After<'_> {
    /// The sharpness of what the level makes of an edge, at its end 0 or 1.
    fn edge(&self, e: u32, end: usize) -> f64 {
        let piece = self.pieces.map_or(e as usize, |d| d * e as usize + end * (d - 1));
        self.sharpness.map_or(0.0, |sharpness| sharpness.edge(piece))
    }

    /// Whether semi-sharp edges end at a vertex that are not among the edges of the net.
    fn is_sharp_beside(&self, v: u32) -> bool {
        self.sharpness.is_some_and(|sharpness| sharpness.is_sharp_beside(v))
    }

    /// The sharpness of a vertex.
    fn vertex(&self, v: usize) -> f64 {
        self.sharpness.map_or(0.0, |sharpness| sharpness.vertex(v))
    }
}

/// The sharp edges around a vertex.
#[derive(Default)]
struct Around {
    /// Sharp edges, at most three of them: before and after the level.
    sharp: [Vec<u32>; 2],
    /// Whether the vertex itself is sharp: before and after the level.
    corner: [bool; 2],
    /// Sum and number of the sharpnesses that vanish in the level.
    vanishing: (f64, f64),
}

impl Around {
    fn of(topology: &Topology, before: &Sharpness, v: usize, after: &After<'_>) -> Self {
        let mut around = Self::default();
        let values = [before.vertex(v), after.vertex(v)];
        around.corner = values.map(|sharpness| sharpness > 0.0);
        around.vanish(values);
        for e in edges_at(topology, v) {
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
