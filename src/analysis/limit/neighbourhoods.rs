//! The neighbourhoods of a refined net's vertices that limits need, independent of the order of construction.

use std::fmt;

use super::disc::{Centre, Disc, Located, Rings};
use super::vertex_parameters::VertexParameters;
use crate::math::rows::Rows;
use crate::shape::numbering::Numbering;
use crate::watch::{Stopped, Watch};

/// The neighbourhoods of the vertices of a refined net.
///
/// Vertices are those whose limits are sought, points those whose weighted means the limits are; both are numbered as
/// the path that refined the net does. Where steps before the next upsampling put faces in the place of vertices, the
/// points are those after these steps, and [`centre`](Self::centre) says what took the place of a vertex. A second path
/// of refinement serves limits once it answers these questions; what it must keep is that discs with the same
/// connectivity and tags are equal, whatever the numbers of their points.
pub(super) trait Neighbourhoods: fmt::Debug + Sync {
    /// Number of vertices.
    fn n_vertices(&self) -> usize;
    /// Number of points.
    fn n_points(&self) -> usize;
    /// What took the place of a vertex, in numbers of points; `None` for a vertex without faces.
    fn centre(&self, v: usize) -> Option<Centre>;
    /// Whether vertices without faces are not among the points.
    fn leaves_out(&self) -> bool;
    /// The rings around a centre with their tags and sharpness, and the number of the point that each of their vertices
    /// is; `None` where there are too many.
    fn disc(&self, centre: Centre, rings: Rings) -> Option<Located>;
    /// The parameters that these points carry.
    fn parameters(&self, points: &[u32]) -> VertexParameters;
    /// The numbers by which perturbations of the vertices, edges and faces of a disc go.
    fn numbering(&self, found: &Located) -> Numbering;
    /// For the first face of each number of sides but this one the least of the discs around it that differ by where
    /// their numbers start, where it is not too large; none where points or edges carry what others do not.
    ///
    /// # Errors
    /// [`Stopped`].
    fn middles(&self, but: usize, rings: Rings, watch: &Watch) -> Result<Vec<Disc>, Stopped>;
    /// For each point whether something is within the rings around it that is not part of a grid of smooth quads, or
    /// carries what others do not.
    fn near_extraordinary(&self, rings: Rings) -> Vec<bool>;
    /// Adds these weights of the points within some rings of a point on a grid of quads, in the order of
    /// [`grid`](super::grid::grid).
    fn add_on_grid(&self, point: u32, rings: usize, weights: &[f64], out: &mut Rows);
}
