//! Limit surfaces: the limit positions of the vertices of a refined mesh, and the normals there.
//!
//! The limit of a vertex is that of its descendants: of itself under schemes that keep vertices, of the centre of the
//! face that takes its place under dual ones. It is a weighted mean of the points around it. The weights are not typed
//! in but computed from the operators themselves: one more cycle is applied to the disc of faces around the vertex,
//! the rows of the points around the child form a matrix, and so on with the child's disc. After a few levels a disc
//! is its own child, and the weights are the left eigenvector of the eigenvalue 1. While the numbers of a plan change
//! from level to level, the matrices of these levels are multiplied; a fixed matrix is used once nothing changes by
//! more than rounding. Equal discs are computed once.
//!
//! Source: M. Halstead, M. Kass, T. DeRose, SIGGRAPH 1993, 35-44 (limits from eigenvectors); math in [`mask`] and
//! [`tangent`].

mod bounds;
mod child;
mod continuity;
mod cost;
mod cycle;
mod disc;
mod disc_rules;
mod dual;
mod error;
mod field;
mod first_use;
mod grid;
mod impulse;
mod leading;
mod limits;
mod mask;
mod mesh;
mod neighbourhoods;
mod normals;
mod on_net;
mod perturbed;
mod probe;
mod record;
mod refined_net;
mod regular;
mod request;
mod rotation;
mod sector;
mod skeleton;
mod small;
mod swept;
mod tangent;
#[cfg(test)]
mod tests;
mod vertex_parameters;
mod walk;
mod weigh;

pub(super) use child::child;
pub use continuity::check;
pub(super) use continuity::check_continuous;
pub use cost::{Follow, LimitCost, cost, sees_whole_fans};
pub(super) use cycle::LEVELS_AHEAD;
pub(super) use disc::Centre;
pub use error::{LimitError, Unlimited};
pub(super) use limits::limits;
pub use mesh::{refine_mesh_to_limit, to_limit_by_rows};
pub use perturbed::{ROWS_A_POINT, followed_points};
pub(super) use record::{CycleRecord, WeightMode};
pub use request::LimitRequest;
pub use weigh::{NoWeights, weigh_mesh_to_limit};
