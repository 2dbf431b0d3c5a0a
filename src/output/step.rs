//! STEP: the limit surface as a solid of B-spline faces, for CAD programs.

mod entities;
mod looks;
mod product;
mod shape;

use self::entities::Entities;
use crate::math::parameter::Values;
use crate::output::counts::Counts;
use crate::output::error::FormatError;
use crate::output::format::{Content, Costs, Format, FormatFacts, MadeOf, Requirements};
use crate::output::left_out::{Datum, left_out};
use crate::output::numbers::total;
use crate::output::scene::Scene;
use crate::output::size::Size;
use crate::output::solid_options::{SOLID_OPTIONS, forecast, solid_of};
use crate::output::stream::Stream;
use crate::shape::attachments::Attachments;

/// ISO 10303-21 with the schema of AP242: exact bicubic B-spline faces, and caps within a tolerance.
#[derive(Debug)]
pub(super) struct StepFormat;

const FACTS: &FormatFacts = &FormatFacts {
    name: "step",
    extension: "step",
    media_type: "model/step",
    content: Content::Text,
    doc: "STEP (AP242): the limit surface of a cage with bicubic regular pieces as solids of B-spline faces",
    parameters: SOLID_OPTIONS,
    made_of: MadeOf::Limit,
    tells_plan: true,
    holds: |kind, _| kind.only_meshes("step holds surfaces only, these are curves; ask for svg or json"),
    ..FormatFacts::USUAL
};

impl Format for StepFormat {
    fn facts(&self) -> &'static FormatFacts {
        FACTS
    }

    fn encode(&self, scene: &Scene<'_>, options: &Values, stream: &mut Stream<'_>) -> Result<(), FormatError> {
        let watch = stream.watch;
        let solid = solid_of(scene, options, watch)?;
        scene.notes.add(solid.certificate.summary());
        let mut out = Entities::new(stream.out);
        out.line("ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');")?;
        out.line("FILE_NAME('','',(''),(''),'planish','planish','');")?;
        out.line(&format!("FILE_SCHEMA(('{}'));\nENDSEC;\nDATA;", product::SCHEMA))?;
        let accuracy = (1e-9 / scene.coordinate_system.unit.metres()).min(1e-7 * solid.certificate.size);
        let product = product::product(&mut out, scene.coordinate_system.unit, accuracy)?;
        let faces = shape::faces(&mut out, &solid.brep, watch)?;
        if let Some(mesh) = scene.control.mesh() {
            looks::looks(&mut out, &mesh.attachments, (&solid.brep.faces, &faces), product)?;
        }
        shape::shells(&mut out, &solid.certificate.shells, &faces, product)?;
        out.line("ENDSEC;\nEND-ISO-10303-21;")?;
        out.finish()
    }
}

impl Requirements for StepFormat {
    fn leaves_out(&self, carried: &Attachments, _: &Values) -> Vec<String> {
        let kinds = [
            Datum::Channels,
            Datum::Uvs,
            Datum::ColorlessMaterials,
            Datum::Surface,
            Datum::Transparency,
            Datum::Sides,
            Datum::Textures,
        ];
        left_out("step", "glb", carried, &kinds)
    }

    fn makes_solid(&self, _options: &Values) -> bool {
        true
    }
}

impl Costs for StepFormat {
    /// A rectangle of m x n cells has (m + 3) (n + 3) control points, so all rectangles together have at most four per
    /// bicubic face and twelve per face of the result, each of a hundred bytes and eight for each reference; curves
    /// have at most as many as the surfaces that they bound. Caps have 36 control points, and names are cut.
    fn size(&self, counts: &Counts, options: &Values) -> Size {
        let forecast = forecast(counts, options);
        let labels = total(&[(counts.attachments.groups.names.len() as u128, 128), (forecast.faces, 200)]);
        Size::AtMost(total(&[(forecast.leaves, 1_000), (forecast.faces, 9_000), (1, 8_192 + labels)]))
    }
}
