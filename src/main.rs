//! The command line of planish.

use std::process::ExitCode;

use clap::Parser;
use planish::cli::Cli;

fn main() -> ExitCode {
    planish::cli::run(Cli::parse())
}
