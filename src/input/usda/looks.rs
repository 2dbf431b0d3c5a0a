//! Materials: the looks of their `UsdPreviewSurface`.

use super::tree::{Layer, Prim};
use crate::input::colors::encoded;
use crate::shape::looks::{Alpha, Look};

/// Returns the prim with this path.
pub(super) fn at<'p, 'a>(layer: &'p Layer<'a>, path: &str) -> Option<&'p Prim<'a>> {
    let mut names = path.strip_prefix('/')?.split('/');
    let named = |prims: &'p [Prim<'a>], name: &str| prims.iter().find(|prim| prim.name == name);
    let root = named(&layer.prims, names.next()?)?;
    names.try_fold(root, |prim, name| named(&prim.children, name))
}

/// Returns the look of a material, and whether it has textures, which are not read.
///
/// Source: `UsdPreviewSurface` specification 2.6.
pub(super) fn look(layer: &Layer<'_>, material: &Prim<'_>) -> (Look, bool) {
    let surface = material.word("outputs:surface.connect");
    let path = surface.and_then(|surface| surface.rsplit_once('.')).map(|(path, _)| path);
    let Some(shader) = path.and_then(|path| at(layer, path)) else { return (Look::default(), false) };
    if shader.word("info:id") != Some("UsdPreviewSurface") {
        return (Look::default(), false);
    }
    let has_textures =
        shader.properties.iter().any(|input| input.name.starts_with("inputs:") && input.name.ends_with(".connect"));
    let share = |name: &str| shader.numbers(name).first().filter(|x| x.is_finite()).map(|x| x.clamp(0.0, 1.0));
    let opacity = share("inputs:opacity");
    let color = match *shader.numbers("inputs:diffuseColor") {
        [red, green, blue] => Some([red, green, blue]),
        _ => opacity.map(|_| [0.18; 3]),
    };
    let color = color.filter(|color| color.iter().all(|x| x.is_finite()));
    let cutoff = share("inputs:opacityThreshold").filter(|&cutoff| cutoff > 0.0);
    let look = Look {
        color: color.map(|color| {
            let [red, green, blue] = color.map(|x| encoded(x.clamp(0.0, 1.0)));
            [red, green, blue, opacity.unwrap_or(1.0)]
        }),
        metallic: share("inputs:metallic"),
        roughness: share("inputs:roughness"),
        alpha: cutoff.map(Alpha::Mask),
        ..Look::default()
    };
    (look, has_textures)
}
