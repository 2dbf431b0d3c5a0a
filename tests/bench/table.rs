//! The table, and the clock behind its figures.

use std::io::{self, Write};
use std::time::{Duration, Instant};

/// One line for each thing measured.
#[derive(Debug, Default)]
pub(crate) struct Table(Vec<[String; 5]>);

/// Whether an aim was met.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Aim {
    /// There is none.
    None,
    /// The figure should be at least this.
    AtLeast(f64),
    /// The figure should be below this.
    Below(f64),
}

const HEAD: [&str; 5] = ["what", "figure", "ratio", "aim", "in detail"];

impl Table {
    /// Adds a line, and shows on standard error that it is there.
    pub(crate) fn add(&mut self, what: &str, (value, unit): (f64, &str), ratio: &str, aim: Aim, detail: &str) {
        let aim = match aim {
            Aim::None => String::new(),
            Aim::AtLeast(least) => format!(">= {least} {}", verdict(value >= least)),
            Aim::Below(most) => format!("< {most} {}", verdict(value < most)),
        };
        let line = [what.to_owned(), format!("{} {unit}", figure(value)), ratio.to_owned(), aim, detail.to_owned()];
        // a bench that cannot tell of its progress goes on
        let _ = writeln!(io::stderr(), "{}", line.join("  "));
        self.0.push(line);
    }

    /// The table as text, in columns; nothing where nothing was added.
    pub(crate) fn text(&self) -> String {
        if self.0.is_empty() {
            return String::new();
        }
        let head = HEAD.map(str::to_owned);
        let lines = || [&head].into_iter().chain(&self.0);
        let width = |column: usize| lines().map(|line| line[column].chars().count()).max().unwrap_or(0);
        let widths = [0, 1, 2, 3, 4].map(width);
        let row = |line: &[String; 5]| {
            let cells: Vec<String> = line.iter().zip(widths).map(|(cell, width)| format!("{cell:width$}")).collect();
            format!("| {} |\n", cells.join(" | "))
        };
        let rule = format!("|{}|\n", widths.map(|width| "-".repeat(width + 2)).join("|"));
        lines().enumerate().map(|(i, line)| if i == 0 { row(line) + &rule } else { row(line) }).collect()
    }
}

/// Shows a line at once, which is not part of the table.
pub(crate) fn say(line: &str) {
    // a bench that cannot tell of its progress goes on
    let _ = writeln!(io::stdout(), "{line}");
}

fn verdict(met: bool) -> &'static str {
    if met { "met" } else { "MISSED" }
}

/// Three digits.
pub(crate) fn figure(value: f64) -> String {
    let decimals = if value < 10.0 { 2 } else { usize::from(value < 100.0) };
    format!("{value:.decimals$}")
}

/// Best time of `work`, after one run that does not count: three runs at least, more while they fit into a second.
/// Where one run takes seconds, two count. Whatever else a machine does only ever makes a run longer.
pub(crate) fn best(mut work: impl FnMut()) -> Duration {
    let mut timed = || {
        let start = Instant::now();
        work();
        start.elapsed()
    };
    let first = timed();
    let runs = if first > Duration::from_secs(3) { 2 } else { 3 };
    let start = Instant::now();
    let (mut best, mut done) = (Duration::MAX, 0);
    while done < runs || start.elapsed() < Duration::from_secs(1) {
        best = best.min(timed());
        done += 1;
    }
    best
}

/// Milliseconds.
pub(crate) fn ms(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

/// Millions a second.
#[expect(clippy::cast_precision_loss, reason = "a rate needs few digits")]
pub(crate) fn millions_a_second(n: usize, time: Duration) -> f64 {
    n as f64 / time.as_secs_f64() / 1e6
}
