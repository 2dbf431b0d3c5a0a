//! MTL: the library of materials beside an OBJ file.

use std::io::Write;

use crate::fault::Fault;
use crate::math::parameter::Values;
use crate::output::counts::{Counts, ShapeKind};
use crate::output::error::FormatError;
use crate::output::format::{Content, Format, FormatFacts};
use crate::output::numbers::{REAL, reals, total};
use crate::output::scene::{Scene, Shape};
use crate::output::size::Size;
use crate::shape::attachments::Attachments;
use crate::shape::looks::Look;
use crate::watch::Watch;

/// The first line.
const HEADER: &[u8] = b"# planish\n";

/// The words of a material besides its name and its numbers.
const WORDS: u128 = b"newmtl \nKd   \nd \nPm \nPr \n".len() as u128;

/// The materials of a mesh as a library for OBJ files: `newmtl` with its name, and as far as they are said `Kd` (red,
/// green, blue as they are given), `d` (alpha), `Pm` (metallic) and `Pr` (roughness). What alpha does, which sides are
/// seen and textures have no place in it.
#[derive(Debug)]
pub(super) struct Mtl;

const FACTS: &FormatFacts = &FormatFacts {
    name: "mtl",
    extension: "mtl",
    media_type: "model/mtl",
    content: Content::Text,
    doc: "The library of materials of a mesh, for the obj output of the same job: colours, alpha, metalness, roughness",
    parameters: &[],
    holds_frames: true,
    holds: |kind, _| match kind {
        ShapeKind::Mesh => Ok(()),
        ShapeKind::Curves { .. } => Err("curves have no materials; ask for obj alone".to_owned()),
    },
};

impl Format for Mtl {
    fn facts(&self) -> &'static FormatFacts {
        FACTS
    }

    fn suits(&self, _: ShapeKind, carried: &Attachments, _: &Values) -> Result<(), Fault> {
        let missing = || Fault::new("/format", "the mesh has no materials to tell of; leave it out");
        if carried.materials.is_empty() { Err(missing()) } else { Ok(()) }
    }

    fn size(&self, counts: &Counts, _: &Values) -> Size {
        let names = &counts.attachments.materials;
        let material = WORDS + 6 * REAL;
        let rows = [(1, HEADER.len() as u128), (names.names.len() as u128, material), (1, names.name_bytes() as u128)];
        Size::AtMost(total(&rows))
    }

    fn write(&self, scene: &Scene<'_>, _: &Values, out: &mut dyn Write, watch: &Watch) -> Result<(), FormatError> {
        let Shape::Mesh(mesh) = scene.shape else { return Ok(()) };
        watch.check()?;
        let carried = mesh.attachments();
        let mut text = HEADER.to_vec();
        for (i, name) in carried.materials.names.iter().enumerate() {
            text.extend_from_slice(b"newmtl ");
            text.extend_from_slice(name.as_bytes());
            text.push(b'\n');
            tell(&carried.look(Some(i)), &mut text);
        }
        Ok(out.write_all(&text)?)
    }
}

/// Appends what is said of a look.
fn tell(look: &Look, out: &mut Vec<u8>) {
    let mut line = |keyword: &str, numbers: &[f64]| {
        out.extend_from_slice(keyword.as_bytes());
        out.push(b' ');
        reals(out, numbers, b' ');
        out.push(b'\n');
    };
    if let Some([red, green, blue, alpha]) = look.color {
        line("Kd", &[red, green, blue]);
        line("d", &[alpha]);
    }
    for (keyword, number) in [("Pm", look.metallic), ("Pr", look.roughness)] {
        number.into_iter().for_each(|number| line(keyword, &[number]));
    }
}
