//! The command line: runs the same jobs as the HTTP service, by the same code, with identical bytes as results.

mod analyse;
mod catalogue;
mod command;
mod compare;
mod elsewhere;
mod error;
mod estimate;
mod evaluate;
mod fault_translator;
mod figures;
mod files;
mod flags;
mod folder;
mod health;
mod inputs;
mod job;
mod key;
mod library;
mod log;
mod mcp;
mod peek;
mod pieces;
mod progress;
mod remote;
mod render;
mod reproduce;
mod say;
mod serve;
mod shell;
mod sign;
mod signals;
mod sniff;
mod targets;
mod tools;
mod validate;

pub use command::{Cli, run};
