//! Groups as layers, and colours of materials as styles of faces.

use super::entities::{Entities, Id, List, Real, StepText};
use super::product::StepProduct;
use crate::output::error::FormatError;
use crate::shape::attachments::Attachments;
use crate::shape::labels::Labels;
use crate::solid::Face;

/// Returns the faces of each label; all input faces of a face have the same label.
fn by_label(labels: &Labels, faces: &[Face], ids: &[Id]) -> Vec<Vec<Id>> {
    let mut found = vec![Vec::new(); labels.names.len()];
    for (face, &id) in faces.iter().zip(ids) {
        if let Some(label) = face.inputs.first().and_then(|&input| labels.number(input)) {
            found[label].push(id);
        }
    }
    found
}

/// Writes a layer for each group, and a style for each material with a colour.
pub(super) fn looks(
    out: &mut Entities<'_>,
    carried: &Attachments,
    (faces, ids): (&[Face], &[Id]),
    product: StepProduct,
) -> Result<(), FormatError> {
    for (name, members) in carried.groups.names.iter().zip(by_label(&carried.groups, faces, ids)) {
        if !members.is_empty() {
            out.add(format_args!("PRESENTATION_LAYER_ASSIGNMENT({},'',{})", StepText(name), List(&members)))?;
        }
    }
    let mut items = Vec::new();
    for (material, members) in by_label(&carried.materials, faces, ids).into_iter().enumerate() {
        let Some([red, green, blue, _]) = carried.look(Some(material)).color else { continue };
        if members.is_empty() {
            continue;
        }
        let name = &carried.materials.names[material];
        let style = style(out, name, [red, green, blue])?;
        for face in members {
            items.push(out.add(format_args!("STYLED_ITEM({},({style}),{face})", StepText(name)))?);
        }
    }
    if !items.is_empty() {
        let context = product.context;
        let kind = "MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION";
        out.add(format_args!("{kind}('',{},{context})", List(&items)))?;
    }
    Ok(())
}

fn style(out: &mut Entities<'_>, name: &str, color: [f64; 3]) -> Result<Id, FormatError> {
    let [red, green, blue] = color.map(Real);
    let color = out.add(format_args!("COLOUR_RGB('',{red},{green},{blue})"))?;
    let fill = out.add(format_args!("FILL_AREA_STYLE_COLOUR('',{color})"))?;
    let fill = out.add(format_args!("FILL_AREA_STYLE('',({fill}))"))?;
    let fill = out.add(format_args!("SURFACE_STYLE_FILL_AREA({fill})"))?;
    let side = out.add(format_args!("SURFACE_SIDE_STYLE({},({fill}))", StepText(name)))?;
    let usage = out.add(format_args!("SURFACE_STYLE_USAGE(.BOTH.,{side})"))?;
    out.add(format_args!("PRESENTATION_STYLE_ASSIGNMENT(({usage}))"))
}
