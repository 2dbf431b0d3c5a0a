//! Materials of glTF: names, faces, looks, and notes on what is left out.

use std::collections::BTreeMap;
use std::sync::Arc;

use gltf::json::material::{AlphaCutoff, AlphaMode, Material};
use gltf::json::texture::{Info, MagFilter, MinFilter, Sampler, WrappingMode};
use gltf::json::validation::Checked::{self, Valid};

use super::buffers::GltfDocument;
use super::packed::PACKED;
use crate::input::colors::encoded;
use crate::input::reader::ReadMesh;
use crate::input::room::MemoryBudget;
use crate::input::text::{first_names, quoted};
use crate::shape::attachments::COLOR_CHANNEL;
use crate::shape::labels::FaceSet;
use crate::shape::looks::{Alpha, DEFAULT_COLOR, Look, PLAIN_SURFACE};
use crate::shape::textures::{Filter, Image, Texture, Wrap};

/// Parts of the names of extensions that affect looks: those of materials, those that transform textures or add picture
/// formats, and the techniques of glTF 1.0.
const LOOK_EXTENSIONS: [&str; 3] = ["KHR_materials_", "_texture_", "KHR_technique"];

/// Extensions that are read, or that may be ignored: with `MSFT_lod` the finest level is the document itself.
const READ_EXTENSIONS: [&str; 3] = [PACKED, "KHR_mesh_quantization", "MSFT_lod"];

/// Adds the materials with their faces, given by material index, to the mesh in order.
pub(super) fn finish(
    document: &GltfDocument<'_>,
    faces: BTreeMap<usize, Vec<u64>>,
    room: &mut MemoryBudget,
    mesh: &mut ReadMesh,
) {
    // under vertex colours, white is the plain colour
    let is_colored = mesh.channels.iter().any(|channel| channel.name == COLOR_CHANNEL);
    let plain = if is_colored { [1.0; 4] } else { DEFAULT_COLOR };
    let has_uvs = mesh.uvs.is_some();
    let mut looks = MaterialReader { document, images: BTreeMap::new(), left_out: BTreeMap::new(), has_uvs, plain };
    let materials = &document.root.materials;
    let name_of = |i: usize| materials.get(i).and_then(|material| material.name.clone());
    let nameless = faces.keys().filter(|&&i| name_of(i).is_none()).count();
    for (i, faces) in faces {
        let look = materials.get(i).map(|material| looks.of(material, room)).unwrap_or_default();
        // a single nameless material with a plain look is dropped
        if nameless == 1 && name_of(i).is_none() && (look.is_silent() || is_usual(&look)) {
            continue;
        }
        mesh.materials.push(FaceSet { name: name_of(i).unwrap_or_else(|| format!("material {i}")), faces });
        mesh.looks.push(look);
    }
    for (what, n) in looks.left_out {
        mesh.notes.push(format!("{what}: {n}"));
    }
    let (of_looks, others): (Vec<&String>, Vec<&String>) = (document.root.extensions_used.iter())
        .filter(|name| !READ_EXTENSIONS.contains(&name.as_str()))
        .partition(|name| LOOK_EXTENSIONS.iter().any(|part| name.contains(part)));
    for (what, names) in [("extensions of materials", of_looks), ("extensions", others)] {
        if !names.is_empty() {
            let names = first_names(names.into_iter().map(|name| quoted(name)));
            mesh.notes.push(format!("{what} are left out: {names}"));
        }
    }
}

/// Whether the look is the default material of glTF.
fn is_usual(look: &Look) -> bool {
    let plain = (look.metallic, look.roughness, look.double_sided) == (Some(1.0), Some(1.0), Some(false));
    plain && look.color == Some([1.0; 4]) && look.alpha == Some(Alpha::Opaque) && look.texture.is_none()
}

/// Reads looks, and each picture once.
struct MaterialReader<'a> {
    document: &'a GltfDocument<'a>,
    /// The pictures by index; `None` if a picture cannot be read.
    images: BTreeMap<usize, Option<Arc<Image>>>,
    /// The features that are left out, with their number.
    left_out: BTreeMap<String, usize>,
    has_uvs: bool,
    /// The colour that planish writes for materials without one.
    plain: [f32; 4],
}

impl MaterialReader<'_> {
    /// Reads the look of a material. Values that planish writes as defaults are read as absent.
    fn of(&mut self, material: &Material, room: &mut MemoryBudget) -> Look {
        self.note_left_out(material);
        let pbr = &material.pbr_metallic_roughness;
        let surface = [pbr.metallic_factor.0, pbr.roughness_factor.0];
        let factor = pbr.base_color_factor.0;
        let texture = pbr.base_color_texture.as_ref().and_then(|info| self.texture(info, room));
        let is_plain = bits(&factor) == bits(&self.plain) && bits(&surface) == bits(&PLAIN_SURFACE);
        if is_plain && material.double_sided && texture.is_none() {
            return Look::default();
        }
        let within = |x: f32| f64::from(x).clamp(0.0, 1.0);
        let [red, green, blue, alpha] = factor.map(within);
        let AlphaCutoff(cutoff) = material.alpha_cutoff.unwrap_or_default();
        Look {
            color: Some([encoded(red), encoded(green), encoded(blue), alpha]),
            metallic: Some(within(surface[0])),
            roughness: Some(within(surface[1])),
            double_sided: Some(material.double_sided),
            alpha: Some(match material.alpha_mode {
                Valid(AlphaMode::Mask) => Alpha::Mask(within(cutoff)),
                Valid(AlphaMode::Blend) => Alpha::Blend,
                _ => Alpha::Opaque,
            }),
            texture,
        }
    }

    fn leave_out(&mut self, what: impl Into<String>) {
        *self.left_out.entry(what.into()).or_default() += 1;
    }

    fn note_left_out(&mut self, material: &Material) {
        let pbr = &material.pbr_metallic_roughness;
        let glows = material.emissive_factor.0.iter().any(|&x| x > 0.0);
        let kinds = [
            ("textures of metalness and roughness are left out", pbr.metallic_roughness_texture.is_some()),
            ("textures of normals are left out", material.normal_texture.is_some()),
            ("textures of occlusion are left out", material.occlusion_texture.is_some()),
            ("light that materials give off is left out", glows || material.emissive_texture.is_some()),
        ];
        kinds.into_iter().filter(|(_, is_there)| *is_there).for_each(|(what, _)| self.leave_out(what));
    }

    fn texture(&mut self, info: &Info, room: &mut MemoryBudget) -> Option<Texture> {
        if info.tex_coord != 0 {
            self.leave_out("textures that lie by another set of texture coordinates than the first are left out");
            return None;
        }
        if !self.has_uvs {
            self.leave_out("textures without texture coordinates are left out");
            return None;
        }
        let root = &self.document.root;
        let texture = root.textures.get(info.index.value());
        let Some(texture) = texture else {
            self.leave_out(format!("textures that are not in the file are left out, such as {}", info.index.value()));
            return None;
        };
        let sampler = texture.sampler.and_then(|sampler| root.samplers.get(sampler.value()));
        let image = self.image(texture.source.value(), room)?;
        Some(sampler.map_or_else(|| Texture::new(image.clone()), |sampler| sampled(image.clone(), sampler)))
    }

    /// Reads a picture by index; a picture that cannot be read is reported in a note.
    fn image(&mut self, i: usize, room: &mut MemoryBudget) -> Option<Arc<Image>> {
        if let Some(known) = self.images.get(&i) {
            return known.clone();
        }
        let found = self.read(i, room).map(Arc::new);
        let found =
            found.map_err(|detail| self.leave_out(format!("pictures that are left out, as of one {detail}"))).ok();
        self.images.insert(i, found.clone());
        found
    }

    fn read(&self, i: usize, room: &mut MemoryBudget) -> Result<Image, String> {
        let image = self.document.root.images.get(i).ok_or("that it has no PNG or JPEG can be said")?;
        let bytes = match (&image.uri, image.buffer_view) {
            (Some(uri), _) => self.document.referred(uri, room)?,
            (None, Some(view)) => {
                let (bytes, _) = self.document.view(view)?;
                room.take(bytes.len())?;
                bytes.to_vec()
            }
            (None, None) => return Err("it has neither a URI nor a bufferView".to_owned()),
        };
        Image::new(bytes)
    }
}

fn bits<const N: usize>(numbers: &[f32; N]) -> [u32; N] {
    numbers.map(f32::to_bits)
}

/// Combines a picture with the wrapping and filters of its sampler.
fn sampled(image: Arc<Image>, sampler: &Sampler) -> Texture {
    let wrap = |wrap: &Checked<WrappingMode>| match wrap {
        Valid(WrappingMode::ClampToEdge) => Wrap::ClampToEdge,
        Valid(WrappingMode::MirroredRepeat) => Wrap::MirroredRepeat,
        _ => Wrap::Repeat,
    };
    let magnify = match sampler.mag_filter {
        Some(Valid(MagFilter::Nearest)) => Some(Filter::Nearest),
        Some(Valid(MagFilter::Linear)) => Some(Filter::Linear),
        _ => None,
    };
    let minify = match sampler.min_filter {
        Some(Valid(MinFilter::Nearest)) => Some(Filter::Nearest),
        Some(Valid(MinFilter::Linear)) => Some(Filter::Linear),
        Some(Valid(MinFilter::NearestMipmapNearest)) => Some(Filter::NearestMipmapNearest),
        Some(Valid(MinFilter::LinearMipmapNearest)) => Some(Filter::LinearMipmapNearest),
        Some(Valid(MinFilter::NearestMipmapLinear)) => Some(Filter::NearestMipmapLinear),
        Some(Valid(MinFilter::LinearMipmapLinear)) => Some(Filter::LinearMipmapLinear),
        _ => None,
    };
    Texture { image, wrap: [wrap(&sampler.wrap_s), wrap(&sampler.wrap_t)], magnify, minify }
}
