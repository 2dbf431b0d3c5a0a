//! Numbers and weights: floor 0, which knows no nets.

pub mod expression;
pub mod functions;
pub mod mask;
pub mod parameter;
pub mod planar;
pub mod rows;
pub mod sharing;
pub mod vector;
