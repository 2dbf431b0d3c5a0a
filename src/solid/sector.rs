//! Sectors: the faces around a vertex between two infinitely sharp edges, and the kind of the surface there.

use super::level::{Level, Sharpened};
use crate::shape::topology::NONE;

/// The kind of the surface at a vertex, as seen from one sector.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SectorKind {
    /// Smooth, with faces all around.
    Smooth,
    /// A corner on a surface without sharp edges at it.
    Cone,
    /// The end of a sharp edge.
    Dart,
    /// A smooth curve along two sharp edges.
    Crease,
    /// A corner, or a vertex at which three sharp edges meet.
    Corner,
    /// Not known yet, as something is sharp for some levels.
    Undecided,
}

impl SectorKind {
    /// Returns the name in certificates.
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

/// The faces around a vertex, counter-clockwise, from one infinitely sharp edge to the next, or all of them.
#[derive(Debug, Clone)]
pub(super) struct Sector {
    /// The half-edge of each face that starts at the vertex.
    pub(super) spokes: Vec<u32>,
    /// Whether no sharp edge bounds the sector.
    pub(super) is_closed: bool,
    /// The kind of the surface there.
    pub(super) kind: SectorKind,
}

impl Sector {
    /// Returns whether four regular faces, or the part of them that a crease or corner leaves, meet here, so that the
    /// surface is bicubic.
    pub(super) fn is_regular(&self) -> bool {
        let regular = match self.kind {
            SectorKind::Smooth => 4,
            SectorKind::Crease => 2,
            SectorKind::Corner => 1,
            SectorKind::Cone | SectorKind::Dart | SectorKind::Undecided => return false,
        };
        self.spokes.len() == regular
    }
}

impl Level {
    /// Returns the half-edge from the same vertex in the next face counter-clockwise, unless the edge between is
    /// infinitely sharp.
    fn onward(&self, half_edge: u32) -> Option<u32> {
        let before = self.topology.previous(half_edge);
        let sharp = self.edge_sharpened(self.topology.edge(before)) == Sharpened::Ever;
        (!sharp).then(|| self.topology.twin(before)).filter(|&next| next != NONE)
    }

    /// Returns the half-edge from the same vertex in the next face clockwise, unless the edge between is infinitely
    /// sharp.
    fn back(&self, half_edge: u32) -> Option<u32> {
        let sharp = self.edge_sharpened(self.topology.edge(half_edge)) == Sharpened::Ever;
        let twin = (!sharp).then(|| self.topology.twin(half_edge)).filter(|&twin| twin != NONE)?;
        Some(self.topology.next(twin))
    }

    /// Returns the sector of the face of a half-edge at the vertex where it starts.
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

    /// Returns the infinitely sharp edges at the vertex where a half-edge starts.
    pub(super) fn sharp_edges_at(&self, half_edge: u32) -> Vec<u32> {
        let v = self.topology.vertex(half_edge) as usize;
        self.topology.edges_at(v).filter(|&e| self.edge_sharpened(e) == Sharpened::Ever).collect()
    }

    fn kind(&self, half_edge: u32, is_closed: bool) -> SectorKind {
        let v = self.topology.vertex(half_edge);
        let own = self.vertex_sharpened(v);
        let semi = |e| self.edge_sharpened(e) == Sharpened::Semi;
        if own == Sharpened::Semi || self.topology.edges_at(v as usize).any(semi) {
            return SectorKind::Undecided;
        }
        let fixed = own == Sharpened::Ever;
        match (is_closed, fixed, self.sharp_edges_at(half_edge).len()) {
            (true, false, _) => SectorKind::Smooth,
            (true, true, _) => SectorKind::Cone,
            (false, true, _) | (false, false, 3..) => SectorKind::Corner,
            (false, false, 2) => SectorKind::Crease,
            (false, false, _) => SectorKind::Dart,
        }
    }

    /// Returns whether a face is bicubic: its corners and everything around them are regular.
    pub(super) fn is_leaf(&self, f: u32) -> bool {
        let half_edges = self.topology.half_edges(f as usize);
        half_edges.len() == 4
            && half_edges.clone().all(|half_edge| {
                let sector = self.sector(half_edge);
                sector.is_regular() && self.is_of_quads(&sector)
            })
    }

    /// Returns whether all faces of a sector are quads.
    pub(super) fn is_of_quads(&self, sector: &Sector) -> bool {
        let size = |&half_edge: &u32| self.topology.half_edges(self.topology.face_of(half_edge)).len();
        sector.spokes.iter().all(|spoke| size(spoke) == 4)
    }

    /// Returns the half-edge of a face at its only extraordinary vertex, if a cap is possible there: all else around
    /// the face must be regular, nothing semi-sharp, and all faces quads. Around a smooth vertex nothing may be sharp
    /// either: in the middle of a face with sharp sides, caps have to wait for another level.
    pub(super) fn lone_extraordinary(&self, f: u32) -> Option<u32> {
        let half_edges = self.topology.half_edges(f as usize);
        if half_edges.len() != 4 {
            return None;
        }
        let (mut found, mut is_smooth) = (None, true);
        for half_edge in half_edges {
            let sector = self.sector(half_edge);
            if sector.kind == SectorKind::Undecided || !self.is_of_quads(&sector) {
                return None;
            }
            if sector.is_regular() {
                is_smooth &= sector.is_closed;
            } else if found.replace((half_edge, sector.kind)).is_some() {
                return None;
            }
        }
        found.filter(|&(_, kind)| is_smooth || kind != SectorKind::Smooth).map(|(half_edge, _)| half_edge)
    }
}
