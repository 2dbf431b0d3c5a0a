//! The common parts of the output formats that draw: pictures in pixels and drawings in lines.

pub(super) mod coat;
mod comb;
mod contours;
pub(super) mod drawing;
mod easel;
pub(super) mod forecast;
pub(super) mod framing;
pub(super) mod hidden_lines;
pub(super) mod legend;
pub(super) mod lines;
pub(super) mod look;
pub(super) mod meanings;
pub(super) mod mesh;
pub(super) mod number_scale;
pub(super) mod options;
pub(super) mod outline;
pub(super) mod plot;
pub(super) mod sections;
pub(super) mod shading;
mod skin;
pub(super) mod styles;
pub(super) mod vector;
mod view_box;
