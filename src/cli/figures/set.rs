//! Rendering and checking of all jobs of a folder.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use super::compare::{FigureDifference, output_of, side_by_side};
use super::manifest::{Entry, FigureManifest, put};
use super::rendered::{Rendered, admitted, load, names, part, render};
use super::report;
use crate::cli::error::CliError;
use crate::cli::inputs::InputSource;
use crate::cli::progress::Progress;

/// What is rendered, and where to.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct FigureOptions {
    /// The folder with the jobs (*.json); each asks for one or more pictures, a png where it names no output.
    #[arg(value_name = "DIR")]
    jobs: PathBuf,
    /// The folder for the pictures and their manifest.json. A picture that is there already, as the key in the manifest
    /// tells, is not made again.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Write no picture: render each anew, and end with 1 where one differs from that in the folder, or from its
    /// manifest.
    #[arg(long)]
    check: bool,
    /// With --check: the folder for the report (report.md, report.html) on what differs; OUTPUT.report when left out.
    #[arg(long, value_name = "DIR", requires = "check")]
    report: Option<PathBuf>,
    /// With --check: the folder with the jobs of before, by the same names. Then the report shows both versions of a
    /// shape from one camera, framed by the box around both.
    #[arg(long, value_name = "DIR", requires = "check")]
    before: Option<PathBuf>,
    /// Say nothing but what fails: no bar, no notes, no summary.
    #[arg(short, long)]
    quiet: bool,
}

impl FigureOptions {
    /// Renders the jobs, or checks their pictures for changes.
    pub(crate) fn run(&self) -> Result<(), CliError> {
        let jobs = jobs(&self.jobs)?;
        check_names(&jobs)?;
        let known = match (FigureManifest::read(&self.output)?, self.check) {
            (None, true) => {
                let detail =
                    format!("{} has no manifest.json; render the figures without --check first", self.output.display());
                return Err(CliError::files(detail));
            }
            (known, _) => known.unwrap_or_default(),
        };
        let progress = Mutex::new(Progress::new(jobs.len(), self.quiet));
        let each = |path: &PathBuf| {
            // A key identifies the job, not the version of the renderer, so a check renders every picture anew.
            let rendered = render(path, &known, (!self.check).then_some(self.output.as_path()));
            let rendered = rendered.and_then(|made| self.kept(made, &known));
            let (made, outcome) = match rendered {
                Ok(made) => (made, Ok(())),
                Err(error) => (Vec::new(), Err(error)),
            };
            let is_whole = outcome.is_ok();
            let mut progress = progress.lock().unwrap_or_else(PoisonError::into_inner);
            progress.done(&InputSource::File(path.clone()), outcome);
            (made, is_whole)
        };
        let all: Vec<(Vec<Rendered>, bool)> = jobs.par_iter().map(each).collect();
        let (made, outcomes): (Vec<Vec<Rendered>>, Vec<bool>) = all.into_iter().unzip();
        let is_whole = outcomes.iter().all(|is_whole| *is_whole);
        let made: Vec<Rendered> = made.into_iter().flatten().collect();
        let progress = progress.into_inner().unwrap_or_else(PoisonError::into_inner);
        if self.check {
            let ended = progress.end("inputs checked");
            let failed: Vec<String> = jobs
                .iter()
                .zip(outcomes)
                .filter(|(_, is_whole)| !is_whole)
                .map(|(path, _)| part(path.file_name()))
                .collect();
            return match (self.checked(&known, made, &failed), ended) {
                (outcome, Ok(())) => outcome,
                (Ok(()), refused) => refused,
                // what differs is told, the code is that of the jobs that failed
                (Err(differs), Err(refused)) => Err(CliError { kind: refused.kind, ..differs }),
            };
        }
        let (of, fresh) = (made.len(), made.iter().filter(|made| made.bytes.is_some()).count());
        if !self.quiet {
            progress.say(&format!("planish: {fresh} of {of} pictures were made, the others are as they were"));
        }
        for name in known.figures.keys().filter(|name| is_whole && made.iter().all(|made| made.name != **name)) {
            progress
                .say(&format!("planish: {name}: no job makes it any more; remove it from {}", self.output.display()));
        }
        // If a job failed, its old entries stay in the manifest.
        let mut figures: BTreeMap<String, Entry> = if is_whole { BTreeMap::new() } else { known.figures };
        figures.extend(made.into_iter().map(|made| (made.name, made.entry)));
        FigureManifest { figures, ..FigureManifest::default() }.write(&self.output)?;
        progress.end("inputs rendered")
    }

    /// Writes the new pictures to the folder. In a check, writes nothing, and keeps only the bytes of pictures that
    /// differ from the folder or its manifest.
    fn kept(&self, mut made: Vec<Rendered>, known: &FigureManifest) -> Result<Vec<Rendered>, CliError> {
        for Rendered { name, entry, bytes } in &mut made {
            if self.check {
                let old = known.figures.get(name);
                if old.is_some_and(|old| old.hash == entry.hash && old.is_in(&self.output, name)) {
                    *bytes = None;
                }
            } else if let Some(bytes) = bytes {
                put(&self.output.join(name), bytes)?;
                *bytes = Vec::new();
            }
        }
        Ok(made)
    }

    /// Compares the new pictures with those in the folder, and writes a report if any differ.
    /// Pictures of jobs that failed, which are named by their files, are left out.
    fn checked(&self, known: &FigureManifest, made: Vec<Rendered>, failed: &[String]) -> Result<(), CliError> {
        let mut same = 0;
        let mut differences = Vec::new();
        let names: BTreeSet<String> = made.iter().map(|made| made.name.clone()).collect();
        for Rendered { name, entry, bytes } in made {
            if bytes.is_none() {
                same += 1;
                continue;
            }
            let before = known.figures.get(&name).map(|old| (old, fs::read(self.output.join(&name)).ok()));
            let mut difference = FigureDifference::new(&name, before, Some((&entry, bytes)));
            difference.together = self.together(&entry.job, &name)?;
            differences.push(difference);
        }
        let gone = known.figures.iter().filter(|(name, entry)| !names.contains(*name) && !failed.contains(&entry.job));
        for (name, entry) in gone {
            let before = Some((entry, fs::read(self.output.join(name)).ok()));
            differences.push(FigureDifference::new(name, before, None));
        }
        if differences.is_empty() {
            return Ok(());
        }
        let folder = self.report.clone().unwrap_or_else(|| {
            let mut name = self.output.file_name().unwrap_or_default().to_owned();
            name.push(".report");
            self.output.with_file_name(name)
        });
        let counted =
            |n: usize, one: &str, several: &str| if n == 1 { format!("1 {one}") } else { format!("{n} {several}") };
        let differ = counted(differences.len(), "picture differs", "pictures differ");
        let head = format!("{differ}, {}.", counted(same, "is as it was", "are as they were"));
        report::write(&folder, &head, &differences)?;
        let mut lines = vec![format!("{head} {} shows them", folder.join("report.html").display())];
        lines.extend(differences.iter().map(|difference| format!("  {}: {}", difference.name, difference.describe())));
        Err(CliError::other(lines.join("\n")))
    }

    /// Draws the old and the new version of a job's shape from one camera, if the folder of old jobs has the job.
    fn together(&self, job: &str, name: &str) -> Result<Option<Vec<u8>>, CliError> {
        let Some(folder) = &self.before else { return Ok(None) };
        let (before, after) = (folder.join(job), self.jobs.join(job));
        if !before.exists() {
            return Ok(None);
        }
        let stem = Path::new(job).file_stem().unwrap_or_default().to_string_lossy();
        let output = output_of(admitted(load(&after)?)?.job(), &stem, name);
        side_by_side(&before, &after, output)
    }
}

/// Returns the jobs of a folder, sorted by name.
fn jobs(folder: &Path) -> Result<Vec<PathBuf>, CliError> {
    let cannot = |error: std::io::Error| CliError::files(format!("cannot read {}: {error}", folder.display()));
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).map_err(cannot)? {
        let path = entry.map_err(cannot)?.path();
        if path.is_file() && path.extension().is_some_and(|extension| extension == "json") {
            found.push(path);
        }
    }
    if found.is_empty() {
        return Err(CliError::files(format!("{} has no jobs (*.json)", folder.display())));
    }
    found.sort();
    Ok(found)
}

/// Refuses jobs that make pictures of the same name.
fn check_names(jobs: &[PathBuf]) -> Result<(), CliError> {
    let mut seen: BTreeMap<String, &Path> = BTreeMap::new();
    let all: Vec<Vec<String>> = jobs.par_iter().map(|job| names(job)).collect();
    for (job, name) in jobs.iter().zip(all).flat_map(|(job, names)| names.into_iter().map(move |name| (job, name))) {
        // A job whose own outputs have one name is refused with its other faults.
        if let Some(other) = seen.insert(name.clone(), job).filter(|other| *other != job.as_path()) {
            let (other, job) = (part(other.file_name()), part(job.file_name()));
            let detail = format!("{other} and {job} both make {name}; rename one of them; nothing was rendered");
            return Err(CliError::usage(detail));
        }
    }
    Ok(())
}
