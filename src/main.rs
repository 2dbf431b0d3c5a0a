//! The binary `planish`: runs the command line.

use std::process::ExitCode;

/// The allocator returns freed memory to the system within ten seconds, by background threads: the default allocator of
/// Linux kept gigabytes after a burst.
#[cfg(not(windows))]
#[global_allocator]
static ALLOCATOR: tikv_jemallocator::Jemalloc = tikv_jemallocator::Jemalloc;

fn main() -> ExitCode {
    planish::cli::run(planish::cli::Cli::from_command_line())
}
