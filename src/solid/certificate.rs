//! The certificate of a solid: its distance from the limit surface, and how its faces meet.

use super::brep::{Brep, Shell};
use super::caps::DeviationMethod;
use super::isolate::Isolated;
use super::measure::FaceMeasure;
use crate::math::functions::asin;
use crate::math::vector::{Vector, cross, length, minus, unit};

/// The certificate of a solid.
#[derive(Debug, Clone)]
pub struct Certificate {
    /// The largest side of the bounding box of the control mesh, in model units.
    pub size: f64,
    /// The fraction of the area whose faces are exactly the limit surface.
    pub exact_area_share: f64,
    /// The largest distance from the limit surface, in model units; if everything is exact, that of rounding errors.
    pub deviation: f64,
    /// How the deviation was determined; sampled if it was sampled at any vertex.
    pub known: DeviationMethod,
    /// The largest angle between the normals of two faces along a smooth edge, in degrees.
    pub worst_edge_angle_deg: f64,
    /// The largest distance at an edge between the positions that its two faces give, in model units.
    pub gap: f64,
    /// The numbers of faces, edges and vertices.
    pub counts: [usize; 3],
    /// The shells.
    pub shells: Vec<Shell>,
    /// The isolated vertices, one entry per sector.
    pub vertices: Vec<Isolated>,
}

impl Certificate {
    /// Creates the certificate of a boundary representation; `rounding` is the deviation of its exact faces. Closed
    /// shells that are inside out are reversed.
    pub(super) fn of(brep: &mut Brep, vertices: Vec<Isolated>, (size, origin): (f64, Vector), rounding: f64) -> Self {
        let measures: Vec<FaceMeasure> = brep.faces.iter().map(|face| FaceMeasure::of(&face.surface, origin)).collect();
        let mut shells = brep.shells();
        let mut areas = [0.0; 2];
        for (face, measure) in brep.faces.iter().zip(&measures) {
            areas[usize::from(face.is_exact)] += measure.area;
        }
        for shell in &mut shells {
            let of_faces = || shell.faces.iter().map(|&f| measures[f as usize]);
            shell.area = of_faces().fold(0.0, |sum, measure| sum + measure.area);
            let volume = of_faces().fold(0.0, |sum, measure| sum + measure.volume);
            if shell.is_closed {
                shell.was_inside_out = volume < 0.0;
                shell.volume = volume.abs();
            }
        }
        for shell in shells.iter().filter(|shell| shell.was_inside_out) {
            brep.reverse(&shell.faces);
        }
        let worst = |known: DeviationMethod, vertex: &Isolated| known.max(vertex.known);
        Self {
            size,
            exact_area_share: if areas[1] > 0.0 { areas[1] / (areas[0] + areas[1]) } else { 0.0 },
            deviation: vertices.iter().map(|vertex| vertex.deviation).fold(rounding, f64::max),
            known: vertices.iter().fold(DeviationMethod::Certified, worst),
            worst_edge_angle_deg: brep.worst_angle().to_degrees(),
            gap: brep.gap,
            counts: [brep.faces.len(), brep.edges.len(), brep.vertices.len()],
            shells,
            vertices,
        }
    }

    /// Returns the deviation relative to the size of the control mesh.
    pub fn deviation_of_size(&self) -> f64 {
        if self.size > 0.0 { self.deviation / self.size } else { 0.0 }
    }

    /// Returns the certificate as a sentence.
    pub fn summary(&self) -> String {
        let [faces, ..] = self.counts;
        let closed = if self.is_closed() { "closed" } else { "open" };
        format!(
            "{faces} faces, {closed}, {:.2} % of the area exact, the rest within {:.1e} of the size ({}), largest \
             angle between faces at smooth edges {:.1e} degrees",
            100.0 * self.exact_area_share,
            self.deviation_of_size(),
            self.known.name(),
            self.worst_edge_angle_deg
        )
    }

    /// Returns the total volume of closed shells, in cubic model units.
    pub fn volume(&self) -> f64 {
        self.shells.iter().fold(0.0, |sum, shell| sum + shell.volume)
    }

    /// Returns the total area of all shells, in square model units.
    pub fn area(&self) -> f64 {
        self.shells.iter().fold(0.0, |sum, shell| sum + shell.area)
    }

    /// Returns whether all shells are closed.
    pub fn is_closed(&self) -> bool {
        self.shells.iter().all(|shell| shell.is_closed)
    }

    /// Returns the number of sectors whose caps do not have common tangent planes by construction.
    pub fn n_not_tangent(&self) -> usize {
        self.vertices.iter().filter(|vertex| !vertex.is_tangent).count()
    }
}

impl Brep {
    /// Returns the largest angle between the normals of two faces along smooth edges, in radians.
    fn worst_angle(&self) -> f64 {
        let mut worst = 0.0_f64;
        for edge in self.edges.iter().filter(|edge| !edge.is_sharp) {
            let [a, b] = [edge.uses.first(), edge.uses.last()].map(|at| {
                let normals = at.map(|at| {
                    let surface = &self.faces[at.face as usize].surface;
                    let normal = |place: [f64; 2]| {
                        let [_, along_u, along_v] = surface.at(place);
                        unit(cross(along_u, along_v))
                    };
                    at.places(surface).into_iter().map(normal).collect::<Vec<_>>()
                });
                normals.unwrap_or_default()
            });
            for (n, m) in a.iter().zip(b.iter().rev()) {
                worst = worst.max(2.0 * asin((0.5 * length(minus(*n, *m))).min(1.0)));
            }
        }
        worst
    }
}
