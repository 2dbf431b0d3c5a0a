//! One binary, one story a file.

mod forecast;
mod formats;
mod laws;
mod robustness;
mod shapes;
mod store;
mod support;
mod vectors;
