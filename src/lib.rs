//! planish refines control polygons and control meshes by subdivision, analyses the schemes, and draws the results.
//!
//! The modules form layers, separated by blank lines: each imports only from layers above it in this list. Three
//! modules may be used by all others: `fault`, `kept` and `watch`. One import crosses within a layer: `cli` uses
//! `http`, to start the service.

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

pub mod config;
pub mod service;

pub mod wire;

pub mod cli;
pub mod http;
