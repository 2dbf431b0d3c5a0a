//! The service: finds, joins or makes artifacts; knows no HTTP.

pub mod account;
pub mod clock;
pub mod computation;
pub mod desk;
pub mod jobs;
mod line;
pub mod peer;
pub mod pool;
pub mod store;
pub mod task;
pub mod tiers;
