//! The service: finds, joins or makes artifacts; knows no HTTP.

pub mod clock;
pub mod computation;
pub mod desk;
pub mod jobs;
pub mod pool;
pub mod store;
pub mod tiers;
