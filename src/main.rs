//! The command line of planish.

use std::process::ExitCode;

/// Memory goes back to the system when requests are done: the usual allocator of Linux kept gigabytes after a burst.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    planish::cli::run(planish::cli::Cli::from_command_line())
}
