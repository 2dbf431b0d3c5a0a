//! The HTTP interface: one file a resource, listed in `routes`.

mod address;
mod answer;
mod app;
mod artifacts;
mod body;
mod canary;
mod catalogue;
mod client;
mod connections;
mod document;
mod early;
mod estimate;
mod guard;
mod health;
mod jobs;
mod memo;
mod negotiate;
mod pace;
mod pages;
mod problem;
mod reading;
mod render;
mod requests;
mod router;
mod routes;
mod segment;
pub mod serve;
mod short;
mod stream;
mod validate;

pub use app::App;
pub use canary::Canary;
pub use connections::Connections;
pub use memo::Memo;
pub use router::{document, document_text, router};
pub use short::Short;
