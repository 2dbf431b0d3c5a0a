//! Operators: one file each; the registry is the only place that lists them.

pub(super) mod around;
mod average;
mod box_average;
mod butterfly;
mod catmull_clark;
mod circle;
mod cosines;
mod doo_sabin;
mod dual;
mod incenter;
mod kobbelt_edges;
mod kobbelt_faces;
mod latitude;
mod local_average;
mod loop_smoothing;
mod masked;
mod push_back;
mod registry;
mod ring_average;
mod root_three;
mod upsample;

pub use butterfly::ButterflyEdges;
pub use catmull_clark::CatmullClark;
pub use circle::Circle;
pub use doo_sabin::DooSabin;
pub(super) use dual::{cannot_carry, dual, no_interior, no_manifold};
pub use incenter::Incenter;
pub use kobbelt_edges::KobbeltEdges;
pub use kobbelt_faces::KobbeltFaces;
pub use loop_smoothing::LoopSmoothing;
pub use masked::Masked;
pub use push_back::CIRCULAR_PUSH_BACK;
pub(super) use push_back::{lost_points, no_anchor, odd_duals, seen_valence};
pub use registry::OPERATORS;
pub use root_three::RootThree;
pub(super) use upsample::not_triangles;
