//! Finds the level at which a mesh is within a tolerance of its limit surface.
//!
//! Where a net is regular, averages move vertices by multiples of second differences, which a level divides by 4
//! ([`spline`], [`bend`]); elsewhere the limit lies in the hull of the points around ([`mod@bound`]). Further levels
//! are measured until what is left is small, at last only around faces where it is not ([`level`]). Where points move
//! along the surface, they do not leave it ([`sheet`]).
//!
//! Derivation and sources: `docs/tolerance.md`; Dyn and Levin, Acta Numerica 11 (2002), section 3; Cheng, Chen and
//! Yong, LNCS 4035 (2006), 404-416; Lane and Riesenfeld, IEEE PAMI 2 (1980), 35-46.

mod bend;
mod bound;
mod bounds;
mod budget;
mod cut;
mod hull;
mod level;
mod nearest;
mod placed;
mod remainder;
mod search;
mod sheet;
mod spline;
mod walk;

pub use bounds::MAX_WORK;
pub use placed::Placed;
pub use search::{check, reach, search_bytes};
