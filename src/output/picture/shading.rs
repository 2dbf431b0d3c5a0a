//! The choices of "shading": how the surface of a mesh is lit or inspected.

use super::options::Options;
use crate::fault::Fault;
use crate::math::parameter::{Parameter, ParameterKind, Value, Values};
use crate::output::counts::ShapeKind;
use crate::output::options::ISOLINES;
use crate::raster::{Finish, StripePattern, Stripes};

/// How a surface is shown.
pub(crate) const SHADING: Parameter = Parameter::choice(
    "shading",
    &[
        "smooth",
        "flat",
        "matcap",
        NORMALS_SHADING,
        HIDDEN_LINE,
        GAUSSIAN,
        MEAN,
        ZEBRA,
        REFLECTION_LINES,
        ISOPHOTES,
        DISTANCE,
    ],
    "How the surface of a mesh is shown. Lit: smooth or by its faces (flat), as clay in a studio (matcap). As a \
     drawing: in the colour of the paper, with its outline, boundary, hard edges and the edges of the input \
     (hidden-line). Inspected: the normal as a colour (normals), colours of curvature (gaussian-curvature, \
     mean-curvature) or of the distance from the control net, or from the surface of the job that `distance_to` \
     of the job holds (distance), the mirror images of bands (zebra) and of strips of light (reflection-lines), \
     lines of equal angle to a direction (isophotes).",
);

/// The number of stripes.
pub(crate) const STRIPES: Parameter = Parameter::optional(
    "stripes",
    ParameterKind::Integer { min: 1, max: MAX_STRIPES },
    "How many stripes shading zebra, reflection-lines and isophotes shows: dark bands from one end of their axis \
     to the other, strips of light around half of it, lines between the angles of 90 and 0 degrees. Left out, \
     12, 18 and 12.",
);

/// Maximum number of stripes; more would be finer than the pixels of the largest pictures.
const MAX_STRIPES: i64 = 256;

/// The axis of stripes.
pub(crate) const STRIPE_DIRECTION: Parameter = Parameter::optional(
    "stripe_direction",
    ParameterKind::Direction,
    "The axis of the stripes of zebra (across it), reflection-lines (along it) and isophotes (towards it), in \
     model coordinates. Left out, up; for reflection-lines, from left to right in the picture.",
);

/// Default colour of surfaces.
pub(super) const SURFACE: [u8; 4] = [112, 160, 222, 255];

const NORMALS_SHADING: &str = "normals";
pub(super) const HIDDEN_LINE: &str = "hidden-line";
const GAUSSIAN: &str = "gaussian-curvature";
const MEAN: &str = "mean-curvature";
const ZEBRA: &str = "zebra";
const REFLECTION_LINES: &str = "reflection-lines";
const ISOPHOTES: &str = "isophotes";
const DISTANCE: &str = "distance";

/// The shadings with stripes, and the default number of stripes of each.
const PATTERNS: [(&str, StripePattern, u8); 3] = [
    (ZEBRA, StripePattern::Zebra, 12),
    (REFLECTION_LINES, StripePattern::ReflectionLines, 18),
    (ISOPHOTES, StripePattern::Isophotes, 12),
];

/// Width of isophotes, in units of line width. Half of it is fainter than a pixel in usual pictures; twice of it fills
/// strongly bent parts.
const ISOPHOTE_WIDTH: f32 = 1.6;

/// A quantity at vertices that the colours of a shading stand for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ShadedQuantity {
    /// Gaussian curvature.
    Gaussian,
    /// Mean curvature.
    Mean,
    /// Distance from the control net, or from the surface of another job.
    Distance,
}

/// Returns the quantity that the shading shows, if any.
pub(super) fn measure(options: &Values) -> Option<ShadedQuantity> {
    match options.choice(SHADING.name)? {
        GAUSSIAN => Some(ShadedQuantity::Gaussian),
        MEAN => Some(ShadedQuantity::Mean),
        DISTANCE => Some(ShadedQuantity::Distance),
        _ => None,
    }
}

/// Returns whether a picture with these options shows distances.
pub fn shows_distances(options: &Values) -> bool {
    measure(options) == Some(ShadedQuantity::Distance)
}

/// The default items of a picture of a mesh: shaded, and as a drawing of lines.
const DEFAULT_SURFACE_ITEMS: [&[&str]; 2] = [&["surface"], &["surface", ISOLINES]];

/// Returns whether a picture of a mesh shows an item.
pub(crate) fn shows(options: &Options<'_>, item: &str) -> bool {
    options.shows(item, DEFAULT_SURFACE_ITEMS[usize::from(is_drawing(options.values))])
}

/// Returns whether the shading is a drawing of the lines of the surface.
pub(super) fn is_drawing(options: &Values) -> bool {
    options.choice(SHADING.name) == Some(HIDDEN_LINE)
}

/// Returns whether the colours of a picture with these options are normals.
pub(super) fn shows_normals(options: &Options<'_>) -> bool {
    options.values.choice(SHADING.name) == Some(NORMALS_SHADING) && shows(options, "surface")
}

fn pattern(options: &Values) -> Option<(&'static str, StripePattern, u8)> {
    PATTERNS.into_iter().find(|(name, ..)| options.choice(SHADING.name) == Some(name))
}

/// Returns the finish of a surface that is not lit like a plain material; `right` points to the right in the picture.
pub(super) fn finish(options: &Options<'_>, right: [f64; 3]) -> Option<Finish> {
    if let Some((_, pattern, usual)) = pattern(options.values) {
        let given = options.values.integer(STRIPES.name).and_then(|n| u16::try_from(n).ok());
        let along_picture = pattern == StripePattern::ReflectionLines;
        let axis = if along_picture { right } else { options.coordinate_system.up.direction() };
        return Some(Finish::Stripes(Stripes {
            pattern,
            axis: options.values.vector(STRIPE_DIRECTION.name).unwrap_or(axis),
            count: f32::from(given.unwrap_or(u16::from(usual))),
            width_px: ISOPHOTE_WIDTH * options.unit_px(),
        }));
    }
    match options.values.choice(SHADING.name)? {
        "matcap" => Some(Finish::Matcap),
        NORMALS_SHADING => Some(Finish::Normals),
        HIDDEN_LINE => Some(Finish::Bare),
        GAUSSIAN | MEAN | DISTANCE => Some(Finish::Matt),
        _ => None,
    }
}

/// Returns whether the surface is not lit like a plain material.
pub(super) fn is_finished(options: &Values) -> bool {
    !["smooth", "flat"].contains(&options.choice(SHADING.name).unwrap_or("smooth"))
}

/// Returns the colour of a surface if no colour is given: chalk under stripes, clay, the paper, or `lit`, by the
/// shading.
pub(super) fn color(options: &Options<'_>, lit: [u8; 4]) -> [u8; 4] {
    let paper = if options.background[3] == 255 { options.background } else { [255; 4] };
    match options.values.choice(SHADING.name) {
        Some(HIDDEN_LINE) => options.color(paper),
        Some("matcap") => options.color([206, 190, 172, 255]),
        _ if pattern(options.values).is_some() => options.color([244, 245, 247, 255]),
        _ => options.color(lit),
    }
}

/// Refuses a shading that a shape of this kind cannot have, and options that have no effect under the shading.
pub(crate) fn check(kind: ShapeKind, options: &Values) -> Result<(), Fault> {
    let shading = options.choice(SHADING.name).unwrap_or("smooth");
    let is_lit = !is_finished(options);
    if kind != ShapeKind::Mesh && !is_lit {
        return Err(Fault::new(
            "/shading",
            format!("curves have no surface that \"{shading}\" could show; leave it out"),
        ));
    }
    if !is_lit && options.choice("color_by").is_some_and(|by| by != "none") {
        let detail = format!("\"{shading}\" has colours of its own; leave \"color_by\" or \"shading\" out");
        return Err(Fault::new("/color_by", detail));
    }
    if (measure(options).is_some() || shading == NORMALS_SHADING) && options.color("color").is_some() {
        return Err(Fault::new("/color", format!("the colours of \"{shading}\" are numbers; leave it out")));
    }
    for option in [STRIPES, STRIPE_DIRECTION] {
        if pattern(options).is_none() && *options.get(option.name) != Value::Absent {
            let detail = "only shading zebra, reflection-lines and isophotes has stripes; leave it out";
            return Err(Fault::new(format!("/{}", option.name), detail));
        }
    }
    Ok(())
}
