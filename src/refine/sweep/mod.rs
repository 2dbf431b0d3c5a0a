//! The fast path: refines quads and triangles patch by patch, straight into the documented order.
//!
//! A patch is a grid with a halo of cells around it. Triangles use the lower half of such a grid, whose cells are
//! divided by diagonals. A round (an upsampling and the steps up to the next one) is a few flat loops over the planes
//! of a grid, or, while patches are small, of a stack of grids, whose points are interleaved. Where the grid is not
//! regular around a vertex, small tables then overwrite the points that the loops computed; along boundaries and
//! creases, masks of curves do. All masks and tables are read off the rows of the operators. As a symmetric sum does
//! not depend on where a walk around a vertex begins, every point has the same bits as under the rows of the whole net.

mod aligned;
mod block;
mod bundle;
mod evaluate;
mod fans;
mod grid;
mod joint;
mod kernel;
mod lanes;
mod lattice;
mod line;
mod mask;
mod numbering;
mod overlay;
mod patch_evaluator;
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
mod upcoming;
mod weave;
mod window;

pub(crate) use evaluate::PointValues;
pub(crate) use patch_evaluator::ValueRule;
pub(crate) use program::{Sweep, SweepOutline};
pub(crate) use stencils::{Stencil, StencilReach, Stencils};
pub(crate) use traced::TracedRows;
pub(super) use window::OnDemand;
