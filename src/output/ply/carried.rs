//! Properties of vertices and faces in PLY besides positions and normals: channels, names, origins.

use super::layout::{PlyEncoding, PlyLayout};
use crate::output::colors::byte;
use crate::output::numbers::{REAL_BYTES, digits, whole};
use crate::output::scene::MeshSource;
use crate::shape::attachments::{Attachments, Channel};
use crate::shape::labels::Labels;

/// Names of the properties of a colour.
const COLOR_PROPERTIES: [&str; 4] = ["red", "green", "blue", "alpha"];

/// Maximum number of bytes of the number of a group or material: four in binary, a blank and three digits in text.
const LABEL_BYTES: u128 = 4;

/// Returns the lines of the header that list the names of groups and materials by their numbers.
pub(super) fn remarks(attachments: &Attachments) -> String {
    kinds(attachments)
        .flat_map(|(kind, labels)| labels.names.iter().enumerate().map(move |(i, name)| (kind, i, name)))
        .map(|(kind, i, name)| format!("comment {kind} {i} {name}\n"))
        .collect::<Vec<_>>()
        .concat()
}

/// Returns the lines of the header for the properties of vertices.
pub(super) fn vertex_properties(attachments: &Attachments, layout: PlyLayout) -> String {
    let number = if layout.float { "float" } else { "double" };
    let property = |channel: &Channel| -> Vec<String> {
        if channel.is_color() {
            return COLOR_PROPERTIES[..channel.width].iter().map(|name| format!("property uchar {name}\n")).collect();
        }
        channel.number_names().iter().map(|name| format!("property {number} {name}\n")).collect()
    };
    let mut properties = attachments.channels.iter().flat_map(property).collect::<Vec<_>>().concat();
    if attachments.uvs.is_some() {
        ["s", "t"].iter().for_each(|name| properties.extend(["property ", number, " ", name, "\n"]));
    }
    if layout.ids {
        properties.push_str("property uchar origin_dimension\nproperty uint origin\n");
    }
    properties
}

/// Returns the lines of the header for the properties of faces.
pub(super) fn face_properties(attachments: &Attachments, layout: PlyLayout) -> String {
    let mut properties =
        kinds(attachments).map(|(kind, _)| format!("property int {kind}\n")).collect::<Vec<_>>().concat();
    if layout.ids {
        properties.push_str("property uint origin\n");
    }
    properties
}

/// Returns the kinds of labels that the mesh has.
fn kinds(attachments: &Attachments) -> impl Iterator<Item = (&'static str, &Labels)> {
    [("group", &attachments.groups), ("material", &attachments.materials)]
        .into_iter()
        .filter(|(_, labels)| !labels.is_empty())
}

/// Returns the bytes per vertex and per face beyond positions and corners; for text, their maximum.
pub(super) fn bytes(attachments: &Attachments, layout: PlyLayout, cells: u128) -> (u128, u128) {
    let ascii = layout.encoding == PlyEncoding::Ascii;
    let number = match (ascii, layout.float) {
        (true, _) => REAL_BYTES + 1,
        (false, true) => 4,
        (false, false) => 8,
    };
    let of_channel = |channel: &Channel| {
        let each = if channel.is_color() { if ascii { 4 } else { 1 } } else { number };
        channel.width as u128 * each
    };
    let names = kinds(attachments).count() as u128;
    // the number of a cell is at most that of a vertex, edge or face, and -1 takes two bytes
    let cell = if ascii { digits(cells) + 1 } else { 4 };
    let (vertex_origin, face_origin) = match (layout.ids, ascii) {
        (false, _) => (0, 0),
        (true, true) => (2 + cell, cell),
        (true, false) => (1 + cell, cell),
    };
    let uvs = if attachments.uvs.is_some() { 2 * number } else { 0 };
    (attachments.channels.iter().map(of_channel).sum::<u128>() + uvs + vertex_origin, names * LABEL_BYTES + face_origin)
}

/// Returns whether vertices have any properties besides positions and normals.
pub(super) fn any_of_vertices(mesh: &dyn MeshSource, layout: PlyLayout) -> bool {
    layout.ids || !mesh.attachments().channels.is_empty() || mesh.uvs().is_some()
}

/// Returns whether faces have any properties besides their corners.
pub(super) fn any_of_faces(mesh: &dyn MeshSource, layout: PlyLayout) -> bool {
    layout.ids || mesh.attachments().names_faces()
}

/// The properties of consecutive vertices that are appended to their positions.
pub(super) struct VertexProperties<'a> {
    mesh: &'a dyn MeshSource,
    layout: PlyLayout,
    start: usize,
    /// The numbers of each channel.
    channels: Vec<Vec<f64>>,
    uvs: Vec<f64>,
}

impl<'a> VertexProperties<'a> {
    /// Reads the properties of the vertices `start .. start + n`.
    pub(super) fn of(mesh: &'a dyn MeshSource, layout: PlyLayout, start: usize, n: usize) -> Self {
        let fetch = |channel| {
            let mut values = Vec::new();
            mesh.channel(channel, start..start + n, &mut values);
            values
        };
        let mut uvs = Vec::new();
        if let Some(source) = mesh.uvs() {
            source.values(start..start + n, &mut uvs);
        }
        Self { mesh, layout, start, channels: (0..mesh.attachments().channels.len()).map(fetch).collect(), uvs }
    }

    /// Appends the properties of the `i`-th of these vertices.
    pub(super) fn vertex(&self, i: usize, out: &mut Vec<u8>) {
        for (channel, values) in self.mesh.attachments().channels.iter().zip(&self.channels) {
            for &x in &values[i * channel.width..(i + 1) * channel.width] {
                self.layout.separate(out);
                if channel.is_color() { self.layout.byte(byte(x), out) } else { self.layout.number(x, out) }
            }
        }
        for &x in self.uvs.get(2 * i..2 * i + 2).into_iter().flatten() {
            self.layout.separate(out);
            self.layout.number(x, out);
        }
        if self.layout.ids {
            let origin = self.mesh.vertex_origin(self.start + i);
            self.layout.separate(out);
            self.layout.byte(origin.dimension, out);
            self.layout.separate(out);
            self.layout.index(origin.cell, out);
        }
    }
}

/// Appends the properties of face `index`.
pub(super) fn face(mesh: &dyn MeshSource, layout: PlyLayout, index: usize, out: &mut Vec<u8>) {
    if !any_of_faces(mesh, layout) {
        return;
    }
    let origin = mesh.face_origin(index);
    for (_, labels) in kinds(mesh.attachments()) {
        layout.separate(out);
        let label = labels.number(origin).and_then(|label| i32::try_from(label).ok());
        match (layout.encoding, label) {
            (PlyEncoding::Ascii, None) => out.extend_from_slice(b"-1"),
            (PlyEncoding::Ascii, Some(label)) => whole(out, label.unsigned_abs().into()),
            (_, label) => out.extend_from_slice(&label.unwrap_or(-1).to_le_bytes()),
        }
    }
    if layout.ids {
        layout.separate(out);
        layout.index(origin, out);
    }
}
