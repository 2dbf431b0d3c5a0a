//! The log of the service: a thread of its own writes it to standard error, and what nobody reads in time is dropped,
//! so that a full pipe never holds a request.

use std::collections::VecDeque;
use std::io::{self, Write};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use tracing_subscriber::EnvFilter;
use tracing_subscriber::fmt::MakeWriter;

use crate::config::LogLevels;
use crate::fault::cut;

/// Most bytes of lines that wait to be written: some thousand of them, more than a reader that is alive falls behind
/// by.
const MOST_BYTES: usize = 1 << 20;
/// Longest wait at the end for lines to be written: a reader that is alive takes a mebibyte in a small part of it.
const PATIENCE: Duration = Duration::from_secs(1);
/// Most characters of a panic's message, which may repeat what made it.
const MOST_MESSAGE: usize = 1000;

/// Where lines are left to be written. When it is dropped, the lines that wait are given a moment.
#[derive(Debug)]
pub(super) struct Log(Arc<Queue>);

#[derive(Debug, Default)]
struct Queue {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct State {
    lines: VecDeque<Vec<u8>>,
    /// Bytes of the lines.
    bytes: usize,
    /// Lines that were dropped since it was last told.
    dropped: u64,
    /// Whether a line was taken and is not written yet.
    is_writing: bool,
}

impl Log {
    /// Starts the log of this process, and sends to it what panics say.
    pub(super) fn start(levels: &LogLevels, json: bool) -> io::Result<Self> {
        let queue = Arc::new(Queue::default());
        let worker = queue.clone();
        thread::Builder::new().name("log".to_owned()).spawn(move || worker.write_all(&mut io::stderr()))?;
        let filter = EnvFilter::new(levels.as_str());
        let subscriber = tracing_subscriber::fmt().with_env_filter(filter).with_writer(Lines(queue.clone()));
        // a second subscriber in one process is refused, and the first goes on
        let _ = if json { subscriber.json().try_init() } else { subscriber.try_init() };
        std::panic::set_hook(Box::new(|panic| {
            let text = cut(panic.payload_as_str().unwrap_or("no message"), MOST_MESSAGE);
            let place = panic.location().map(ToString::to_string).unwrap_or_default();
            let backtrace = std::backtrace::Backtrace::capture();
            tracing::error!(%text, place, %backtrace, "a thread panicked");
        }));
        Ok(Self(queue))
    }

    /// Says something whatever the level of the log is.
    pub(super) fn say(&self, text: &str) {
        self.0.push(format!("{text}\n").into_bytes());
    }
}

impl Drop for Log {
    fn drop(&mut self) {
        let waits = |state: &mut State| state.is_writing || !state.lines.is_empty();
        drop(self.0.changed.wait_timeout_while(self.0.state(), PATIENCE, waits));
    }
}

impl Queue {
    fn state(&self) -> MutexGuard<'_, State> {
        // nothing panics while it is held
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Leaves a line to be written, or drops it where too much waits already.
    fn push(&self, line: Vec<u8>) {
        let mut state = self.state();
        if state.bytes + line.len() > MOST_BYTES {
            state.dropped += 1;
            return;
        }
        state.bytes += line.len();
        state.lines.push_back(line);
        self.changed.notify_all();
    }

    /// Takes the next line when there is one.
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

    /// Writes lines for as long as the process lives, and tells how many were dropped as soon as it has caught up.
    fn write_all(&self, out: &mut impl Write) {
        loop {
            // nobody can be told that the log cannot be written
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

/// Takes lines, each in one piece.
#[derive(Debug, Clone)]
struct Lines(Arc<Queue>);

impl MakeWriter<'_> for Lines {
    type Writer = Self;

    fn make_writer(&self) -> Self {
        self.clone()
    }
}

impl Write for Lines {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.push(bytes.to_vec());
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
