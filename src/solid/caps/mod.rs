//! Caps: patches that close the surface around an extraordinary vertex, where it has no bicubic piece, with common
//! tangent planes along every edge and a statement of their distance from the limit surface.

mod bezier;
mod bound;
mod characteristic;
mod composed;
mod cost;
mod join;
mod least;
mod proof;
mod rings;
mod samples;
mod stretch;
mod table;

pub use bound::{Deviation, DeviationMethod};
pub use characteristic::decay;
pub use cost::{CapCost, cost};
pub use table::{CapPatch, CapTable, VALENCES};

#[cfg(test)]
mod tests;
