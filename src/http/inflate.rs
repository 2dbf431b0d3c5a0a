//! Compressed request bodies: inflated piece by piece in the reading lane, up to the maximum length of a body; the
//! memory of the inflated bytes is charged before it is allocated.

use std::io::Read;
use std::sync::Arc;

use flate2::bufread::MultiGzDecoder;

use super::app::App;
use super::charge::Charge;
use super::client::Client;
use super::content::BodyCoding;
use super::problem::{self, Problem};
use crate::math::amounts::in_bytes;
use crate::watch::Watch;

/// Maximum window of Zstandard, as a power of two: 8 MiB, which RFC 8878 asks of every decoder. Twice of it takes twice
/// the memory of each body that is inflated; half of it refuses the output of `zstd -19` for large files.
const WINDOW_LOG: u32 = 23;
/// Memory of a decoder in bytes: its window, its pending output, and its tables.
const DECODER_BYTES: u64 = (1 << WINDOW_LOG) + (1 << 20);
/// Number of bytes inflated between two checks of the bounds. Half of it checks twice as often; twice of it lets a
/// decompression bomb pass its bound by twice as much.
const INFLATE_STEP_BYTES: usize = 64 << 10;

/// Inflates a body.
///
/// # Errors
/// A body that is not in this coding, or is longer than the maximum; 503 if too much is being read already.
pub(super) async fn inflated(
    app: &Arc<App>,
    client: &Client,
    coding: BodyCoding,
    packed: Vec<u8>,
    charge: Charge,
) -> Result<(Vec<u8>, Charge), Problem> {
    if coding == BodyCoding::Identity {
        return Ok((packed, charge));
    }
    let (of_lane, of_client) = (app.clone(), client.clone());
    // in a box, so that requests that are not packed are not moved with room for it
    Box::pin(app.desk.read(client.peer(), DECODER_BYTES, move |watch| {
        let inflated = inflate(&of_lane, &of_client, coding, &packed, watch);
        drop((packed, charge));
        inflated
    }))
    .await?
}

fn inflate(
    app: &App,
    client: &Client,
    coding: BodyCoding,
    packed: &[u8],
    watch: &Watch,
) -> Result<(Vec<u8>, Charge), Problem> {
    let limit = app.settings.max_body_bytes;
    let (mut bytes, mut charge, mut piece) = (Vec::new(), Charge::default(), vec![0; INFLATE_STEP_BYTES]);
    let mut decoder = decoder(coding, packed).map_err(|error| broken(&error))?;
    loop {
        watch.check().map_err(|_| Problem::new(problem::SLOW, "inflating the body took too long; send it as it is"))?;
        let n = decoder.read(&mut piece).map_err(|error| broken(&error))?;
        if n == 0 {
            return Ok((bytes, charge));
        }
        let length = bytes.len() + n;
        if length as u64 > limit {
            return Err(too_long(length as u64, limit));
        }
        if length > bytes.capacity() {
            let most = usize::try_from(limit).unwrap_or(usize::MAX);
            let capacity = (2 * bytes.capacity()).min(most).max(length);
            charge.cover(app, client, capacity)?;
            bytes.reserve_exact(capacity - bytes.len());
        }
        bytes.extend_from_slice(&piece[..n]);
    }
}

fn decoder(coding: BodyCoding, packed: &[u8]) -> std::io::Result<Box<dyn Read + '_>> {
    Ok(match coding {
        BodyCoding::Identity => Box::new(packed),
        BodyCoding::Gzip => Box::new(MultiGzDecoder::new(packed)),
        BodyCoding::Zstd => {
            let mut decoder = zstd::stream::read::Decoder::with_buffer(packed)?;
            decoder.window_log_max(WINDOW_LOG)?;
            Box::new(decoder)
        }
    })
}

fn broken(error: &std::io::Error) -> Problem {
    let detail = format!("the body is not what Content-Encoding says: {error}; send it again, or as it is");
    Problem::new(problem::NOT_CODED, detail)
}

/// Returns the refusal of a body with at least `length` bytes.
pub(super) fn too_long(length: u64, limit: u64) -> Problem {
    let limit = in_bytes(limit.into());
    let detail = format!(
        "the body has {length} bytes or more; this server reads {limit} (max-body-bytes): send a smaller input, or \
         start the server with a larger --max-body-bytes"
    );
    Problem::new(problem::BODY_TOO_LONG, detail)
}
