//! Sectors: the faces around a vertex between two edges that stay sharp for ever, and what the surface is there.

use super::level::{Level, Sharpened};
use crate::shape::topology::NONE;

/// What the surface is around a vertex, as far as the faces of one sector tell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Smooth, with faces all around.
    Smooth,
    /// A vertex that keeps its place on a surface without sharp edges there.
    Cone,
    /// The end of a sharp edge.
    Dart,
    /// A smooth curve along two sharp edges.
    Crease,
    /// A vertex that keeps its place, or where three sharp edges meet.
    Corner,
    /// Not known yet: something is sharp for some levels.
    Undecided,
}

impl Kind {
    /// Its name in certificates.
    pub fn name(self) -> &'static str {
        match self {
            Self::Smooth => "smooth",
            Self::Cone => "cone",
            Self::Dart => "dart",
            Self::Crease => "crease",
            Self::Corner => "corner",
            Self::Undecided => "undecided",
        }
    }
}

/// The faces around a vertex, counter-clockwise, from one edge that stays sharp to the next, or all of them.
#[derive(Debug, Clone)]
pub(super) struct Sector {
    /// The half-edge of each face that starts at the vertex.
    pub(super) spokes: Vec<u32>,
    /// Whether no sharp edge bounds it.
    pub(super) is_closed: bool,
    /// What the surface is there.
    pub(super) kind: Kind,
}

impl Sector {
    /// Whether four regular faces, or what a crease or a corner leaves of them, meet here, so that the surface is
    /// bicubic.
    pub(super) fn is_regular(&self) -> bool {
        let regular = match self.kind {
            Kind::Smooth => 4,
            Kind::Crease => 2,
            Kind::Corner => 1,
            Kind::Cone | Kind::Dart | Kind::Undecided => return false,
        };
        self.spokes.len() == regular
    }
}

impl Level {
    /// The half-edge from the same vertex in the next face counter-clockwise, unless the edge between stays sharp.
    fn onward(&self, half_edge: u32) -> Option<u32> {
        let before = self.topology.previous(half_edge);
        let sharp = self.edge_sharpened(self.topology.edge(before)) == Sharpened::Ever;
        (!sharp).then(|| self.topology.twin(before)).filter(|&next| next != NONE)
    }

    /// The same in the next face clockwise.
    fn back(&self, half_edge: u32) -> Option<u32> {
        let sharp = self.edge_sharpened(self.topology.edge(half_edge)) == Sharpened::Ever;
        let twin = (!sharp).then(|| self.topology.twin(half_edge)).filter(|&twin| twin != NONE)?;
        Some(self.topology.next(twin))
    }

    /// The sector of the face of a half-edge at the vertex where it starts.
    pub(super) fn sector(&self, half_edge: u32) -> Sector {
        let mut first = half_edge;
        let is_closed = loop {
            match self.back(first) {
                None => break false,
                Some(before) if before == half_edge => break true,
                Some(before) => first = before,
            }
        };
        let first = if is_closed { half_edge } else { first };
        let mut spokes = vec![first];
        let mut at = first;
        while let Some(next) = self.onward(at).filter(|&next| next != first) {
            spokes.push(next);
            at = next;
        }
        Sector { kind: self.kind(half_edge, is_closed), spokes, is_closed }
    }

    /// The edges at the vertex where a half-edge starts that stay sharp.
    pub(super) fn sharp_edges_at(&self, half_edge: u32) -> Vec<u32> {
        let v = self.topology.vertex(half_edge) as usize;
        self.edges_at(v).filter(|&e| self.edge_sharpened(e) == Sharpened::Ever).collect()
    }

    /// The edges at a vertex.
    fn edges_at(&self, v: usize) -> impl Iterator<Item = u32> {
        self.topology.ring(v).flat_map(|half_edge| {
            let before = self.topology.previous(half_edge);
            let last = (self.topology.twin(before) == NONE).then(|| self.topology.edge(before));
            std::iter::once(self.topology.edge(half_edge)).chain(last)
        })
    }

    fn kind(&self, half_edge: u32, is_closed: bool) -> Kind {
        let v = self.topology.vertex(half_edge);
        let own = self.vertex_sharpened(v);
        let semi = |e| self.edge_sharpened(e) == Sharpened::Semi;
        if own == Sharpened::Semi || self.edges_at(v as usize).any(semi) {
            return Kind::Undecided;
        }
        let fixed = own == Sharpened::Ever;
        match (is_closed, fixed, self.sharp_edges_at(half_edge).len()) {
            (true, false, _) => Kind::Smooth,
            (true, true, _) => Kind::Cone,
            (false, true, _) | (false, false, 3..) => Kind::Corner,
            (false, false, 2) => Kind::Crease,
            (false, false, _) => Kind::Dart,
        }
    }

    /// Whether a face is bicubic: its own corners and everything around them are regular.
    pub(super) fn is_leaf(&self, f: u32) -> bool {
        let half_edges = self.topology.half_edges(f as usize);
        half_edges.len() == 4
            && half_edges.clone().all(|half_edge| {
                let sector = self.sector(half_edge);
                sector.is_regular() && self.is_of_quads(&sector)
            })
    }

    /// Whether all faces of a sector are quads.
    pub(super) fn is_of_quads(&self, sector: &Sector) -> bool {
        let size = |&half_edge: &u32| self.topology.half_edges(self.topology.face_of(half_edge)).len();
        sector.spokes.iter().all(|spoke| size(spoke) == 4)
    }

    /// The half-edge of a face at its only vertex that is not regular, if a cap can stand there: all else around the
    /// face has to be regular, nothing sharp for some levels only, and all faces quads. Around a smooth vertex nothing
    /// is sharp either: in the middle of a face with sharp sides, caps have to wait for another level.
    pub(super) fn lone_irregular(&self, f: u32) -> Option<u32> {
        let half_edges = self.topology.half_edges(f as usize);
        if half_edges.len() != 4 {
            return None;
        }
        let (mut found, mut is_smooth) = (None, true);
        for half_edge in half_edges {
            let sector = self.sector(half_edge);
            if sector.kind == Kind::Undecided || !self.is_of_quads(&sector) {
                return None;
            }
            if sector.is_regular() {
                is_smooth &= sector.is_closed;
            } else if found.replace((half_edge, sector.kind)).is_some() {
                return None;
            }
        }
        found.filter(|&(_, kind)| is_smooth || kind != Kind::Smooth).map(|(half_edge, _)| half_edge)
    }
}
