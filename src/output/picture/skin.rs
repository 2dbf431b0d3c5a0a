//! The looks of the materials of a mesh in a picture: a colour each, and perhaps an image over it.

use std::io::Cursor;
use std::sync::Arc;

use image::{ImageFormat, ImageReader};
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use crate::output::colors::linear;
use crate::output::error::FormatError;
use crate::output::numbers::rounded;
use crate::raster::{Cover, Swatch, Texels, WrapMode};
use crate::shape::attachments::Attachments;
use crate::shape::looks::{Alpha, Look};
use crate::shape::textures::{Filter, Image, ImageKind, Texture, Wrap};
use crate::watch::Watch;

/// Bytes of memory for each pixel while an image is decoded: as it is stored (at most 8), its coefficients (6) or its
/// bytes (3), and the texels that are kept with their smaller copies (4).
const DECODED_PIXEL_BYTES: u128 = 18;
/// Pixels of an image that are decoded in the time of a row, 100 ns. Half or twice of it predicts twice or half the
/// time.
const DECODED_PIXELS_A_ROW: u128 = 4;

/// Returns whether materials give faces a look of their own.
pub(super) fn is_said(carried: &Attachments) -> bool {
    let shows =
        |look: &Look| look.color.is_some() || look.texture.is_some() || is_metal(look) || look.roughness.is_some();
    carried.looks.iter().any(shows)
}

fn is_metal(look: &Look) -> bool {
    look.metallic.is_some_and(|metallic| metallic > 0.0)
}

/// Returns whether some material is more than one opaque colour.
pub(super) fn is_rich(swatches: &[Swatch]) -> bool {
    let is_rich = |swatch: &Swatch| swatch.alpha < 1.0 || swatch.metal > 0.0 || swatch.roughness.is_some();
    swatches.iter().any(|swatch| swatch.cover.is_some() || is_rich(swatch))
}

/// Returns whether some material has an image.
pub(super) fn has_images(carried: &Attachments) -> bool {
    carried.looks.iter().any(|look| look.texture.is_some())
}

/// Returns the memory for the images of materials, bytes.
pub(super) fn memory(carried: &Attachments) -> u128 {
    pixels(carried) * DECODED_PIXEL_BYTES
}

/// Returns the work of decoding the images, rows.
pub(super) fn work(carried: &Attachments) -> u128 {
    pixels(carried) / DECODED_PIXELS_A_ROW
}

fn pixels(carried: &Attachments) -> u128 {
    pictures(carried).iter().map(|(image, _)| image.size().map(u128::from).iter().product::<u128>()).sum()
}

/// Returns the images of materials, each once per use with alpha (`true`) and without.
fn pictures(carried: &Attachments) -> Vec<(&Arc<Image>, bool)> {
    let mut found = Vec::new();
    for look in &carried.looks {
        let picture = look.texture.as_ref().map(|texture| (&texture.image, keeps_alpha(look)));
        found.extend(picture.filter(|picture| !found.contains(picture)));
    }
    found
}

/// Returns a swatch for each material, and at the end one for faces without a material.
///
/// # Errors
/// An image that cannot be decoded, or a stopped watch.
pub(super) fn swatches(carried: &Attachments, plain: [f32; 3], watch: &Watch) -> Result<Vec<Swatch>, FormatError> {
    let images = pictures(carried);
    let mut texels = Vec::with_capacity(images.len());
    for (image, keeps_alpha) in &images {
        watch.check()?;
        texels.push(Arc::new(decoded(image, *keeps_alpha)?));
    }
    let cover = |look: &Look| {
        let texture = look.texture.as_ref()?;
        let wanted = (&texture.image, keeps_alpha(look));
        let image = images.iter().position(|(image, keeps_alpha)| (*image, *keeps_alpha) == wanted)?;
        Some(cover(texture, texels[image].clone()))
    };
    let swatch = |look: &Look| {
        let (cover, metal, roughness) = (cover(look), look.metallic.map_or(0.0, rounded), look.roughness.map(rounded));
        let (alpha, cutoff) = alpha(look, cover.as_ref().is_some_and(|cover| cover.texels.has_alpha()));
        Swatch { color: color(look, plain), alpha, cutoff, metal, roughness, cover }
    };
    let nothing = Swatch { color: plain, alpha: 1.0, cutoff: None, metal: 0.0, roughness: None, cover: None };
    Ok(carried.looks.iter().map(swatch).chain([nothing]).collect())
}

/// Returns the opacity of a material, and for masks with an alpha channel the cutoff below which a texel is not there.
fn alpha(look: &Look, has_alpha: bool) -> (f32, Option<f32>) {
    let given = look.color.map_or(1.0, |color| color[3]);
    match look.alpha() {
        Alpha::Opaque => (1.0, None),
        Alpha::Mask(cutoff) if has_alpha => (rounded(given), Some(rounded(cutoff))),
        Alpha::Mask(cutoff) => (f32::from(u8::from(given >= cutoff)), None),
        Alpha::Blend => (rounded(given), None),
    }
}

/// Returns whether the alpha of the texture of a material has an effect.
fn keeps_alpha(look: &Look) -> bool {
    let is_png = look.texture.as_ref().is_some_and(|texture| texture.image.kind() == ImageKind::Png);
    is_png && look.alpha() != Alpha::Opaque
}

/// Returns the colour of a material in linear light; without one, white under an image and otherwise `plain`.
fn color(look: &Look, plain: [f32; 3]) -> [f32; 3] {
    let said = look.color.map(|color| std::array::from_fn(|k| rounded(linear(k, color[k]))));
    said.unwrap_or(if look.texture.is_some() { [1.0; 3] } else { plain })
}

fn cover(texture: &Texture, texels: Arc<Texels>) -> Cover {
    let beyond = texture.wrap.map(|wrap| match wrap {
        Wrap::Repeat => WrapMode::Repeat,
        Wrap::MirroredRepeat => WrapMode::Mirror,
        Wrap::ClampToEdge => WrapMode::Edge,
    });
    Cover { texels, beyond, nearest: texture.magnify == Some(Filter::Nearest) }
}

/// Decodes an image, with its alpha if `keeps_alpha`.
fn decoded(image: &Image, keeps_alpha: bool) -> Result<Texels, FormatError> {
    let size = image.size().map(|side| side as usize);
    let bytes = match image.kind() {
        ImageKind::Png => png(image, keeps_alpha),
        ImageKind::Jpeg => jpeg(image).map(|bytes| (bytes, Vec::new())),
    };
    let (bytes, alphas) = bytes.map_err(|detail| {
        let kind = image.kind().media_type();
        FormatError::Unfit(format!("a texture ({kind}, {} x {}) cannot be decoded: {detail}", size[0], size[1]))
    })?;
    let (pixels, rest) = bytes.as_chunks::<3>();
    if pixels.len() != size[0] * size[1] || !rest.is_empty() {
        return Err(FormatError::Unfit("a texture has not the size that its head says; send it whole".to_owned()));
    }
    Ok(Texels::new(size, pixels.to_vec(), alphas))
}

/// Decodes a PNG to colours and alphas; no alphas if they are ignored or all opaque.
fn png(image: &Image, keeps_alpha: bool) -> Result<(Vec<u8>, Vec<u8>), String> {
    let [width, height] = image.size();
    let mut reader = ImageReader::with_format(Cursor::new(image.bytes()), ImageFormat::Png);
    let mut limits = image::Limits::default();
    (limits.max_image_width, limits.max_image_height) = (Some(width), Some(height));
    limits.max_alloc = Some(u64::from(width) * u64::from(height) * 8 + (1 << 20));
    reader.limits(limits);
    let decoded = reader.decode().map_err(|error| error.to_string())?;
    if !keeps_alpha || !decoded.color().has_alpha() {
        return Ok((decoded.into_rgb8().into_raw(), Vec::new()));
    }
    let pixels = decoded.into_rgba8().into_raw();
    let (pixels, _) = pixels.as_chunks::<4>();
    let colors = pixels.iter().flat_map(|[red, green, blue, _]| [*red, *green, *blue]).collect();
    let is_clear = pixels.iter().any(|pixel| pixel[3] < u8::MAX);
    Ok((colors, if is_clear { pixels.iter().map(|pixel| pixel[3]).collect() } else { Vec::new() }))
}

/// Decodes a JPEG without instructions that only some machines have, so that all machines get the same bytes.
fn jpeg(image: &Image) -> Result<Vec<u8>, String> {
    let [width, height] = image.size().map(|side| side as usize);
    let options = DecoderOptions::default().set_max_width(width).set_max_height(height);
    let options = options.jpeg_set_out_colorspace(ColorSpace::RGB);
    JpegDecoder::new_with_options(ZCursor::new(image.bytes()), options).decode().map_err(|error| error.to_string())
}
