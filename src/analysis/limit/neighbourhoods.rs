//! What limits ask of a refined net: what is around its vertices, and no order of construction.

use std::fmt;

use super::error::Unlimited;
use super::patch::{Centre, Located, Rings};
use super::vertex_parameters::VertexParameters;
use crate::math::rows::Rows;
use crate::scheme::surroundings::Surroundings;
use crate::shape::numbering::Numbering;
use crate::watch::{Stopped, Watch};

/// The neighbourhoods of the vertices of a refined net.
///
/// Vertices are those whose limits are sought, points those whose weighted means the limits are; both are numbered as
/// the path that refined the net does. Where steps before the next upsampling put faces in the place of vertices, the
/// points are those after these steps, and [`centre`](Self::centre) says what took the place of a vertex. A second path
/// of refinement serves limits once it answers these questions; what it must keep is that patches with the same
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
    /// What has to be known of the net beyond a patch, where it has a say; all patches carry it.
    fn surroundings(&self) -> Option<Surroundings>;
    /// The rings around a centre with their tags and sharpness, and the number of the point that each of their vertices
    /// is; `None` where there are too many.
    fn patch(&self, centre: Centre, rings: Rings) -> Option<Located>;
    /// The least of the patches around a centre that differ by where their numbers start.
    ///
    /// # Errors
    /// [`Stopped`].
    fn least_patch(&self, centre: Centre, rings: Rings, watch: &Watch) -> Result<Option<Located>, Stopped>;
    /// The parameters that these points carry.
    fn parameters(&self, points: &[u32]) -> VertexParameters;
    /// The numbers by which perturbations of the vertices, edges and faces of a patch go.
    fn numbering(&self, found: &Located) -> Numbering;
    /// Whether points or edges carry what others do not.
    fn carries(&self) -> bool;
    /// The first face of each number of sides but this one.
    fn middles(&self, but: usize) -> Vec<Centre>;
    /// For each point whether something is within the rings around it that is not part of a grid of smooth quads.
    fn near_extraordinary(&self, rings: Rings) -> Vec<bool>;
    /// Adds these weights of the points within some rings of a point on a grid of quads, in the order of
    /// [`grid`](super::grid::grid).
    fn add_on_grid(&self, point: u32, rings: usize, weights: &[f64], out: &mut Rows);
    /// What a vertex is, in words: its number would be one of a net that the client never sees.
    fn describe(&self, v: usize) -> String;

    /// The patch around what took the place of a vertex, and the parameters there; `None` for a vertex without faces.
    ///
    /// # Errors
    /// [`Unlimited::Size`].
    fn patch_of(&self, v: u32, rings: Rings) -> Result<Option<(Located, VertexParameters)>, Unlimited> {
        let Some(centre) = self.centre(v as usize) else { return Ok(None) };
        let found = self.patch(centre, rings).ok_or(Unlimited::Size)?;
        let parameters = self.parameters(&found.vertices);
        Ok(Some((found, parameters)))
    }
}
