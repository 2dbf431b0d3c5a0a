//! The appearance of materials: the part of the metallic-roughness model of glTF 2.0 that a client gives.

use std::sync::Arc;

use super::textures::{Image, Texture};
use crate::fault::{Fault, under};

/// The default [`Look::color`] in formats with materials: a calm blue, in linear light.
pub const DEFAULT_COLOR: [f32; 4] = [0.3, 0.47, 0.65, 1.0];
/// The default [`Look::metallic`] and [`Look::roughness`]; both sides are visible.
pub const PLAIN_SURFACE: [f32; 2] = [0.0, 0.5];

/// The appearance of the faces of a material; what is `None` is left to the viewer.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Look {
    /// Red, green, blue and alpha, sRGB from 0 to 1; alpha is linear.
    pub color: Option<[f64; 4]>,
    /// From 0, as plastic and wood, to 1, as bare metal.
    pub metallic: Option<f64>,
    /// From 0, as a mirror, to 1, as chalk.
    pub roughness: Option<f64>,
    /// Whether faces are visible from behind, too.
    pub double_sided: Option<bool>,
    /// How alpha is used; if `None`, as the alpha of the colour requires.
    pub alpha: Option<Alpha>,
    /// A texture that is multiplied with the colour.
    pub texture: Option<Texture>,
}

/// How alpha is used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Alpha {
    /// Alpha is ignored: everything is opaque.
    Opaque,
    /// Points with at least this alpha are opaque, others invisible.
    Mask(f64),
    /// Alpha is the opacity with which the surface covers what lies behind.
    Blend,
}

impl Alpha {
    /// Returns the name of the mode in requests.
    pub fn name(self) -> &'static str {
        match self {
            Self::Opaque => "opaque",
            Self::Mask(_) => "mask",
            Self::Blend => "blend",
        }
    }
}

impl Look {
    /// Returns whether nothing is given.
    pub fn is_silent(&self) -> bool {
        *self == Self::default()
    }

    /// Returns how alpha is used; by default, faces with a translucent colour are blended.
    pub fn alpha(&self) -> Alpha {
        let is_opaque = self.color.is_none_or(|color| color[3] >= 1.0);
        self.alpha.unwrap_or(if is_opaque { Alpha::Opaque } else { Alpha::Blend })
    }

    /// Checks all values; `has_uvs` tells whether the mesh has texture coordinates.
    ///
    /// # Errors
    /// Values outside 0 to 1, and a texture on a mesh without texture coordinates.
    pub(super) fn check(&self, has_uvs: bool) -> Vec<Fault> {
        let Self { color, metallic, roughness, double_sided: _, alpha, texture } = self;
        let within = |place: String, x: f64| {
            let detail = || format!("{x} is not from 0 to 1");
            (!(0.0..=1.0).contains(&x)).then(|| Fault::new(place, detail()))
        };
        let cutoff = if let Some(Alpha::Mask(cutoff)) = alpha { Some(*cutoff) } else { None };
        let color = color.iter().flatten().enumerate().filter_map(|(k, &x)| within(format!("/color/{k}"), x));
        let others = [("metallic", *metallic), ("roughness", *roughness), ("alpha_cutoff", cutoff)];
        let others = others.into_iter().filter_map(|(name, x)| within(format!("/{name}"), x?));
        let mut faults: Vec<Fault> = color.chain(others).collect();
        if let Some(texture) = texture {
            faults.extend(under("/texture", texture.check().err().into_iter().collect()));
            if !has_uvs {
                faults.push(Fault::new("/texture", "the mesh has no uvs, which say where a picture lies; give them"));
            }
        }
        faults
    }
}

/// Returns the distinct images of some looks, in order of first use.
pub fn images(looks: &[Look]) -> Vec<&Arc<Image>> {
    let mut found: Vec<&Arc<Image>> = Vec::new();
    for texture in looks.iter().filter_map(|look| look.texture.as_ref()) {
        if !found.contains(&&texture.image) {
            found.push(&texture.image);
        }
    }
    found
}
