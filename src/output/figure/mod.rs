//! Figures: pictures of several scenes in a grid.

mod compose;
mod extent;
mod grid;

pub use compose::{PanelPicture, picture, size, suits, write};
pub use extent::{FigureExtent, framed};
pub use grid::{MAX_CAPTION_CHARS, MAX_COLUMNS, MAX_PANELS, PanelCell, PanelGrid, PanelRect, Sheet};
