//! The options that pictures have in common.

use super::view_box::BOX;
use crate::drawing::Stroke;
use crate::fault::Fault;
use crate::math::parameter::{Default, Parameter, ParameterKind, Value, Values};
use crate::output::colors::linear;
use crate::output::counts::ShapeKind;
use crate::output::error::FormatError;
use crate::output::numbers::rounded;
use crate::output::positions::Positions;
use crate::output::scene::{CoordinateSystem, Scene, Shape};
use crate::output::surface::NORMALS;
use crate::raster::{Ground, MAX_SIDE_PX, Projection, RenderStyle, View};
use crate::watch::Watch;

/// Maximum width and height, pixels.
const MAX_SIDE: i64 = MAX_SIDE_PX as i64;

/// Width of the picture.
pub(crate) const WIDTH: Parameter =
    Parameter::integer("width", [16, MAX_SIDE], 1024.0, "Width of the picture.").in_unit("pixels");

/// Height of the picture.
pub(crate) const HEIGHT: Parameter =
    Parameter::integer("height", [16, MAX_SIDE], 768.0, "Height of the picture.").in_unit("pixels");

/// Colour behind everything.
pub(crate) const BACKGROUND: Parameter = Parameter {
    default: Default::Text("#ffffff"),
    ..Parameter::optional(
        "background",
        ParameterKind::Color,
        "Colour behind everything; \"transparent\" leaves it out.",
    )
};

/// Colour of the refined shape.
pub(crate) const COLOR: Parameter = Parameter::optional(
    "color",
    ParameterKind::Color,
    "Colour of the refined shape, whatever its materials; left out, theirs, and a calm blue where they have none.",
);

/// How well edges are drawn.
pub(crate) const QUALITY: Parameter = Parameter {
    name: "quality",
    kind: ParameterKind::Choice(&["draft", "final"]),
    unit: "",
    default: Default::Text("final"),
    doc: "\"final\" draws edges of meshes with 16 samples a pixel and grounds the model, \"draft\" draws with 4 and \
          grounds it only where `grounding` asks for it, in about two thirds of the time.",
};

/// How the model is grounded: occlusion and shadow.
pub(crate) const GROUNDING: Parameter = Parameter::choice(
    "grounding",
    &["auto", "none", "occlusion", "shadow"],
    "Less light in hollows (\"occlusion\"), and with it a soft shadow on the ground, the level plane through the \
     lowest point (\"shadow\"). \"auto\" is \"occlusion\", and \"shadow\" where the model stands: the centre of \
     its surface is over the hull of what is near the ground, and it is no flat sheet. The ground is only seen \
     from above.",
);

/// Resolution of the picture on paper.
pub(crate) const DPI: Parameter = Parameter::number(
    "dpi",
    [1.0, 10_000.0],
    Default::Absent,
    "How large the picture is on paper, written into the file; pixels stay the same.",
)
.in_unit("pixels an inch");

/// Width of lines.
pub(crate) const LINE_WIDTH: Parameter = Parameter::number(
    "line_width",
    [0.1, 20.0],
    Default::Number(1.0),
    "By what the usual width of lines is multiplied, which keeps its proportion to the picture.",
);

/// Colour of wireframe and isolines.
pub(crate) const WIRE_COLOR: Parameter = Parameter::optional(
    "wire_color",
    ParameterKind::Color,
    "Colour of the wireframe and of isolines; left out, a dark blue.",
);

/// Colour of the control net.
pub(crate) const CONTROL_COLOR: Parameter = Parameter::optional(
    "control_color",
    ParameterKind::Color,
    "Colour of the edges of the control net, which are faint behind the surface; left out, orange.",
);

/// Colour of control points.
pub(crate) const POINT_COLOR: Parameter =
    Parameter::optional("point_color", ParameterKind::Color, "Colour of control points; left out, a dark orange.");

/// Size of points.
pub(crate) const POINT_SIZE: Parameter = Parameter::number(
    "point_size",
    [0.1, 20.0],
    Default::Absent,
    "By what the usual size of points is multiplied; left out, points are smaller where they crowd. Curves only.",
);

/// Colour of the inside of closed curves.
pub(crate) const FILL: Parameter = Parameter::optional(
    "fill",
    ParameterKind::Color,
    "Colour of what closed curves lead around an odd number of times. Curves only.",
);

/// Length of the teeth of combs.
pub(crate) const COMB_SCALE: Parameter = Parameter::number(
    "comb_scale",
    [-1000.0, 1000.0],
    Default::Number(1.0),
    "By what the usual length of the teeth of curvature combs is multiplied, at which most are up to an eighth of \
     the picture long; below 0 they stand on the other side.",
);

/// The camera.
pub(crate) const CAMERA: Parameter = Parameter {
    name: "camera",
    kind: ParameterKind::Group(CAMERA_FIELDS),
    unit: "",
    default: Default::Fields,
    doc: "Where the picture is taken from; everything shown is framed unless an eye is given. Curves in the plane use \
          only zoom and target.",
};

pub(super) const CAMERA_FIELDS: &[Parameter] = &[
    Parameter::choice("projection", &["perspective", "orthographic"], "Whether far things look smaller."),
    Parameter::number(
        "azimuth_deg",
        [-360.0, 360.0],
        Default::Number(35.0),
        "Turn about the up axis; with y up, 0 looks from +z and 90 from +x.",
    )
    .in_unit("degrees"),
    Parameter::number("elevation_deg", [-90.0, 90.0], Default::Number(25.0), "Height above the horizon.")
        .in_unit("degrees"),
    Parameter::number(
        "fov_deg",
        [1.0, 150.0],
        Default::Number(30.0),
        "Vertical angle of view of the perspective camera.",
    )
    .in_unit("degrees"),
    Parameter::number("zoom", [0.001, 1000.0], Default::Number(1.0), "Magnification about the centre of the picture."),
    Parameter::optional("eye", ParameterKind::Vector, "Where the camera stands; with it the angles do not count.")
        .in_unit("model units"),
    Parameter::optional(
        "target",
        ParameterKind::Vector,
        "What stands in the centre of the picture; left out, the middle of what is shown.",
    )
    .in_unit("model units"),
    Parameter::optional(
        "up",
        ParameterKind::Vector,
        "The direction that points up in the picture; left out, that of the input's `up`: +y, or +z.",
    ),
    BOX,
];

/// Refuses shapes whose coordinates are too large or too small for the arithmetic of a camera.
///
/// # Errors
/// The refusal, or a stop of the watch.
pub(crate) fn check_extent(scene: &Scene<'_>, watch: &Watch) -> Result<(), FormatError> {
    let mut largest = 0.0_f64;
    match scene.control.shape() {
        Shape::Curves(curves) => {
            curves.iter().flat_map(|curve| &curve.points).for_each(|x| largest = largest.max(x.abs()));
        }
        Shape::Mesh(mesh) => {
            let bounds = Positions::of_mesh(mesh).bounds(watch)?;
            if !bounds.is_empty() {
                bounds.min.iter().chain(&bounds.max).for_each(|x| largest = largest.max(x.abs()));
            }
        }
    }
    if largest == 0.0 || (1e-100..=1e100).contains(&largest) {
        return Ok(());
    }
    let detail = format!("coordinates up to {largest:e} cannot be drawn; scale the input to between 1e-100 and 1e100");
    Err(FormatError::Unfit(detail))
}

/// Refuses items that a shape of this kind cannot show, and translucent colours.
pub(crate) fn shows_only(fitting: &[&str], kind: ShapeKind, options: &Values) -> Result<(), Fault> {
    opaque(options)?;
    let Value::Choices(items) = options.get("show") else { return Ok(()) };
    if items.is_empty() {
        return Err(Fault::new("/show", format!("an empty list shows nothing; name some of {}", fitting.join(", "))));
    }
    let Some(alien) = items.iter().find(|item| !fitting.contains(item)) else { return Ok(()) };
    let what = if kind == ShapeKind::Mesh { "a mesh" } else { "a curve" };
    Err(Fault::new("/show", format!("{what} has no \"{alien}\" to show; it has {}", fitting.join(", "))))
}

/// Refuses translucent colours of shapes.
pub(crate) fn opaque(options: &Values) -> Result<(), Fault> {
    if options.color("color").is_some_and(|color| color[3] != 255) {
        return Err(Fault::new("/color", "shapes are drawn opaque; give a colour as #rgb or #rrggbb"));
    }
    Ok(())
}

/// The options of a picture, read once.
#[derive(Debug, Clone)]
pub(crate) struct Options<'a> {
    pub(super) values: &'a Values,
    /// The unit and the up axis of coordinates.
    pub(crate) coordinate_system: CoordinateSystem,
    /// Width and height, pixels.
    pub(crate) size: [u32; 2],
    /// The background in straight sRGB and alpha.
    pub(crate) background: [u8; 4],
}

impl<'a> Options<'a> {
    /// Reads resolved values of the parameters of pictures.
    pub(crate) fn new(values: &'a Values, coordinate_system: CoordinateSystem) -> Self {
        Self {
            values,
            coordinate_system,
            size: size(values),
            background: values.color("background").unwrap_or([255; 4]),
        }
    }

    /// Returns whether `item` is shown, by the request or, if it has no "show", by `default`.
    pub(crate) fn shows(&self, item: &str, default: &[&str]) -> bool {
        let given = matches!(self.values.get("show"), Value::Choices(_));
        if given { self.values.has("show", item) } else { default.contains(&item) }
    }

    /// Returns whether each face has one normal.
    pub(crate) fn flat(&self) -> bool {
        self.values.choice("shading") == Some("flat") || self.values.choice(NORMALS.name) == Some("none")
    }

    /// Returns background, quality and grounding of a mesh; by default shown numbers have no grounding.
    pub(crate) fn look(&self) -> RenderStyle {
        let is_fine = self.values.choice(QUALITY.name) != Some("draft");
        let shaded = matches!(self.values.choice("shading"), None | Some("smooth" | "flat"));
        let (is_occluded, shadow) = match self.values.choice(GROUNDING.name) {
            Some("none") => (false, Ground::None),
            Some("occlusion") => (true, Ground::None),
            Some("shadow") => (true, Ground::Always),
            _ if is_fine && shaded => (true, Ground::Stood),
            _ => (false, Ground::None),
        };
        RenderStyle { background: self.background, is_fine, is_occluded, shadow }
    }

    /// Returns the resolution on paper, pixels per inch.
    pub(crate) fn dpi(&self) -> Option<f64> {
        self.values.number(DPI.name)
    }

    /// Returns the factor of the default width of lines.
    pub(crate) fn line_width(&self) -> f32 {
        self.values.number(LINE_WIDTH.name).map_or(1.0, rounded)
    }

    /// Returns a solid line of this width, which follows the size of the picture and the width of lines.
    pub(super) fn stroke(&self, width: f32, color: [u8; 4]) -> Stroke {
        Stroke::solid(width * self.unit_px() * self.line_width(), color)
    }

    /// Returns the colour that an option gives to lines or points, or `default`.
    pub(super) fn ink(&self, option: &Parameter, default: [u8; 4]) -> [u8; 4] {
        self.values.color(option.name).unwrap_or(default)
    }

    /// Returns the factor of the default size of points, if given.
    pub(super) fn point_size(&self) -> Option<f32> {
        self.values.number(POINT_SIZE.name).map(rounded)
    }

    /// Returns the colour of the refined shape.
    pub(crate) fn color(&self, default: [u8; 4]) -> [u8; 4] {
        self.values.color("color").unwrap_or(default)
    }

    /// Returns the pixels per unit of line width, so that lines keep their proportion to the picture.
    pub(crate) fn unit_px(&self) -> f32 {
        let smaller = f64::from(self.size[0].min(self.size[1]));
        #[expect(clippy::cast_possible_truncation, reason = "a width needs no last digit")]
        let unit = (smaller / 768.0).max(0.35) as f32;
        unit
    }

    /// Returns the side of the square that each of `n` things gets in the picture, in units of line width.
    pub(crate) fn room(&self, n: usize) -> f32 {
        let [width, height] = self.size.map(f64::from);
        let unit = f64::from(self.unit_px());
        #[expect(clippy::cast_precision_loss, reason = "a width needs no last digit")]
        let each = width * height / (unit * unit * n.max(1) as f64);
        #[expect(clippy::cast_possible_truncation, reason = "a width needs no last digit")]
        let side = each.sqrt() as f32;
        side
    }

    /// Returns the view that the camera options give.
    pub(crate) fn view(&self) -> View {
        let fallback = Values::default();
        let camera = self.values.group("camera").unwrap_or(&fallback);
        let number = |name: &str, default: f64| camera.number(name).unwrap_or(default);
        let radians = |degrees: f64| degrees * (std::f64::consts::PI / 180.0);
        let orthographic = camera.choice("projection") == Some("orthographic");
        View {
            projection: if orthographic { Projection::Orthographic } else { Projection::Perspective },
            azimuth_rad: radians(number("azimuth_deg", 35.0)),
            elevation_rad: radians(number("elevation_deg", 25.0)),
            fov_rad: radians(number("fov_deg", 30.0)),
            zoom: number("zoom", 1.0),
            eye: camera.vector("eye"),
            target: camera.vector("target"),
            up: camera.vector("up").unwrap_or(self.coordinate_system.up.direction()),
        }
    }
}

/// Returns width and height, pixels.
pub(crate) fn size(values: &Values) -> [u32; 2] {
    let side = |name: &str, default: u32| {
        let given = values.integer(name).and_then(|n| u32::try_from(n).ok()).unwrap_or(default);
        given.clamp(1, MAX_SIDE_PX)
    };
    [side("width", 1024), side("height", 768)]
}

/// Converts straight sRGB bytes to linear light.
pub(super) fn shown_as(color: [u8; 4]) -> [f32; 3] {
    std::array::from_fn(|k| rounded(linear(k, f64::from(color[k]) / 255.0)))
}

/// Refuses curves that pictures cannot show.
pub(crate) fn drawable(kind: ShapeKind) -> Result<(), String> {
    match kind {
        ShapeKind::Mesh | ShapeKind::Curves { dimension: 1..=3 } => Ok(()),
        ShapeKind::Curves { dimension } => Err(format!(
            "points of {dimension} coordinates cannot be drawn, pictures show 1 to 3; ask for \"json\" instead"
        )),
    }
}
