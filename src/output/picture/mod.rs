//! Pictures: what the formats that draw have in common.

pub(super) mod coat;
mod comb;
pub(super) mod drawing;
mod easel;
pub(super) mod forecast;
mod hidden_lines;
pub(super) mod mesh;
pub(super) mod options;
pub(super) mod plot;
pub(super) mod sections;
mod skin;
pub(super) mod styles;
pub(super) mod vector;
