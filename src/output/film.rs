//! Moving pictures: the camera of each frame, and the frames one after another.

use std::io::{self, Write};

use png::Writer;

use super::error::FormatError;
use super::figure::{FigureExtent, framed};
use super::format::ParameterRange;
use super::picture::framing::facing;
use super::picture::options::{CAMERA, Options};
use super::png as picture;
use super::scene::{CoordinateSystem, Scene};
use crate::math::parameter::{Default, Parameter, ParameterKind, Values};
use crate::math::vector::minus;
use crate::watch::{Stage, Watch};

/// Maximum number of frames. Ten seconds of a smooth picture. Half of it cuts turntables of half degrees; with twice of
/// it one job draws for twice as long.
const MAX_FILM_FRAMES: i64 = 240;

/// Frames of a moving picture.
pub(super) const FRAMES: Parameter =
    Parameter::integer("frames", [2, MAX_FILM_FRAMES], 24.0, "How many frames there are.");

/// The duration of a frame.
pub(super) const DELAY: Parameter = Parameter::integer(
    "delay_ms",
    [10, 10_000],
    80.0,
    "How long each frame is seen. The picture begins again after the last one.",
)
.in_unit("milliseconds");

/// The path of the camera.
pub(super) const TURNTABLE: Parameter = Parameter::optional(
    "turntable",
    ParameterKind::Group(&[
        Parameter::number("from_deg", TURNS_DEG, Default::Number(0.0), "The azimuth of the first frame.")
            .in_unit("degrees"),
        Parameter::number(
            "to_deg",
            TURNS_DEG,
            Default::Number(360.0),
            "The azimuth of the last frame, or, after whole turns, of the frame that would follow it.",
        )
        .in_unit("degrees"),
    ]),
    "The camera goes around the up axis, in place of its azimuth. Left out, once around unless there is a \
     `sweep`.",
);

/// The parameter that changes from frame to frame.
pub(super) const SWEPT_RANGE: Parameter = Parameter::optional(
    "sweep",
    ParameterKind::Group(&[
        Parameter::required(
            "pointer",
            ParameterKind::Name,
            "The place of the parameter in the job, such as /plan/parameters/delta.",
        ),
        Parameter::number("from", ANY_NUMBER, Default::Required, "Its value in the first frame."),
        Parameter::number("to", ANY_NUMBER, Default::Required, "Its value in the last frame."),
    ]),
    "A parameter of the plan that goes evenly from one value to another; all frames have one camera.",
);

const TURNS_DEG: [f64; 2] = [-3600.0, 3600.0];
const ANY_NUMBER: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

/// Returns the number of frames.
pub(super) fn frames(values: &Values) -> usize {
    values.integer(FRAMES.name).and_then(|n| usize::try_from(n).ok()).unwrap_or(2).max(2)
}

/// Returns the parameter that changes from frame to frame and its values, if one does.
pub(super) fn parameter_range(values: &Values) -> Option<ParameterRange> {
    let asked = values.group(SWEPT_RANGE.name)?;
    let [from, to] = [asked.number("from")?, asked.number("to")?];
    let pointer = asked.name("pointer")?.to_owned();
    Some(ParameterRange { pointer, values: between(from, to, frames(values), false) })
}

/// Returns `n` evenly spaced numbers from `from` to `to`; if `round`, without `to`, which would be the next one.
#[expect(clippy::cast_precision_loss, reason = "there are some hundred frames")]
fn between(from: f64, to: f64, n: usize, round: bool) -> Vec<f64> {
    let steps = if round { n } else { n - 1 } as f64;
    // the last frame is at the end to the last digit
    let at = |i: usize| if i + 1 == n && !round { to } else { from + (to - from) * (i as f64 / steps) };
    (0..n).map(at).collect()
}

/// Returns the options of each frame, all framed by the box around everything that the frames show.
pub fn shots(values: &Values, extent: &FigureExtent, coordinate_system: CoordinateSystem) -> Vec<Values> {
    let values = framed(values, extent);
    let n = frames(&values);
    let turn = match values.group(TURNTABLE.name) {
        None if values.group(SWEPT_RANGE.name).is_some() => return vec![values; n],
        turn => turn.cloned().unwrap_or_default(),
    };
    let [from, to] = [turn.number("from_deg").unwrap_or(0.0), turn.number("to_deg").unwrap_or(360.0)];
    let whole = (to - from).abs() >= 360.0 && (to - from) % 360.0 == 0.0;
    let azimuths = between(from, to, n, whole);
    turned(&values, &azimuths, coordinate_system)
}

/// Returns the options with these azimuths, at the distance or scale at which all frames show everything.
fn turned(values: &Values, azimuths: &[f64], coordinate_system: CoordinateSystem) -> Vec<Values> {
    let options = Options::new(values, coordinate_system);
    let camera = values.group(CAMERA.name).cloned().unwrap_or_default();
    let corners = options.corners().unwrap_or_default();
    let middle = [0, 1, 2].map(|k| 0.5 * corners[0][k] + 0.5 * corners[7][k]);
    let target = camera.vector("target").unwrap_or(middle);
    let cameras: Vec<_> = azimuths.iter().map(|azimuth| facing(&options, *azimuth, target, &corners)).collect();
    let distance = |eye: [f64; 3]| {
        let way = minus(eye, target);
        way.iter().map(|x| x * x).sum::<f64>().sqrt()
    };
    let farthest = cameras.iter().map(|camera| distance(camera.eye())).fold(0.0, f64::max);
    let smallest = cameras.iter().map(crate::raster::Camera::scale).fold(f64::INFINITY, f64::min);
    let seen = |(azimuth, camera): (&f64, &crate::raster::Camera)| {
        options.seen_from(*azimuth, target, (camera.forward(), farthest), smallest / camera.scale())
    };
    azimuths.iter().zip(&cameras).map(seen).collect()
}

/// A moving picture that is being written.
#[expect(missing_debug_implementations, reason = "what bytes go to need not have one")]
pub struct Film<'a> {
    writer: Writer<&'a mut dyn Write>,
    is_opaque: bool,
}

fn failed(error: png::EncodingError) -> FormatError {
    match error {
        png::EncodingError::IoError(error) => FormatError::Io(error),
        other => FormatError::Io(io::Error::other(other)),
    }
}

impl<'a> Film<'a> {
    /// Begins a moving picture with these options.
    ///
    /// # Errors
    /// When the writer fails.
    pub fn begin(values: &Values, out: &'a mut dyn Write) -> Result<Self, FormatError> {
        let options = Options::new(values, CoordinateSystem::default());
        let is_opaque = options.background[3] == 255;
        // frames are compressed like still pictures, see decision 7
        let mut encoder = picture::encoder(options.size, (is_opaque, options.dpi()), out);
        let delay = values.integer(DELAY.name).and_then(|ms| u16::try_from(ms).ok()).unwrap_or(80);
        encoder.set_animated(u32::try_from(frames(values)).unwrap_or(2), 0).map_err(failed)?;
        encoder.set_frame_delay(delay, 1000).map_err(failed)?;
        Ok(Self { writer: encoder.write_header().map_err(failed)?, is_opaque })
    }

    /// Adds a frame: the picture of a scene.
    ///
    /// # Errors
    /// Errors of the picture, or when the writer fails.
    pub fn frame(&mut self, scene: &Scene<'_>, values: &Values, watch: &Watch) -> Result<(), FormatError> {
        let pixels = picture::pixels(scene, values, watch)?;
        watch.check()?;
        watch.enter(Stage::Encode);
        if self.is_opaque {
            self.writer.write_image_data(&picture::without_alpha(pixels)).map_err(failed)
        } else {
            self.writer.write_image_data(&pixels).map_err(failed)
        }
    }

    /// Ends the picture after its last frame.
    ///
    /// # Errors
    /// When the writer fails.
    pub fn end(self) -> Result<(), FormatError> {
        self.writer.finish().map_err(failed)
    }
}
