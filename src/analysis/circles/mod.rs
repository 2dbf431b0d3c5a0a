//! Finds the latitude lines of a mesh that become exact circles, and their radii.
//!
//! A line is told exact when the rings around it, as far as the scheme reaches, are regular polygons of as many
//! vertices on one axis that turn the same way, stars included, or end in a boundary or a crease, when every vertex of
//! a ring has the same parameters, and when the plan keeps circles: a U, then averages of which the first has the
//! kernel `cos(alpha/2)` and the others 1, and push-backs with the compensation `1/cos(alpha/2)`.
//!
//! With the centres `c_u` and complex radii `z_u` the vertex i of the ring u is `c_u + z_u e^(i theta)` in its plane.
//! The weights of a plan depend on the place along a ring by its parity alone, so that it acts on both parts apart: of
//! the centres, equal all around, it makes means, equal all around again, and of the second part a real factor times a
//! sum of `z_u` with real weights, times the finer `e^(i theta)`: a regular polygon again. (So parallel planes would be
//! enough.)

mod boundary;
mod outlook;
mod profile;
mod ring;
mod straight;
mod tube;
mod words;

pub use outlook::{Circle, Outlook};
pub use straight::StraightTube;
pub use tube::outlooks;
