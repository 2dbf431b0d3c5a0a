//! The neighbourhoods of a refined net's vertices that limits need, independent of the order of construction.

use std::fmt;

use super::disc::{Centre, Disc, Located, RingCount};
use super::vertex_parameters::VertexParameters;
use crate::math::rows::Rows;
use crate::shape::numbering::Numbering;
use crate::watch::{Stopped, Watch};

/// The interface to the neighbourhoods of the vertices of a refined net.
///
/// Limits are computed for vertices, as weighted means of points; both are numbered by the path that refined the net.
/// If steps before the next upsampling put faces in the place of vertices, points are numbered after these steps, and
/// [`centre`](Self::centre) returns what took the place of a vertex. A second path of refinement supports limits by
/// implementing this trait. Discs with the same connectivity and tags must be equal, whatever the numbers of their
/// points.
pub(super) trait Neighbourhoods: fmt::Debug + Sync {
    /// Returns the number of vertices.
    fn n_vertices(&self) -> usize;
    /// Returns the number of points.
    fn n_points(&self) -> usize;
    /// Returns what took the place of a vertex, in numbers of points; `None` for a vertex without faces.
    fn centre(&self, v: usize) -> Option<Centre>;
    /// Returns whether vertices without faces are not among the points.
    fn leaves_out(&self) -> bool;
    /// Returns the rings around a centre with their tags and sharpness, and the point number of each of their vertices;
    /// `None` if the disc is too large.
    fn disc(&self, centre: Centre, rings: RingCount) -> Option<Located>;
    /// Returns the parameters that these points carry.
    fn parameters(&self, points: &[u32]) -> VertexParameters;
    /// Returns the numbers that select the perturbations of the vertices, edges and faces of a disc.
    fn numbering(&self, found: &Located) -> Numbering;
    /// Returns the least disc around the first face of each number of sides except `but`, over all starts of its
    /// numbering; too large discs are left out. Returns none if points or edges carry data of their own.
    ///
    /// # Errors
    /// [`Stopped`].
    fn middles(&self, but: usize, rings: RingCount, watch: &Watch) -> Result<Vec<Disc>, Stopped>;
    /// Returns for each point whether the rings around it contain anything that is not part of a grid of smooth quads,
    /// or that carries data of its own.
    fn near_extraordinary(&self, rings: RingCount) -> Vec<bool>;
    /// Adds these weights of the points within some rings of a point on a grid of quads, in the order of
    /// [`grid`](super::grid::grid).
    fn add_on_grid(&self, point: u32, rings: usize, weights: &[f64], out: &mut Rows);
}
