//! The styles of the curves of a drawing, as options.

use super::options::Options;
use crate::drawing::{Cap, Color, Stroke};
use crate::math::parameter::{Default, Parameter, ParameterKind, Values};

/// Maximum number of styles of one output.
const MAX_STYLES: usize = 64;

/// The styles of single curves.
pub(crate) const STYLES: Parameter = Parameter::optional(
    "styles",
    ParameterKind::Groups { fields: STYLE_FIELDS, most: MAX_STYLES },
    "Looks of the polygons' curves, one each in their order and from the first again where there are more \
     polygons. Curves only.",
);

const STYLE_FIELDS: &[Parameter] = &[
    Parameter::optional(
        "color",
        ParameterKind::Color,
        "Colour of the curve; left out, the next of six that are told apart with every kind of sight.",
    ),
    Parameter::choice("dash", &["solid", "dashed", "dotted", "dash-dot"], "How the line is broken."),
    Parameter::number("width", [0.1, 20.0], Default::Number(1.0), "By what the usual width of the line is multiplied."),
    Parameter::optional(
        "label",
        ParameterKind::Name,
        "What the legend says of it, with markup: `_x` and `^{...}` for small letters, `\\alpha` for Greek ones.",
    ),
    Parameter::optional("fill", ParameterKind::Color, "Colour of the inside where the curve is closed."),
];

/// Colours that can be told apart with every kind of sight: those of M. Okabe and K. Ito, Color Universal Design
/// (2002), without yellow and black.
const CURVE_PALETTE: [Color; 6] = [
    [0, 114, 178, 255],
    [213, 94, 0, 255],
    [0, 158, 115, 255],
    [204, 121, 167, 255],
    [86, 180, 233, 255],
    [230, 159, 0, 255],
];

/// The style of a curve.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Style<'a> {
    pub(super) stroke: Stroke,
    /// Markup for the legend.
    pub(super) label: Option<&'a str>,
    /// Colour of the inside.
    pub(super) fill: Option<Color>,
}

/// Returns the styles that the options give, none if all curves look alike. `width_px` is the default width.
pub(super) fn styles<'a>(options: &Options<'a>, width_px: f32) -> Vec<Style<'a>> {
    let style = |(i, values): (usize, &'a Values)| {
        let color = values.color("color").unwrap_or_else(|| options.color(CURVE_PALETTE[i % CURVE_PALETTE.len()]));
        #[expect(clippy::cast_possible_truncation, reason = "a width needs no last digit")]
        let width_px = width_px * values.number("width").unwrap_or(1.0) as f32;
        let stroke = dashed(values.choice("dash").unwrap_or("solid"), Stroke::solid(width_px, color));
        Style { stroke, label: values.name("label"), fill: values.color("fill") }
    };
    options.values.groups(STYLES.name).iter().enumerate().map(style).collect()
}

/// Returns a line with the dashes of a named pattern, in proportion to its width.
fn dashed(name: &str, solid: Stroke) -> Stroke {
    let (lengths, cap): (&[f32], Cap) = match name {
        "dashed" => (&[3.5, 2.2], Cap::Butt),
        // dots are the round ends of very short dashes
        "dotted" => (&[0.02, 2.0], Cap::Round),
        "dash-dot" => (&[4.0, 1.6, 1.0, 1.6], Cap::Butt),
        _ => return solid,
    };
    // dashes stay visible however thin the line is
    let unit = solid.width_px.max(0.5);
    Stroke { dash: lengths.iter().map(|length| length * unit).collect(), cap, ..solid }
}
