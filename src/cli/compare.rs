//! `planish compare`: the differences between two pictures, or between two shapes.

use std::path::PathBuf;
use std::sync::Arc;

use super::error::{CliError, ExitKind};
use super::files::to_new_file;
use super::inputs::InputSource;
use super::job::{JobOptions, Loaded, OutputChoice};
use super::say::answer;
use crate::fault::Fault;
use crate::job::limits::Limits;
use crate::job::{Comparison, KeepNothing, PngFile, RunError, Side, Tolerances, run};
use crate::output;
use crate::watch::Watch;
use crate::wire::comparison::ComparisonAnswer;
use crate::wire::output::OutputRequest;

/// What is compared.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct CompareOptions {
    /// The first: a picture (PNG), a mesh file, or a job (JSON), which is rendered; - is standard input.
    #[arg(value_name = "A")]
    a: PathBuf,
    /// The second.
    #[arg(value_name = "B")]
    b: PathBuf,
    /// How far apart colours may be, 0 to 1, as pixelmatch means it; left out, pictures that jobs make are compared by
    /// equality, and files at 0.1.
    #[arg(long)]
    threshold: Option<f64>,
    /// How far apart shapes may be, in their units; 0 when left out.
    #[arg(long)]
    tolerance: Option<f64>,
    /// Where the picture of what differs goes (PNG): grey where pixels are the same, red where they differ, yellow at
    /// smoothed edges.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Print nothing; the exit code tells.
    #[arg(short, long)]
    quiet: bool,
}

/// One of the two inputs, as it was read.
enum Read {
    Picture(Vec<u8>),
    Job(Box<Loaded>),
}

/// The first bytes of a PNG file.
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";

impl CompareOptions {
    /// Prints the differences as JSON, and fails with code 1 if there are any.
    pub(super) fn compare(&self) -> Result<(), CliError> {
        let asked = self.tolerances()?;
        let [a, b] = [&self.a, &self.b].map(|path| InputSource::of(path));
        let [read_a, read_b] = [read(&a)?, read(&b)?];
        let is_picture = read_a.is_picture() || read_b.is_picture();
        let sides = [read_a.side(&a, is_picture)?, read_b.side(&b, is_picture)?];
        let comparison = Comparison::new(sides, asked).map_err(|faults| fault_error(&faults))?;
        if self.output.is_some() && !is_picture {
            return Err(CliError::refused("--output: only two pictures have a picture of what differs"));
        }
        let watch = Watch::new();
        let unmade = |error: RunError| match error {
            RunError::Impossible(fault) => fault_error(&[fault.fault]),
            error => CliError::files(error),
        };
        let found = comparison.run(&KeepNothing, &watch).map_err(unmade)?;
        // Pictures of different sizes have no difference picture, as the answer says.
        if let Some(path) = self.output.as_ref().filter(|_| comparison.has_picture()) {
            to_new_file(path, |out| found.write_picture(out).map_err(|error| CliError::files(&error)))?;
        }
        let found = ComparisonAnswer::new(&found);
        if !self.quiet {
            let text = serde_json::to_string_pretty(&found).map_err(CliError::files)?;
            answer(format!("{text}\n").as_bytes())?;
        }
        if found.equal { Ok(()) } else { Err(CliError::printed(ExitKind::Other)) }
    }

    fn tolerances(&self) -> Result<Tolerances, CliError> {
        if let Some(threshold) = self.threshold.filter(|threshold| !(0.0..=1.0).contains(threshold)) {
            return Err(CliError::usage(format!("--threshold: {threshold} is none; colours are from 0 to 1 apart")));
        }
        if let Some(tolerance) = self.tolerance.filter(|tolerance| !tolerance.is_finite() || *tolerance < 0.0) {
            return Err(CliError::usage(format!("--tolerance: {tolerance} is no distance; give 0 or more")));
        }
        Ok(Tolerances { threshold: self.threshold, tolerance: self.tolerance })
    }
}

fn read(source: &InputSource) -> Result<Read, CliError> {
    let named = |error: CliError| error.about(source);
    let bytes = source.read().map_err(named)?;
    if bytes.starts_with(PNG) {
        return Ok(Read::Picture(bytes));
    }
    let loaded = JobOptions::default().read(source, bytes).map_err(named)?;
    Ok(Read::Job(Box::new(loaded)))
}

impl Read {
    fn is_picture(&self) -> bool {
        match self {
            Self::Picture(_) => true,
            Self::Job(loaded) => {
                matches!(loaded.request.outputs.as_slice(), [only] if only.format() == Some("png"))
            }
        }
    }

    /// Makes one side of the comparison: a picture, drawn from a job if necessary, or a refined shape.
    fn side(self, source: &InputSource, is_picture: bool) -> Result<Side, CliError> {
        let named = |error: CliError| error.about(source);
        let refused = |detail: String| CliError::refused(detail).about(source);
        let options = JobOptions::default();
        match self {
            Self::Picture(bytes) => Ok(Side::Picture(PngFile::new(bytes.into(), false).map_err(refused)?)),
            Self::Job(mut loaded) if is_picture => {
                let png = output::named("png").ok_or_else(|| refused("there is no format png".to_owned()))?;
                loaded.choose(OutputChoice::Named(png), &options).map_err(named)?;
                let admitted = loaded.admit(&options, &Limits::default()).map_err(named)?;
                let mut bytes = Vec::new();
                run(&admitted, &admitted.job().outputs[0], &mut bytes, &Watch::new())
                    .map_err(|error| refused(error.to_string()))?;
                Ok(Side::Picture(PngFile::new(bytes.into(), true).map_err(refused)?))
            }
            Self::Job(mut loaded) => {
                let shape = OutputRequest::of_shape(loaded.request.outputs.first());
                let shape = shape.map_err(CliError::faults).map_err(named)?;
                loaded.request.outputs = vec![shape];
                Ok(Side::Shape(Arc::new(loaded.admit(&options, &Limits::default()).map_err(named)?)))
            }
        }
    }
}

/// Converts faults to an error, with flags in place of JSON pointers.
fn fault_error(faults: &[Fault]) -> CliError {
    let flagged = |fault: &Fault| {
        let place = match fault.pointer.as_str() {
            "/threshold" => "--threshold".to_owned(),
            "/tolerance" => "--tolerance".to_owned(),
            "/a" => "the first".to_owned(),
            "/b" => "the second".to_owned(),
            other => other.to_owned(),
        };
        let detail = fault.detail.replace("\"threshold\"", "--threshold").replace("\"tolerance\"", "--tolerance");
        Fault::new(place, detail)
    };
    CliError::faults(faults.iter().map(flagged))
}
