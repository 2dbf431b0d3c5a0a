//! Certificates of solids: which parts are exact, which are bounded, and how.

use serde_json::{Value, json};

use crate::math::parameter::Values;
use crate::output::counts::Counts;
use crate::output::error::FormatError;
use crate::output::format::{Content, Costs, Format, FormatFacts, MadeOf, Requirements};
use crate::output::numbers::total;
use crate::output::scene::Scene;
use crate::output::size::Size;
use crate::output::solid_options::{SOLID_OPTIONS, forecast, solid_of};
use crate::output::stream::Stream;
use crate::solid;

/// JSON with the properties of the solid that `step` writes with the same options. Lengths are in model units.
///
/// `size` (largest side of the box around the cage), `exact_area_share`, `deviation_bound` and `deviation_of_size`
/// (distance between the surface and the limit surface), `bound_method` (`certified`, or `sampled` if the distance at
/// some vertex was only measured at points), `worst_edge_angle_deg` (between normals of faces along smooth edges),
/// `gap` (between the two curves of an edge on its faces), `volume` (of closed shells; null if there is none), `area`,
/// `faces`, `edges`, `vertices`, `shells` (each with its counts), `irregular` (one entry a sector of a vertex where the
/// surface is not bicubic: place, `faces` around it, `kind`, `level` of isolation, deviation, method, and whether
/// tangent planes agree by construction), `caps_without_tangent_planes`, `self_intersections` (always `not checked`).
#[derive(Debug)]
pub(super) struct CertificateFormat;

const FACTS: &FormatFacts = &FormatFacts {
    name: "certificate",
    extension: "json",
    media_type: "application/json",
    content: Content::Json,
    doc: "JSON: what is known of the solid that step writes: share that is exact, deviation bound, angles, volume",
    parameters: SOLID_OPTIONS,
    made_of: MadeOf::Limit,
    tells_plan: true,
    holds: |kind, _| kind.only_meshes("certificates are of solids, these are curves; ask for stats"),
    ..FormatFacts::USUAL
};

impl Format for CertificateFormat {
    fn facts(&self) -> &'static FormatFacts {
        FACTS
    }

    fn encode(&self, scene: &Scene<'_>, options: &Values, stream: &mut Stream<'_>) -> Result<(), FormatError> {
        let solid = solid_of(scene, options, stream.watch)?;
        Ok(writeln!(stream.out, "{}", report(&solid.certificate))?)
    }
}

impl Requirements for CertificateFormat {
    fn makes_solid(&self, _options: &Values) -> bool {
        true
    }
}

impl Costs for CertificateFormat {
    fn size(&self, counts: &Counts, options: &Values) -> Size {
        Size::AtMost(length(counts, options))
    }
}

/// Returns the maximum number of bytes of a certificate: at most every third face is at a vertex of its own.
pub(super) fn length(counts: &Counts, options: &Values) -> u128 {
    total(&[(1, 4_096), (forecast(counts, options).faces, 512)])
}

/// Returns the entries of a certificate, in the order of the documentation.
pub(super) fn report(certificate: &solid::Certificate) -> Value {
    let shell = |shell: &solid::Shell| {
        json!({
            "faces": shell.faces.len(),
            "is_closed": shell.is_closed,
            "was_inside_out": shell.was_inside_out,
            "area": shell.area,
            "volume": shell.is_closed.then_some(shell.volume),
            "euler_characteristic": shell.euler,
        })
    };
    let irregular = |vertex: &solid::Isolated| {
        json!({
            "at": vertex.at.map(|x| x + 0.0),
            "faces": vertex.faces,
            "kind": vertex.kind.name(),
            "level": vertex.level,
            "deviation": vertex.deviation,
            "method": vertex.known.name(),
            "tangent_planes_agree": vertex.is_tangent,
        })
    };
    let [faces, edges, vertices] = certificate.counts;
    let any_closed = certificate.shells.iter().any(|shell| shell.is_closed);
    json!({
        "size": certificate.size,
        "exact_area_share": certificate.exact_area_share,
        "deviation_bound": certificate.deviation,
        "deviation_of_size": certificate.deviation_of_size(),
        "bound_method": certificate.known.name(),
        "worst_edge_angle_deg": certificate.worst_edge_angle_deg,
        "gap": certificate.gap,
        "is_closed": certificate.is_closed(),
        "volume": any_closed.then(|| certificate.volume()),
        "area": certificate.area(),
        "faces": faces,
        "edges": edges,
        "vertices": vertices,
        "euler_characteristic": certificate.shells.iter().map(|shell| shell.euler).sum::<i64>(),
        "shells": certificate.shells.iter().map(shell).collect::<Vec<_>>(),
        "irregular": certificate.vertices.iter().map(irregular).collect::<Vec<_>>(),
        "caps_without_tangent_planes": certificate.n_not_tangent(),
        "self_intersections": "not checked",
    })
}
