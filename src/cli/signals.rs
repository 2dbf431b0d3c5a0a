//! The signals that end a process.

use std::io;

use tokio::runtime::{Builder, Runtime};
#[cfg(unix)]
use tokio::signal::unix::{Signal, SignalKind, signal};

/// Waits for an interrupt or for termination.
#[derive(Debug)]
pub(super) struct Signals {
    runtime: Runtime,
    #[cfg(unix)]
    taken: Taken,
}

/// The signals from the moment on when they were asked for.
#[cfg(unix)]
#[derive(Debug)]
struct Taken {
    interrupt: Signal,
    terminate: Signal,
}

impl Signals {
    /// Signals no longer end the process by themselves from here on.
    pub(super) fn new() -> io::Result<Self> {
        let runtime = Builder::new_current_thread().enable_all().build()?;
        #[cfg(unix)]
        let taken = {
            let _inside = runtime.enter();
            Taken { interrupt: signal(SignalKind::interrupt())?, terminate: signal(SignalKind::terminate())? }
        };
        Ok(Self {
            runtime,
            #[cfg(unix)]
            taken,
        })
    }

    /// The code that the first signal ends the process with: 128 and its number.
    #[cfg(unix)]
    pub(super) fn wait(mut self) -> i32 {
        self.runtime.block_on(async {
            tokio::select! {
                _ = self.taken.interrupt.recv() => 130,
                _ = self.taken.terminate.recv() => 143,
            }
        })
    }

    /// The code that the first signal ends the process with: 128 and its number.
    #[cfg(not(unix))]
    pub(super) fn wait(self) -> i32 {
        let _ = self.runtime.block_on(tokio::signal::ctrl_c());
        130
    }
}
