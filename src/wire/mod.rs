//! Request and answer types: the only serde of jobs; used by http and cli.

pub mod analysis;
pub mod answer;
pub mod catalogue;
mod channels;
mod choice;
mod corners;
mod declared;
pub(crate) mod fields;
mod figure;
mod fixed;
pub mod input;
pub mod job;
pub mod levels;
pub mod literal;
pub mod material;
pub mod mesh;
pub mod object;
pub mod output;
pub mod plan;
pub mod polygon;
pub mod posted;
pub mod query;
pub mod query_parameters;
pub mod read;
mod report;
mod schema;
pub mod standing;
pub mod surface_analysis;
pub mod text;
pub mod tube_analysis;
mod variants;
pub mod weld;
mod whole;
pub(crate) mod written;

pub use job::JobRequest;
