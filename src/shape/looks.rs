//! How materials look: the metallic-roughness model of glTF 2.0, as far as each says something.

use std::sync::Arc;

use super::textures::{Image, Texture};
use crate::fault::{Fault, under};

/// What faces are shown as by formats with materials, where nothing is said: a calm blue, linear light, for
/// [`Look::color`].
pub const PLAIN: [f32; 4] = [0.3, 0.47, 0.65, 1.0];
/// The same for [`Look::metallic`] and [`Look::roughness`]; both sides are seen.
pub const PLAIN_SURFACE: [f32; 2] = [0.0, 0.5];

/// How the faces of a material look; what is left out is left to whoever shows it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Look {
    /// Red, green, blue and alpha, sRGB from 0 to 1; alpha is linear.
    pub color: Option<[f64; 4]>,
    /// From 0, as plastic and wood, to 1, as bare metal.
    pub metallic: Option<f64>,
    /// From 0, as a mirror, to 1, as chalk.
    pub roughness: Option<f64>,
    /// Whether faces are seen from their inside, too.
    pub double_sided: Option<bool>,
    /// What alpha does; left out, what the alpha of the colour needs.
    pub alpha: Option<Alpha>,
    /// A picture that is multiplied with the colour.
    pub texture: Option<Texture>,
}

/// What alpha does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Alpha {
    /// Nothing: all is opaque.
    Opaque,
    /// What has at least this alpha is opaque, the rest is not there.
    Mask(f64),
    /// It says how much hides what lies behind.
    Blend,
}

impl Alpha {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Opaque => "opaque",
            Self::Mask(_) => "mask",
            Self::Blend => "blend",
        }
    }
}

impl Look {
    /// Whether nothing is said.
    pub fn is_silent(&self) -> bool {
        *self == Self::default()
    }

    /// What alpha does, said or not: faces whose colour lets something through are blended.
    pub fn alpha(&self) -> Alpha {
        let is_opaque = self.color.is_none_or(|color| color[3] >= 1.0);
        self.alpha.unwrap_or(if is_opaque { Alpha::Opaque } else { Alpha::Blend })
    }

    /// Checks all numbers; `has_uvs` says whether the mesh has texture coordinates.
    ///
    /// # Errors
    /// Numbers beyond 0 to 1, and a picture that nothing says where to lay.
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

/// The different pictures of some looks, in their order.
pub fn images(looks: &[Look]) -> Vec<&Arc<Image>> {
    let mut found: Vec<&Arc<Image>> = Vec::new();
    for texture in looks.iter().filter_map(|look| look.texture.as_ref()) {
        if !found.contains(&&texture.image) {
            found.push(&texture.image);
        }
    }
    found
}
