//! One binary, one story a file.

mod expressions;
mod forecast;
mod formats;
mod house;
mod keys;
mod laws;
mod nets;
mod robustness;
mod shapes;
mod store;
mod support;
mod vectors;
mod words;
