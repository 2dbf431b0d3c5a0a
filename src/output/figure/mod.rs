//! Figures: pictures of several scenes in a grid.

mod compose;
mod extent;
mod grid;

pub use compose::{Picture, picture, size, suits, write};
pub use extent::{Extent, framed};
pub use grid::{Grid, MAX_COLUMNS, MAX_PANELS, MAX_TEXT, PanelCell, PanelRect, Sheet};
