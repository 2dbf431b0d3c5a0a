//! One binary, one story a file.

mod cache;
mod carried;
mod cli;
mod expressions;
mod figures;
mod forecast;
mod formats;
mod hardening;
mod house;
mod http;
mod keys;
mod laws;
mod limits;
mod nets;
mod openapi;
mod readers;
mod refusals;
mod robustness;
mod sections;
mod shapes;
mod stats;
mod store;
mod support;
mod told_before;
mod vectors;
mod words;
