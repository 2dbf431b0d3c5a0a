//! Pictures: what the formats that draw have in common.

pub(super) mod coat;
mod comb;
pub(super) mod drawing;
mod easel;
pub(super) mod forecast;
pub(super) mod framing;
pub(super) mod mesh;
pub(super) mod options;
pub(super) mod plot;
pub(super) mod sections;
mod skin;
pub(super) mod styles;
pub(super) mod vector;
