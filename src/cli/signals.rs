//! The signals that end a process.

use std::io;

#[cfg(unix)]
use tokio::signal::unix::{Signal, SignalKind, signal};

/// The signals SIGINT, SIGTERM and SIGHUP, caught since this was created.
#[derive(Debug)]
pub(super) struct Signals {
    #[cfg(unix)]
    interrupt: Signal,
    #[cfg(unix)]
    terminate: Signal,
    /// SIGHUP, sent when the terminal is closed; `None` if the process was started with it ignored.
    #[cfg(unix)]
    hang_up: Option<Signal>,
}

impl Signals {
    /// Starts to catch the signals, which no longer end the process by themselves. Must be called within a runtime.
    pub(super) fn new() -> io::Result<Self> {
        Ok(Self {
            #[cfg(unix)]
            interrupt: signal(SignalKind::interrupt())?,
            #[cfg(unix)]
            terminate: signal(SignalKind::terminate())?,
            #[cfg(unix)]
            hang_up: if ignores_hang_ups() { None } else { Some(signal(SignalKind::hangup())?) },
        })
    }

    /// Waits for the first signal and returns its exit code: 128 plus its number.
    #[cfg(unix)]
    pub(super) async fn first(mut self) -> u8 {
        let Self { interrupt, terminate, hang_up } = &mut self;
        let hung_up = async {
            match hang_up {
                Some(signal) => signal.recv().await,
                None => std::future::pending().await,
            }
        };
        tokio::select! {
            _ = hung_up => 129,
            _ = interrupt.recv() => 130,
            _ = terminate.recv() => 143,
        }
    }

    /// Waits for the first signal and returns its exit code: 128 plus its number.
    #[cfg(not(unix))]
    pub(super) async fn first(self) -> u8 {
        // If the signal cannot be caught, there is nothing to wait for.
        if tokio::signal::ctrl_c().await.is_err() {
            std::future::pending::<()>().await;
        }
        130
    }
}

/// Returns whether the process was started with SIGHUP ignored, as `nohup` does, according to `/proc`, if it exists.
#[cfg(unix)]
fn ignores_hang_ups() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    // The lowest bit belongs to signal 1, SIGHUP.
    ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).is_some_and(|mask| mask & 1 == 1)
}
