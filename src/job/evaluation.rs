//! Evaluates the limit surface of a mesh at places on its faces, and finds the places closest to points.

use std::sync::Arc;

use super::codec::Item;
use super::error::RunError;
use super::key::{Key, versioned};
use super::limits::Admitted;
use crate::fault::Fault;
use crate::math::vector::Vector;
use crate::scheme::operator::BICUBIC;
use crate::shape::creases::INFINITE_SHARPNESS;
use crate::shape::mesh::Mesh;
use crate::solid::CageCounts;
use crate::solid::SolidError;
use crate::solid::evaluate::{Closest, Jet, Place, closest, evaluate};
use crate::watch::Watch;

/// Maximum number of places of one evaluation. Half as many would make scans of a part two requests; twice as many
/// would make answers of half a gigabyte.
pub const MAX_EVALUATED_PLACES: usize = 1_000_000;
/// Largest coordinate with which distances are found, as they are squared. Between it and the root of the largest
/// number (1.3e154) is room for sums and products; a tenth of it would do for any part. Half or twice of it leaves as
/// much room.
const MAX_COORDINATE: f64 = 1e150;
/// Maximum number of faults that are reported.
const MAX_PLACE_FAULTS: usize = 64;
/// Memory of a place in bytes: the place (24), its positions in a face (24 twice), its values (208), and the same
/// values as text (208).
const EVALUATED_PLACE_BYTES: u128 = 24 + 48 + 208 + 208;
/// Memory in bytes of a face that is split while places in it are evaluated: some sixteen faces around it and their
/// quads, with 60 bytes per half-edge.
const SPLIT_FACE_BYTES: u128 = 16 * 5 * 4 * 60;
/// Bytes of a number as text, with its comma.
const NUMBER_BYTES: u128 = 26;
/// Nanoseconds per place in a bicubic piece. Measured together with [`RING_NS`] on a control mesh of 498 quads: 5,000
/// per place with its share of rings. Half or twice of both would book half or twice the time.
const PLACE_NS: u128 = 2_000;
/// Nanoseconds per ring around an extraordinary vertex, measured together with [`PLACE_NS`]. Half or twice of it books
/// half or twice the time for such rings.
const RING_NS: u128 = 150_000;
/// Memory in bytes of a point whose closest place is searched for: the point (24), the results (96 twice), candidates
/// that may be nearer (40), and the answer (64).
const CLOSEST_POINT_BYTES: u128 = 24 + 192 + 40 + 64;
/// Memory in bytes of a bicubic piece with its box.
const BICUBIC_PIECE_BYTES: u128 = 700;
/// Memory in bytes of a face at an extraordinary vertex with sixteen faces around it and its rings.
const END_BYTES: u128 = 12_000;
/// Nanoseconds to find the closest place to a point (measured on a control mesh of 498 quads: 280,000 near the surface,
/// 710,000 at ten times its size). Half or twice of it would book half or twice the time.
const POINT_NS: u128 = 500_000;

/// A quantity to evaluate at each place.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Quantity {
    /// The position.
    Position,
    /// The unit normal.
    Normal,
    /// The derivatives along u and v.
    Derivatives,
    /// The second derivatives.
    SecondDerivatives,
    /// The principal curvatures, their mean and their product.
    Curvatures,
}

impl Quantity {
    /// Returns how many numbers the quantity has.
    fn n_numbers(self) -> u128 {
        match self {
            Self::Position | Self::Normal => 3,
            Self::Derivatives => 6,
            Self::SecondDerivatives => 9,
            Self::Curvatures => 4,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Normal => "normal",
            Self::Derivatives => "derivatives",
            Self::SecondDerivatives => "second_derivatives",
            Self::Curvatures => "curvatures",
        }
    }
}

/// A request for values of the limit surface of a job's mesh.
#[derive(Debug)]
pub struct Evaluation {
    admitted: Arc<Admitted>,
    at: Vec<Place>,
    closest: Vec<Vector>,
    values: Vec<Quantity>,
    key: Key,
}

/// The result of an evaluation.
#[derive(Debug)]
pub struct Evaluated {
    /// The values at the places, in their order.
    pub at: Vec<Jet>,
    /// The places closest to the points, in their order.
    pub closest: Vec<Closest>,
}

impl Evaluation {
    /// Creates the evaluation of the mesh of a job under its plan at some places, and at the places closest to some
    /// points.
    ///
    /// # Errors
    /// Every fault, with a pointer below the request: no mesh, another scheme than Catmull-Clark, places that are not
    /// on the mesh, or too many of them.
    pub fn new(
        admitted: Arc<Admitted>,
        at: Vec<Place>,
        closest: Vec<Vector>,
        mut values: Vec<Quantity>,
    ) -> Result<Self, Vec<Fault>> {
        let job = admitted.job();
        let Some(mesh) = job.input.mesh() else {
            let detail = "only meshes have a limit surface; points of curves are in json with \"positions\": \"limit\"";
            return Err(vec![Fault::new("/input", detail)]);
        };
        let mut faults = Vec::new();
        if !job.plan.is_bicubic() {
            let detail = format!(
                "values are those of {BICUBIC} alone, whose regular pieces are bicubic; choose it, or ask for json of \
                 some levels with limit positions and normals"
            );
            faults.push(Fault::new("/plan", detail));
        }
        for (name, n) in [("at", at.len()), ("closest", closest.len())] {
            if n > MAX_EVALUATED_PLACES {
                let detail = format!("{n} entries; one request has at most {MAX_EVALUATED_PLACES}, send several");
                faults.push(Fault::new(format!("/{name}"), detail));
            }
        }
        let misplaced = at.iter().enumerate().filter_map(|(i, place)| {
            let (entry, detail) = place.fault(&mesh.topology)?;
            Some(Fault::new(format!("/at/{i}/{entry}"), detail))
        });
        faults.extend(misplaced.take(MAX_PLACE_FAULTS));
        let is_far = |x: &f64| x.abs() > MAX_COORDINATE;
        let far = closest.iter().enumerate().filter(|(_, point)| point.iter().any(is_far)).map(|(i, point)| {
            let detail = format!("{point:?} is too far away, distances are squared; coordinates are at most 1e150");
            Fault::new(format!("/closest/{i}"), detail)
        });
        faults.extend(far.take(MAX_PLACE_FAULTS));
        if !closest.is_empty() && mesh.positions.iter().any(is_far) {
            let detail = "the mesh is too large for distances, which are squared; coordinates are at most 1e150";
            faults.push(Fault::new("/closest", detail));
        }
        if !faults.is_empty() {
            return Err(faults);
        }
        values.sort_unstable();
        values.dedup();
        let numbers =
            at.iter().flat_map(|place| [f64::from(place.face), f64::from(place.corner), place.uv[0], place.uv[1]]);
        let names = values.iter().map(|value| Item::text(value.name())).collect();
        let (of_job, points) = (Item::text(&job.keys()[0].to_string()), Item::Numbers(closest.as_flattened().into()));
        let items = [of_job, Item::List(names), Item::Numbers(numbers.collect()), points];
        let key = versioned("planish evaluation", items);
        Ok(Self { admitted, at, closest, values, key })
    }

    /// Returns the key of the result.
    pub fn key(&self) -> Key {
        self.key
    }

    /// Returns the quantities evaluated at each place.
    pub fn values(&self) -> &[Quantity] {
        &self.values
    }

    /// Returns an upper bound of the memory in bytes.
    pub fn bytes(&self) -> u128 {
        let places = self.at.len() as u128 * EVALUATED_PLACE_BYTES;
        let faces = self.mesh().map_or(0, |mesh| mesh.topology.n_faces().min(self.at.len()) as u128);
        let mesh = self.admitted.estimate().memory_bytes;
        let pieces = match self.mesh().filter(|_| !self.closest.is_empty()).map(CageCounts::of) {
            Some(cage) => {
                let pieces = cage.faces + 4 * cage.extraordinary + cage.semi_sharp;
                pieces * BICUBIC_PIECE_BYTES + 4 * cage.extraordinary * END_BYTES
            }
            None => 0,
        };
        let points = self.closest.len() as u128 * CLOSEST_POINT_BYTES;
        2 * mesh + places + faces * SPLIT_FACE_BYTES + pieces + points + self.result_bytes()
    }

    /// Returns an upper bound of the size of the answer in bytes.
    pub fn result_bytes(&self) -> u128 {
        let numbers: u128 = self.values.iter().map(|value| value.n_numbers()).sum();
        // a closest place has four numbers, its position three, and a distance
        4_096 + (self.at.len() as u128 * numbers + self.closest.len() as u128 * 8) * NUMBER_BYTES
    }

    /// Returns the work, in the units of the watch.
    pub fn work(&self) -> u128 {
        (self.at.len() + self.closest.len()) as u128
    }

    /// Returns the approximate time in milliseconds on one core.
    pub fn milliseconds(&self) -> u128 {
        let Some(mesh) = self.mesh() else { return 0 };
        let cage = if self.closest.is_empty() { CageCounts::default() } else { CageCounts::of(mesh) };
        let all = cage.extraordinary + cage.faces / 16;
        let rings = rings(mesh, &self.at) + all;
        let points = self.closest.len() as u128 * POINT_NS;
        (self.at.len() as u128 * PLACE_NS + rings * RING_NS + points) / 1_000_000
    }

    fn mesh(&self) -> Option<&Mesh> {
        self.admitted.job().input.mesh()
    }

    /// Runs the evaluation.
    ///
    /// # Errors
    /// [`RunError`].
    pub fn run(&self, watch: &Watch) -> Result<Evaluated, RunError> {
        let nothing = || RunError::of_request(Fault::new("/input", "only meshes have a limit surface"));
        let mesh = self.mesh().ok_or_else(nothing)?;
        let plan = &self.admitted.job().plan;
        let refused = |error: SolidError| match error {
            SolidError::Stopped(stopped) => RunError::Stopped(stopped),
            SolidError::Unfit(fault) => RunError::of_request(Fault::new("/input", fault.detail)),
        };
        let at = evaluate(mesh, plan, &self.at, watch).map_err(refused)?;
        watch.advance(at.len() as u64);
        let closest = if self.closest.is_empty() {
            Vec::new()
        } else {
            closest(mesh, plan, &self.closest, watch).map_err(refused)?
        };
        Ok(Evaluated { at, closest })
    }
}

/// Returns an upper bound of the number of splits of faces with places: faces at possibly extraordinary vertices are
/// split as often as the place nearest to a corner requires.
fn rings(mesh: &Mesh, places: &[Place]) -> u128 {
    let topology = &mesh.topology;
    let mut is_regular: Vec<bool> =
        (0..topology.n_vertices()).map(|v| topology.boundary_edges(v).is_none() && topology.valence(v) == 4).collect();
    let creased = mesh.creases.iter().flat_map(|&(e, _)| topology.ends(e as usize));
    let sharp = mesh.semi_sharp_corners.iter().map(|&(v, _)| v).chain(mesh.corners.iter().copied());
    let others =
        (0..topology.n_faces()).filter(|&f| topology.face(f).len() != 4).flat_map(|f| topology.face(f)).copied();
    creased.chain(sharp).chain(others).for_each(|v| is_regular[v as usize] = false);
    let semi =
        mesh.creases.iter().chain(&mesh.semi_sharp_corners).any(|&(_, sharpness)| sharpness < INFINITE_SHARPNESS);
    let first = if semi { 12 } else { 3 };
    let mut deepest = vec![0_u8; topology.n_faces()];
    for place in places {
        let near = place.uv.map(|x| x.min(1.0 - x)).into_iter().fold(0.0, f64::max);
        let depth =
            std::iter::successors(Some(0.5), |size| Some(0.5 * size)).take(60).take_while(|&size| near < size).count();
        let deepest = &mut deepest[place.face as usize];
        *deepest = (*deepest).max(u8::try_from(depth + first).unwrap_or(u8::MAX));
    }
    let is_split = |f: usize| topology.face(f).iter().any(|&v| !is_regular[v as usize]);
    (0..deepest.len()).filter(|&f| deepest[f] > 0 && is_split(f)).map(|f| u128::from(deepest[f])).sum()
}
