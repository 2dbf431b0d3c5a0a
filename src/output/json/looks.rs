//! The looks of materials, in the notation of requests.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use crate::output::error::FormatError;
use crate::output::numbers::{REAL_BYTES, reals};
use crate::output::stream::Stream;
use crate::shape::looks::{Alpha, Look};
use crate::shape::textures::{Filter, Texture};

/// Maximum number of bytes of the entries of a material without numbers and images.
const MATERIAL_ENTRY_BYTES: u128 = 512;

/// Bytes of an image that are written at once, a multiple of three. Half or twice of it gives the same text.
const IMAGE_PART_BYTES: usize = 48 << 10;

/// Returns the maximum number of bytes of the entries of looks.
pub(super) fn size(looks: &[Look]) -> u128 {
    let picture = |texture: &Texture| (texture.image.bytes().len() as u128).div_ceil(3) * 4;
    looks
        .iter()
        .map(|look| MATERIAL_ENTRY_BYTES + 7 * (REAL_BYTES + 1) + look.texture.as_ref().map_or(0, picture))
        .sum()
}

/// Writes the entries of a look that are given, each after a comma.
pub(super) fn write(look: &Look, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    let Look { color, metallic, roughness, double_sided, alpha, texture } = look;
    let mut out = Vec::new();
    if let Some(color) = color {
        out.extend_from_slice(br#","color":["#);
        reals(&mut out, color, b',');
        out.push(b']');
    }
    let cutoff = if let Some(Alpha::Mask(cutoff)) = *alpha { Some(cutoff) } else { None };
    for (name, number) in [("metallic", *metallic), ("roughness", *roughness), ("alpha_cutoff", cutoff)] {
        if let Some(number) = number {
            out.extend_from_slice(format!(r#","{name}":"#).as_bytes());
            reals(&mut out, &[number], b',');
        }
    }
    if let Some(alpha) = alpha {
        out.extend_from_slice(format!(r#","alpha_mode":"{}""#, alpha.name()).as_bytes());
    }
    if let Some(double_sided) = double_sided {
        out.extend_from_slice(format!(r#","double_sided":{double_sided}"#).as_bytes());
    }
    stream.bytes(&out)?;
    texture.as_ref().map_or(Ok(()), |texture| write_texture(texture, stream))
}

fn write_texture(texture: &Texture, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    let Texture { image, wrap: [s, t], magnify, minify } = texture;
    let (s, t, kind) = (s.name(), t.name(), image.kind().media_type());
    let filter = |name: &str, filter: &Option<Filter>| {
        filter.map_or_else(String::new, |filter| format!(r#","{name}":"{}""#, filter.name()))
    };
    let filters = filter("mag_filter", magnify) + &filter("min_filter", minify);
    let head = format!(r#","texture":{{"wrap_s":"{s}","wrap_t":"{t}"{filters},"image":"data:{kind};base64,"#);
    stream.bytes(head.as_bytes())?;
    for part in image.bytes().chunks(IMAGE_PART_BYTES) {
        stream.bytes(STANDARD.encode(part).as_bytes())?;
    }
    stream.bytes(br#""}"#)
}
