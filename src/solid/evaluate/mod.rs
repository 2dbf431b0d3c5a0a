//! Values of the limit surface at places on the input faces, without caps: exact up to rounding.

mod descent;
mod isolated;
mod jet;
mod place;
mod vertex;

pub use descent::evaluate;
pub use jet::Jet;
pub use place::Place;

#[cfg(test)]
mod tests;
