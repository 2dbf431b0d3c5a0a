//! One binary, one story a file.

mod formats;
mod store;
mod support;
mod vectors;
