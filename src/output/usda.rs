//! USD as text: control meshes as subdivision surfaces, refined meshes as polygons.

mod attributes;
mod cage;
mod carried;
mod names;
mod tokens;

use self::attributes::{INDENT, On, attribute, comma, corners, entries, faces, numbers};
use self::cage::UsdaCage;
use crate::fault::Fault;
use crate::math::parameter::Values;
use crate::output::control_source::ControlSource;
use crate::output::counts::Counts;
use crate::output::error::FormatError;
use crate::output::format::{Content, Costs, Format, FormatFacts, Requirements};
use crate::output::hard_edges::HardEdges;
use crate::output::left_out::{Datum, left_out, of_tags};
use crate::output::normals;
use crate::output::numbers::{REAL_BYTES, digits, real, total, whole};
use crate::output::options::{LIMIT, POSITIONS};
use crate::output::positions::Positions;
use crate::output::scene::{CoordinateSystem, MeshSource, Scene, Shape};
use crate::output::size::Size;
use crate::output::split_vertices::SplitVertices;
use crate::output::stream::Stream;
use crate::output::surface::{NORMALS, with_normals};
use crate::shape::attachments::Attachments;
use crate::shape::coordinate_system::Up;
use crate::shape::creases::CreaseTags;
use crate::shape::labels::Labels;
use crate::shape::looks::Look;
use crate::shape::mesh::Mesh;
use crate::shape::tile::Tile;

/// Maximum number of bytes of everything but lists, and of a group or a material without its list of faces.
const USDA_FRAME_BYTES: u128 = 4_096;
const USDA_LABEL_BYTES: u128 = 1_280;

/// USD as text (`.usda`): one `Mesh` below an `Xform`, with `metersPerUnit` and `upAxis` of the input.
///
/// At level 0 of Catmull and Clark's, Loop's or bilinear refinement the mesh is the control mesh as a subdivision
/// surface, so that viewers refine it as finely as they like: `subdivisionScheme`, boundary and triangle rules,
/// creases, corners, holes and texture coordinates with their rule of interpolation have the same meaning as in
/// planish. If levels were applied, or USD cannot express the scheme, limit positions or normals, faces are polygons
/// with `subdivisionScheme = "none"`.
///
/// Numbers are the shortest decimals that read back as the same f64, though USD keeps positions, texture coordinates
/// and sharpness as f32. Colours are linear. Groups and materials are subsets of the faces.
///
/// Source: Pixar, `OpenUSD` 26.11, `UsdGeomMesh`, `UsdGeomSubset`, `UsdPreviewSurface` specification 2.6.
#[derive(Debug)]
pub(super) struct Usda;

const FACTS: &FormatFacts = &FormatFacts {
    name: "usda",
    extension: "usda",
    media_type: "model/vnd.usda",
    content: Content::Text,
    doc: "USD as text: at level 0 of catmull-clark, loop and bilinear the cage as a subdivision surface, else polygons",
    parameters: &[POSITIONS, NORMALS],
    tells_plan: true,
    holds: |kind, _| kind.only_meshes("usda holds meshes here, these are curves; ask for json or obj"),
    ..FormatFacts::USUAL
};

impl Format for Usda {
    fn facts(&self) -> &'static FormatFacts {
        FACTS
    }

    fn streams(&self, _mesh: &Mesh, options: &Values) -> &'static [Tile] {
        if with_normals(options) { &[] } else { &[Tile::Quad, Tile::Triangle] }
    }

    fn encode(&self, scene: &Scene<'_>, options: &Values, stream: &mut Stream<'_>) -> Result<(), FormatError> {
        let Shape::Mesh(mesh) = scene.shape else {
            return Err(FormatError::Unfit("usda holds meshes here; ask for json or obj".into()));
        };
        stream.bytes(header(scene.coordinate_system).as_bytes())?;
        let cage = cage(scene, mesh, options);
        if let Some(cage) = &cage {
            tell_differences(scene, cage);
            write_mesh(&cage.source(), Some(cage), stream)?;
        } else {
            of_tags("usda", &mesh.tags()).into_iter().for_each(|sentence| scene.notes.add(sentence));
            write_polygons(mesh, options, stream)?;
        }
        carried::materials(mesh.attachments(), stream)?;
        stream.bytes(b"}\n")
    }
}

impl Requirements for Usda {
    fn fits(&self, counts: &Counts, options: &Values) -> Result<(), Fault> {
        let normals = if with_normals(options) { counts.split_vertices } else { 0 };
        let most = counts.vertices.saturating_add(normals).max(counts.uvs).max(counts.seamed).max(counts.faces);
        if most <= i32::MAX as u128 {
            return Ok(());
        }
        let detail = format!("{most} vertices or faces, usda counts at most {}; ask for fewer levels", i32::MAX);
        Err(Fault::new("/format", detail))
    }

    fn leaves_out(&self, carried: &Attachments, _: &Values) -> Vec<String> {
        left_out("usda", "glb", carried, &[Datum::Textures])
    }
}

impl Costs for Usda {
    fn size(&self, counts: &Counts, options: &Values) -> Size {
        Size::AtMost(size(counts, options))
    }
}

/// Returns the control mesh, if the scene shows it without refinement under a scheme that USD has.
fn cage<'a>(scene: &Scene<'a>, mesh: &dyn MeshSource, options: &Values) -> Option<UsdaCage<'a>> {
    let (given, plan) = (scene.control.mesh()?, scene.control.plan()?);
    // every level of these schemes adds vertices
    let stays = mesh.n_vertices() == given.topology.n_vertices();
    let is_plain = options.choice(POSITIONS.name) != Some(LIMIT) && !with_normals(options);
    if stays && is_plain { UsdaCage::of(given, plan) } else { None }
}

fn tell_differences(scene: &Scene<'_>, cage: &UsdaCage<'_>) {
    for name in cage.otherwise() {
        scene.notes.add(format!(
            "the channel \"{name}\" has another interpolation than USD, which knows one for all values of corners; it \
             is refined otherwise there"
        ));
    }
}

/// Returns the text before the mesh.
fn header(CoordinateSystem { unit, up }: CoordinateSystem) -> String {
    let mut metres = Vec::new();
    real(&mut metres, unit.metres());
    let axis = if up == Up::Y { "Y" } else { "Z" };
    let metres = String::from_utf8_lossy(&metres);
    format!(
        "#usda 1.0\n(\n    defaultPrim = \"planish\"\n    metersPerUnit = {metres}\n    upAxis = \"{axis}\"\n)\n\ndef \
         Xform \"planish\"\n{{"
    )
}

/// Writes a mesh of polygons, with normals if requested.
fn write_polygons(mesh: &dyn MeshSource, options: &Values, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    if !with_normals(options) {
        return write_mesh(mesh, None, stream);
    }
    begin(mesh, None, stream)?;
    write_normals(mesh, stream)?;
    end(mesh, stream)
}

/// Writes a mesh without normals.
fn write_mesh(mesh: &dyn MeshSource, cage: Option<&UsdaCage<'_>>, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    begin(mesh, cage, stream)?;
    end(mesh, stream)
}

/// Writes the mesh up to its attachments.
fn begin(mesh: &dyn MeshSource, cage: Option<&UsdaCage<'_>>, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    let materials = &mesh.attachments().materials;
    let binds = (!materials.is_empty()).then(|| "prepend apiSchemas = [\"MaterialBindingAPI\"]".to_owned());
    carried::prim("Mesh", "mesh", binds.into_iter(), "    ", stream)?;
    let is_one_sided = mesh.attachments().looks.iter().any(|look: &Look| look.double_sided == Some(false));
    stream.bytes(format!("{INDENT}uniform bool doubleSided = {}\n", u8::from(!is_one_sided)).as_bytes())?;
    let positions = Positions::of_mesh(mesh).within_f32();
    let bounds = positions.bounds(stream.watch)?;
    if !bounds.is_empty() {
        attribute("float3[] extent", On::Untold, stream, |stream| {
            let ends = [bounds.min, bounds.max];
            stream.rows(&ends, |start, rows, out| entries(start, rows.as_flattened(), 3, out))
        })?;
    }
    faces(mesh, stream)?;
    attribute("point3f[] points", On::Untold, stream, |stream| {
        stream.positions(&positions, |start, rows, out| entries(start, rows.as_flattened(), 3, out))
    })?;
    let scheme = cage.map_or("none", UsdaCage::scheme);
    stream.bytes(format!("{INDENT}uniform token subdivisionScheme = \"{scheme}\"\n").as_bytes())?;
    for (name, token) in cage.into_iter().flat_map(UsdaCage::rules) {
        stream.bytes(format!("{INDENT}token {name} = \"{token}\"\n").as_bytes())?;
    }
    write_tags(&mesh.tags(), stream)?;
    match cage.map(UsdaCage::source).as_ref().map(ControlSource::holes) {
        Some(holes @ [_, ..]) => numbers("int[] holeIndices", holes, stream, |&f, out| whole(out, f.into())),
        _ => Ok(()),
    }
}

/// Writes the attachments of the mesh, and ends it.
fn end(mesh: &dyn MeshSource, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    carried::primvars(mesh, stream)?;
    carried::subsets(mesh, stream)?;
    stream.bytes(b"    }\n")
}

fn write_tags(tags: &CreaseTags, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    let CreaseTags { creases, corners } = tags;
    if !corners.is_empty() {
        numbers("int[] cornerIndices", corners, stream, |&(v, _), out| whole(out, v.into()))?;
        numbers("float[] cornerSharpnesses", corners, stream, |&(_, sharpness), out| real(out, sharpness))?;
    }
    if creases.is_empty() {
        return Ok(());
    }
    numbers("int[] creaseIndices", creases, stream, |&([a, b], _), out| {
        whole(out, a.into());
        comma(1, out);
        whole(out, b.into());
    })?;
    numbers("int[] creaseLengths", creases, stream, |_, out| out.push(b'2'))?;
    numbers("float[] creaseSharpnesses", creases, stream, |&(_, sharpness), out| real(out, sharpness))
}

/// Writes normals, which differ on the sides of sharp edges.
fn write_normals(mesh: &dyn MeshSource, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    let watch = stream.watch;
    let split_vertices = SplitVertices::of(Shape::Mesh(mesh), &HardEdges::default(), watch)?;
    let sides = split_vertices.as_ref().map_or(mesh, |split_vertices| split_vertices);
    let normals = normals::of(sides, Positions::of_mesh(sides).held(watch)?.rows(), watch)?;
    let on = if split_vertices.is_some() { On::Corners } else { On::Vertices };
    attribute("normal3f[] primvars:normals", on, stream, |stream| {
        stream.rows(&normals, |start, rows, out| {
            let rows: Vec<[f64; 3]> = rows.iter().map(|&normal| normals::or_up(normal)).collect();
            entries(start, rows.as_flattened(), 3, out);
        })
    })?;
    if split_vertices.is_none() {
        return Ok(());
    }
    attribute("int[] primvars:normals:indices", On::Untold, stream, |stream| stream.faces(sides, corners))
}

/// Returns the maximum number of bytes: of each kind of element the larger number of the cage and of the shown mesh
/// counts.
fn size(counts: &Counts, options: &Values) -> u128 {
    let carried = &counts.attachments;
    let vertices = counts.vertices.max(counts.control);
    let corners = counts.half_edges.max(2 * counts.input_edges as u128);
    let faces = counts.faces.max(counts.input_faces as u128);
    let row = |width: u128| 4 + width * (REAL_BYTES + 2);
    let n_normals = if with_normals(options) { vertices.saturating_add(counts.split_vertices) } else { 0 };
    let most = vertices.max(n_normals).max(counts.uvs).max(counts.seamed).max(corners);
    let index = digits(most) + 2;
    let indexed = u128::from(n_normals > 0) + u128::from(counts.uvs > 0);
    let seamed = carried.channels.iter().filter(|channel| channel.seams.is_some()).count() as u128;
    let of_channels = carried.channels.iter().map(|channel| {
        let rows = if channel.seams.is_some() { counts.seamed } else { vertices };
        total(&[(1, 512 + channel.name.len() as u128), (rows, row(channel.width as u128) + 2)])
    });
    let labels = |labels: &Labels| {
        let named = if labels.is_empty() { 0 } else { faces };
        let names = 12 * labels.name_bytes() as u128;
        total(&[(labels.names.len() as u128, USDA_LABEL_BYTES), (1, names), (named, index)])
    };
    let names = labels(&carried.groups).saturating_add(labels(&carried.materials));
    let tag = 2 * index + row(1) + 3;
    of_channels.fold(names, u128::saturating_add).saturating_add(total(&[
        (1, USDA_FRAME_BYTES),
        (vertices, row(3)),
        (n_normals, row(3)),
        (counts.uvs, row(2)),
        (corners, index * (1 + indexed + seamed)),
        (faces, 2 * index),
        (counts.tags as u128, tag),
    ]))
}
