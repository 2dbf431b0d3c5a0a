//! The looks of triangles: materials of faces, or colours of vertices.

use std::fmt::Write;

use quick_xml::escape::partial_escape;

use crate::output::colors::{byte, encoded};
use crate::output::error::FormatError;
use crate::output::numbers::whole;
use crate::output::scene::MeshSource;
use crate::output::stream::Stream;
use crate::shape::attachments::{Attachments, Channel};
use crate::shape::looks::DEFAULT_COLOR;

/// Ids of the resources.
const MATERIALS_ID: &str = "1";
const COLORS_ID: &str = "2";

/// The source of the looks of triangles.
#[derive(Debug, Clone, Copy)]
pub(super) enum TriangleMaterials<'a> {
    /// No looks are given.
    Plain,
    /// Each face has a material, or none.
    Materials(&'a dyn MeshSource),
    /// Each vertex has a colour: the channel with this number.
    Colors(&'a dyn MeshSource, usize),
}

/// Returns the channel of colours and its number, if each vertex has one colour.
pub(super) fn color(carried: &Attachments) -> Option<(usize, &Channel)> {
    carried.color().filter(|(_, color)| color.seams.is_none())
}

/// Escapes a text as the value of an attribute in XML.
pub(super) fn escaped(text: &str) -> String {
    partial_escape(text).replace('"', "&quot;")
}

/// Returns a colour in sRGB, 0 to 1, as eight hexadecimal digits.
fn hexadecimal(color: &[f64]) -> String {
    let mut text = "#".to_owned();
    for k in 0..4 {
        // writing to a string cannot fail
        let _ = write!(text, "{:02X}", byte(color.get(k).copied().unwrap_or(1.0)));
    }
    text
}

impl<'a> TriangleMaterials<'a> {
    /// Returns the source of looks of a mesh: colours of vertices take precedence over materials.
    pub(super) fn of(mesh: &'a dyn MeshSource) -> Self {
        let carried = mesh.attachments();
        match color(carried) {
            Some((channel, _)) => Self::Colors(mesh, channel),
            None if carried.materials.is_empty() => Self::Plain,
            None => Self::Materials(mesh),
        }
    }

    /// Writes the resources that triangles refer to.
    pub(super) fn resources(self, stream: &mut Stream<'_>) -> Result<(), FormatError> {
        match self {
            Self::Plain => Ok(()),
            Self::Materials(mesh) => {
                let carried = mesh.attachments();
                let mut text = format!("<basematerials id=\"{MATERIALS_ID}\">\n");
                let plain = DEFAULT_COLOR.map(f64::from);
                let plain = [encoded(plain[0]), encoded(plain[1]), encoded(plain[2]), plain[3]];
                let mut base = |name: &str, color: [f64; 4]| {
                    let (name, color) = (escaped(name), hexadecimal(&color));
                    let _ = writeln!(text, "<base name=\"{name}\" displaycolor=\"{color}\"/>");
                };
                for (i, name) in carried.materials.names.iter().enumerate() {
                    base(name, carried.look(Some(i)).color.unwrap_or(plain));
                }
                if carried.materials.differ() {
                    base(NO_MATERIAL, plain);
                }
                text.push_str("</basematerials>\n");
                stream.bytes(text.as_bytes())
            }
            Self::Colors(mesh, channel) => {
                stream.bytes(format!("<m:colorgroup id=\"{COLORS_ID}\">\n").as_bytes())?;
                let width = mesh.attachments().channels[channel].width;
                stream.channel(mesh, channel, |_, values, out| {
                    out.append(|out| {
                        for color in values.chunks_exact(width) {
                            out.extend_from_slice(b"<m:color color=\"");
                            out.extend_from_slice(hexadecimal(color).as_bytes());
                            out.extend_from_slice(b"\"/>\n");
                        }
                    });
                })?;
                stream.bytes(b"</m:colorgroup>\n")
            }
        }
    }

    /// Returns the attributes of an object: the default look of its triangles.
    pub(super) fn of_object(self) -> String {
        match self {
            Self::Plain => String::new(),
            Self::Materials(mesh) => {
                let materials = &mesh.attachments().materials;
                let usual = if materials.differ() { materials.names.len() } else { 0 };
                format!(" pid=\"{MATERIALS_ID}\" pindex=\"{usual}\"")
            }
            Self::Colors(..) => format!(" pid=\"{COLORS_ID}\" pindex=\"0\""),
        }
    }

    /// Appends the attributes of a triangle of a face.
    pub(super) fn of_triangle(self, triangle: [u32; 3], face: usize, out: &mut Vec<u8>) {
        let mut property = |name: &str, n: u64| {
            out.extend_from_slice(name.as_bytes());
            whole(out, n);
            out.push(b'"');
        };
        match self {
            Self::Plain => {}
            Self::Materials(mesh) => {
                let materials = &mesh.attachments().materials;
                let number = materials.number(mesh.face_origin(face)).filter(|_| materials.differ());
                number.into_iter().for_each(|number| property(" pid=\"1\" p1=\"", number as u64));
            }
            Self::Colors(..) => {
                property(" pid=\"2\" p1=\"", triangle[0].into());
                property(" p2=\"", triangle[1].into());
                property(" p3=\"", triangle[2].into());
            }
        }
    }
}

/// The name of the material of faces that have none.
pub(super) const NO_MATERIAL: &str = "default";
