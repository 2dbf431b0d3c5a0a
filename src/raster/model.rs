//! The content of a picture: triangles with their appearance, and lines.

use super::finish::Finish;
use super::paint::Paint;

/// Everything in one picture.
#[derive(Debug, Clone, Copy)]
pub struct Model<'a> {
    /// Corners of triangles, in model units.
    pub positions: &'a [[f64; 3]],
    /// Three corners each, counter-clockwise seen from outside.
    pub triangles: &'a [[u32; 3]],
    /// Normals for shading.
    pub normals: ShadingNormals<'a>,
    /// The appearance of the triangles.
    pub surface: TriangleAppearance<'a>,
    /// Lines and discs; the first list is drawn first.
    pub strokes: &'a [Strokes<'a>],
}

/// Unit normals for shading; a zero normal is replaced by that of the triangle's plane.
#[derive(Debug, Clone, Copy)]
pub enum ShadingNormals<'a> {
    /// One normal per vertex, interpolated over each triangle.
    Vertices(&'a [[f64; 3]]),
    /// One normal per triangle.
    Triangles(&'a [[f64; 3]]),
    /// The normals of the triangles' planes.
    Planes,
}

/// The appearance of the triangles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TriangleAppearance<'a> {
    /// Lit, in this sRGB colour; its alpha is ignored.
    Lit([u8; 4]),
    /// Lit, in varying colours.
    Painted(Paint<'a>),
    /// With a finish, in this sRGB colour or in varying ones.
    Finished {
        /// The colour; its alpha is ignored.
        color: [u8; 4],
        /// Varying colours that replace it.
        paint: Option<Paint<'a>>,
        /// The finish.
        finish: Finish,
    },
    /// Invisible, but hiding the lines behind it.
    Unseen,
}

/// Lines with a common appearance; a line from a point to itself is a disc.
#[derive(Debug, Clone, Copy)]
pub struct Strokes<'a> {
    /// End points, in model units.
    pub positions: &'a [[f64; 3]],
    /// Pairs of end points.
    pub segments: &'a [[u32; 2]],
    /// Width of the lines, or diameter of the discs, in pixels.
    pub width_px: f32,
    /// The colour, straight sRGB.
    pub color: [u8; 4],
    /// The treatment of places where lines are closer than they are wide.
    pub crowding: Crowding,
    /// Opacity of the lines where the surface hides them, 0 to 1.
    pub hidden: f32,
}

/// The treatment of places where lines are closer than they are wide.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Crowding {
    /// The lines cover what is below them.
    Keep,
    /// The lines become fainter, so that the surface stays visible.
    Fade,
}
