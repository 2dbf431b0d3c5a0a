//! How the faces of a glTF model look: materials, and the pictures that they have, which lie at the end of the buffer.

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
use crate::shape::looks::{Alpha, Look, PLAIN, PLAIN_SURFACE, images};
use crate::shape::textures::{self, Filter, Image, Wrap};
use crate::shape::topology::index;

/// Most bytes that a material with a look takes in a document: its numbers, a texture and a sampler.
const LOOK: u128 = 768;
/// Most bytes of a picture in a document, and of its view.
const IMAGE: u128 = 256;

/// Bytes of all pictures, filled up to a multiple of 4.
pub(super) fn bytes_of_images(looks: &[Look]) -> u128 {
    let bytes: u128 = images(looks).iter().map(|image| image.bytes().len() as u128).sum();
    bytes.div_ceil(4) * 4
}

/// Most bytes of what a document says of looks.
pub(super) fn room(looks: &[Look]) -> u128 {
    looks.len() as u128 * LOOK + images(looks).len() as u128 * IMAGE
}

/// Makes the materials of a mesh.
pub(super) struct Looks<'a> {
    attachments: &'a Attachments,
    images: Vec<&'a Arc<Image>>,
    /// Numbers of the colour of vertices, if they have one.
    color: Option<usize>,
}

impl<'a> Looks<'a> {
    /// The looks of what a mesh carries.
    pub(super) fn of(attachments: &'a Attachments) -> Self {
        let color = attachments.color().map(|(_, channel)| channel.width);
        Self { attachments, images: images(&attachments.looks), color }
    }

    /// Adds a material, given by its number, or that of faces without; vertices with colours of their own are white
    /// where nothing else is said, and see-through where their colours say so.
    pub(super) fn add(&self, material: Option<usize>, root: &mut Root) {
        let name = material.map(|material| self.attachments.materials.names[material].as_str());
        let look = self.attachments.look(material);
        let is_white = self.color.is_some() || look.texture.is_some();
        let base = match look.color {
            Some(color) => std::array::from_fn(|k| rounded(linear(k, color[k]))),
            None if is_white => [1.0; 4],
            None => PLAIN,
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

    /// Adds the pictures, in their order, behind everything else in the buffer.
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

/// An opaque material of a colour in linear light, seen from both sides.
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
