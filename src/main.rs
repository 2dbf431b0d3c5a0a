//! The command line of planish.

use std::process::ExitCode;

fn main() -> ExitCode {
    planish::cli::run(planish::cli::Cli::from_command_line())
}
