//! One binary, one story a file.

mod expressions;
mod forecast;
mod formats;
mod keys;
mod laws;
mod robustness;
mod shapes;
mod store;
mod support;
mod vectors;
mod words;
