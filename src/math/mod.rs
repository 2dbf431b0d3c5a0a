//! Numbers and weights, the lowest layer, which knows no nets.

pub mod amounts;
pub mod dense;
pub mod distinct;
pub mod elimination;
pub mod exact;
pub mod exactly;
pub mod expression;
pub mod functions;
pub mod mask;
pub mod number;
pub mod parameter;
pub mod planar;
pub mod rows;
pub mod sharing;
pub mod spectrum;
pub mod vector;
pub mod weight;
