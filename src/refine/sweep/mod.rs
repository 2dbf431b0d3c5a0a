//! Refinement of quads and of triangles patch by patch, straight into the documented order: the fast path.
//!
//! A patch is a grid with a halo of cells around it: of quads, or the lower half of such a grid, whose cells diagonals
//! cut into triangles. A round (a U and the steps up to the next one) is a few
//! flat loops over its planes of points; around vertices where the grid is not regular, small tables overwrite what the
//! loops made there, and along boundaries and creases masks of curves do. All masks and tables are read off the rows of
//! the operators. As symmetric sums do not depend on where a walk begins, every point has the bits that the rows of the
//! whole net give it.

mod evaluate;
mod fans;
mod grid;
mod kernel;
mod lanes;
mod lattice;
mod line;
mod mask;
mod numbering;
mod patches;
mod places;
mod planes;
mod program;
mod sample;
mod star;
mod stencils;
mod surface;
mod task;
mod traced;
mod weave;
mod window;

pub(crate) use evaluate::Rule;
pub(crate) use program::{Outline, Sweep};
pub(crate) use stencils::{Stencil, Stencils};
pub(crate) use traced::Traced;
pub(super) use window::OnDemand;
