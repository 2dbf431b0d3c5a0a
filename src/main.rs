//! The command line of planish.

use std::process::ExitCode;

/// Memory goes back to the system within ten seconds of being freed, by threads that do only this: the usual allocator
/// of Linux kept gigabytes after a burst.
#[cfg(not(windows))]
#[global_allocator]
static ALLOCATOR: tikv_jemallocator::Jemalloc = tikv_jemallocator::Jemalloc;

fn main() -> ExitCode {
    planish::cli::run(planish::cli::Cli::from_command_line())
}
