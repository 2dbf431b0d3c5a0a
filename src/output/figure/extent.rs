//! Collects what pictures with the same framing have in common: the bounding box of everything that they show, and the
//! room for their legends.

use crate::math::parameter::Values;
use crate::math::vector::Vector;
use crate::output::error::FormatError;
use crate::output::picture::framing::boxed;
use crate::output::picture::options::{CAMERA, Options, WIDTH};
use crate::output::picture::{legend, lines, shading};
use crate::output::scene::{Curve, MeshSource, Scene, Shape, in_chunks};
use crate::watch::Watch;

/// A bounding box of finite points, model units. Plane curves lie at z = 0; values of functions are y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FigureExtent {
    low: Vector,
    high: Vector,
    /// Width of the widest legend, and that of its picture, pixels.
    strip: [u32; 2],
}

impl Default for FigureExtent {
    /// The box of no points.
    fn default() -> Self {
        Self { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3], strip: [0, 1] }
    }
}

impl FigureExtent {
    /// Extends the box to everything that a picture with these options shows of a scene.
    ///
    /// # Errors
    /// When the watch says stop.
    pub fn add(&mut self, scene: &Scene<'_>, values: &Values, watch: &Watch) -> Result<(), FormatError> {
        let options = Options::new(values, scene.coordinate_system);
        let (shows_shape, shows_control) = match scene.shape {
            Shape::Curves(_) => {
                let shows = |items: &[&str]| items.iter().any(|item| options.shows(item, &["curve", "control"]));
                (shows(&["curve", "vertices", "comb", "tangents"]), shows(&["control", "points"]))
            }
            Shape::Mesh(mesh) => {
                let shows = |item| shading::shows(&options, item);
                self.leave(legend::width(mesh.attachments(), &options, shows("surface")), options.size[0]);
                (lines::shows_body(&options), shows("control") || shows("points"))
            }
        };
        if shows_shape {
            self.reach(scene.shape, watch)?;
        }
        if shows_control {
            self.reach(scene.control.shape(), watch)?;
        }
        Ok(())
    }

    /// Extends the strip for a legend to `strip` of `width` pixels, if that is a larger share.
    fn leave(&mut self, strip: u32, width: u32) {
        let [known, of] = self.strip.map(u64::from);
        if u64::from(strip) * of > known * u64::from(width) {
            self.strip = [strip, width];
        }
    }

    fn reach(&mut self, shape: Shape<'_>, watch: &Watch) -> Result<(), FormatError> {
        match shape {
            Shape::Curves(curves) => curves.iter().for_each(|curve| self.reach_curve(curve)),
            Shape::Mesh(mesh) => self.reach_mesh(mesh, watch)?,
        }
        Ok(())
    }

    fn reach_curve(&mut self, curve: &Curve) {
        for point in curve.points.chunks_exact(curve.dimension) {
            self.point(match *point {
                [value] => [0.0, value, 0.0],
                [x, y] => [x, y, 0.0],
                _ => [point[0], point[1], point[2]],
            });
        }
    }

    fn reach_mesh(&mut self, mesh: &dyn MeshSource, watch: &Watch) -> Result<(), FormatError> {
        let mut chunk = Vec::new();
        in_chunks(mesh.n_vertices(), |range| {
            watch.check()?;
            mesh.positions(range, &mut chunk);
            chunk.iter().for_each(|point| self.point(*point));
            Ok::<_, FormatError>(())
        })
    }

    fn point(&mut self, point: Vector) {
        if point.iter().all(|x| x.is_finite()) {
            self.low = [0, 1, 2].map(|k| self.low[k].min(point[k]));
            self.high = [0, 1, 2].map(|k| self.high[k].max(point[k]));
        }
    }
}

/// Returns the options of a picture framed by a box in place of the shown items, with room for the widest legend.
/// Options that have a box already stay as they are.
pub fn framed(values: &Values, extent: &FigureExtent) -> Values {
    let mut values = values.clone();
    let camera = values.group(CAMERA.name).cloned().unwrap_or_default();
    if extent.low[0] <= extent.high[0] && camera.group("box").is_none() {
        let [strip, of] = extent.strip.map(u64::from);
        let strip = values.integer(WIDTH.name).and_then(|width| u64::try_from(width).ok()).unwrap_or(0) * strip / of;
        boxed(&mut values, [extent.low, extent.high], u32::try_from(strip).unwrap_or(0));
    }
    values
}
