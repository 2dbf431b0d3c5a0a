//! Base64 decoding (RFC 4648, section 4) as files need it: with line breaks, and with or without padding.

use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use base64::{DecodeError, Engine};

/// Padding is optional.
const ENGINE: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// Decodes base64; line breaks are skipped and padding is optional.
///
/// # Errors
/// A character is not base64, which the message names by its position, or the text ends within a byte.
pub fn decode(text: &str) -> Result<Vec<u8>, String> {
    let has_breaks = text.bytes().any(is_break);
    let letters: Vec<u8>;
    let letters = if has_breaks {
        letters = text.bytes().filter(|letter| !is_break(*letter)).collect();
        &letters
    } else {
        text.as_bytes()
    };
    ENGINE.decode(letters).map_err(|error| match error {
        DecodeError::InvalidByte(at, _) => {
            let at = text.bytes().enumerate().filter(|(_, letter)| !is_break(*letter)).nth(at).map_or(at, |(at, _)| at);
            format!("character {at} is no base64; letters are A-Z, a-z, 0-9, + and /")
        }
        _ => "the base64 breaks off within a byte; send it whole".to_owned(),
    })
}

fn is_break(letter: u8) -> bool {
    matches!(letter, b'\r' | b'\n')
}
