//! Finds the first level at which a mesh is within a tolerance of its limit surface.
//!
//! Where a net is regular, averages move vertices by at most a multiple of the second differences, which each level
//! divides by 4 ([`spline`], [`bend`]). Elsewhere the limit of a face lies in the convex hull of the points that it
//! depends on ([`hull`]). Together these bound the remainder, the distance between a net and its limit ([`remainder`]).
//! The distance between the output and finer nets is measured until the remainder is small; in the end, only the
//! surroundings of faces with a large remainder are refined ([`mod@bound`], [`level`]). Movements along the surface do
//! not count as distance, as far as the surface is a graph over a plane ([`sheet`]).
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

pub use bounds::MAX_MESH_WORK;
pub use placed::VertexPlacement;
pub use search::{check, reach, search_bytes};
