//! PLY: reads elements with properties of any type, as text or binary.
//!
//! Source: G. Turk, The PLY Polygon File Format, Stanford University (1994).

mod body;
mod header;
mod joined;
mod strips;

use std::collections::BTreeMap;

use self::body::{Ascii, Binary, Body};
use self::header::{BodyEncoding, Element, Header, NAMED_PROPERTIES, PlyProperty, Scalar};
use super::collect::{MeshBuilder, vertex_index};
use super::reader::{CornerUvs, ReadLimits, ReadMesh, Reader, Vertices};
use super::text::quoted;
use crate::shape::attachments::ChannelInput;
use crate::shape::labels::FaceSet;

/// Maximum number of channels of further vertex properties.
const MAX_FURTHER_PROPERTIES: usize = 64;

/// The reader of PLY as text or binary of either byte order, with properties of any type. Elements are `vertex` (`x`,
/// `y`, `z`) and `face` (`vertex_indices` or `vertex_index`); `red`, `green`, `blue`, `alpha` are a colour, `s`, `t`
/// (or `u`, `v`) texture coordinates, as is the list `texcoord` of faces. Consecutive `weight_0`, `weight_1` are the
/// channel `weight` of two components, and so on up to four. `group` and `material` of faces are numbers that comments
/// name (`comment group 0 top`). Triangle strips (`tristrips`) replace faces; normals are ignored; other scalars of
/// vertices are channels. Other elements and lists are left out with a note. Vertices that planish split at the seams
/// of texture coordinates are read as doubled, as in glTF.
pub(super) const PLY: Reader = Reader {
    name: "ply",
    media_type: "model/ply",
    doc: "Stanford PLY, text or binary: polygons, further numbers of vertices as channels",
    vertices: Vertices::Shared,
    likeness: |file| (file.first_word() == b"ply").into(),
    read: |file, limits| read(file.bytes, limits).map_err(|detail| vec![detail]),
};

fn read(bytes: &[u8], limits: &ReadLimits) -> Result<ReadMesh, String> {
    let header = header::read(bytes)?;
    let body = &bytes[header.length..];
    match header.encoding {
        BodyEncoding::Ascii => {
            let text = super::text::text(body);
            elements(&header, Ascii::new(&text, header.lines + 1), limits)
        }
        BodyEncoding::LittleEndian => elements(&header, Binary::new(body, header.length, false), limits),
        BodyEncoding::BigEndian => elements(&header, Binary::new(body, header.length, true), limits),
    }
}

fn elements(header: &Header, mut body: impl Body, limits: &ReadLimits) -> Result<ReadMesh, String> {
    let mut reading = PlyReader {
        mesh: MeshBuilder::new(limits),
        n_vertices: header.elements.iter().find(|element| element.name == "vertex").map_or(0, |element| element.count),
        ..PlyReader::default()
    };
    let named = |name: &str| header.elements.iter().filter(|element| element.name == name).count();
    for name in ["vertex", "face"] {
        // a file without faces is a point cloud or has strips instead
        if named(name) != 1 && (name == "vertex" || named(name) > 1) {
            return Err(format!("the header has {} elements \"{name}\"; a mesh has one", named(name)));
        }
    }
    if named("face") > 0 && named("tristrips") > 0 {
        return Err("the header has faces and strips of triangles; give one of them".to_owned());
    }
    let no_faces = named("face") + named("tristrips") == 0;
    if let Some(name) = header.elements.iter().filter(|_| no_faces).find_map(faces_among_vertices) {
        return Err(format!(
            "the header has the list {} among the properties of \"vertex\"; a line \"element face\" with the number of \
             faces is missing before it",
            quoted(name)
        ));
    }
    for element in &header.elements {
        body.holds(element)?;
        match element.name.as_str() {
            "vertex" => reading.vertices(element, &mut body)?,
            "face" => reading.faces(element, &mut body)?,
            "tristrips" => strips::read(element, &mut body, &mut reading.mesh)?,
            name => {
                for _ in 0..element.count {
                    element.properties.iter().try_for_each(|property| body.pass(property))?;
                }
                if element.count > 0 {
                    reading.note(format!("elements {} are left out: {}", quoted(name), element.count));
                }
            }
        }
    }
    body.end()?;
    let is_split = header.is_own && !reading.uvs.is_empty();
    let mesh = reading.finish(&header.names);
    // texture coordinates of vertices split them at seams, which were not boundaries before
    Ok(ReadMesh { vertices: is_split.then_some(Vertices::Doubled), ..mesh })
}

/// Returns the name of the face list if it is wrongly a property of the vertices.
fn faces_among_vertices(element: &Element) -> Option<&str> {
    let list = element.properties.iter().find(|property| property.holds_corners());
    list.filter(|_| element.name == "vertex").map(|property| property.name.as_str())
}

#[derive(Default)]
struct PlyReader {
    mesh: MeshBuilder,
    channels: Vec<ChannelInput>,
    /// Texture coordinates of vertices.
    uvs: Vec<[f64; 2]>,
    /// Texture coordinates of corners.
    corner_uvs: Vec<[f64; 2]>,
    /// Faces by group number and by material number.
    groups: BTreeMap<u64, Vec<u64>>,
    materials: BTreeMap<u64, Vec<u64>>,
    n_vertices: u64,
}

/// The use of a vertex property.
#[derive(Debug, Clone, Copy, PartialEq)]
enum PropertyUse {
    Position(usize),
    Uv(usize),
    /// The channel, the component in it, and the divisor of the value.
    Channel(usize, usize, f64),
    Ignored,
}

impl PlyReader {
    fn note(&mut self, note: String) {
        self.mesh.mesh.notes.push(note);
    }

    fn vertices(&mut self, element: &Element, body: &mut impl Body) -> Result<(), String> {
        let uses = self.uses(element)?;
        self.mesh.expect_vertices(element.count)?;
        let has_uvs = uses.iter().any(|what| matches!(what, PropertyUse::Uv(_)));
        for i in 0..element.count {
            let (mut position, mut uv) = ([0.0; 3], [0.0; 2]);
            for (property, &what) in element.properties.iter().zip(&uses) {
                if property.list.is_some() {
                    body.pass(property)?;
                    continue;
                }
                let x = body.scalar(property.kind)?;
                if !x.is_finite() && what != PropertyUse::Ignored {
                    return Err(format!("{}: {} of vertex {i} is not finite", body.place(), property.name));
                }
                match what {
                    PropertyUse::Position(k) => position[k] = x,
                    PropertyUse::Uv(k) => uv[k] = x,
                    PropertyUse::Channel(channel, _, scale) => self.channels[channel].values.push(x / scale),
                    PropertyUse::Ignored => {}
                }
            }
            self.mesh.vertex(position)?;
            if has_uvs {
                self.uvs.push(uv);
            }
        }
        self.reorder(&uses);
        Ok(())
    }

    /// Determines the use of each vertex property and creates the channels.
    fn uses(&mut self, element: &Element) -> Result<Vec<PropertyUse>, String> {
        let has = |name: &str| element.properties.iter().any(|p| p.name == name && p.list.is_none());
        if let Some(missing) = ["x", "y", "z"].iter().find(|name| !has(name)) {
            return Err(format!("the vertices have no property \"{missing}\"; they need x, y and z"));
        }
        let pairs = [["s", "t"], ["u", "v"], ["texture_u", "texture_v"]];
        let uv = pairs.iter().find(|pair| pair.iter().all(|name| has(name)));
        let colors: &[&str] = match ["red", "green", "blue"].iter().all(|name| has(name)) {
            true if has("alpha") => &["red", "green", "blue", "alpha"],
            true => &["red", "green", "blue"],
            false => &[],
        };
        if !colors.is_empty() {
            self.channels.push(ChannelInput::of_vertices("color", colors.len(), Vec::new()));
        }
        let mut uses = Vec::with_capacity(element.properties.len());
        let joined = joined::runs(&element.properties);
        for (property, joined) in element.properties.iter().zip(joined) {
            let name = property.name.as_str();
            uses.push(if property.list.is_some() {
                self.note(format!("the lists {} of vertices are left out", quoted(name)));
                PropertyUse::Ignored
            } else if let Some(k) = ["x", "y", "z"].iter().position(|known| *known == name) {
                PropertyUse::Position(k)
            } else if let Some(k) = uv.and_then(|pair| pair.iter().position(|known| *known == name)) {
                PropertyUse::Uv(k)
            } else if let Some(k) = colors.iter().position(|known| *known == name) {
                PropertyUse::Channel(0, k, full(property.kind))
            } else if ["nx", "ny", "nz"].contains(&name) {
                PropertyUse::Ignored
            } else if let Some((_, place @ 1..)) = joined {
                // the first property of the run has created the channel
                PropertyUse::Channel(self.channels.len() - 1, place, 1.0)
            } else if self.channels.len() == MAX_FURTHER_PROPERTIES {
                let detail =
                    format!("the vertices have more than {MAX_FURTHER_PROPERTIES} further properties; send fewer");
                return Err(detail);
            } else {
                let (name, width) = joined.map_or((name, 1), |(run, _)| run);
                self.channels.push(ChannelInput::of_vertices(name, width, Vec::new()));
                PropertyUse::Channel(self.channels.len() - 1, 0, 1.0)
            });
        }
        Ok(uses)
    }

    /// Reorders colour components from file order to red, green, blue, alpha.
    fn reorder(&mut self, uses: &[PropertyUse]) {
        let order: Vec<usize> = uses
            .iter()
            .filter_map(|what| match what {
                PropertyUse::Channel(0, place, _) => Some(*place),
                _ => None,
            })
            .collect();
        let Some(color) = self.channels.first_mut().filter(|channel| channel.is_color()) else { return };
        for row in color.values.chunks_exact_mut(order.len().max(1)) {
            let given = row.to_vec();
            order.iter().zip(given).for_each(|(&place, x)| row[place] = x);
        }
    }

    fn faces(&mut self, element: &Element, body: &mut impl Body) -> Result<(), String> {
        if element.properties.iter().filter(|p| p.holds_corners()).count() != 1 {
            return Err("the faces need one list \"vertex_indices\" (or \"vertex_index\")".to_owned());
        }
        self.mesh.expect_faces(element.count)?;
        let is_name =
            |p: &PlyProperty| p.list.is_none() && p.kind.is_whole() && NAMED_PROPERTIES.contains(&p.name.as_str());
        let is_uvs = |p: &PlyProperty| p.list.is_some() && p.name == "texcoord";
        let others = element.properties.iter().filter(|p| !p.holds_corners() && !is_uvs(p) && !is_name(p));
        let others: Vec<String> = others.map(|property| quoted(&property.name)).collect();
        if !others.is_empty() {
            self.note(format!("properties of faces are left out: {}", others.join(", ")));
        }
        let (mut face, mut uvs): (Vec<u32>, Vec<f64>) = (Vec::new(), Vec::new());
        let n = usize::try_from(self.n_vertices).unwrap_or(usize::MAX);
        for i in 0..element.count {
            let wrong = |body: &dyn Body, detail: String| format!("{}: face {i}: {detail}", body.place());
            uvs.clear();
            for property in &element.properties {
                if is_name(property) {
                    let number = body.scalar(property.kind)?;
                    self.name(&property.name, number, i);
                    continue;
                }
                let Some(sizes) = property.list.filter(|_| property.holds_corners() || is_uvs(property)) else {
                    body.pass(property)?;
                    continue;
                };
                let size = body.size(sizes, property.kind)?;
                if is_uvs(property) {
                    for _ in 0..size {
                        uvs.push(body.scalar(property.kind)?);
                    }
                    continue;
                }
                face.clear();
                for _ in 0..size {
                    let vertex = body.index(property.kind)?;
                    face.push(vertex_index(vertex, n).map_err(|detail| wrong(body, detail))?);
                }
            }
            self.mesh.face(&face).map_err(|detail| wrong(body, detail))?;
            if element.properties.iter().any(is_uvs) {
                if uvs.len() != 2 * face.len() || uvs.iter().any(|x| !x.is_finite()) {
                    let detail =
                        format!("{} texture coordinates; it has {} corners, each takes 2", uvs.len(), face.len());
                    return Err(wrong(body, detail));
                }
                self.corner_uvs.extend(uvs.as_chunks::<2>().0);
            }
        }
        Ok(())
    }

    /// Adds a face to the set with this number; negative numbers mean no set.
    fn name(&mut self, kind: &str, number: f64, face: u64) {
        if number >= 0.0 {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it is whole and below 2^32")]
            let number = number as u64;
            let sets = if kind == NAMED_PROPERTIES[0] { &mut self.groups } else { &mut self.materials };
            sets.entry(number).or_default().push(face);
        }
    }

    fn finish(self, names: &BTreeMap<(String, u64), String>) -> ReadMesh {
        let mut mesh = self.mesh.mesh;
        let named = |kind: &str, sets: BTreeMap<u64, Vec<u64>>| {
            let name = |number: u64| names.get(&(kind.to_owned(), number)).cloned();
            let set =
                |(number, faces)| FaceSet { name: name(number).unwrap_or_else(|| format!("{kind}_{number}")), faces };
            sets.into_iter().map(set).collect()
        };
        mesh.groups = named(NAMED_PROPERTIES[0], self.groups);
        mesh.materials = named(NAMED_PROPERTIES[1], self.materials);
        mesh.channels = self.channels;
        if !self.corner_uvs.is_empty() {
            let corners = (0..).take(self.corner_uvs.len()).collect();
            mesh.uvs = Some(CornerUvs::new(self.corner_uvs, corners));
        } else if !self.uvs.is_empty() {
            mesh.uvs = Some(CornerUvs::new(self.uvs, mesh.faces.vertices().to_vec()));
        }
        mesh
    }
}

/// Returns the value of a colour component at full strength.
fn full(kind: Scalar) -> f64 {
    match kind {
        Scalar::U8 => 255.0,
        Scalar::U16 => 65_535.0,
        _ => 1.0,
    }
}
