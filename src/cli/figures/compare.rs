//! The differences between two versions of a figure, as pictures and as numbers.

use std::io::Cursor;
use std::path::Path;

use image::codecs::png::PngDecoder;
use image::{AnimationDecoder, ImageFormat};
use serde_json::Value;

use super::manifest::Entry;
use super::rendered::{admitted, bytes, load};
use crate::cli::error::CliError;
use crate::job::{Compared, Comparison, Job, KeepNothing, PngFile, Side, Tolerances};
use crate::watch::Watch;
use crate::wire::job::{FigureRequest, JobRequest, PanelRequest, SharedRequest};
use crate::wire::output::OutputRequest;

/// The differences between two versions of a figure.
#[derive(Debug)]
pub(super) struct FigureDifference {
    /// Name of the file.
    pub(super) name: String,
    /// The old picture, if it exists.
    pub(super) before: Option<Vec<u8>>,
    /// The new picture, if it exists.
    pub(super) after: Option<Vec<u8>>,
    /// A PNG of the differences, if both versions are PNG pictures of the same size.
    pub(super) where_: Option<Vec<u8>>,
    /// Number of different pixels, number of all pixels, and largest difference of colours from 0 to 1.
    pub(super) pixels: Option<(u64, u64, f64)>,
    /// Number of frames that differ and number of all frames, if the picture moves; then `pixels` and `where_` are
    /// those of the frame with the most different pixels.
    pub(super) frames: Option<(usize, usize)>,
    /// The numbers that differ: name, old value, new value.
    pub(super) numbers: Vec<(String, Option<Value>, Option<Value>)>,
    /// A PNG of both shapes from one camera, if both jobs are available.
    pub(super) together: Option<Vec<u8>>,
}

impl FigureDifference {
    /// Compares two versions, each with its manifest entry and, if available, its bytes.
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
        let compared = before.as_ref().zip(after.as_ref()).and_then(|(old, new)| compared(old, new));
        let (frames, compared) = compared.unzip();
        let (where_, pixels) = compared.map_or((None, None), |(picture, counts)| (picture, Some(counts)));
        let frames = frames.flatten();
        Self { name: name.to_owned(), before, after, where_, pixels, frames, numbers, together: None }
    }

    /// Describes the difference in words.
    pub(super) fn describe(&self) -> String {
        let of_frames = match self.frames {
            Some((n, of)) if n > 0 => format!("{n} of {of} frames differ; in the one that differs most "),
            _ => String::new(),
        };
        match (&self.before, &self.after, self.pixels) {
            (None, Some(_), _) => "new, or the file before is missing".to_owned(),
            (_, None, _) => "no job makes it any more".to_owned(),
            (_, _, Some((0, _, _))) => "other bytes, the same pixels".to_owned(),
            (_, _, Some((n, of, most))) => {
                format!(
                    "{of_frames}{n} of {of} pixels differ, by {:.1} % of the distance of black and white at most",
                    100.0 * most
                )
            }
            (_, _, None) => "other bytes".to_owned(),
        }
    }
}

/// A PNG of the differences, with the number of different pixels, the number of all pixels, and the largest difference
/// of colours from 0 to 1.
type PixelsCompared = (Option<Vec<u8>>, (u64, u64, f64));

/// Compares two pictures, frame by frame if they move; `None` if either is not a PNG, or their sizes or numbers of
/// frames differ. The counts of frames come with the comparison of the frame with the most different pixels.
fn compared(before: &[u8], after: &[u8]) -> Option<(Option<(usize, usize)>, PixelsCompared)> {
    let (Some(mut before), Some(mut after)) = (frames(before), frames(after)) else {
        return Some((None, pixels(before, after)?));
    };
    let (mut n, mut differ, mut worst) = (0, 0, None::<PixelsCompared>);
    loop {
        let (before, after) = match (before.next(), after.next()) {
            (Some(before), Some(after)) => (before?, after?),
            (None, None) => break,
            _ => return None,
        };
        let found = pixels(&before, &after)?;
        n += 1;
        differ += usize::from(found.1.0 > 0);
        if worst.as_ref().is_none_or(|worst| worst.1.0 < found.1.0) {
            worst = Some(found);
        }
    }
    Some((Some((differ, n)), worst?))
}

/// Returns the frames of a moving picture, each as a PNG file or `None` if it cannot be read; `None` for anything else.
fn frames(bytes: &[u8]) -> Option<impl Iterator<Item = Option<Vec<u8>>>> {
    let decoder = PngDecoder::new(Cursor::new(bytes)).ok()?;
    let frames = decoder.is_apng().ok()?.then_some(decoder)?.apng().ok()?.into_frames();
    Some(frames.map(|frame| {
        let mut png = Cursor::new(Vec::new());
        frame.ok()?.into_buffer().write_to(&mut png, ImageFormat::Png).ok()?;
        Some(png.into_inner())
    }))
}

/// Compares two PNG pictures; `None` if either is not a PNG, or their sizes differ.
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

/// Draws both versions of a job side by side, from one camera framed by the box around both; `None` if either is a
/// figure or cannot be drawn.
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

/// Returns the index of the output whose file has this name.
pub(super) fn output_of(job: &Job, stem: &str, name: &str) -> usize {
    let has = |output: &crate::job::Output| name == format!("{stem}-{}.{}", output.name, output.format.extension());
    job.outputs.iter().position(has).unwrap_or(0)
}
