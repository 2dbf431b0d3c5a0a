//! The appearance of faces, as clients write it.

use std::fmt;
use std::sync::Arc;

use serde::Deserialize;
use serde::de::value::SeqAccessDeserializer;
use serde::de::{Deserializer, Error, SeqAccess, Visitor};
use utoipa::ToSchema;

use super::choice::choice;
use crate::fault::Fault;
use crate::input::from_base64;
use crate::math::parameter;
use crate::shape::looks::Alpha;
use crate::shape::textures::{Filter, Image, Texture, Wrap};

/// Default alpha cutoff of masked materials. Source: glTF 2.0, section 5.19.8.
pub(crate) const USUAL_CUTOFF: f64 = 0.5;

/// Declares an object with the fields of the appearance of faces after its own fields.
macro_rules! looks {
    (
        $(#[doc = $about:literal])+
        pub struct $name:ident { $($(#[$of:meta])+ pub $field:ident: $type:ty,)* }
    ) => {
        $(#[doc = $about])+
        #[derive(Debug, Clone, serde::Deserialize, utoipa::ToSchema)]
        #[serde(deny_unknown_fields)]
        pub struct $name {
            $($(#[$of])+ pub $field: $type,)*
            /// Red, green, blue and perhaps alpha (1 when left out), sRGB from 0 to 1; or as a text like `#ff8800`.
            #[serde(default, deserialize_with = "crate::wire::look::color")]
            #[schema(schema_with = crate::wire::schema::color)]
            pub color: Option<[f64; 4]>,
            /// From 0, as plastic and wood, to 1, as bare metal.
            #[schema(minimum = 0, maximum = 1)]
            pub metallic: Option<f64>,
            /// From 0, as a mirror, to 1, as chalk.
            #[schema(minimum = 0, maximum = 1)]
            pub roughness: Option<f64>,
            /// Whether faces are seen from their inside, too; true when left out.
            pub double_sided: Option<bool>,
            /// What alpha does; left out, `blend` where that of the color is below 1, else `opaque`.
            pub alpha_mode: Option<crate::wire::look::AlphaModeRequest>,
            /// The alpha below which nothing is seen, where `alpha_mode` is `mask`; 0.5 when left out.
            #[schema(minimum = 0, maximum = 1)]
            pub alpha_cutoff: Option<f64>,
            /// A picture over the faces, multiplied with their color; white when that is left out.
            #[serde(default, deserialize_with = "crate::wire::object::optional")]
            pub texture: Option<crate::wire::look::TextureRequest>,
        }

        impl $name {
            /// Converts the request, without checking its numbers; pictures in `images` are shared, and new ones are
            /// added there.
            ///
            /// # Errors
            /// An alpha cutoff without a mask, or a texture that is no picture.
            pub(super) fn look(
                self,
                images: &mut Vec<(String, std::sync::Arc<crate::shape::textures::Image>)>,
            ) -> Result<crate::shape::looks::Look, crate::fault::Fault> {
                let Self { color, metallic, roughness, double_sided, alpha_mode, alpha_cutoff, texture, .. } = self;
                let alpha = crate::wire::look::alpha(alpha_mode, alpha_cutoff)?;
                let texture = texture.map(|texture| texture.resolve(images)).transpose()?;
                Ok(crate::shape::looks::Look { color, metallic, roughness, double_sided, alpha, texture })
            }
        }
    };
}
pub(super) use looks;

looks! {
    /// How faces look that have no material of their own, and those of materials of which nothing but the name is said.
    pub struct LookRequest {}
}

choice! {
    /// What alpha does.
    pub enum AlphaModeRequest {
        /// Alpha has no effect.
        Opaque = "opaque",
        /// What has at least `alpha_cutoff` is opaque, the rest is not there.
        Mask = "mask",
        /// Alpha is the opacity: how much a face hides of what lies behind it.
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

/// Reads a colour: 3 or 4 numbers, or a text in the notation of picture options.
pub(super) fn color<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<[f64; 4]>, D::Error> {
    deserializer.deserialize_option(ColorVisitor)
}

struct ColorVisitor;

impl<'de> Visitor<'de> for ColorVisitor {
    type Value = Option<[f64; 4]>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a color: 3 or 4 numbers from 0 to 1, or a text like \"#ff8800\"")
    }

    fn visit_none<E>(self) -> Result<Self::Value, E> {
        Ok(None)
    }

    fn visit_unit<E>(self) -> Result<Self::Value, E> {
        Ok(None)
    }

    fn visit_some<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
        deserializer.deserialize_any(self)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Self::Value, E> {
        let bytes = parameter::read::color(text).map_err(E::custom)?;
        Ok(Some(bytes.map(|byte| f64::from(byte) / 255.0)))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Self::Value, A::Error> {
        let numbers = Vec::<f64>::deserialize(SeqAccessDeserializer::new(list))?;
        match *numbers {
            [red, green, blue] => Ok(Some([red, green, blue, 1.0])),
            [red, green, blue, alpha] => Ok(Some([red, green, blue, alpha])),
            _ => {
                let detail = "a color has 3 or 4: red, green, blue, perhaps alpha";
                Err(A::Error::custom(format!("{} numbers; {detail}", numbers.len())))
            }
        }
    }
}

/// Returns the effect of alpha, if the request states one.
///
/// # Errors
/// An alpha cutoff without a mask.
pub(super) fn alpha(mode: Option<AlphaModeRequest>, cutoff: Option<f64>) -> Result<Option<Alpha>, Fault> {
    match (mode, cutoff) {
        (Some(AlphaModeRequest::Mask), cutoff) => Ok(Some(Alpha::Mask(cutoff.unwrap_or(USUAL_CUTOFF)))),
        (_, Some(_)) => Err(Fault::new("/alpha_cutoff", "only \"alpha_mode\": \"mask\" has one; say so")),
        (Some(AlphaModeRequest::Opaque), None) => Ok(Some(Alpha::Opaque)),
        (Some(AlphaModeRequest::Blend), None) => Ok(Some(Alpha::Blend)),
        (None, None) => Ok(None),
    }
}

impl TextureRequest {
    /// Converts the texture; a picture that is already in `images` is not decoded again.
    ///
    /// # Errors
    /// An image that is not a data URI of a picture.
    pub(super) fn resolve(self, images: &mut Vec<(String, Arc<Image>)>) -> Result<Texture, Fault> {
        let fault = |detail: String| Fault::new("/texture/image", detail);
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
