//! MTL: the library of materials beside an OBJ file.

use crate::fault::Fault;
use crate::math::parameter::{Parameter, ParameterKind, Values};
use crate::output::counts::{Counts, ShapeKind};
use crate::output::error::FormatError;
use crate::output::format::{Content, Costs, Format, FormatFacts, Requirements};
use crate::output::left_out::{Datum, left_out};
use crate::output::numbers::{REAL_BYTES, reals, total};
use crate::output::scene::{Scene, Shape};
use crate::output::size::Size;
use crate::output::stream::Stream;
use crate::shape::attachments::Attachments;
use crate::shape::looks::{Look, images};
use crate::shape::textures::{Image, ImageKind, Wrap};

/// The first line.
const FIRST_LINE: &[u8] = b"# planish\n";

/// Bytes of a material besides its names and its numbers.
const MATERIAL_WORDS_BYTES: u128 = b"newmtl \nKd   \nd \nPm \nPr \nmap_Kd -clamp on -256.jpg\n".len() as u128;

/// The option of textures.
const TEXTURES: Parameter = Parameter::optional(
    "textures",
    ParameterKind::Name,
    "What the names of the files with the textures begin with: \"wall\" names wall-1.png, wall-2.jpg, ..., in the \
     order in which materials first have them; left out, no texture is named.",
);

/// The materials of a mesh as a library for OBJ files: `newmtl` with the name, and, as far as they are given, `Kd`
/// (red, green, blue as given), `d` (alpha), `Pm` (metallic), `Pr` (roughness), and `map_Kd` if textures have file
/// names. MTL cannot hold the alpha mode and the visible sides. The library of a mesh without materials has its first
/// line only.
#[derive(Debug)]
pub(super) struct Mtl;

const FACTS: &FormatFacts = &FormatFacts {
    name: "mtl",
    extension: "mtl",
    media_type: "model/mtl",
    content: Content::Text,
    doc: "The library of materials of a mesh, for the obj output of the same job: colours, alpha, metalness, roughness",
    parameters: &[TEXTURES],
    holds_frames: true,
    holds: |kind, _| kind.only_meshes("curves have no materials; ask for obj alone"),
    ..FormatFacts::USUAL
};

impl Format for Mtl {
    fn facts(&self) -> &'static FormatFacts {
        FACTS
    }

    fn encode(&self, scene: &Scene<'_>, options: &Values, stream: &mut Stream<'_>) -> Result<(), FormatError> {
        let Shape::Mesh(mesh) = scene.shape else { return Ok(()) };
        stream.watch.check()?;
        stream.bytes(&library(mesh.attachments(), options.name(TEXTURES.name)))
    }
}

impl Requirements for Mtl {
    fn suits(&self, _: ShapeKind, _: &Attachments, options: &Values) -> Result<(), Fault> {
        check_file_name(&TEXTURES, options)
    }

    fn leaves_out(&self, carried: &Attachments, options: &Values) -> Vec<String> {
        let mut sentences = unheld(carried);
        let has_textures = carried.looks.iter().any(|look| look.texture.is_some());
        if has_textures && options.name(TEXTURES.name).is_none() {
            let sentence = "textures are left out, as nothing says how their files are called; give \"textures\"";
            sentences.push(sentence.to_owned());
        }
        sentences
    }
}

impl Costs for Mtl {
    fn size(&self, counts: &Counts, options: &Values) -> Size {
        let names = &counts.attachments.materials;
        let material =
            MATERIAL_WORDS_BYTES + 6 * REAL_BYTES + options.name(TEXTURES.name).map_or(0, |stem| stem.len() as u128);
        let rows =
            [(1, FIRST_LINE.len() as u128), (names.names.len() as u128, material), (1, names.name_bytes() as u128)];
        Size::AtMost(total(&rows))
    }
}

/// Returns sentences about the attachments of a mesh that libraries cannot hold.
pub fn unheld(carried: &Attachments) -> Vec<String> {
    left_out("mtl", "glb or json", carried, &[Datum::AlphaMode, Datum::Sides])
}

/// Returns the library of the materials of a mesh; textures are named if `textures`, the start of their names, is
/// given.
pub fn library(carried: &Attachments, textures: Option<&str>) -> Vec<u8> {
    let images = images(&carried.looks);
    let mut text = FIRST_LINE.to_vec();
    for (i, name) in carried.materials.names.iter().enumerate() {
        text.extend_from_slice(b"newmtl ");
        text.extend_from_slice(name.as_bytes());
        text.push(b'\n');
        let look = carried.look(Some(i));
        write_look(&look, &mut text);
        if let (Some(stem), Some(texture)) = (textures, &look.texture) {
            let number = images.iter().position(|image| **image == texture.image).unwrap_or_default();
            let clamp = if texture.wrap == [Wrap::ClampToEdge; 2] { "-clamp on " } else { "" };
            let name = file_name(stem, number, &texture.image);
            text.extend_from_slice(format!("map_Kd {clamp}{name}\n").as_bytes());
        }
    }
    text
}

/// Returns the name of the file of a texture, given its number among those of a mesh, from 0.
pub fn file_name(stem: &str, number: usize, image: &Image) -> String {
    let extension = match image.kind() {
        ImageKind::Png => "png",
        ImageKind::Jpeg => "jpg",
    };
    format!("{stem}-{}.{extension}", number + 1)
}

/// Refuses file names that OBJ and MTL cannot tell from several words or a comment.
pub(super) fn check_file_name(option: &Parameter, options: &Values) -> Result<(), Fault> {
    let is_word = |name: &str| !name.chars().any(|c| c.is_whitespace() || c.is_control() || c == '#');
    match options.name(option.name) {
        Some(name) if !is_word(name) => {
            let detail = "a name of a file has no place for blanks, control characters and #";
            Err(Fault::new(format!("/{}", option.name), detail))
        }
        _ => Ok(()),
    }
}

/// Appends the numbers that a look defines.
fn write_look(look: &Look, out: &mut Vec<u8>) {
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
