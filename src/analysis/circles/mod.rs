//! Finds the latitude lines of a mesh that become exact circles, and their radii.
//!
//! A line is reported as exact under three conditions. The rings around it, as far as the scheme reaches, are regular
//! polygons (or star polygons) on one axis with the same number of vertices and the same orientation, or end in a
//! boundary or a crease. All vertices of a ring have the same parameters. The plan preserves circles: a U, then
//! averages of which the first has the kernel `cos(alpha/2)` and the others 1, and push-backs with the compensation
//! `1/cos(alpha/2)`.
//!
//! With the centres `c_u` and complex radii `z_u`, vertex i of ring u is `c_u + z_u e^(i theta)` in the plane of the
//! ring. Along a ring the weights of a plan depend on the parity of a point only, so that the plan acts on the two
//! terms separately. It turns the centres, equal all around, into means that are equal all around again, and the second
//! term into a real factor times a sum of `z_u` with real weights, times the finer `e^(i theta)`: again a regular
//! polygon. (Parallel planes would therefore suffice.)

mod boundary;
mod outlook;
mod profile;
mod ring;
mod straight;
mod tube;
mod words;

pub use outlook::{LimitCircle, Outlook};
pub use straight::StraightTube;
pub use tube::outlooks;
