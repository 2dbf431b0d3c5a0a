//! What is in a picture: triangles with their look, and lines.

use super::finish::Finish;
use super::paint::Paint;

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
    /// Normals of the planes of the triangles.
    Planes,
}

/// How triangles look.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Surface<'a> {
    /// Lit, in this sRGB colour; its alpha does not count.
    Lit([u8; 4]),
    /// Lit, in these colours.
    Painted(Paint<'a>),
    /// With a finish of its own, in this sRGB colour or in those of the paint.
    Finished {
        /// The colour, whose alpha does not count.
        color: [u8; 4],
        /// Colours in its place.
        paint: Option<Paint<'a>>,
        /// How it looks.
        finish: Finish,
    },
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
    /// How much of their colour is seen where the surface hides them, 0 to 1.
    pub hidden: f32,
}

/// What happens when lines stand closer than they are wide.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Crowding {
    /// They cover what is under them.
    Keep,
    /// They become fainter, so that the surface stays visible.
    Fade,
}
