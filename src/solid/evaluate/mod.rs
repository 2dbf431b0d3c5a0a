//! Values of the limit surface at places on the input faces, without caps: exact up to rounding.

mod boxes;
mod closest;
mod descent;
mod isolated;
mod jet;
mod lowest;
mod patch;
mod pieces;
mod place;
mod vertex;

pub use closest::{Closest, closest};
pub use descent::evaluate;
pub use jet::Jet;
pub use place::Place;
