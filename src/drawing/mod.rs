//! Two-dimensional drawings: one description of lines, areas, discs, text and pictures, and three back ends that paint
//! it as pixels or write it as SVG or PDF.
//!
//! A drawing knows nothing of formats, options or shapes: whoever has something to draw makes items, and hands the
//! [`Drawing`] to [`pixels()`], [`svg()`] or [`pdf()`]. All lengths are pixels, y downwards; 96 pixels are an inch, as
//! in CSS. The bytes of all three are the same on every machine: nothing in them tells of a time, a font of the system,
//! or chance.

mod axes;
mod error;
mod font;
mod label;
mod legend;
mod letters;
mod pdf;
mod pixels;
mod scene;
mod svg;
mod ticks;

pub use axes::{Axes, Axis};
pub use error::DrawError;
pub use font::{ASCENT, DESCENT, FontWeight};
pub use label::{Label, wrapped};
pub use legend::{Legend, LegendEntry, LegendSample, color_bar};
pub use pdf::pdf;
pub use pixels::pixels;
pub use scene::{
    Cap, Color, Discs, Drawing, DrawingItem, Group, HorizontalAlign, Lettering, Mark, Picture, Point, PolylinePoints,
    Stroke, Text, VerticalAlign,
};
pub use svg::svg;
pub use ticks::{Tick, ticks};
