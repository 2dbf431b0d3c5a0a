//! Pictures of triangles and lines: a tiled software rasteriser that knows no meshes and no shapes.
//!
//! Vertices are projected in parallel, triangles and lines are sorted into tiles of [`TILE`] pixels in the order of
//! submission, and tiles are drawn in parallel. A tile keeps depth and triangle number of four samples a pixel; light is
//! computed once for each triangle seen in a pixel, after everything hidden has fallen away. Threads divide tiles, never
//! a sum: the bytes are the same for any number of threads.

mod bins;
mod camera;
mod clip;
mod forecast;
mod frame;
mod line;
mod paint;
mod pixmap;
mod project;
mod shade;
#[cfg(test)]
mod tests;
mod tiles;
mod triangle;

pub use camera::{Camera, Projection, View};
pub use forecast::Forecast;
pub use paint::Paint;
pub use pixmap::Pixmap;

use crate::watch::{Stopped, Watch};

/// Side of a tile, pixels.
const TILE: usize = 32;

/// Largest width and height of a picture, pixels.
pub const MAX_SIDE_PX: u32 = 8192;

/// Everything in one picture.
#[derive(Debug, Clone, Copy)]
pub struct Model<'a> {
    /// Corners of triangles, model units.
    pub positions: &'a [[f64; 3]],
    /// Three corners each, counter-clockwise seen from outside.
    pub triangles: &'a [[u32; 3]],
    /// Directions that light sees.
    pub normals: Normals<'a>,
    /// How triangles look.
    pub surface: Surface<'a>,
    /// Lines and discs, the first list undermost.
    pub strokes: &'a [Strokes<'a>],
}

/// Normals of a surface, of length one or zero; where one is zero, that of the triangle's plane is taken.
#[derive(Debug, Clone, Copy)]
pub enum Normals<'a> {
    /// One a vertex, blended over the triangle.
    Vertices(&'a [[f64; 3]]),
    /// One a triangle.
    Triangles(&'a [[f64; 3]]),
    /// Those of the planes of the triangles.
    Planes,
}

/// How triangles look.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Surface<'a> {
    /// Lit, in this sRGB colour; its alpha does not count.
    Lit([u8; 4]),
    /// Lit, in these colours.
    Painted(Paint<'a>),
    /// Not seen, but hiding the lines behind it.
    Unseen,
}

/// Lines of one look; a line from a point to itself is a disc.
#[derive(Debug, Clone, Copy)]
pub struct Strokes<'a> {
    /// Ends, model units.
    pub positions: &'a [[f64; 3]],
    /// Pairs of ends.
    pub segments: &'a [[u32; 2]],
    /// Width of the lines or diameter of the discs, pixels.
    pub width_px: f32,
    /// Straight sRGB.
    pub color: [u8; 4],
    /// What happens when lines stand closer than they are wide.
    pub crowding: Crowding,
}

/// What happens when lines stand closer than they are wide.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Crowding {
    /// They cover what is under them.
    Keep,
    /// They become fainter, so that the surface stays visible.
    Fade,
}

/// Draws the model into a picture of `width x height` pixels (1 to [`MAX_SIDE_PX`] each; the camera must have been framed
/// for them) over `background`, straight sRGB.
///
/// # Errors
/// [`Stopped`] when the watch says stop; it is asked at least once a tile.
///
/// # Panics
/// When an index points past its array.
pub fn render(
    model: &Model<'_>,
    camera: &Camera,
    background: [u8; 4],
    [width, height]: [u32; 2],
    watch: &Watch,
) -> Result<Pixmap, Stopped> {
    let (width, height) = (width.clamp(1, MAX_SIDE_PX), height.clamp(1, MAX_SIDE_PX));
    let frame = frame::Frame::new(model, camera, bins::Grid::of(width, height), watch)?;
    tiles::draw(&frame, background, width, height, watch)
}
