//! The framing of a picture by its camera.

use super::options::{CAMERA, CAMERA_FIELDS, Options};
use super::view_box::{BOX, BOX_FIELDS, LEGEND_PX};
use crate::fault::Fault;
use crate::math::parameter::{Value, Values};
use crate::math::vector::{Vector, minus, times};
use crate::output::counts::ShapeKind;
use crate::raster::{Camera, Projection, View};

/// Sets the box that the camera frames, and the width in pixels that is left free for a legend.
pub(crate) fn boxed(values: &mut Values, [min, max]: [Vector; 2], legend_px: u32) {
    let mut camera = values.group(CAMERA.name).cloned().unwrap_or_else(|| Values::usual(CAMERA_FIELDS));
    let mut corners = Values::usual(BOX_FIELDS);
    corners.set(&BOX_FIELDS[0], Value::Vector(min));
    corners.set(&BOX_FIELDS[1], Value::Vector(max));
    corners.set(&LEGEND_PX, Value::Integer(legend_px.into()));
    camera.set(&BOX, Value::Group(corners));
    values.set(&CAMERA, Value::Group(camera));
}

/// Refuses a box whose corners are exchanged; and a camera that looks nowhere, and one to which nothing is up, where
/// they count: not for curves in the plane.
pub(crate) fn check(kind: ShapeKind, values: &Values) -> Result<(), Fault> {
    let Some(camera) = values.group(CAMERA.name) else { return Ok(()) };
    let corners = camera.group(BOX.name).and_then(|corners| corners.vector("min").zip(corners.vector("max")));
    if let Some((min, max)) = corners
        && let Some(axis) = (0..3).find(|&axis| min[axis] > max[axis])
    {
        let (name, low, high) = (["x", "y", "z"][axis], min[axis], max[axis]);
        let detail = format!("the least {name} is {low}, the greatest is {high}; exchange them");
        return Err(Fault::new(format!("/camera/box/min/{axis}"), detail));
    }
    if matches!(kind, ShapeKind::Curves { dimension: 1..=2 }) {
        return Ok(());
    }
    let is_nothing = |v: Vector| v.iter().all(|c| c.abs() <= 0.0);
    if camera.vector("up").is_some_and(is_nothing) {
        let detail = "a direction of length 0 points nowhere; give one like [0, 1, 0], or leave it out";
        return Err(Fault::new("/camera/up", detail));
    }
    let way = camera.vector("eye").zip(camera.vector("target")).map(|(eye, target)| minus(target, eye));
    if way.is_some_and(is_nothing) {
        let detail = "the eye is at the target, so that it looks nowhere; move one of them, or leave the target out";
        return Err(Fault::new("/camera/eye", detail));
    }
    Ok(())
}

impl Options<'_> {
    /// Returns the corners of the box that is framed in place of the shown items, if one is given.
    pub(crate) fn corners(&self) -> Option<[Vector; 8]> {
        let corners = self.view_box()?;
        let ends = [corners.vector("min")?, corners.vector("max")?];
        Some(std::array::from_fn(|i| [0, 1, 2].map(|k| ends[i >> k & 1][k])))
    }

    /// Returns the size in pixels of the picture without the width that is left free for a legend.
    pub(super) fn size_beside(&self, legend_px: u32) -> [u32; 2] {
        let asked = self.view_box().and_then(|corners| corners.integer(LEGEND_PX.name));
        let asked = asked.and_then(|asked| u32::try_from(asked).ok()).unwrap_or(0);
        let [width, height] = self.size;
        [width - legend_px.max(asked).min(width / 2), height]
    }

    fn view_box(&self) -> Option<&Values> {
        self.values.group(CAMERA.name)?.group(BOX.name)
    }

    /// Returns the camera that frames these points, or the given box, in a picture of `width` by `height` pixels.
    pub(crate) fn camera(&self, points: &[&[Vector]], [width, height]: [u32; 2]) -> Camera {
        match self.corners() {
            Some(corners) => Camera::framing(&self.view(), &[&corners], width, height),
            None => Camera::framing(&self.view(), points, width, height),
        }
    }

    /// Returns the options with a camera that looks at `target` from an azimuth: with perspective from `distance`
    /// against the direction `forward`, otherwise with the zoom multiplied by `scale`.
    pub(crate) fn seen_from(
        &self,
        azimuth_deg: f64,
        target: Vector,
        (forward, distance): (Vector, f64),
        scale: f64,
    ) -> Values {
        let mut camera = self.values.group(CAMERA.name).cloned().unwrap_or_else(|| Values::usual(CAMERA_FIELDS));
        let mut set = |name: &str, value: Value| {
            CAMERA_FIELDS.iter().filter(|field| field.name == name).for_each(|field| camera.set(field, value.clone()));
        };
        set("target", Value::Vector(target));
        set("azimuth_deg", Value::Number(azimuth_deg));
        let view = self.view();
        match view.projection {
            Projection::Perspective => set("eye", Value::Vector(minus(target, times(distance, forward)))),
            Projection::Orthographic => set("zoom", Value::Number(view.zoom * scale)),
        }
        let mut values = self.values.clone();
        values.set(&CAMERA, Value::Group(camera));
        values
    }
}

/// Returns the camera that frames a box from an azimuth, with `target` in the middle of the picture.
pub(crate) fn facing(options: &Options<'_>, azimuth_deg: f64, target: Vector, corners: &[Vector; 8]) -> Camera {
    let azimuth_rad = azimuth_deg * (std::f64::consts::PI / 180.0);
    let view = View { azimuth_rad, target: Some(target), eye: None, ..options.view() };
    Camera::framing(&view, &[corners], options.size[0], options.size[1])
}
