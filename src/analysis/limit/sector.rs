//! Sectors: the runs of faces around a vertex between infinitely sharp edges.
//!
//! Such an edge acts as a boundary from both sides, so that the surface has a tangent plane on each side of it. A
//! single sharp edge that ends at an inner vertex does not separate sectors.

use std::collections::BTreeMap;

use super::disc::{Centre, Disc};
use crate::math::distinct::distinct;
use crate::shape::topology::index;

/// Largest absolute weight outside a sector that counts as zero: 450 roundings of 1, as iterated masks have. Half of it
/// is still above what sums of a disc's weights leave; twice of it takes a sector for independent whose limit depends
/// on others by 2e-13.
const OUTSIDE_ROUNDING: f64 = 1e-13;

/// The sectors to which the faces at the centre of a disc belong.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Sectors {
    /// The sector of each face at the centre, in the order of the disc; numbered by first appearance.
    of_faces: Vec<usize>,
    /// Number of sectors.
    pub(super) n: usize,
}

impl Sectors {
    /// Returns the sectors of a disc; a disc around a face has one.
    pub(super) fn of(disc: &Disc) -> Self {
        if disc.centre() != Centre::Vertex(0) {
            return Self { of_faces: vec![0], n: 1 };
        }
        let faces: Vec<&[u32]> = disc.central_faces().collect();
        // the half-edge from the centre with which each face begins
        let mut half_edge = 0;
        let mut parts = Vec::with_capacity(faces.len());
        for face in &faces {
            parts.push(disc.is_sharp_for_ever(half_edge));
            half_edge += face.len();
        }
        let closed = disc.is_closed();
        parts[0] &= closed;
        let cuts = parts.iter().filter(|&&cut| cut).count();
        if closed && cuts < 2 {
            return Self { of_faces: vec![0; faces.len()], n: 1 };
        }
        let n = if closed { cuts } else { cuts + 1 };
        let mut sector = 0;
        let of_faces = parts.iter().enumerate().map(|(i, &cut)| {
            sector = (sector + usize::from(cut && i > 0)) % n;
            sector
        });
        Self { of_faces: of_faces.collect(), n }
    }

    /// Returns the sector of a face at the centre.
    pub(super) fn of_face(&self, face: usize) -> usize {
        self.of_faces[face]
    }

    /// Returns for each sector of a disc the sector that it becomes in the disc of the child, whose face 0 comes from
    /// face `rotation`.
    pub(super) fn children(disc: &Disc, child: &Disc, rotation: usize) -> Vec<usize> {
        let [before, after] = [disc, child].map(Self::of);
        let faces = before.of_faces.len();
        let first = |sector| before.of_faces.iter().position(|&other| other == sector).unwrap_or(0);
        (0..before.n).map(|sector| after.of_faces[(first(sector) + faces - rotation) % faces]).collect()
    }
}

/// The points of a disc's support in one sector. Tangents of a sector are computed only if these points depend on no
/// others from level to level.
#[derive(Debug)]
pub(super) struct SectorSupport {
    /// The vertices of the support that belong to the sector, ascending.
    vertices: Vec<u32>,
    /// The faces of the sector at the centre, as indices into `vertices`.
    pub(super) faces: Vec<Vec<u32>>,
    /// Number of points of the disc's support.
    n: usize,
}

impl SectorSupport {
    /// Collects a sector of a disc: what can be reached from its faces at the centre without crossing an edge that
    /// stays sharp for ever.
    pub(super) fn of(disc: &Disc, sectors: &Sectors, sector: usize) -> Self {
        let faces: Vec<&[u32]> = disc.faces().collect();
        let mut beside: BTreeMap<(u32, u32), Vec<usize>> = BTreeMap::new();
        let mut half_edge = 0;
        for (f, face) in faces.iter().enumerate() {
            for i in 0..face.len() {
                let (a, b) = (face[i], face[(i + 1) % face.len()]);
                if !disc.is_sharp_for_ever(half_edge + i) {
                    beside.entry((a.min(b), a.max(b))).or_default().push(f);
                }
            }
            half_edge += face.len();
        }
        let first = (0..sectors.of_faces.len()).filter(|&f| sectors.of_face(f) == sector);
        let mut reached: Vec<usize> = first.clone().collect();
        let mut known = vec![false; faces.len()];
        reached.iter().for_each(|&f| known[f] = true);
        while let Some(f) = reached.pop() {
            let face = faces[f];
            for i in 0..face.len() {
                let (a, b) = (face[i], face[(i + 1) % face.len()]);
                for &g in beside.get(&(a.min(b), a.max(b))).into_iter().flatten() {
                    if !std::mem::replace(&mut known[g], true) {
                        reached.push(g);
                    }
                }
            }
        }
        let reached = (0..faces.len()).filter(|&f| known[f]).flat_map(|f| faces[f]).copied();
        let vertices = distinct(reached.filter(|&v| (v as usize) < disc.support));
        let number = |v: &u32| index(vertices.binary_search(v).unwrap_or_default());
        let faces = first.map(|f| faces[f].iter().map(number).collect()).collect();
        Self { vertices, faces, n: disc.support }
    }

    /// Returns those of the support's numbers that belong to the sector's vertices.
    pub(super) fn within(&self, numbers: &[f64]) -> Vec<f64> {
        self.vertices.iter().map(|&v| numbers[v as usize]).collect()
    }

    /// Extends numbers of the sector's vertices to the support, with zeros elsewhere.
    pub(super) fn widened(&self, numbers: &[f64]) -> Vec<f64> {
        let mut all = vec![0.0; self.n];
        self.vertices.iter().zip(numbers).for_each(|(&v, &x)| all[v as usize] = x);
        all
    }

    /// Returns whether numbers of the support are zero outside the sector, up to [`OUTSIDE_ROUNDING`].
    pub(super) fn holds(&self, numbers: &[f64]) -> bool {
        let outside = |(v, _): &(usize, &f64)| self.vertices.binary_search(&index(*v)).is_err();
        numbers.iter().enumerate().filter(outside).all(|(_, x)| x.abs() <= OUTSIDE_ROUNDING)
    }
}
