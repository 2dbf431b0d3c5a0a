//! The attachments of a mesh, in the notation of requests, and the origins of its cells in the input.

use serde_json::Value;

use super::looks;
use super::row::{comma, faces, row, vectors};
use crate::math::parameter::Values;
use crate::output::bytes::Bytes;
use crate::output::counts::Counts;
use crate::output::error::FormatError;
use crate::output::numbers::{REAL_BYTES, digits, real, total, whole};
use crate::output::options::{IDS, ISOLINES};
use crate::output::scene::{MeshSource, labelled_ranges};
use crate::output::stream::Stream;
use crate::shape::attachments::Channel;
use crate::shape::creases::CreaseTags;
use crate::shape::labels::Labels;
use crate::shape::looks::Look;
use crate::shape::source::PlaceSource;

/// Bytes of the entry of a channel with seams, without its values and faces.
const SEAM_ENTRY_BYTES: u128 = br#"{"values":,"faces":[]}"#.len() as u128;

/// Returns the maximum number of bytes of the entries of attachments and origins.
pub(super) fn size(counts: &Counts, options: &Values) -> u128 {
    let attachments = &counts.attachments;
    let row = |channel: &Channel| 3 + channel.width as u128 * (REAL_BYTES + 1);
    let corners = |places: u128| total(&[(counts.faces, 2), (counts.half_edges, digits(places) + 1)]);
    let channels = attachments.channels.iter().map(|channel| {
        let rows = if channel.seams.is_some() { counts.seamed } else { counts.vertices };
        let corners = channel.seams.as_ref().map_or(0, |_| SEAM_ENTRY_BYTES.saturating_add(corners(counts.seamed)));
        let name = br#""":[],"#.len() as u128 + channel.name.len() as u128;
        total(&[(1, name), (rows, row(channel)), (1, corners)])
    });
    let channels: u128 = channels.fold(br#","channels":{}"#.len() as u128, u128::saturating_add);
    let labels = |labels: &Labels| {
        let frames = br#"{"name":"","faces":[]},"#.len() * labels.names.len() + 6 * labels.name_bytes();
        let faces = if labels.is_empty() { 0 } else { counts.faces };
        total(&[(1, br#","materials":[]"#.len() as u128), (1, frames as u128), (faces, digits(counts.faces) + 1)])
    };
    let cell = digits(counts.half_edges.max(counts.vertices).max(counts.input_faces as u128)) + 1;
    let origins = br#","ids":{"faces":[],"vertices":[]}"#.len() as u128;
    let origins = if options.flag(IDS.name) {
        total(&[(1, origins), (counts.faces, cell), (counts.vertices, cell + 4)])
    } else {
        0
    };
    let frame = br#","uvs":{"values":[],"faces":[]}"#.len() as u128;
    let values = (counts.uvs, 2 + 2 * (REAL_BYTES + 1));
    let uvs = if counts.uvs > 0 { total(&[(1, frame), values, (1, corners(counts.uvs))]) } else { 0 };
    // the inner vertices of different edges are different
    let edges = counts.input_edges as u128;
    let along = counts.vertices.saturating_add(2 * edges);
    let frame = br#","isolines":[]"#.len() as u128;
    let isolines = total(&[(1, frame), (edges, 3), (along, digits(counts.vertices) + 1)]);
    let isolines = if options.flag(ISOLINES) { isolines } else { 0 };
    let tag = br#"{"edge":[,],"sharpness":},"#.len() as u128 + 2 * digits(counts.vertices) + REAL_BYTES;
    let frame = br#","corners":[],"creases":[]"#.len() as u128;
    let tags = total(&[(1, frame), (counts.tags as u128, tag)]);
    let names = [&attachments.groups, &attachments.materials].map(labels);
    [channels, uvs, tags, names[0], names[1], looks::size(&attachments.looks), origins, isolines]
        .into_iter()
        .fold(0, u128::saturating_add)
}

/// Writes the entries that exist, each after a comma.
pub(super) fn write(mesh: &dyn MeshSource, options: &Values, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    write_tags(&mesh.tags(), stream)?;
    let attachments = mesh.attachments();
    for (i, channel) in attachments.channels.iter().enumerate() {
        stream.bytes(if i == 0 { br#","channels":{"# } else { b"," })?;
        stream.bytes(format!("{}:", Value::from(channel.name.as_str())).as_bytes())?;
        match mesh.channel_places(i) {
            Some(places) => write_places(mesh, places.as_ref(), channel.width, stream)?,
            None => write_channel(mesh, i, stream)?,
        }
    }
    if !attachments.channels.is_empty() {
        stream.bytes(b"}")?;
    }
    let sets = [("groups", &attachments.groups, &[][..]), ("materials", &attachments.materials, &attachments.looks)];
    for (kind, labels, looks) in sets {
        if !labels.is_empty() {
            stream.bytes(format!(",\"{kind}\":[").as_bytes())?;
            write_labels(mesh, labels, looks, stream)?;
            stream.bytes(b"]")?;
        }
    }
    if let Some(uvs) = mesh.uvs() {
        stream.bytes(br#","uvs":"#)?;
        write_places(mesh, uvs.as_ref(), 2, stream)?;
    }
    if options.flag(IDS.name) {
        write_origins(mesh, stream)?;
    }
    if options.flag(ISOLINES) { write_isolines(mesh, stream) } else { Ok(()) }
}

fn write_isolines(mesh: &dyn MeshSource, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    stream.bytes(br#","isolines":["#)?;
    stream.each(0..mesh.input_cells()[1], |edge, out| {
        let mut line = Vec::new();
        mesh.isoline(edge, &mut line);
        row(edge, out, |out| line.iter().enumerate().for_each(|(i, &v)| listed(v.into(), i == 0, out)));
    })?;
    stream.bytes(b"]")
}

/// Writes values of corners, `width` numbers each.
fn write_places(
    mesh: &dyn MeshSource,
    places: &dyn PlaceSource,
    width: usize,
    stream: &mut Stream<'_>,
) -> Result<(), FormatError> {
    stream.bytes(br#"{"values":["#)?;
    stream.places(places, |start, numbers, out| rows(start, numbers, width, out))?;
    stream.bytes(br#"],"faces":["#)?;
    stream.place_faces(mesh, places, faces)?;
    stream.bytes(b"]}")
}

/// Makes consecutive entries of `width` numbers each; `start` is the index of the first of them.
fn rows(start: usize, numbers: &[f64], width: usize, out: &mut Bytes) {
    if width > 1 {
        let rows: Vec<&[f64]> = numbers.chunks_exact(width).collect();
        return vectors(start, &rows, out);
    }
    out.append(|out| {
        for (place, &x) in (start..).zip(numbers) {
            comma(place, out);
            real(out, x);
        }
    });
}

/// Writes the sharp vertices and edges, which requests call `corners` and `creases`.
fn write_tags(tags: &CreaseTags, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    write_sharp("corners", &tags.corners, stream, |&(v, sharpness), out| {
        out.extend_from_slice(br#"{"vertex":"#);
        whole(out, v.into());
        sharpness
    })?;
    write_sharp("creases", &tags.creases, stream, |&([a, b], sharpness), out| {
        out.extend_from_slice(br#"{"edge":["#);
        whole(out, a.into());
        out.push(b',');
        whole(out, b.into());
        out.push(b']');
        sharpness
    })
}

/// Writes a list of cells with their sharpness, if it is not empty. `place` appends the cell and returns its sharpness.
fn write_sharp<T: Sync>(
    name: &str,
    entries: &[T],
    stream: &mut Stream<'_>,
    place: impl Fn(&T, &mut Vec<u8>) -> f64 + Sync,
) -> Result<(), FormatError> {
    if entries.is_empty() {
        return Ok(());
    }
    stream.bytes(format!(r#","{name}":["#).as_bytes())?;
    stream.each(0..entries.len(), |i, out| {
        comma(i, out);
        let sharpness = place(&entries[i], out);
        out.extend_from_slice(br#","sharpness":"#);
        real(out, sharpness);
        out.push(b'}');
    })?;
    stream.bytes(b"]")
}

fn write_channel(mesh: &dyn MeshSource, i: usize, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    let width = mesh.attachments().channels[i].width;
    stream.bytes(b"[")?;
    stream.channel(mesh, i, |start, numbers, out| rows(start, numbers, width, out))?;
    stream.bytes(b"]")
}

/// Writes for each name its output faces and, for materials, the look.
fn write_labels(
    mesh: &dyn MeshSource,
    labels: &Labels,
    looks: &[Look],
    stream: &mut Stream<'_>,
) -> Result<(), FormatError> {
    for (i, (name, ranges)) in labels.names.iter().zip(labelled_ranges(mesh, labels)).enumerate() {
        let comma = if i > 0 { "," } else { "" };
        stream.bytes(format!("{comma}{{\"name\":{},\"faces\":[", Value::from(name.as_str())).as_bytes())?;
        let first = ranges.first().map(|range| range.start);
        for range in ranges {
            stream.each(range, |face, out| listed(face as u64, Some(face) == first, out))?;
        }
        stream.bytes(b"]")?;
        if let Some(look) = looks.get(i) {
            looks::write(look, stream)?;
        }
        stream.bytes(b"}")?;
    }
    Ok(())
}

fn write_origins(mesh: &dyn MeshSource, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    stream.bytes(br#","ids":{"faces":["#)?;
    stream.each(0..mesh.n_faces(), |face, out| listed(mesh.face_origin(face).into(), face == 0, out))?;
    stream.bytes(br#"],"vertices":["#)?;
    stream.each(0..mesh.n_vertices(), |vertex, out| {
        let origin = mesh.vertex_origin(vertex);
        out.extend_from_slice(if vertex == 0 { b"[" } else { b",[" });
        whole(out, origin.dimension.into());
        out.push(b',');
        whole(out, origin.cell.into());
        out.push(b']');
    })?;
    stream.bytes(b"]}")
}

/// Appends a number of a list, with a comma before all but the first.
pub(super) fn listed(n: u64, first: bool, out: &mut Vec<u8>) {
    if !first {
        out.push(b',');
    }
    whole(out, n);
}
