//! What was done to a mesh before it was refined, as values; their sentences are written where they are shown.

use std::fmt;

/// Most entries of a repair that are named one by one.
const NAMED: usize = 20;

/// One repair of a mesh, or a note on it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Repair {
    /// What the reader of its file left out, in a sentence.
    Read(String),
    /// Vertices were merged: how many, and the first of them with those that they were merged into.
    Welded {
        /// How many.
        merged: usize,
        /// The first of them, by their old numbers.
        pairs: Vec<[u32; 2]>,
    },
    /// Merged vertices carried other parameters than those that stayed: each parameter with the first such pair.
    LostParameters(Vec<(&'static str, [usize; 2])>),
    /// Faces were left out, as welding left them no area.
    LeftOut(Faces),
    /// Faces were turned to agree with their neighbours.
    Turned(Faces),
    /// Pairs of triangles were joined into quads.
    Paired {
        /// How many pairs.
        pairs: usize,
        /// Triangles that are left.
        left: usize,
    },
    /// A vertex joined several fans of faces, and another was split from it.
    Split {
        /// The vertex.
        from: u32,
        /// The one that was added.
        added: usize,
    },
}

/// Some faces: how many, and the first of them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Faces {
    /// How many.
    pub count: usize,
    /// The first of them.
    pub first: Vec<u32>,
}

impl Faces {
    /// These faces; `None` where there are none.
    pub(super) fn some(faces: &[u32]) -> Option<Self> {
        let first = faces.iter().take(NAMED).copied().collect();
        (!faces.is_empty()).then_some(Self { count: faces.len(), first })
    }
}

impl fmt::Display for Faces {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let list: Vec<String> = self.first.iter().map(u32::to_string).collect();
        let more = if self.count > list.len() { ", ..." } else { "" };
        write!(f, "{}{more}", list.join(", "))
    }
}

impl fmt::Display for Repair {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Read(note) => f.write_str(note),
            Self::Welded { merged, pairs } => {
                let vertices = if *merged == 1 { "vertex" } else { "vertices" };
                let list: Vec<String> = pairs.iter().map(|[from, into]| format!("{from} into {into}")).collect();
                let more = if *merged > pairs.len() { ", ..." } else { "" };
                write!(f, "welding merged {merged} {vertices}: {}{more}", list.join(", "))
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
            Self::Split { from, added } => {
                write!(f, "vertex {from} joined several fans of faces; vertex {added} was split from it")
            }
        }
    }
}
