//! The attachments of a mesh: primvars, subsets of faces, materials.

use super::attributes::{INDENT, On, attribute, comma, entries, entry, places};
use super::names::{Names, display_name};
use crate::output::bytes::Bytes;
use crate::output::colors::linear;
use crate::output::error::FormatError;
use crate::output::numbers::{real, whole};
use crate::output::scene::{MeshSource, labelled_ranges};
use crate::output::stream::Stream;
use crate::shape::attachments::{Attachments, Channel};
use crate::shape::labels::Labels;
use crate::shape::looks::{Alpha, Look};

/// Names of primvars that have a meaning in USD.
const USD_PRIMVARS: [&str; 4] = ["st", "normals", "displayColor", "displayOpacity"];

/// Writes texture coordinates and channels.
pub(super) fn primvars(mesh: &dyn MeshSource, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    if let Some(uvs) = mesh.uvs() {
        attribute("texCoord2f[] primvars:st", On::Corners, stream, |stream| {
            stream.places(uvs.as_ref(), |start, values, out| entries(start, values, 2, out))
        })?;
        places("primvars:st", mesh, uvs.as_ref(), stream)?;
    }
    for (i, channel) in mesh.attachments().channels.iter().enumerate() {
        if channel.is_color() {
            primvar(mesh, i, ("color3f[]", "primvars:displayColor"), stream, |row, out| {
                entry(&[0, 1, 2].map(|k| linear(k, row[k])), out);
            })?;
            if channel.width == 4 {
                primvar(mesh, i, ("float[]", "primvars:displayOpacity"), stream, |row, out| {
                    real(out, linear(3, row[3]));
                })?;
            }
            continue;
        }
        let kind = ["double[]", "double2[]", "double3[]", "double4[]"][channel.width.clamp(1, 4) - 1];
        primvar(mesh, i, (kind, &name(channel)), stream, entry)?;
    }
    Ok(())
}

fn name(channel: &Channel) -> String {
    let space = if USD_PRIMVARS.contains(&channel.name.as_str()) { "channel:" } else { "" };
    format!("primvars:{space}{}", channel.name)
}

/// Writes a channel under a type and a name; `write` appends the entry for the numbers of a vertex or corner.
fn primvar(
    mesh: &dyn MeshSource,
    channel: usize,
    (kind, name): (&str, &str),
    stream: &mut Stream<'_>,
    write: impl Fn(&[f64], &mut Vec<u8>) + Sync,
) -> Result<(), FormatError> {
    let width = mesh.attachments().channels[channel].width;
    let rows = |start: usize, values: &[f64], out: &mut Bytes| {
        out.append(|out| {
            for (i, row) in (start..).zip(values.chunks_exact(width)) {
                comma(i, out);
                write(row, out);
            }
        });
    };
    let declared = format!("{kind} {name}");
    let Some(source) = mesh.channel_places(channel) else {
        return attribute(&declared, On::Vertices, stream, |stream| stream.channel(mesh, channel, rows));
    };
    attribute(&declared, On::Corners, stream, |stream| stream.places(source.as_ref(), rows))?;
    places(name, mesh, source.as_ref(), stream)
}

/// Writes groups and materials as subsets of the faces; a material that all faces have is bound to the mesh itself.
pub(super) fn subsets(mesh: &dyn MeshSource, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    let Attachments { groups, materials, .. } = mesh.attachments();
    let mut names = Names::default();
    let bindings: Vec<String> = material_names(materials).into_iter().map(|name| binding(&name)).collect();
    match bindings.first() {
        Some(binding) if !materials.differ() => stream.bytes(format!("{INDENT}{binding}\n").as_bytes())?,
        Some(_) => subset_type("materialBind", stream)?,
        None => {}
    }
    if !groups.is_empty() {
        subset_type("group", stream)?;
        write_subsets(mesh, groups, |_| None, &mut names, stream)?;
    }
    if materials.differ() {
        write_subsets(mesh, materials, |label| bindings.get(label), &mut names, stream)?;
    }
    Ok(())
}

fn binding(material: &str) -> String {
    format!("rel material:binding = </planish/materials/{material}>")
}

fn subset_type(family: &str, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    let line = format!("{INDENT}uniform token subsetFamily:{family}:familyType = \"nonOverlapping\"\n");
    stream.bytes(line.as_bytes())
}

fn write_subsets<'a>(
    mesh: &dyn MeshSource,
    labels: &Labels,
    binding: impl Fn(usize) -> Option<&'a String>,
    names: &mut Names,
    stream: &mut Stream<'_>,
) -> Result<(), FormatError> {
    for (label, (name, ranges)) in labels.names.iter().zip(labelled_ranges(mesh, labels)).enumerate() {
        let (identifier, binding) = (names.identifier(name), binding(label));
        let schema = binding.map(|_| "prepend apiSchemas = [\"MaterialBindingAPI\"]".to_owned());
        prim("GeomSubset", &identifier, display_name(name, &identifier).into_iter().chain(schema), INDENT, stream)?;
        let family = if binding.is_some() { "materialBind" } else { "group" };
        let facts = [
            "uniform token elementType = \"face\"\n",
            &format!("uniform token familyName = \"{family}\"\n"),
            "int[] indices = [",
        ];
        facts.iter().try_for_each(|fact| stream.bytes(format!("{INDENT}    {fact}").as_bytes()))?;
        let first = ranges.first().map(|range| range.start);
        for range in ranges {
            stream.each(range, |face, out| {
                comma(usize::from(Some(face) != first), out);
                whole(out, face as u64);
            })?;
        }
        stream.bytes(b"]\n")?;
        if let Some(binding) = binding {
            stream.bytes(format!("{INDENT}    {binding}\n").as_bytes())?;
        }
        stream.bytes(format!("{INDENT}}}\n").as_bytes())?;
    }
    Ok(())
}

/// Writes the first lines of a prim, up to its opening brace.
pub(super) fn prim(
    kind: &str,
    name: &str,
    metadata: impl Iterator<Item = String>,
    indent: &str,
    stream: &mut Stream<'_>,
) -> Result<(), FormatError> {
    let lines = metadata.fold(String::new(), |lines, line| lines + indent + "    " + &line + "\n");
    let metadata = if lines.is_empty() { lines } else { format!(" (\n{lines}{indent})") };
    stream.bytes(format!("\n{indent}def {kind} \"{name}\"{metadata}\n{indent}{{\n").as_bytes())
}

/// Returns the names of the prims of materials.
fn material_names(materials: &Labels) -> Vec<String> {
    let mut names = Names::default();
    materials.names.iter().map(|name| names.identifier(name)).collect()
}

/// Writes the materials.
pub(super) fn materials(carried: &Attachments, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    let materials = &carried.materials;
    if materials.is_empty() {
        return Ok(());
    }
    prim("Scope", "materials", std::iter::empty(), "    ", stream)?;
    for (i, (name, identifier)) in materials.names.iter().zip(material_names(materials)).enumerate() {
        prim("Material", &identifier, display_name(name, &identifier).into_iter(), INDENT, stream)?;
        let surface = format!("</planish/materials/{identifier}/surface.outputs:surface>");
        let mut text = format!("{INDENT}    token outputs:surface.connect = {surface}\n\n").into_bytes();
        shader(&carried.look(Some(i)), &mut text);
        text.extend_from_slice(format!("{INDENT}}}\n").as_bytes());
        stream.bytes(&text)?;
    }
    stream.bytes(b"    }\n")
}

/// Appends the shader of a look, with the properties that the look defines.
fn shader(look: &Look, out: &mut Vec<u8>) {
    let Look { color, metallic, roughness, double_sided: _, alpha, texture: _ } = look;
    out.extend_from_slice(format!("{INDENT}    def Shader \"surface\"\n{INDENT}    {{\n").as_bytes());
    out.extend_from_slice(format!("{INDENT}        uniform token info:id = \"UsdPreviewSurface\"\n").as_bytes());
    let mut input = |declared: &str, numbers: &[f64]| {
        out.extend_from_slice(format!("{INDENT}        {declared} = ").as_bytes());
        entry(numbers, out);
        out.push(b'\n');
    };
    if let Some(color) = color {
        input("color3f inputs:diffuseColor", &[0, 1, 2].map(|k| linear(k, color[k])));
        if *alpha != Some(Alpha::Opaque) {
            input("float inputs:opacity", &[linear(3, color[3])]);
        }
    }
    if let Some(Alpha::Mask(cutoff)) = alpha {
        input("float inputs:opacityThreshold", &[*cutoff]);
    }
    for (declared, number) in [("float inputs:metallic", metallic), ("float inputs:roughness", roughness)] {
        number.iter().for_each(|&number| input(declared, &[number]));
    }
    out.extend_from_slice(format!("{INDENT}        token outputs:surface\n{INDENT}    }}\n").as_bytes());
}
