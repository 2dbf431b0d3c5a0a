//! Pictures of triangles and lines: a tiled software rasteriser that knows no meshes and no shapes.
//!
//! Vertices are projected in parallel, triangles and lines are sorted into tiles of 32 x 32 pixels, and tiles are drawn
//! in parallel: first the triangles that show their outside, then those that show their inside, most of which are found
//! hidden before their pixels are looked at. A tile keeps depth and triangle number of four samples a pixel; of equal
//! depths the lower number is seen, so the order of drawing does not matter. Light is computed once for each triangle
//! seen in a pixel, after everything hidden has fallen away. Pixels in which an edge is then seen are drawn once more
//! with sixteen samples. At last hollows are darkened, a shadow is laid on the ground, and lines are laid over all.
//! Threads divide tiles, never a sum: the bytes are the same for any number of threads.

mod axes;
mod binned_model;
mod bins;
mod camera;
mod clip;
mod contact;
#[cfg(test)]
mod coverage_tests;
mod culling;
mod difference;
mod extents;
mod facet_block;
mod facets;
mod fine;
mod finish;
mod forecast;
mod ground;
#[cfg(test)]
mod grounding_tests;
mod height_map;
mod lighter;
mod line;
mod model;
mod occlusion;
mod paint;
mod pixmap;
mod project;
mod samples;
mod shade;
mod sight;
mod spots;
#[cfg(test)]
mod tests;
mod texels;
mod tile_rows;
mod tile_scratch;
mod tiles;
mod triangle;
mod triangle_block;
mod veil;

pub use camera::{Camera, Projection, View};
pub use contact::Ground;
pub use difference::{Difference, Measure, Pixels, difference};
pub use finish::{Finish, StripePattern, Stripes};
pub use forecast::RasterForecast;
pub use model::{Crowding, Model, ShadingNormals, Strokes, TriangleAppearance};
pub use paint::{Paint, Swatch};
pub use pixmap::Pixmap;
pub use sight::{ProjectedPoint, Sight};
pub use texels::{Cover, Texels, WrapMode};
pub use tiles::{MAX_SIDE_PX, RenderStyle, render};
