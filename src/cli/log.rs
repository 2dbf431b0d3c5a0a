//! The log of the service. A separate thread writes it to standard error, and lines that are not read in time are
//! dropped, so that a full pipe never blocks a request.

use std::collections::VecDeque;
use std::io::{self, Write};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use tracing_subscriber::EnvFilter;
use tracing_subscriber::fmt::MakeWriter;

use crate::config::LogLevels;
use crate::fault::cut;

/// Maximum total length of waiting lines in bytes: some thousand lines, more than a working reader falls behind.
const MAX_WAITING_BYTES: usize = 1 << 20;
/// Maximum wait at the end for lines to be written; a working reader takes a mebibyte in a small part of it. Half of it
/// loses lines to readers that pause; twice of it makes a process wait longer for one that has stopped.
const FLUSH_PATIENCE: Duration = Duration::from_secs(1);
/// Maximum length of a panic message in characters; a message may repeat the input that caused the panic.
const MAX_MESSAGE: usize = 1000;

/// The queue of lines to be written. Dropping it waits up to [`FLUSH_PATIENCE`] for the waiting lines.
#[derive(Debug)]
pub(super) struct Log(Arc<LogQueue>);

#[derive(Debug, Default)]
struct LogQueue {
    state: Mutex<WaitingLines>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct WaitingLines {
    lines: VecDeque<Vec<u8>>,
    /// Total length of the waiting lines in bytes.
    bytes: usize,
    /// Number of lines dropped since this was last reported.
    dropped: u64,
    /// Whether a line was taken from the queue and is not written yet.
    is_writing: bool,
}

impl Log {
    /// Starts the log of this process and redirects panic messages to it.
    pub(super) fn start(levels: &LogLevels, json: bool) -> io::Result<Self> {
        let queue = Arc::new(LogQueue::default());
        let worker = queue.clone();
        thread::Builder::new().name("log".to_owned()).spawn(move || worker.write_all(&mut io::stderr()))?;
        let filter = EnvFilter::new(levels.as_str());
        let subscriber = tracing_subscriber::fmt().with_env_filter(filter).with_writer(LogWriter(queue.clone()));
        // A second subscriber in one process is refused, and the first stays in use.
        let _ = if json { subscriber.json().try_init() } else { subscriber.try_init() };
        std::panic::set_hook(Box::new(|panic| {
            let text = cut(panic.payload_as_str().unwrap_or("no message"), MAX_MESSAGE);
            let place = panic.location().map(ToString::to_string).unwrap_or_default();
            let backtrace = std::backtrace::Backtrace::capture();
            tracing::error!(%text, place, %backtrace, "a thread panicked");
        }));
        Ok(Self(queue))
    }

    /// Logs a text regardless of the log level.
    pub(super) fn say(&self, text: &str) {
        self.0.push(format!("{text}\n").into_bytes());
    }
}

impl Drop for Log {
    fn drop(&mut self) {
        let waits = |state: &mut WaitingLines| state.is_writing || !state.lines.is_empty();
        drop(self.0.changed.wait_timeout_while(self.0.state(), FLUSH_PATIENCE, waits));
    }
}

impl LogQueue {
    fn state(&self) -> MutexGuard<'_, WaitingLines> {
        // Nothing panics while the lock is held.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Appends a line to the queue, or drops it if the queue is full.
    fn push(&self, line: Vec<u8>) {
        let mut state = self.state();
        if state.bytes + line.len() > MAX_WAITING_BYTES {
            state.dropped += 1;
            return;
        }
        state.bytes += line.len();
        state.lines.push_back(line);
        self.changed.notify_all();
    }

    /// Takes the next line, waiting until there is one.
    fn next(&self) -> Vec<u8> {
        let mut state = self.state();
        state.is_writing = false;
        self.changed.notify_all();
        loop {
            if let Some(line) = state.lines.pop_front() {
                state.bytes -= line.len();
                state.is_writing = true;
                return line;
            }
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Writes lines for as long as the process lives, and reports the number of dropped lines whenever the queue is
    /// empty.
    fn write_all(&self, out: &mut impl Write) {
        loop {
            // A failure to write the log cannot be reported anywhere.
            let _ = out.write_all(&self.next());
            let mut state = self.state();
            if state.lines.is_empty() && state.dropped > 0 {
                let lines = std::mem::take(&mut state.dropped);
                drop(state);
                metrics::counter!("planish_log_lines_dropped_total").increment(lines);
                tracing::warn!(lines, "lines of the log were dropped, as nobody read them in time");
            }
        }
    }
}

/// A writer that appends each write to the queue as one line.
#[derive(Debug, Clone)]
struct LogWriter(Arc<LogQueue>);

impl MakeWriter<'_> for LogWriter {
    type Writer = Self;

    fn make_writer(&self) -> Self {
        self.clone()
    }
}

impl Write for LogWriter {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.push(bytes.to_vec());
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
