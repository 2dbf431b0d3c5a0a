//! The looks of faces of a glTF model: materials, and their images at the end of the buffer.

use std::sync::Arc;

use gltf::json::image::MimeType;
use gltf::json::material::{
    AlphaCutoff, AlphaMode, Material, PbrBaseColorFactor, PbrMetallicRoughness, StrengthFactor,
};
use gltf::json::texture::{Info, MagFilter, MinFilter, Sampler, WrappingMode};
use gltf::json::validation::Checked::Valid;
use gltf::json::{self, Extras, Index, Root, Texture};

use crate::output::colors::linear;
use crate::output::gltf_views::Views;
use crate::output::numbers::rounded;
use crate::shape::attachments::Attachments;
use crate::shape::looks::{Alpha, DEFAULT_COLOR, Look, PLAIN_SURFACE, images};
use crate::shape::textures::{self, Filter, Image, Wrap};
use crate::shape::topology::index;

/// Maximum number of bytes of a material with a look in a document: its numbers, a texture and a sampler.
const MAX_LOOK_BYTES: u128 = 768;
/// Maximum number of bytes of an image in a document, and of its view.
const IMAGE_BYTES: u128 = 256;

/// Returns the bytes of all images, each padded to a multiple of 4.
pub(super) fn bytes_of_images(looks: &[Look]) -> u128 {
    images(looks).iter().map(|image| (image.bytes().len() as u128).next_multiple_of(4)).sum()
}

/// Returns the maximum number of bytes of looks in a document.
pub(super) fn room(looks: &[Look]) -> u128 {
    looks.len() as u128 * MAX_LOOK_BYTES + images(looks).len() as u128 * IMAGE_BYTES
}

/// Makes the materials of a mesh.
pub(super) struct MaterialWriter<'a> {
    attachments: &'a Attachments,
    images: Vec<&'a Arc<Image>>,
    /// Number of components of the colour of vertices, if they have one.
    color: Option<usize>,
}

impl<'a> MaterialWriter<'a> {
    /// Returns the looks of the attachments of a mesh.
    pub(super) fn of(attachments: &'a Attachments) -> Self {
        let color = attachments.color().map(|(_, channel)| channel.width);
        Self { attachments, images: images(&attachments.looks), color }
    }

    /// Adds a material, given by its number, or the material of faces without one. If vertices have colours, a material
    /// without a colour is white, and a material without an alpha mode is blended if these colours have alpha.
    pub(super) fn add(&self, material: Option<usize>, root: &mut Root) {
        let name = material.map(|material| self.attachments.materials.names[material].as_str());
        let look = self.attachments.look(material);
        let is_white = self.color.is_some() || look.texture.is_some();
        let base = match look.color {
            Some(color) => std::array::from_fn(|k| rounded(linear(k, color[k]))),
            None if is_white => [1.0; 4],
            None => DEFAULT_COLOR,
        };
        let alpha = if look.alpha.is_none() && self.color == Some(4) { Alpha::Blend } else { look.alpha() };
        let mut made = surface(base, name);
        let number = |said: Option<f64>, otherwise| StrengthFactor(said.map_or(otherwise, rounded));
        made.pbr_metallic_roughness.metallic_factor = number(look.metallic, PLAIN_SURFACE[0]);
        made.pbr_metallic_roughness.roughness_factor = number(look.roughness, PLAIN_SURFACE[1]);
        made.double_sided = look.double_sided.unwrap_or(true);
        (made.alpha_mode, made.alpha_cutoff) = match alpha {
            Alpha::Opaque => (Valid(AlphaMode::Opaque), None),
            Alpha::Mask(cutoff) => (Valid(AlphaMode::Mask), Some(AlphaCutoff(rounded(cutoff)))),
            Alpha::Blend => (Valid(AlphaMode::Blend), None),
        };
        made.pbr_metallic_roughness.base_color_texture = look.texture.map(|texture| self.texture(&texture, root));
        root.materials.push(made);
    }

    /// Adds a texture.
    fn texture(&self, texture: &textures::Texture, root: &mut Root) -> Info {
        let image = self.images.iter().position(|image| **image == texture.image).unwrap_or_default();
        let sampler = root.push(sampler(texture));
        let source = Index::new(index(image));
        let made = Texture { name: None, sampler: Some(sampler), source, extensions: None, extras: Extras::default() };
        Info { index: root.push(made), tex_coord: 0, extensions: None, extras: Extras::default() }
    }

    /// Adds the images, in their order, after everything else in the buffer.
    pub(super) fn add_images(&self, root: &mut Root) {
        for image in &self.images {
            let view = Views::of(root).loose(image.bytes().len() as u128);
            root.images.push(json::Image {
                buffer_view: Some(Index::new(view)),
                mime_type: Some(MimeType(image.kind().media_type().to_owned())),
                name: None,
                uri: None,
                extensions: None,
                extras: Extras::default(),
            });
        }
    }
}

/// Returns an opaque material of a colour in linear light, visible from both sides.
pub(super) fn surface(base: [f32; 4], name: Option<&str>) -> Material {
    Material {
        name: name.map(Into::into),
        double_sided: true,
        alpha_mode: Valid(AlphaMode::Opaque),
        pbr_metallic_roughness: PbrMetallicRoughness {
            base_color_factor: PbrBaseColorFactor(base),
            metallic_factor: StrengthFactor(PLAIN_SURFACE[0]),
            roughness_factor: StrengthFactor(PLAIN_SURFACE[1]),
            ..PbrMetallicRoughness::default()
        },
        ..Material::default()
    }
}

fn sampler(texture: &textures::Texture) -> Sampler {
    let wrap = |wrap| match wrap {
        Wrap::Repeat => WrappingMode::Repeat,
        Wrap::MirroredRepeat => WrappingMode::MirroredRepeat,
        Wrap::ClampToEdge => WrappingMode::ClampToEdge,
    };
    let [wrap_s, wrap_t] = texture.wrap.map(|side| Valid(wrap(side)));
    let magnify = |filter| if filter == Filter::Nearest { MagFilter::Nearest } else { MagFilter::Linear };
    let minify = |filter| match filter {
        Filter::Nearest => MinFilter::Nearest,
        Filter::Linear => MinFilter::Linear,
        Filter::NearestMipmapNearest => MinFilter::NearestMipmapNearest,
        Filter::LinearMipmapNearest => MinFilter::LinearMipmapNearest,
        Filter::NearestMipmapLinear => MinFilter::NearestMipmapLinear,
        Filter::LinearMipmapLinear => MinFilter::LinearMipmapLinear,
    };
    Sampler {
        mag_filter: texture.magnify.map(|filter| Valid(magnify(filter))),
        min_filter: texture.minify.map(|filter| Valid(minify(filter))),
        wrap_s,
        wrap_t,
        ..Sampler::default()
    }
}
