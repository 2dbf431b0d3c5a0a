//! Two versions of a figure: what is different, as a picture and in numbers.

use std::path::Path;

use serde_json::Value;

use super::manifest::Entry;
use super::rendered::{admitted, bytes, load};
use crate::cli::error::CliError;
use crate::job::{Compared, Comparison, Job, KeepNothing, PngFile, Side, Tolerances};
use crate::watch::Watch;
use crate::wire::job::{FigureRequest, JobRequest, PanelRequest, SharedRequest};
use crate::wire::output::OutputRequest;

/// What is different between two versions of a figure.
#[derive(Debug)]
pub(super) struct Difference {
    /// The name of the file.
    pub(super) name: String,
    /// The picture before, where there was one.
    pub(super) before: Option<Vec<u8>>,
    /// The picture now, where there is one.
    pub(super) after: Option<Vec<u8>>,
    /// Where they differ, as a PNG, where both are pictures in pixels of one size.
    pub(super) where_: Option<Vec<u8>>,
    /// Pixels that differ, of how many, and how far their colours are apart at most, 0 to 1.
    pub(super) pixels: Option<(u64, u64, f64)>,
    /// Numbers that differ: name, before, after.
    pub(super) numbers: Vec<(String, Option<Value>, Option<Value>)>,
    /// Both shapes from one camera, as a PNG, where both jobs are at hand.
    pub(super) together: Option<Vec<u8>>,
}

impl Difference {
    /// The difference of two versions, each with its bytes where they are at hand.
    pub(super) fn new(
        name: &str,
        before: Option<(&Entry, Option<Vec<u8>>)>,
        after: Option<(&Entry, Option<Vec<u8>>)>,
    ) -> Self {
        let split = |side: Option<(&Entry, Option<Vec<u8>>)>| {
            side.map_or((None, None), |(entry, bytes)| (Some(entry.clone()), bytes))
        };
        let ((old, before), (new, after)) = (split(before), split(after));
        let of =
            |entry: &Option<Entry>, name: &String| entry.as_ref().and_then(|entry| entry.numbers.get(name).cloned());
        let mut names: Vec<&String> =
            [&old, &new].into_iter().flatten().flat_map(|entry| entry.numbers.keys()).collect();
        names.sort_unstable();
        names.dedup();
        let numbers = names.into_iter().map(|name| (name.clone(), of(&old, name), of(&new, name)));
        let numbers = numbers.filter(|(_, old, new)| old != new).collect();
        let compared = before.as_ref().zip(after.as_ref()).and_then(|(old, new)| pixels(old, new));
        let (where_, pixels) = compared.map_or((None, None), |(picture, counts)| (picture, Some(counts)));
        Self { name: name.to_owned(), before, after, where_, pixels, numbers, together: None }
    }

    /// What has become of the figure, in words.
    pub(super) fn told(&self) -> String {
        match (&self.before, &self.after, self.pixels) {
            (None, Some(_), _) => "new, or the file before is missing".to_owned(),
            (_, None, _) => "there is no job for it any more".to_owned(),
            (_, _, Some((0, _, _))) => "other bytes, the same pixels".to_owned(),
            (_, _, Some((n, of, most))) => {
                format!(
                    "{n} of {of} pixels differ, by {:.1} % of the distance of black and white at most",
                    100.0 * most
                )
            }
            (_, _, None) => "other bytes".to_owned(),
        }
    }
}

/// A picture of what differs, how many pixels do, of how many, and how far apart they are at most, 0 to 1.
type PixelsCompared = (Option<Vec<u8>>, (u64, u64, f64));

/// Where two pictures in pixels differ, and how many pixels do; nothing where they are none, or not of one size.
fn pixels(before: &[u8], after: &[u8]) -> Option<PixelsCompared> {
    let side = |bytes: &[u8]| PngFile::new(bytes.into(), true).ok().map(Side::Picture);
    let comparison = Comparison::new([side(before)?, side(after)?], Tolerances::default()).ok()?;
    let found = comparison.run(&KeepNothing, &Watch::new()).ok()?;
    let Compared::Pixels { difference, size } = &found else { return None };
    let [width, height] = size.map(u64::from);
    let mut picture = Vec::new();
    let written = found.write_picture(&mut picture).is_ok();
    Some((written.then_some(picture), (difference.different, width * height, difference.largest)))
}

/// What two versions of a job show, side by side, from one camera framed by the box around both; nothing where one of
/// them is a figure, or cannot be drawn.
pub(super) fn side_by_side(before: &Path, after: &Path, output: usize) -> Result<Option<Vec<u8>>, CliError> {
    let (before, after) = (load(before)?, load(after)?);
    if before.figure.is_some() || after.figure.is_some() {
        return Ok(None);
    }
    let of_output = |mut request: JobRequest| {
        let asked = request.outputs.get(output).or(request.outputs.first()).cloned();
        request.outputs = asked.into_iter().collect();
        PanelRequest { job: request, caption: None, span: None, overlay: false }
    };
    let panels = vec![of_output(before), of_output(after)];
    let figure = FigureRequest {
        columns: Some(2),
        panels,
        title: None,
        letters: false,
        shared: Some(SharedRequest { camera: None, scale: true }),
    };
    let drawn = admitted(JobRequest::of_figure(figure, OutputRequest::of_format("png")));
    Ok(drawn.and_then(|admitted| bytes(&admitted, 0)).ok())
}

/// The index of the output whose file has a name.
pub(super) fn output_of(job: &Job, stem: &str, name: &str) -> usize {
    let has = |output: &crate::job::Output| name == format!("{stem}-{}.{}", output.name, output.format.extension());
    job.outputs.iter().position(has).unwrap_or(0)
}
