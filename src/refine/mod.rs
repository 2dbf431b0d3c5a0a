//! Refinement: applies the steps of a plan to points. Other modules do not depend on how a net is stored.

mod act;
mod apply;
mod at_limit;
mod error;
mod mesh;
mod normals;
mod origins;
mod polygon;
mod program;
mod recorder;
mod refined;
mod seams;
mod shown;
mod source;
mod start;
mod streamed;
mod sweep;
mod swept;
mod unfolded;
mod vertex_order;
mod weighed;

pub use act::act_on;
pub use apply::{Points, advance};
pub use error::RefineError;
pub use mesh::{assembled, is_swept, numbers, refine_by_rows, swept_from};
pub use normals::Normals;
pub use polygon::{refine_polygon, refined_points};
pub use program::{Program, refine_mesh};
pub use recorder::Recorder;
pub use refined::RefinedMesh;
pub use seams::{refined_places, seam_net};
pub use start::{carried, mesh_net, polygon_net};
pub use streamed::{StreamedMesh, held_levels};
pub(crate) use sweep::{Stencil, StencilReach, Stencils, TracedRows};
pub use weighed::{documented, weigh_mesh, weigh_net, weigh_polygon};
