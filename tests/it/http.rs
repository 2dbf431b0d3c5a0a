//! The service as its clients see it: a real server on a free port, accessed over TCP.
#![allow(clippy::unwrap_used, reason = "a test may fail where it stands")]

mod analyses;
mod batches;
mod blobs;
mod browsers;
mod caching;
mod catalogue;
mod comparisons;
mod durable;
mod errors;
mod evaluations;
mod events;
mod examples;
mod files;
mod formats;
pub(crate) mod jobs;
pub(crate) mod keys;
mod levels_of_detail;
mod links;
mod metrics;
mod negotiation;
mod operations;
mod play;
mod posting;
mod questions;
mod quotas;
mod ranges;
pub(crate) mod server;
mod short;
mod signed;
mod streaming;
mod tenants;
mod traces;
mod variants;
mod waiting;
