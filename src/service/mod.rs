//! The service: finds, joins or makes artifacts; knows no HTTP.

pub mod store;
