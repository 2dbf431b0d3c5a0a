//! The box that a camera frames, as an option.

use crate::math::parameter::{Default, Kind, Parameter};

/// A box that is framed in place of the shown items.
pub(super) const BOX: Parameter = Parameter {
    name: "box",
    kind: Kind::Group(BOX_FIELDS),
    unit: "",
    default: Default::Absent,
    doc: "A box that is framed in place of what is shown, so that pictures of several shapes have one scale. Values of \
          functions stand as y.",
};

pub(super) const BOX_FIELDS: &[Parameter] = &[
    Parameter {
        name: "min",
        kind: Kind::Vector,
        unit: "model units",
        default: Default::Required,
        doc: "The corner with the least coordinates.",
    },
    Parameter {
        name: "max",
        kind: Kind::Vector,
        unit: "model units",
        default: Default::Required,
        doc: "The corner opposite to it.",
    },
];
