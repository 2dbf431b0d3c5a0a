//! An analysis as bytes in one of the output forms.

use std::io::{self, Write};

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

use super::{AnalysisAnswer, figure, markdown};
use crate::drawing::{DrawError, Lettering, pixels, svg};
use crate::job::{Form, RunError};
use crate::watch::Watch;

impl AnalysisAnswer {
    /// Writes the answer in a form.
    ///
    /// # Errors
    /// When the watch says stop, or the bytes cannot be written.
    pub fn write(&self, form: Form, out: &mut dyn Write, watch: &Watch) -> Result<(), RunError> {
        match form {
            Form::Json => out.write_all(&serde_json::to_vec(self).expect("numbers and text")).map_err(RunError::Io),
            Form::Markdown => out.write_all(markdown::report(self).as_bytes()).map_err(RunError::Io),
            Form::Svg => svg(&figure::figure(self), Lettering::Text, out, watch).map_err(unmade),
            Form::Png => self.encode(out, watch),
        }
    }

    fn encode(&self, out: &mut dyn Write, watch: &Watch) -> Result<(), RunError> {
        let figure = figure::figure(self);
        let [width, height] = figure.size;
        let colors: Vec<u8> =
            pixels(&figure, watch).map_err(unmade)?.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
        PngEncoder::new_with_quality(out, CompressionType::Fast, FilterType::Adaptive)
            .write_image(&colors, width, height, ExtendedColorType::Rgb8)
            .map_err(|error| RunError::Io(io::Error::other(error)))
    }
}

fn unmade(error: DrawError) -> RunError {
    match error {
        DrawError::Stopped(stopped) => RunError::Stopped(stopped),
        DrawError::Io(error) => RunError::Io(error),
        DrawError::Unfit(why) => RunError::Io(io::Error::other(why)),
    }
}
