//! planish refines control polygons and control meshes by subdivision, analyses the schemes, and draws the results.
//!
//! The modules are floors, divided by blank lines: each imports only from floors above it in this list. Three are
//! leaves, which all may use: `fault`, `kept` and `watch`. One import goes between neighbours: `cli` starts `http`.

pub mod fault;
pub mod kept;
pub mod watch;

pub mod math;

pub mod drawing;
pub mod raster;
pub mod shape;

pub mod scheme;

pub mod refine;
pub mod solid;

pub mod analysis;
pub mod input;
pub mod output;

pub mod job;

pub mod service;

pub mod config;
pub mod wire;

pub mod cli;
pub mod http;
