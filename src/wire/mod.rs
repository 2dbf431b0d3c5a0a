//! Request and answer types: the only serde of jobs; used by http and cli.

pub mod analysis;
pub mod answer;
pub mod catalogue;
mod channels;
mod choice;
mod fixed;
pub mod input;
pub mod job;
pub mod levels;
pub mod literal;
pub mod mesh;
pub mod object;
pub mod output;
pub mod plan;
pub mod polygon;
pub mod read;
mod report;
mod schema;
pub mod text;

pub use job::JobRequest;
