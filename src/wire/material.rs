//! Materials as clients write them.

use std::sync::Arc;

use serde::Deserialize;
use utoipa::ToSchema;

use super::choice::choice;
use super::{object, schema, whole};
use crate::fault::{Fault, under};
use crate::input::from_base64;
use crate::shape::labels::FaceSet;
use crate::shape::looks::{Alpha, Look};
use crate::shape::textures::{Filter, Image, Texture, Wrap};

/// What is multiplied with textures that are masked, where nothing else is said. Source: glTF 2.0, section 5.19.8.
pub(crate) const USUAL_CUTOFF: f64 = 0.5;

/// Some faces under one name, and how they look. Pictures and glTF show what is said here; what is left out is left to
/// them.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct MaterialRequest {
    /// The name: 1 to 64 bytes without blanks, control characters and `#`.
    pub name: String,
    /// Faces, counted from 0.
    #[serde(deserialize_with = "whole::list")]
    pub faces: Vec<u64>,
    /// Red, green, blue and perhaps alpha (1 when left out), sRGB from 0 to 1.
    #[schema(schema_with = schema::color)]
    pub color: Option<Vec<f64>>,
    /// From 0, as plastic and wood, to 1, as bare metal.
    #[schema(minimum = 0, maximum = 1)]
    pub metallic: Option<f64>,
    /// From 0, as a mirror, to 1, as chalk.
    #[schema(minimum = 0, maximum = 1)]
    pub roughness: Option<f64>,
    /// Whether faces are seen from their inside, too; true when left out.
    pub double_sided: Option<bool>,
    /// What alpha does; left out, `blend` where that of the color is below 1, else `opaque`.
    pub alpha_mode: Option<AlphaModeRequest>,
    /// The alpha below which nothing is seen, where `alpha_mode` is `mask`; 0.5 when left out.
    #[schema(minimum = 0, maximum = 1)]
    pub alpha_cutoff: Option<f64>,
    /// A picture over the faces, multiplied with their color; white when that is left out.
    #[serde(default, deserialize_with = "object::optional")]
    pub texture: Option<TextureRequest>,
}

choice! {
    /// What alpha does.
    pub enum AlphaModeRequest {
        /// Nothing.
        Opaque = "opaque",
        /// What has at least `alpha_cutoff` is opaque, the rest is not there.
        Mask = "mask",
        /// It says how much hides what lies behind.
        Blend = "blend",
    }
}

/// A picture over faces, laid by the mesh's `uvs`: 0 to 1 are its width, and its height from the lower edge upwards.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct TextureRequest {
    /// A PNG or JPEG as a data URI: `data:image/png;base64,...`.
    #[schema(pattern = "^data:image/(png|jpeg);base64,")]
    pub image: String,
    /// What lies beyond the left and right side; `repeat` when left out.
    pub wrap_s: Option<WrapRequest>,
    /// What lies beyond the upper and lower side; `repeat` when left out.
    pub wrap_t: Option<WrapRequest>,
    /// How pixels look that are larger than those they are shown with: `nearest` or `linear`.
    pub mag_filter: Option<FilterRequest>,
    /// How pixels look that are smaller.
    pub min_filter: Option<FilterRequest>,
}

choice! {
    /// What lies beyond the sides of a picture.
    pub enum WrapRequest means Wrap {
        /// The picture again.
        Repeat = "repeat",
        /// The picture turned over, then as it is, in turns.
        MirroredRepeat = "mirrored-repeat",
        /// The pixels along the side.
        ClampToEdge = "clamp-to-edge",
    }
}

choice! {
    /// How a picture is filtered.
    pub enum FilterRequest means Filter {
        /// The pixel that is nearest.
        Nearest = "nearest",
        /// A mean of the four that are nearest.
        Linear = "linear",
        /// The nearest pixel of the smaller copy whose pixels fit best.
        NearestMipmapNearest = "nearest-mipmap-nearest",
        /// A mean of the four nearest of that copy.
        LinearMipmapNearest = "linear-mipmap-nearest",
        /// A mean of the nearest pixels of two copies.
        NearestMipmapLinear = "nearest-mipmap-linear",
        /// A mean of the four nearest of two copies.
        LinearMipmapLinear = "linear-mipmap-linear",
    }
}

/// The faces of materials, and how each looks; their numbers are unchecked.
///
/// # Errors
/// What is no colour, no mask or no picture, with pointers below the mesh.
pub(super) fn materials(requests: Vec<MaterialRequest>) -> Result<(Vec<FaceSet>, Vec<Look>), Vec<Fault>> {
    let (mut sets, mut looks, mut faults) = (Vec::new(), Vec::new(), Vec::new());
    // pictures that several materials have are kept once
    let mut images: Vec<(String, Arc<Image>)> = Vec::new();
    for (i, mut request) in requests.into_iter().enumerate() {
        let set = FaceSet { name: std::mem::take(&mut request.name), faces: std::mem::take(&mut request.faces) };
        match request.look(&mut images) {
            Ok(look) => looks.push(look),
            Err(fault) => faults.extend(under(&format!("/materials/{i}"), vec![fault])),
        }
        sets.push(set);
    }
    if faults.is_empty() { Ok((sets, looks)) } else { Err(faults) }
}

impl MaterialRequest {
    fn look(self, images: &mut Vec<(String, Arc<Image>)>) -> Result<Look, Fault> {
        let color = match self.color.as_deref() {
            None => None,
            Some(&[red, green, blue]) => Some([red, green, blue, 1.0]),
            Some(&[red, green, blue, alpha]) => Some([red, green, blue, alpha]),
            Some(other) => {
                let detail = format!("{} numbers; a color has 3 or 4: red, green, blue, perhaps alpha", other.len());
                return Err(Fault::new("/color", detail));
            }
        };
        let alpha = match (self.alpha_mode, self.alpha_cutoff) {
            (Some(AlphaModeRequest::Mask), cutoff) => Some(Alpha::Mask(cutoff.unwrap_or(USUAL_CUTOFF))),
            (_, Some(_)) => {
                return Err(Fault::new("/alpha_cutoff", "only \"alpha_mode\": \"mask\" has one; say so"));
            }
            (Some(AlphaModeRequest::Opaque), None) => Some(Alpha::Opaque),
            (Some(AlphaModeRequest::Blend), None) => Some(Alpha::Blend),
            (None, None) => None,
        };
        let texture = self.texture.map(|texture| texture.resolve(images)).transpose();
        let texture = texture.map_err(|fault| fault.under("/texture"))?;
        let Self { metallic, roughness, double_sided, .. } = self;
        Ok(Look { color, metallic, roughness, double_sided, alpha, texture })
    }
}

impl TextureRequest {
    fn resolve(self, images: &mut Vec<(String, Arc<Image>)>) -> Result<Texture, Fault> {
        let fault = |detail: String| Fault::new("/image", detail);
        let known = images.iter().find(|(uri, _)| *uri == self.image).map(|(_, image)| image.clone());
        let image = if let Some(image) = known {
            image
        } else {
            let data = self.image.strip_prefix("data:image/").and_then(|rest| rest.split_once(";base64,"));
            let (_, data) = data.ok_or_else(|| {
                fault("no data URI of a picture; write \"data:image/png;base64,...\" or \"data:image/jpeg;...\"".into())
            })?;
            let image = Arc::new(from_base64(data).and_then(Image::new).map_err(fault)?);
            images.push((self.image, image.clone()));
            image
        };
        let wrap = [self.wrap_s, self.wrap_t].map(|wrap| wrap.map(Into::into).unwrap_or_default());
        let [magnify, minify] = [self.mag_filter, self.min_filter].map(|filter| filter.map(Into::into));
        Ok(Texture { image, wrap, magnify, minify })
    }
}
