//! `planish render`: a job to a file.

use std::fs::File;
use std::io::{self, BufWriter, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use rayon::ThreadPoolBuilder;

use super::error::CliError;
use super::job::{self, MeshOptions};
use crate::job::limits::{Admitted, Limits};
use crate::job::{Output, Report, RunError, run};
use crate::output::{self, Format};
use crate::watch::Watch;
use crate::wire::JobRequest;
use crate::wire::output::OutputRequest;

/// Most milliseconds, by the estimate, of a job that runs on the calling thread alone.
/// A thread takes 25 us to be started (measured), and memory. With half of it more jobs start threads; with twice of it
/// the longest of them wait for up to 4 ms more that other cores could have saved.
const ALONE_MS: u128 = 4;

/// Renders the job in `path` to `target`.
pub(super) fn render(
    path: &Path,
    options: &MeshOptions,
    target: &Path,
    format: Option<&str>,
    max_faces: Option<u64>,
) -> Result<(), CliError> {
    let mut request = job::load(path, options)?;
    choose(&mut request, target, format)?;
    let default = Limits::default();
    let limits = Limits {
        max_faces: max_faces.unwrap_or(default.max_faces),
        max_vertices: max_faces.map_or(default.max_vertices, |faces| faces.saturating_mul(2).min(u32::MAX.into())),
        max_output_bytes: if max_faces.is_some() { u64::MAX } else { default.max_output_bytes },
        ..default
    };
    let admitted = job::admit(request, &limits)?;
    let output = &admitted.job().outputs[0];
    let report = if target == Path::new("-") {
        let mut out = io::stdout().lock();
        watched(&admitted, output, &mut out)?
    } else {
        to_file(&admitted, output, target)?
    };
    if let Some(reached) = admitted.job().reached {
        eprintln!("planish: note: level {} is at most {} from the limit", reached.level, reached.bound);
    }
    report.warnings.iter().for_each(|warning| eprintln!("planish: note: {warning}"));
    Ok(())
}

/// Leaves the one output that fits the target: of the format named, else by the extension, else the job's only one.
fn choose(request: &mut JobRequest, target: &Path, format: Option<&str>) -> Result<(), CliError> {
    let extension = target.extension().and_then(|extension| extension.to_str());
    let known = |name: &str| output::named(name).map(<dyn Format>::name);
    let wanted = match (format, extension) {
        (Some(name), _) => Some(known(name).ok_or_else(|| CliError::new(format!("there is no format {name}")))?),
        (None, Some(extension)) => {
            let fits = |request: &&OutputRequest| {
                request.format().and_then(output::named).is_some_and(|format| format.extension() == extension)
            };
            let asked = request.outputs.iter().find(fits).and_then(|output| output.format());
            let wanted = asked.and_then(output::named).map(<dyn Format>::name).or_else(|| known(extension));
            Some(wanted.ok_or_else(|| {
                CliError::new(format!("no format has the extension .{extension}; name one with --format"))
            })?)
        }
        (None, None) => None,
    };
    let Some(wanted) = wanted else {
        return match request.outputs.len() {
            1 => Ok(()),
            _ => Err(CliError::new("the target has no extension; name a format with --format")),
        };
    };
    let asked = request.outputs.iter().position(|output| output.format() == Some(wanted));
    (request.outputs, request.left_out) = match asked {
        Some(i) => (vec![request.outputs.swap_remove(i)], i),
        None => (vec![OutputRequest::of_format(wanted)], 0),
    };
    Ok(())
}

/// Writes next to the target first, so that a broken run leaves no broken file.
fn to_file(admitted: &Admitted, output: &Output, target: &Path) -> Result<Report, CliError> {
    let mut name = target.file_name().unwrap_or_default().to_owned();
    name.push(format!(".{}.part", std::process::id()));
    let part: PathBuf = target.with_file_name(name);
    let cannot = |error: io::Error| CliError::new(format!("cannot write {}: {error}", target.display()));
    let mut out = BufWriter::with_capacity(1 << 20, File::create(&part).map_err(cannot)?);
    let written = watched(admitted, output, &mut out);
    let finished = written.and_then(|report| {
        out.flush().map_err(cannot)?;
        std::fs::rename(&part, target).map_err(cannot)?;
        Ok(report)
    });
    if finished.is_err() {
        let _ = std::fs::remove_file(&part);
    }
    finished
}

/// Runs the job; on a terminal a bar shows how far it is.
fn watched(admitted: &Admitted, output: &Output, out: &mut dyn Write) -> Result<Report, CliError> {
    let watch = Watch::new();
    let ended = AtomicBool::new(false);
    let is_short = admitted.estimate().time_ms <= ALONE_MS;
    let alone = || ThreadPoolBuilder::new().num_threads(1).use_current_thread().build().map_err(CliError::new);
    let _pool = is_short.then(alone).transpose()?;
    let report = thread::scope(|scope| {
        if io::stderr().is_terminal() {
            scope.spawn(|| show(&watch, admitted, &ended));
        }
        let report = run(admitted, output, out, &watch);
        ended.store(true, Ordering::Relaxed);
        report
    });
    report.map_err(|error| match error {
        RunError::Impossible(fault) => CliError::Faults(vec![admitted.job().entries(output).fault(fault)]),
        RunError::Io(error) => CliError::new(format!("cannot write the result: {error}")),
        RunError::Stopped(stopped) => CliError::new(stopped),
    })
}

fn show(watch: &Watch, admitted: &Admitted, ended: &AtomicBool) {
    let work = u64::try_from(admitted.estimate().forecast.work).unwrap_or(u64::MAX);
    let bar = ProgressBar::new(work);
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {percent}% {elapsed}") {
        bar.set_style(style);
    }
    while !ended.load(Ordering::Relaxed) {
        bar.set_position(watch.done());
        thread::sleep(Duration::from_millis(50));
    }
    bar.finish_and_clear();
}
