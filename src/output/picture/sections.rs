//! Draws the sections of a mesh, each in the frame of its plane.

use super::drawing::CURVE_INK;
use super::easel::Easel;
use super::options::Options;
use crate::drawing::{Drawing, DrawingItem, Stroke};
use crate::math::vector::{cross, dot, minus, unit};
use crate::output::error::FormatError;
use crate::output::positions::Positions;
use crate::output::scene::{Curve, MeshSource};
use crate::output::sections::{Plane, Polyline, section};
use crate::raster::View;
use crate::watch::Watch;

/// Width of the lines, in units of line width. A matter of taste: half of it is as thin as other lines; twice of it
/// hides what is small.
const SECTION_WIDTH: f32 = 2.2;
/// Gap between two sections, as a share of the larger side of the largest section. Half of it makes neighbours look
/// like one; twice of it makes all smaller.
const SECTION_GAP: f64 = 0.1;
/// The squared sine of an angle up to which up counts as along the normal of a plane. Half and twice of it turn
/// sections at slightly other angles; far below, rounding would turn them.
const PARALLEL_SINE_SQUARED: f64 = 1e-18;

/// Draws the sections, an item for each plane in their order.
///
/// Each section is viewed against its normal, with the up direction of [`axes`]. Several are arranged row by row, with
/// the number of columns that makes them largest, all at one scale and each centred in its cell.
pub(crate) fn drawing(
    mesh: &dyn MeshSource,
    planes: &[Plane],
    options: &Options<'_>,
    watch: &Watch,
) -> Result<Drawing, FormatError> {
    let positions = Positions::of_mesh(mesh).held(watch)?;
    let up = options.coordinate_system.up.direction();
    let mut drawn = Vec::with_capacity(planes.len());
    for plane in planes {
        drawn.push(flat(&section(mesh, positions.rows(), plane, watch)?, axes(plane.normal, up)));
    }
    arrange(&mut drawn, options.size);
    let shown: Vec<&Curve> = drawn.iter().flatten().collect();
    let easel = Easel::new(&shown, View { target: None, ..options.view() }, options.size);
    let stroke = Stroke::solid(SECTION_WIDTH * options.unit_px(), options.color(CURVE_INK));
    let item = |curves: &Vec<Curve>| Ok(DrawingItem::lines("section", easel.runs(curves, watch)?, stroke.clone()));
    let items = drawn.iter().map(item).collect::<Result<_, FormatError>>()?;
    Ok(Drawing {
        size: options.size,
        background: options.background,
        title: "Sections of a subdivision surface".to_owned(),
        items,
    })
}

/// Returns the directions to the right and up in a plane, of length one, for a viewer towards whom the normal points.
/// If `up` is along the normal, +x points to the right.
fn axes(normal: [f64; 3], up: [f64; 3]) -> [[f64; 3]; 2] {
    let normal = unit(normal);
    let across = cross(up, normal);
    let right = if dot(across, across) > PARALLEL_SINE_SQUARED {
        unit(across)
    } else {
        unit(cross(cross(normal, [1.0, 0.0, 0.0]), normal))
    };
    [right, cross(normal, right)]
}

/// Returns the polylines as plane curves, with the first point of the first polyline as origin.
fn flat(polylines: &[Polyline], axes: [[f64; 3]; 2]) -> Vec<Curve> {
    let Some(origin) = polylines.first().map(|first| first.points[0]) else { return Vec::new() };
    let place = |p: &[f64; 3]| axes.map(|axis| dot(axis, minus(*p, origin)));
    let curve = |polyline: &Polyline| Curve {
        points: polyline.points.iter().flat_map(place).collect(),
        dimension: 2,
        closed: polyline.closed,
        tangents: None,
    };
    polylines.iter().map(curve).collect()
}

/// Moves each list of plane curves to its cell.
fn arrange(drawn: &mut [Vec<Curve>], size: [u32; 2]) {
    let boxes: Vec<[[f64; 2]; 2]> = drawn.iter().map(|curves| bounds(curves)).collect();
    let side = |k: usize| boxes.iter().map(|[low, high]| high[k] - low[k]).fold(0.0, f64::max);
    let gap = SECTION_GAP * side(0).max(side(1));
    let pitch = [side(0) + gap, side(1) + gap];
    let columns = columns(drawn.len(), pitch, size.map(f64::from));
    for (i, (curves, [low, high])) in drawn.iter_mut().zip(boxes).enumerate() {
        #[expect(clippy::cast_precision_loss, reason = "there are few planes")]
        let place = [(i % columns) as f64 * pitch[0], (i / columns) as f64 * -pitch[1]];
        let middle = [0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])];
        for point in curves.iter_mut().flat_map(|curve| curve.points.as_chunks_mut::<2>().0) {
            *point = [point[0] - middle[0] + place[0], point[1] - middle[1] + place[1]];
        }
    }
}

/// Returns the number of columns that gives the largest scale for `n` cells of size `pitch`.
fn columns(n: usize, pitch: [f64; 2], size: [f64; 2]) -> usize {
    let scale = |columns: usize| {
        #[expect(clippy::cast_precision_loss, reason = "there are few planes")]
        let (across, along) = (columns as f64, n.div_ceil(columns) as f64);
        (size[0] / (across * pitch[0])).min(size[1] / (along * pitch[1]))
    };
    (2..=n).fold(1, |best, columns| if scale(columns) > scale(best) { columns } else { best })
}

/// Returns the smallest and the largest coordinates; zeros if there is no point.
fn bounds(curves: &[Curve]) -> [[f64; 2]; 2] {
    let points = curves.iter().flat_map(|curve| curve.points.as_chunks::<2>().0);
    let join = |bounds: Option<[[f64; 2]; 2]>, &p: &[f64; 2]| {
        let [low, high] = bounds.unwrap_or([p, p]);
        Some([[low[0].min(p[0]), low[1].min(p[1])], [high[0].max(p[0]), high[1].max(p[1])]])
    };
    points.fold(None, join).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    const Y: [f64; 3] = [0.0, 1.0, 0.0];
    const Z: [f64; 3] = [0.0, 0.0, 1.0];

    #[test]
    fn sections_are_seen_against_their_normals_and_up_is_up() {
        let x = [1.0, 0.0, 0.0];
        for (normal, up, expected) in [
            ([0.0, 0.0, 1.0], Y, [x, Y]),
            ([0.0, 0.0, -1.0], Y, [[-1.0, 0.0, 0.0], Y]),
            ([1.0, 0.0, 0.0], Y, [[0.0, 0.0, -1.0], Y]),
            (Y, Y, [x, [0.0, 0.0, -1.0]]),
            ([0.0, -1.0, 0.0], Y, [x, Z]),
            (Z, Z, [x, Y]),
            ([0.0, -1.0, 0.0], Z, [x, Z]),
        ] {
            assert_eq!(axes(normal, up), expected, "{normal:?} {up:?}");
        }
    }

    #[test]
    fn places_fill_the_picture() {
        assert_eq!(columns(1, [1.0, 1.0], [4.0, 3.0]), 1);
        assert_eq!(columns(3, [1.0, 1.0], [30.0, 10.0]), 3);
        assert_eq!(columns(3, [1.0, 1.0], [10.0, 30.0]), 1);
        assert_eq!(columns(4, [2.0, 2.0], [10.0, 10.0]), 2);
        assert_eq!(columns(5, [0.0, 0.0], [10.0, 10.0]), 1);
    }
}
