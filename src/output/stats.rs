//! Statistics of a result: a cheap way to check a huge one.

mod connectivity;
mod curves;
mod entries;
mod fairness;
mod hashes;
mod mesh;
mod moments;

use crate::fault::Fault;
use crate::math::parameter::{Parameter, Values};
use crate::output::certificate;
use crate::output::counts::{Counts, ShapeKind};
use crate::output::error::FormatError;
use crate::output::format::{Content, Costs, Format, FormatFacts, Requirements};
use crate::output::numbers::total;
use crate::output::options::POSITIONS;
use crate::output::scene::{Scene, Shape};
use crate::output::size::Size;
use crate::output::solid_options::{forecast, solid_of, work};
use crate::output::stream::Stream;
use crate::output::surface::{NORMALS, with_normals};
use crate::shape::attachments::Attachments;
use crate::shape::mesh::Mesh;

/// JSON with counts, bounding box, measures and hashes.
///
/// Meshes and curves: `kind` (`mesh` or `curves`), `bounding_box`, `moments_of` (the object of the centroid and the
/// moments: `solid`, `surface`, `curve`, or null if it has no extent), `centroid`, `second_moments` (the matrix
/// `int (x - c) (x - c)^T` about the centroid c; negative for a solid that is inside out), `euler_characteristic`
/// (vertices - edges + faces), `positions_hash` and `shape_hash` (see [`hashes::PositionsHash`] and
/// [`hashes::ShapeHash`]).
///
/// Meshes: `area`, signed `volume` (null unless closed), of the faces cut into triangles as for glTF; numbers of
/// vertices, edges, faces, boundary edges and loops, components; vertices by valence, faces by size; with normals
/// `normals_hash`, the hash of the normals that `json` writes; on request the entries of [`fairness::add`], and
/// `certificate`.
/// Curves: `length`, and `area`, the signed area of plane polygons if all are closed.
///
/// Numbers beyond f64 are null. The order of all sums depends on the result only.
#[derive(Debug)]
pub(super) struct Stats;

/// Whether the report has entries about curvature.
const CURVATURE: Parameter = Parameter::flag(
    "curvature",
    "Whether the ranges of Gaussian and mean curvature and the largest angle between the normals of faces at an \
     edge are told, with their places. Meshes only.",
);

/// Whether the report has the certificate of the solid.
const CERTIFICATE: Parameter = Parameter::flag(
    "certificate",
    "Whether the certificate of the solid that step writes by default is told, as the format certificate does.",
);

const FACTS: &FormatFacts = &FormatFacts {
    name: "stats",
    extension: "json",
    media_type: "application/json",
    content: Content::Json,
    doc: "Statistics in JSON: counts, bounding box, measures, moments, valences, hashes",
    parameters: &[POSITIONS, NORMALS, CURVATURE, CERTIFICATE],
    ..FormatFacts::USUAL
};

impl Format for Stats {
    fn facts(&self) -> &'static FormatFacts {
        FACTS
    }

    fn encode(&self, scene: &Scene<'_>, options: &Values, stream: &mut Stream<'_>) -> Result<(), FormatError> {
        let watch = stream.watch;
        let mut found = match scene.shape {
            Shape::Mesh(mesh) => mesh::report(mesh, [with_normals(options), options.flag(CURVATURE.name)], watch)?,
            Shape::Curves(curves) => match curves.first().map_or(1, |curve| curve.dimension) {
                1 => curves::report::<1>(curves, watch)?,
                2 => curves::report::<2>(curves, watch)?,
                3 => curves::report::<3>(curves, watch)?,
                _ => curves::report::<4>(curves, watch)?,
            },
        };
        if options.flag(CERTIFICATE.name) {
            found["certificate"] = certificate::report(&solid_of(scene, options, watch)?.certificate);
        }
        Ok(writeln!(stream.out, "{found}")?)
    }
}

impl Requirements for Stats {
    fn suits(&self, kind: ShapeKind, _: &Attachments, options: &Values) -> Result<(), Fault> {
        if kind != ShapeKind::Mesh && options.flag(CURVATURE.name) {
            return Err(Fault::new("/curvature", "only the curvature of meshes is told; leave it out"));
        }
        if kind != ShapeKind::Mesh && options.flag(CERTIFICATE.name) {
            return Err(Fault::new("/certificate", "only meshes become solids; leave it out"));
        }
        Ok(())
    }

    fn makes_solid(&self, options: &Values) -> bool {
        options.flag(CERTIFICATE.name)
    }
}

impl Costs for Stats {
    /// Bounds three lists that may have many entries. Distinct valences 1, 2, .. k need k (k + 1) / 2 ends of edges, of
    /// which there are at most two per half-edge; likewise for distinct sizes of faces.
    fn size(&self, counts: &Counts, options: &Values) -> Size {
        let distinct = counts.half_edges.saturating_mul(4).isqrt() + 1;
        let curvature_bytes = if options.flag(CURVATURE.name) { fairness::FAIRNESS_ENTRY_BYTES } else { 0 };
        let certified = if options.flag(CERTIFICATE.name) { certificate::length(counts, options) } else { 0 };
        let entry = br#""1234567890":12345678901234567890,"#.len() as u128;
        Size::AtMost(total(&[(1, 2_048 + curvature_bytes), (1, certified), (3 * distinct.min(counts.vertices), entry)]))
    }

    fn memory(&self, counts: &Counts, options: &Values) -> u128 {
        let [of_vertex, of_corner] = fairness::FAIRNESS_BYTES;
        let vertices = counts.vertices.saturating_add(counts.split_vertices);
        let curvature_bytes =
            vertices.saturating_mul(of_vertex).saturating_add(counts.half_edges.saturating_mul(of_corner));
        let solid = if options.flag(CERTIFICATE.name) { forecast(counts, options).bytes() } else { 0 };
        if options.flag(CURVATURE.name) { curvature_bytes.saturating_add(solid) } else { solid }
    }

    /// Counts for curvature three sums over the faces and the sorting of the edges, 150 ns per half-edge.
    fn work(&self, mesh: Option<&Mesh>, counts: &Counts, options: &Values) -> u128 {
        let solid = if options.flag(CERTIFICATE.name) { work(mesh, options) } else { 0 };
        let curvature = if options.flag(CURVATURE.name) { counts.half_edges.saturating_mul(3) / 2 } else { 0 };
        solid.saturating_add(curvature)
    }
}
