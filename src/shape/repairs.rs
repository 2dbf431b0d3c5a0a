//! Records of what was done to a mesh before it was refined; `Display` writes them as sentences.

use std::fmt;

use super::topology::index;

/// Maximum number of items of a repair that are named one by one.
const MAX_NAMED_ITEMS: usize = 20;
const VERTEX_WORDS: [&str; 2] = ["vertex", "vertices"];

/// One repair of a mesh, or a note on it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Repair {
    /// A note of the file reader on what it left out, as a sentence.
    Read(String),
    /// Vertices were merged.
    Welded {
        /// Number of merged vertices.
        merged: usize,
        /// The first merged vertices, each with the vertex that it was merged into, by their old indices.
        pairs: Vec<[u32; 2]>,
    },
    /// Merged vertices had other parameters than those that were kept: each parameter with the first such pair.
    LostParameters(Vec<(&'static str, [usize; 2])>),
    /// Faces were removed, as welding left them without area.
    LeftOut(AffectedFaces),
    /// Faces were reversed to agree with their neighbours.
    Turned(AffectedFaces),
    /// Pairs of triangles were joined into quads.
    Paired {
        /// Number of pairs.
        pairs: usize,
        /// Number of triangles left.
        left: usize,
    },
    /// Edges with more than two faces, at which the mesh was cut.
    Crowded(AffectedEdges),
    /// Edges along which two faces run in the same direction, at which the mesh was cut.
    Opposed(AffectedEdges),
    /// Faces that visit a vertex more than once; the vertex was split.
    Repeating(AffectedFaces),
    /// Vertices that joined several fans of faces were split.
    Split {
        /// Number of added vertices.
        added: usize,
        /// The first added vertices, each with the vertex that it was split from.
        first: Vec<[u32; 2]>,
    },
    /// Boundary edges that coincide with others.
    Doubled(AffectedEdges),
}

impl Repair {
    /// Records the vertices from index `n` on, which were split from the given ones.
    pub(super) fn split(n: usize, split_from: &[u32]) -> Option<Self> {
        let first = (n..).zip(split_from).take(MAX_NAMED_ITEMS).map(|(added, &from)| [index(added), from]).collect();
        (!split_from.is_empty()).then_some(Self::Split { added: split_from.len(), first })
    }
}

/// Some edges or faces: their number, and the first of them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Affected<T> {
    /// Number of edges or faces.
    pub count: usize,
    /// The first of them.
    pub first: Vec<T>,
}

/// Some edges by their ends.
pub type AffectedEdges = Affected<[u32; 2]>;

/// Some faces by their indices.
pub type AffectedFaces = Affected<u32>;

impl<T> Affected<T> {
    /// Records these edges or faces; `None` if there are none.
    pub(super) fn some(items: impl IntoIterator<Item = T>) -> Option<Self> {
        let mut items = items.into_iter();
        let first: Vec<T> = items.by_ref().take(MAX_NAMED_ITEMS).collect();
        (!first.is_empty()).then(|| Self { count: first.len() + items.count(), first })
    }
}

impl fmt::Display for AffectedEdges {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let list: Vec<String> = self.first.iter().map(|[a, b]| format!("({a}, {b})")).collect();
        f.write_str(&listed(&list, self.count))
    }
}

/// Joins the first of some items, with an ellipsis if there are more.
fn listed(first: &[String], count: usize) -> String {
    format!("{}{}", first.join(", "), if count > first.len() { ", ..." } else { "" })
}

/// Returns a number with its noun in the singular or plural.
fn counted(n: usize, [one, many]: [&str; 2]) -> String {
    format!("{n} {}", if n == 1 { one } else { many })
}

impl fmt::Display for AffectedFaces {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let list: Vec<String> = self.first.iter().map(u32::to_string).collect();
        f.write_str(&listed(&list, self.count))
    }
}

impl fmt::Display for Repair {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Read(note) => f.write_str(note),
            Self::Welded { merged, pairs } => {
                let list: Vec<String> = pairs.iter().map(|[from, into]| format!("{from} into {into}")).collect();
                write!(f, "welding merged {}: {}", counted(*merged, VERTEX_WORDS), listed(&list, *merged))
            }
            Self::LostParameters(lost) => {
                let list: Vec<String> =
                    lost.iter().map(|(name, [from, into])| format!("{name} ({from} into {into})")).collect();
                let note = "merged vertices differ in parameters, and those that stayed keep theirs";
                write!(f, "{note}: {}", list.join(", "))
            }
            Self::LeftOut(faces) => write!(f, "faces left out because welding left them no area: {faces}"),
            Self::Turned(faces) => write!(f, "faces turned to agree with their neighbours: {faces}"),
            Self::Paired { pairs, left } => {
                write!(f, "{pairs} pairs of triangles were joined into quads; {left} triangles are left")
            }
            Self::Crowded(edges) => {
                let n = counted(edges.count, ["edge has", "edges have"]);
                write!(f, "{n} more than two faces, and the mesh is cut there: {edges}")
            }
            Self::Opposed(edges) => {
                let n = counted(edges.count, ["edge has", "edges have"]);
                let remedy = "\"orient\": \"repair\" turns faces";
                write!(f, "{n} two faces that run the same way, and the mesh is cut there ({remedy}): {edges}")
            }
            Self::Repeating(faces) => {
                let n = counted(faces.count, ["face visits", "faces visit"]);
                write!(f, "{n} a vertex more than once, which is split there: {faces}")
            }
            Self::Split { added, first } => {
                let list: Vec<String> = first.iter().map(|[added, from]| format!("{added} from {from}")).collect();
                let n = counted(*added, ["vertex was", "vertices were"]);
                write!(f, "{n} split from others, which joined several fans of faces: {}", listed(&list, *added))
            }
            Self::Doubled(edges) => {
                let n = counted(edges.count, ["edge of the boundary lies", "edges of the boundary lie"]);
                write!(f, "{n} where others do, and gaps open along them; \"weld\": 0 joins them: {edges}")
            }
        }
    }
}
