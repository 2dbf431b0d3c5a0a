//! The box that a camera frames, as an option.

use crate::math::parameter::{Parameter, ParameterKind};
use crate::raster::MAX_SIDE_PX;

/// A box that is framed in place of the shown items.
pub(super) const BOX: Parameter = Parameter::optional(
    "box",
    ParameterKind::Group(BOX_FIELDS),
    "A box that is framed in place of what is shown, so that pictures of several shapes have one scale. Values of \
     functions stand as y.",
);

pub(super) const BOX_FIELDS: &[Parameter] = &[
    Parameter::required("min", ParameterKind::Vector, "The corner with the least coordinates.").in_unit("model units"),
    Parameter::required("max", ParameterKind::Vector, "The corner opposite to it.").in_unit("model units"),
    LEGEND_PX,
];

/// Width that is left free for a legend.
pub(super) const LEGEND_PX: Parameter = Parameter::optional(
    "legend_px",
    ParameterKind::Integer { min: 0, max: MAX_SIDE_PX as i64 },
    "Width that is left free at the right, at most half of the picture, where its own legend needs less, so that \
     pictures of meshes with and without a legend have one scale.",
)
.in_unit("pixels");
