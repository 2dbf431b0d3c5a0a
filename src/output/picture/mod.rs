//! Pictures: what the formats that draw have in common.

pub(super) mod coat;
pub(super) mod drawing;
pub(super) mod forecast;
pub(super) mod mesh;
pub(super) mod options;
pub(super) mod sections;
mod skin;
pub(super) mod vector;
