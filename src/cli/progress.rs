//! Progress messages of a command: one bar on a terminal, a line for each note and failure, and a summary.

use std::collections::BTreeMap;
use std::io::{self, IsTerminal};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use super::error::{CliError, ExitKind};
use super::fault_translator::flagged;
use super::inputs::InputSource;
use crate::math::amounts::thousands;
use crate::watch::Watch;

/// Number of steps of the bar for each input: as fine as a wide terminal shows. Half of it moves in steps that can be
/// seen; twice of it shows nothing more.
const BAR_STEPS: u64 = 500;

/// The progress of a command through its inputs.
#[derive(Debug)]
pub(super) struct Progress {
    bar: Option<ProgressBar>,
    is_quiet: bool,
    inputs: usize,
    /// Number of inputs that are finished.
    past: u64,
    failed: BTreeMap<ExitKind, u64>,
    begun: Instant,
}

impl Progress {
    /// Starts the progress; the bar is shown if standard error is a terminal and the command is not quiet.
    pub(super) fn new(inputs: usize, is_quiet: bool) -> Self {
        let is_shown = io::stderr().is_terminal() && !is_quiet;
        let bar = is_shown.then(|| {
            let bar = ProgressBar::new(BAR_STEPS.saturating_mul(inputs as u64));
            let template = if inputs > 1 { "{wide_bar} {msg} {elapsed}" } else { "{wide_bar} {percent}% {elapsed}" };
            ProgressStyle::with_template(template).into_iter().for_each(|style| bar.set_style(style));
            bar
        });
        Self { bar, is_quiet, inputs, past: 0, failed: BTreeMap::new(), begun: Instant::now() }
    }

    /// Prints a note about an input, unless the command is quiet.
    pub(super) fn note(&self, source: &InputSource, text: &str) {
        if !self.is_quiet {
            self.say(&format!("planish: {source}: note: {}", flagged(text)));
        }
    }

    /// Prints a line.
    pub(super) fn say(&self, line: &str) {
        match &self.bar {
            Some(bar) => bar.suspend(|| eprintln!("{line}")),
            None => eprintln!("{line}"),
        }
    }

    /// Records the outcome of an input and prints its error, if any.
    pub(super) fn done(&mut self, source: &InputSource, outcome: Result<(), CliError>) {
        self.past += 1;
        if let Err(error) = outcome {
            *self.failed.entry(error.kind).or_default() += 1;
            self.say(&format!("planish: {source}: {error}"));
        }
        if let Some(bar) = &self.bar {
            bar.set_position(BAR_STEPS * self.past);
            bar.set_message(format!("{} of {}", self.past, self.inputs));
        }
    }

    /// Runs `task`, which takes `work` units in total, and updates the bar from `watch` meanwhile.
    pub(super) fn during<T>(&self, watch: &Watch, work: u128, task: impl FnOnce() -> T) -> T {
        let Some(bar) = &self.bar else { return task() };
        let ended = AtomicBool::new(false);
        let show = || {
            while !ended.load(Ordering::Relaxed) {
                let part = u128::from(watch.done()) * u128::from(BAR_STEPS) / work.max(1);
                bar.set_position(
                    BAR_STEPS * self.past + u64::try_from(part).map_or(BAR_STEPS, |part| part.min(BAR_STEPS)),
                );
                thread::sleep(Duration::from_millis(50));
            }
        };
        thread::scope(|scope| {
            scope.spawn(show);
            let _ended = Ended(&ended);
            task()
        })
    }

    /// Prints a summary if there are several inputs, and returns an error if any input failed.
    pub(super) fn end(self, what: &str) -> Result<(), CliError> {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
        let failed: u64 = self.failed.values().sum();
        if self.inputs > 1 && !self.is_quiet {
            let took = self.begun.elapsed().as_secs_f64();
            let (all, well) = (thousands(self.past.into()), thousands((self.past - failed).into()));
            let kinds: Vec<String> = self.failed.iter().map(|(kind, n)| counted(*kind, *n)).collect();
            let kinds = if kinds.is_empty() { String::new() } else { format!("; {}", kinds.join(", ")) };
            eprintln!("planish: {well} of {all} {what} in {took:.1} s{kinds}");
        }
        match self.failed.keys().copied().collect::<Vec<_>>().as_slice() {
            [] => Ok(()),
            [one] => Err(CliError::printed(*one)),
            _ => Err(CliError::printed(ExitKind::Other)),
        }
    }
}

/// Sets its flag when it is dropped, also when a task panics: the scope of the thread that shows the bar waits for that
/// thread.
struct Ended<'a>(&'a AtomicBool);

impl Drop for Ended<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

fn counted(kind: ExitKind, n: u64) -> String {
    let n = thousands(n.into());
    match kind {
        ExitKind::Refused => format!("{n} refused"),
        ExitKind::TooLarge => format!("{n} beyond a limit"),
        ExitKind::Files => format!("{n} not read or written"),
        ExitKind::Usage => format!("{n} with flags that do not fit"),
        ExitKind::Other => format!("{n} stopped"),
    }
}

#[cfg(test)]
mod tests {
    use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

    use super::*;

    #[test]
    fn a_task_that_panics_ends() {
        let progress = Progress { bar: Some(ProgressBar::hidden()), ..Progress::new(1, true) };
        let panics = || resume_unwind(Box::new("a fault of the task"));
        let ended = catch_unwind(AssertUnwindSafe(|| progress.during::<()>(&Watch::new(), 1, panics)));
        assert!(ended.is_err());
        assert_eq!(progress.during(&Watch::new(), 1, || 7), 7);
    }
}
