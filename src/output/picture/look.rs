//! The look of the surface in a picture: its colours, its finish, and the numbers that its colours stand for.

use super::coat::{self, Coat};
use super::contours;
use super::lines::LEGEND_ITEM;
use super::number_scale::{NumberScale, symmetric};
use super::options::Options;
use super::shading::{self, SURFACE, ShadedQuantity};
use crate::math::parameter::Values;
use crate::output::color_maps::ColorMap;
use crate::output::counts::Counts;
use crate::output::error::FormatError;
use crate::output::mesh_curvature::{self, curvatures};
use crate::output::nearest::{self, Triangles};
use crate::output::normals;
use crate::output::positions::Positions;
use crate::output::scene::{MeshSource, Scene, Shape};
use crate::raster::{Camera, Finish, TriangleAppearance};
use crate::shape::attachments::Attachments;
use crate::watch::Watch;

/// Least upper end of the default range of mean curvature, times half the longest side of the mesh; Gaussian curvature
/// has its square. Surfaces whose radius of curvature is a thousand times their size look flat. Half of it shows what
/// rounding to f32 does to flat meshes of 100 vertices a side; twice of it hides faint bulges.
const LEAST_CURVATURE_RANGE: f64 = 1e-3;

/// Least upper end of the default range of distances, in half the longest side of the mesh: ten times what rounding to
/// f32 moves a point. Half or twice of it makes a difference only for meshes of single precision, where the picture
/// shows the roundings.
const LEAST_DISTANCE_RANGE: f64 = 1e-6;

/// The look of a surface.
#[derive(Debug)]
pub(super) struct SurfaceLook {
    coat: Coat,
    color: [u8; 4],
    finish: Option<Finish>,
}

impl SurfaceLook {
    /// Determines the look of a mesh with these positions, which differs from the shape of the scene in that some of
    /// its vertices are split.
    pub(super) fn of(
        scene: &Scene<'_>,
        mesh: &dyn MeshSource,
        positions: &[[f64; 3]],
        options: &Options<'_>,
        camera: &Camera,
        watch: &Watch,
    ) -> Result<Self, FormatError> {
        let color = shading::color(options, SURFACE);
        let finish = shading::finish(options, camera.right());
        let coat = match (shading::measure(options.values), finish) {
            (Some(ShadedQuantity::Distance), _) => by_distance(scene, positions, options.values, watch)?,
            (Some(measure), _) => by_curvature(measure, mesh, positions, options.values, watch)?,
            (None, Some(_)) => Coat::Plain(color),
            (None, None) => Coat::of(mesh, options, color, watch)?,
        };
        Ok(Self { coat, color, finish })
    }

    /// Returns the surface for the rasteriser.
    pub(super) fn surface(&self) -> TriangleAppearance<'_> {
        match self.finish {
            None => self.coat.surface(),
            Some(finish) => TriangleAppearance::Finished { color: self.color, paint: self.coat.paint(), finish },
        }
    }

    /// Returns the scale by which colours stand for numbers, if they do.
    pub(super) fn scale(&self) -> Option<NumberScale> {
        if let Coat::Numbers { scale, .. } = &self.coat { Some(*scale) } else { None }
    }
}

fn by_curvature(
    measure: ShadedQuantity,
    mesh: &dyn MeshSource,
    positions: &[[f64; 3]],
    options: &Values,
    watch: &Watch,
) -> Result<Coat, FormatError> {
    let found = curvatures(mesh, positions, watch)?;
    let flat = LEAST_CURVATURE_RANGE * normals::scale(positions);
    let (numbers, least) = match measure {
        ShadedQuantity::Gaussian => (found.gaussian, flat * flat),
        _ => (found.mean, flat),
    };
    let scale = NumberScale::new(&numbers, options, ColorMap::SIGNED, |_| symmetric(&numbers, &found.areas, least));
    Ok(Coat::numbers(&numbers, None, scale))
}

fn by_distance(
    scene: &Scene<'_>,
    positions: &[[f64; 3]],
    options: &Values,
    watch: &Watch,
) -> Result<Coat, FormatError> {
    let Shape::Mesh(other) = scene.control.measured_from() else {
        return Err(FormatError::Unfit("distances are those of a mesh; leave \"shading\" out".to_owned()));
    };
    let corners = Positions::of_mesh(other).held(watch)?;
    let mut distances = Triangles::of(other, corners.rows(), watch)?.distances(positions, watch)?;
    // there is no distance if the other mesh has no faces
    distances.iter_mut().filter(|distance| !distance.is_finite()).for_each(|distance| *distance = 0.0);
    // smaller distances come from rounding
    let least = LEAST_DISTANCE_RANGE / normals::scale(positions);
    let scale = NumberScale::new(&distances, options, ColorMap::VIRIDIS, |[_, most]| [0.0, most.max(least)]);
    Ok(Coat::numbers(&distances, None, scale))
}

/// Returns whether colours stand for numbers.
pub(crate) fn are_numbers(carried: &Attachments, options: &Values) -> bool {
    shading::measure(options).is_some() || coat::numbers_of(carried, options).is_some()
}

/// Returns the work of the numbers and of a finish, in rows of 100 ns.
pub(crate) fn work(options: &Values, counts: &Counts, pixels: u128) -> u128 {
    /// Rows for a search of the tree, for a corner of a face in three sums, and for a pixel of stripes, which takes
    /// twelve quotients and roots: 2 us, 100 ns and 300 ns, estimates from pictures of the animal of the examples at
    /// level 5.
    const COLORING_ROWS: [u128; 3] = [20, 1, 3];
    let numbers = match shading::measure(options) {
        Some(ShadedQuantity::Distance) => counts.vertices.saturating_mul(COLORING_ROWS[0]),
        Some(_) => counts.half_edges.saturating_mul(COLORING_ROWS[1]),
        None => 0,
    };
    numbers.saturating_add(if shading::is_finished(options) { pixels.saturating_mul(COLORING_ROWS[2]) } else { 0 })
}

/// Returns the memory in bytes for the numbers of `vertices` vertices, for lines and for the legend.
pub(crate) fn memory(options: &Values, vertices: u128, pixels: u128, counts: &Counts) -> u128 {
    let lines =
        if shading::is_drawing(options) { counts.half_edges.saturating_mul(contours::CONTOUR_CORNER_BYTES) } else { 0 };
    // the picture without its legend, and the legend, twice
    let has_legend = are_numbers(&counts.attachments, options) || options.has("show", LEGEND_ITEM);
    let legend = if has_legend { pixels.saturating_mul(8) } else { 0 };
    let numbers = match shading::measure(options) {
        // numbers and their shares, and the tree
        Some(ShadedQuantity::Distance) => {
            // a mesh has fewer triangles than half-edges
            let net = (counts.input_edges as u128).saturating_mul(2 * nearest::TREE_TRIANGLE_BYTES);
            vertices.saturating_mul(8 + 4).saturating_add(net).saturating_add(counts.control.saturating_mul(24))
        }
        // the sum includes the buffer in which the range of the values is found
        Some(_) => vertices.saturating_mul(mesh_curvature::CURVATURE_VERTEX_BYTES + 16 + 4),
        None => 0,
    };
    lines.saturating_add(legend).saturating_add(numbers)
}
