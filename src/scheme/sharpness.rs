//! Sharpness of edges and vertices, and how it decays from level to level.

use std::sync::Arc;

use crate::shape::creases::{INFINITE_SHARPNESS, Sharp};
use crate::shape::topology::{NONE, Topology, index};

/// How the two halves of a sharp edge inherit its sharpness.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Creasing {
    /// `s - 1`.
    #[default]
    Uniform,
    /// `3/4 s + 1/4 m - 1`, with m the mean of the other semi-sharp edges at the half's end; `s - 1` where there are
    /// none.
    Chaikin,
}

impl Creasing {
    /// Its name in requests.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Uniform => "uniform",
            Self::Chaikin => "chaikin",
        }
    }

    /// Whether the sharpness of an edge depends on the edges at both its ends.
    pub fn evens_out(self) -> bool {
        self == Self::Chaikin
    }
}

/// The sharp edges and vertices of a net; everything else is smooth, boundaries apart.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sharpness {
    edges: Sharp,
    vertices: Sharp,
    /// Boundary vertices that stay fixed while the sharp edges inside fix another one: the vertex, and that other one.
    following: Arc<[(u32, u32)]>,
    /// Sharpness of semi-sharp edges outside the net that end at one of its vertices, by vertex.
    elsewhere: Arc<[(u32, f64)]>,
}

/// Upper bounds of what is still sharp after some levels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Remaining {
    /// Number of edges of the input.
    pub edges: u128,
    /// Number of face corners at the ends of these edges.
    pub corners: u128,
}

/// Number of levels after which no semi-sharp edge is left: the largest finite sharpness, which decays by at least one
/// per level.
const LAST_SHARP_LEVEL: usize = 10;

fn lookup(sharp: &Sharp, i: usize) -> f64 {
    sharp.binary_search_by_key(&index(i), |&(i, _)| i).map_or(0.0, |at| sharp[at].1)
}

fn less(sharpness: f64) -> f64 {
    if sharpness >= INFINITE_SHARPNESS { sharpness } else { (sharpness - 1.0).max(0.0) }
}

/// Returns what stays sharp on the next level.
fn lessened(sharp: &[(u32, f64)]) -> Sharp {
    sharp.iter().map(|&(i, sharpness)| (i, less(sharpness))).filter(|&(_, sharpness)| sharpness > 0.0).collect()
}

impl Sharpness {
    /// Creates the sharpness from edges and vertices, both ascending and above 0; `None` if everything is smooth.
    pub fn of(edges: &Sharp, vertices: &Sharp) -> Option<Self> {
        let any = !edges.is_empty() || !vertices.is_empty();
        any.then(|| Self { edges: edges.clone(), vertices: vertices.clone(), ..Self::default() })
    }

    /// Adds boundary vertices that stay fixed, fully or in part, while the sharp edges that end at another such vertex
    /// fix that vertex.
    #[must_use]
    pub fn following(self, following: Vec<(u32, u32)>) -> Self {
        Self { following: following.into(), ..self }
    }

    /// Adds semi-sharp edges outside the net that end at its vertices, such as those on the other side of a seam: pairs
    /// of a vertex and a sharpness, by ascending vertex. They matter under [`Creasing::Chaikin`], and for vertices that
    /// follow others.
    #[must_use]
    pub fn beside(self, elsewhere: Vec<(u32, f64)>) -> Self {
        Self { elsewhere: elsewhere.into(), ..self }
    }

    /// Returns the vertices that follow others, each with the other vertex.
    pub fn followers(&self) -> &[(u32, u32)] {
        &self.following
    }

    /// Returns whether the sharpness depends on the net alone: no vertex follows another, and no edges outside matter.
    pub fn is_of_the_net_alone(&self) -> bool {
        self.following.is_empty() && self.elsewhere.is_empty()
    }

    /// Returns whether semi-sharp edges outside the net end at vertex `v`.
    pub fn is_sharp_beside(&self, v: u32) -> bool {
        self.elsewhere.binary_search_by_key(&v, |&(v, _)| v).is_ok()
    }

    /// Returns the sharpness of edge `e`; boundary edges have none of their own.
    pub fn edge(&self, e: usize) -> f64 {
        lookup(&self.edges, e)
    }

    /// Returns the sharpness of vertex `v`.
    pub fn vertex(&self, v: usize) -> f64 {
        lookup(&self.vertices, v)
    }

    /// Returns all sharp edges, ascending.
    pub fn edges(&self) -> &Sharp {
        &self.edges
    }

    /// Returns all semi-sharp vertices, ascending.
    pub fn vertices(&self) -> &Sharp {
        &self.vertices
    }

    /// Returns the sharpness after a split of `topology`, whose edge `e` becomes the edges `2 e` (at its start) and
    /// `2 e + 1`.
    ///
    /// Source: DeRose, Kass and Truong, SIGGRAPH 1998, 85-94; Chaikin's rule as in OpenSubdiv 3.5.
    pub fn split(&self, topology: &Topology, creasing: Creasing) -> Option<Self> {
        if creasing == Creasing::Uniform {
            return self.next(self.lessened_pieces(2), lessened(&self.elsewhere));
        }
        let mut edges = Sharp::with_capacity(2 * self.edges.len());
        let mut elsewhere = Vec::with_capacity(self.elsewhere.len());
        let mut ends = self.ends(topology);
        ends.extend(self.elsewhere.iter().map(|&(vertex, sharpness)| EdgeEnd { vertex, half: NONE, sharpness }));
        ends.sort_by_key(|end| (end.vertex, end.half));
        for (end, child) in ends.chunk_by(|a, b| a.vertex == b.vertex).flat_map(chaikin) {
            if end.half == NONE {
                elsewhere.push((end.vertex, child));
            } else {
                edges.push((end.half, child));
            }
        }
        edges.sort_unstable_by_key(|&(e, _)| e);
        edges.retain(|&(_, sharpness)| sharpness > 0.0);
        elsewhere.retain(|&(_, sharpness)| sharpness > 0.0);
        self.next(edges, elsewhere)
    }

    /// Returns the sharpness after a split whose edge `e` becomes the edges `d e`, `d e + 1`, ..., in order: infinite
    /// sharpness stays, any other decays once.
    pub fn pieces(&self, d: usize) -> Option<Self> {
        self.next(self.lessened_pieces(d), Vec::new())
    }

    /// Returns the d pieces of each edge that stay sharp where edges hand on their sharpness less 1.
    fn lessened_pieces(&self, d: usize) -> Sharp {
        let piece = |e: u32, at: usize| index(e as usize * d + at);
        lessened(&self.edges).iter().flat_map(|&(e, s)| (0..d).map(move |at| (piece(e, at), s))).collect()
    }

    /// Returns the sharpness after a split; vertices keep their indices, so that followers stay valid.
    fn next(&self, edges: Sharp, elsewhere: Vec<(u32, f64)>) -> Option<Self> {
        let vertices = lessened(&self.vertices);
        let any = !edges.is_empty() || !vertices.is_empty() || !elsewhere.is_empty();
        any.then(|| Self { edges, vertices, following: self.following.clone(), elsewhere: elsewhere.into() })
    }

    /// Returns both ends of every sharp edge, by vertex, then by edge.
    fn ends(&self, topology: &Topology) -> Vec<EdgeEnd> {
        let ends = |&(e, sharpness): &(u32, f64)| {
            let [a, b] = topology.ends(e as usize);
            [EdgeEnd { vertex: a, half: 2 * e, sharpness }, EdgeEnd { vertex: b, half: 2 * e + 1, sharpness }]
        };
        let mut ends: Vec<EdgeEnd> = self.edges.iter().flat_map(ends).collect();
        ends.sort_unstable_by_key(|end| (end.vertex, end.half));
        ends
    }

    /// Returns upper bounds of what is still sharp after 0, 1, ... levels; the last entry holds for all later levels.
    pub fn remaining(&self, topology: &Topology, creasing: Creasing) -> [Remaining; LAST_SHARP_LEVEL + 1] {
        let mut remaining = [Remaining::default(); LAST_SHARP_LEVEL + 1];
        let finite = self.edges.iter().map(|&(_, s)| s).filter(|&s| s < INFINITE_SHARPNESS);
        let most = finite.fold(0.0, f64::max);
        let bound = |s: f64| if creasing == Creasing::Chaikin { s.max(most) } else { s };
        let levels = |s: f64| std::iter::successors(Some(bound(s)), |&s| Some(less(s))).map(|s| s > 0.0);
        for &(_, sharpness) in &self.edges {
            remaining.iter_mut().zip(levels(sharpness)).for_each(|(entry, left)| entry.edges += u128::from(left));
        }
        for around in self.ends(topology).chunk_by(|a, b| a.vertex == b.vertex) {
            let n = topology.ring(around[0].vertex as usize).count() as u128;
            let sharpest = around.iter().map(|end| end.sharpness).fold(0.0, f64::max);
            remaining.iter_mut().zip(levels(sharpest)).for_each(|(entry, left)| entry.corners += u128::from(left) * n);
        }
        remaining
    }
}

/// One end of a sharp edge, and the half of the edge at this end after a split.
#[derive(Debug, Clone, Copy)]
struct EdgeEnd {
    vertex: u32,
    half: u32,
    sharpness: f64,
}

/// Applies Chaikin's rule around one vertex; returns the ends with the sharpness of their halves.
fn chaikin(around: &[EdgeEnd]) -> impl Iterator<Item = (EdgeEnd, f64)> + '_ {
    let semi_sharp = |end: &&EdgeEnd| end.sharpness < INFINITE_SHARPNESS;
    let (sum, n) = around.iter().filter(semi_sharp).fold((0.0, 0.0), |(sum, n), end| (sum + end.sharpness, n + 1.0));
    around.iter().map(move |end| {
        let child = if semi_sharp(&end) && n > 1.0 {
            let mean = (sum - end.sharpness) / (n - 1.0);
            (0.75 * end.sharpness + 0.25 * mean - 1.0).max(0.0)
        } else {
            less(end.sharpness)
        };
        (*end, child)
    })
}
