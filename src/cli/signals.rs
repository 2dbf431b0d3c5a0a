//! The signals that end a process.

use std::io;

#[cfg(unix)]
use tokio::signal::unix::{Signal, SignalKind, signal};

/// Interrupts, terminations and hang-ups from the moment on when they were asked for.
#[derive(Debug)]
pub(super) struct Signals {
    #[cfg(unix)]
    interrupt: Signal,
    #[cfg(unix)]
    terminate: Signal,
    /// A terminal that is closed; nothing where whoever started the process has it ignored.
    #[cfg(unix)]
    hang_up: Option<Signal>,
}

impl Signals {
    /// Signals no longer end the process by themselves from here on; within a runtime.
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

    /// Waits for the first signal, and gives the code that it ends a command with: 128 and its number.
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

    /// Waits for the first signal, and gives the code that it ends a command with: 128 and its number.
    #[cfg(not(unix))]
    pub(super) async fn first(self) -> u8 {
        // without a signal there is nothing to wait for
        if tokio::signal::ctrl_c().await.is_err() {
            std::future::pending::<()>().await;
        }
        130
    }
}

/// Whether the process was started with hang-ups ignored, as `nohup` does: `/proc` tells, where there is one.
#[cfg(unix)]
fn ignores_hang_ups() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    // the lowest bit is that of signal 1
    ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).is_some_and(|mask| mask & 1 == 1)
}
