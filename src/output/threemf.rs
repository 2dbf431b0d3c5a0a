//! 3MF: triangles for printers, with unit, up axis, colours and parts.

mod look;
mod package;
mod parts;

use self::look::{TriangleMaterials, color, escaped};
use self::package::{Package, overhead};
use self::parts::{MAX_PARTS, MeshParts, PART_TRIANGLE_BYTES, PART_VERTEX_BYTES};
use crate::fault::Fault;
use crate::math::amounts::in_bytes;
use crate::math::parameter::{Parameter, Values};
use crate::output::counts::Counts;
use crate::output::error::FormatError;
use crate::output::format::{Content, Costs, Format, FormatFacts, Requirements};
use crate::output::left_out::{Datum, left_out};
use crate::output::numbers::{REAL_BYTES, digits, real, total, whole};
use crate::output::options::POSITIONS;
use crate::output::positions::Positions;
use crate::output::scene::{CoordinateSystem, MeshSource, Scene, Shape, triangles};
use crate::output::size::Size;
use crate::output::stream::Stream;
use crate::shape::attachments::Attachments;
use crate::shape::coordinate_system::{Unit, Up};
use crate::shape::mesh::Mesh;
use crate::shape::tile::Tile;

/// The option of objects.
const PARTS: Parameter = Parameter::choice(
    "parts",
    &["one", "components"],
    "Whether the whole mesh is one object, or each connected part of it one of its own, named by its group where it \
     has one.",
);
const COMPONENTS: &str = "components";

/// The content types of the files of the archive, and the file of the model. Source: ECMA-376-2 (OPC); 3MF Core 1.3,
/// section 2.
const TYPES: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Types \
                     xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">\n<Default \
                     Extension=\"rels\" \
                     ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>\n<Default \
                     Extension=\"model\" ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/>\n\
                     </Types>\n";
const RELATIONS: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Relationships \
                         xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">\n<Relationship \
                         Target=\"/3D/3dmodel.model\" Id=\"rel0\" \
                         Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/>\n</Relationships>\n";
const PACKAGE_NAMES: [&str; 3] = ["[Content_Types].xml", "_rels/.rels", "3D/3dmodel.model"];

/// The transform of y-up models to 3MF, where z points up: the rows of the matrix by which row vectors are multiplied.
const UPRIGHT: &str = " transform=\"1 0 0 0 0 1 0 -1 0 0 0 0\"";

/// 3MF Core 1.3 with colours of the Materials Extension 1.2: an archive with the triangles as XML.
///
/// Coordinates are the shortest decimals that read back as the same f64, in the unit of the input; models with y up are
/// turned by the transform of their items. Materials are base materials with their colours; colours of vertices take
/// precedence over them. The archive holds no times and no names that vary, so the same model gives the same bytes.
///
/// Source: 3MF Consortium, 3MF Core Specification 1.3, chapters 3 and 4; Materials and Properties Extension 1.2,
/// chapter 3.
#[derive(Debug)]
pub(super) struct ThreeMf;

const FACTS: &FormatFacts = &FormatFacts {
    name: "3mf",
    extension: "3mf",
    media_type: "model/3mf",
    content: Content::Packed,
    doc: "3MF for printers: triangles with unit, up axis, materials or colours of vertices, parts on request",
    parameters: &[POSITIONS, PARTS],
    holds: |kind, _| kind.only_meshes("3mf holds triangles only, these are curves; ask for json or obj"),
    has_no_tags: true,
    ..FormatFacts::USUAL
};

impl Format for ThreeMf {
    fn facts(&self) -> &'static FormatFacts {
        FACTS
    }

    fn streams(&self, _mesh: &Mesh, options: &Values) -> &'static [Tile] {
        if options.choice(PARTS.name) == Some(COMPONENTS) { &[] } else { &[Tile::Quad, Tile::Triangle] }
    }

    fn encode(&self, scene: &Scene<'_>, options: &Values, stream: &mut Stream<'_>) -> Result<(), FormatError> {
        let Shape::Mesh(mesh) = scene.shape else {
            return Err(FormatError::Unfit("3mf holds triangles only; ask for json or obj".into()));
        };
        if mesh.n_faces() == 0 {
            return Err(FormatError::Unfit(
                "no face is shown, and 3mf holds no model without one; ask for json".into(),
            ));
        }
        let [types, relations, model] = PACKAGE_NAMES;
        let mut package = Package::new(stream.out);
        package.file(types, |out| Ok::<_, FormatError>(out.write_all(TYPES.as_bytes())?))?;
        package.file(relations, |out| Ok::<_, FormatError>(out.write_all(RELATIONS.as_bytes())?))?;
        let has_components = options.choice(PARTS.name) == Some(COMPONENTS);
        package.file(model, |out| {
            write_model(mesh, scene.coordinate_system, has_components, &mut Stream::new(out, stream.watch))
        })?;
        Ok(package.finish()?)
    }
}

impl Requirements for ThreeMf {
    fn fits(&self, counts: &Counts, options: &Values) -> Result<(), Fault> {
        let (length, most) = (model_length(counts, options), u128::from(u32::MAX));
        if length <= most {
            return Ok(());
        }
        let [length, most] = [length, most].map(in_bytes);
        let detail =
            format!("the model would take {length}, 3mf holds at most {most} here; ask for fewer levels or stl");
        Err(Fault::new("/format", detail))
    }

    fn leaves_out(&self, carried: &Attachments, options: &Values) -> Vec<String> {
        let kinds =
            [Datum::ColorSeams, Datum::OtherChannels, Datum::Uvs, Datum::Surface, Datum::Sides, Datum::Textures];
        let mut sentences = left_out("3mf", "glb", carried, &kinds);
        if color(carried).is_some() && !carried.materials.is_empty() {
            sentences.push("materials are left out, as triangles of 3mf have the colors of their vertices".to_owned());
        }
        if carried.groups.differ() && options.choice(PARTS.name) != Some(COMPONENTS) {
            let remedy = "where they are parts of their own, \"parts\": \"components\" names them";
            sentences.push(format!("groups are left out of 3mf; {remedy}"));
        }
        sentences
    }
}

impl Costs for ThreeMf {
    fn size(&self, counts: &Counts, options: &Values) -> Size {
        let model = model_length(counts, options);
        let names = PACKAGE_NAMES.iter().map(|name| name.len() as u128).sum();
        let small = (TYPES.len() + RELATIONS.len()) as u128;
        // if stored, five bytes precede each block and a few follow at the end
        Size::AtMost(total(&[(1, model), (1, model / 1_000), (1, small), (1, overhead(3, names) + 64)]))
    }

    fn memory(&self, counts: &Counts, options: &Values) -> u128 {
        if options.choice(PARTS.name) != Some(COMPONENTS) {
            return 0;
        }
        total(&[(counts.vertices, PART_VERTEX_BYTES), (counts.triangles(), PART_TRIANGLE_BYTES)])
    }

    /// Compressing takes about 25 ns a byte.
    fn work(&self, _mesh: Option<&Mesh>, counts: &Counts, options: &Values) -> u128 {
        model_length(counts, options) / 4
    }
}

fn write_model(
    mesh: &dyn MeshSource,
    CoordinateSystem { unit, up }: CoordinateSystem,
    has_components: bool,
    stream: &mut Stream<'_>,
) -> Result<(), FormatError> {
    let unit = match unit {
        Unit::Metre => "meter",
        Unit::Millimetre => "millimeter",
        Unit::Centimetre => "centimeter",
        Unit::Inch => "inch",
    };
    let head = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"{unit}\" xml:lang=\"en-US\" \
         xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" \
         xmlns:m=\"http://schemas.microsoft.com/3dmanufacturing/material/2015/02\">\n<metadata \
         name=\"Application\">planish</metadata>\n<resources>\n"
    );
    stream.bytes(head.as_bytes())?;
    let looks = TriangleMaterials::of(mesh);
    looks.resources(stream)?;
    let n = if has_components { write_parts(mesh, looks, stream)? } else { write_one(mesh, looks, stream)? };
    stream.bytes(b"</resources>\n<build>\n")?;
    let upright = if up == Up::Y { UPRIGHT } else { "" };
    for object in 0..n {
        stream.bytes(format!("<item objectid=\"{}\"{upright}/>\n", FIRST_OBJECT + object).as_bytes())?;
    }
    stream.bytes(b"</build>\n</model>\n")
}

/// The id of the first object; looks have lower ids.
const FIRST_OBJECT: usize = 3;

fn begin(object: usize, name: &str, looks: TriangleMaterials<'_>, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    let (id, name, looks) = (FIRST_OBJECT + object, escaped(name), looks.of_object());
    let head = format!("<object id=\"{id}\" type=\"model\" name=\"{name}\"{looks}>\n<mesh>\n<vertices>\n");
    stream.bytes(head.as_bytes())
}

/// Writes the whole mesh as one object.
fn write_one(
    mesh: &dyn MeshSource,
    looks: TriangleMaterials<'_>,
    stream: &mut Stream<'_>,
) -> Result<usize, FormatError> {
    begin(0, "planish", looks, stream)?;
    stream.positions(&Positions::of_mesh(mesh).within_f32(), |_, rows, out| {
        out.append(|out| rows.iter().for_each(|position| vertex(position, out)));
    })?;
    stream.bytes(b"</vertices>\n<triangles>\n")?;
    stream.faces(mesh, |start, faces, out| {
        out.append(|out| {
            for (face, corners) in (start..).zip(faces.iter()) {
                triangles(corners).for_each(|of_face| triangle(of_face, (of_face, face), looks, out));
            }
        });
    })?;
    stream.bytes(b"</triangles>\n</mesh>\n</object>\n")?;
    Ok(1)
}

/// Writes each connected part as an object.
fn write_parts(
    mesh: &dyn MeshSource,
    looks: TriangleMaterials<'_>,
    stream: &mut Stream<'_>,
) -> Result<usize, FormatError> {
    let parts = MeshParts::of(mesh, stream.watch)?;
    let positions = Positions::of_mesh(mesh).within_f32().held(stream.watch)?;
    let groups = &mesh.attachments().groups;
    for (part, (vertices, of_part)) in parts.vertices.iter().zip(&parts.triangles).enumerate() {
        let mut all = of_part.iter().map(|&(_, face)| groups.name(mesh.face_origin(face as usize)));
        let first = all.next().flatten();
        let name = first.filter(|_| all.all(|other| other == first));
        begin(part, name.unwrap_or(&format!("part-{}", part + 1)), looks, stream)?;
        stream.rows(vertices, |_, vertices, out| {
            out.append(|out| vertices.iter().for_each(|&v| vertex(&positions.rows()[v as usize], out)));
        })?;
        stream.bytes(b"</vertices>\n<triangles>\n")?;
        stream.rows(of_part, |_, some, out| {
            out.append(|out| {
                for &(whole_mesh, face) in some {
                    let own = whole_mesh.map(|v| parts.local[v as usize]);
                    triangle(own, (whole_mesh, face as usize), looks, out);
                }
            });
        })?;
        stream.bytes(b"</triangles>\n</mesh>\n</object>\n")?;
    }
    Ok(parts.triangles.len())
}

fn vertex(position: &[f64; 3], out: &mut Vec<u8>) {
    out.extend_from_slice(b"<vertex");
    for (name, &x) in [" x=\"", " y=\"", " z=\""].iter().zip(position) {
        out.extend_from_slice(name.as_bytes());
        real(out, x);
        out.push(b'"');
    }
    out.extend_from_slice(b"/>\n");
}

/// Appends a triangle with the numbers of its vertices in its object; its looks depend on their numbers in the mesh.
fn triangle(own: [u32; 3], (of_mesh, face): ([u32; 3], usize), looks: TriangleMaterials<'_>, out: &mut Vec<u8>) {
    out.extend_from_slice(b"<triangle");
    for (name, v) in [" v1=\"", " v2=\"", " v3=\""].iter().zip(own) {
        out.extend_from_slice(name.as_bytes());
        whole(out, v.into());
        out.push(b'"');
    }
    looks.of_triangle(of_mesh, face, out);
    out.extend_from_slice(b"/>\n");
}

/// Returns the maximum number of bytes of the model before it is compressed.
fn model_length(counts: &Counts, options: &Values) -> u128 {
    let carried = &counts.attachments;
    let index = digits(counts.vertices);
    let color = if color(carried).is_some() { b"<m:color color=\"#RRGGBBAA\"/>\n".len() as u128 } else { 0 };
    let has_components = options.choice(PARTS.name) == Some(COMPONENTS);
    let n_parts = if has_components { counts.faces.min(MAX_PARTS as u128) } else { 1 };
    let longest = carried.groups.names.iter().map(String::len).max().unwrap_or_default() as u128;
    let vertex = b"<vertex x=\"\" y=\"\" z=\"\"/>\n".len() as u128 + 3 * REAL_BYTES;
    let own = b"<triangle v1=\"\" v2=\"\" v3=\"\"/>\n".len() as u128 + 3 * index;
    let looks = if color > 0 || !carried.materials.is_empty() { 28 + 3 * index } else { 0 };
    total(&[
        (1, 1_024),
        (counts.vertices, vertex + color),
        (counts.triangles(), own + looks),
        (n_parts, 320 + 6 * longest),
        (carried.materials.names.len() as u128, 64),
        (6, carried.materials.name_bytes() as u128),
    ])
}
