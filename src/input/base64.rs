//! Base64 to bytes. Source: RFC 4648, section 4.

/// The bytes of a text in base64; line breaks are passed over, padding may be left out.
///
/// # Errors
/// The place of what does not belong there.
pub fn decode(text: &str) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3 + 3);
    let (mut bits, mut n) = (0_u32, 0);
    let mut ended = false;
    for (at, letter) in text.bytes().enumerate() {
        match (letter, value(letter)) {
            (b'\r' | b'\n', _) => {}
            (b'=', _) => ended = true,
            (_, Some(value)) if !ended => {
                bits = bits << 6 | value;
                n += 1;
                if n == 4 {
                    bytes.extend_from_slice(&bits.to_be_bytes()[1..]);
                    (bits, n) = (0, 0);
                }
            }
            _ => return Err(format!("character {at} is no base64; letters are A-Z, a-z, 0-9, + and /")),
        }
    }
    match n {
        0 => {}
        2 if bits.trailing_zeros() >= 4 => bytes.push((bits >> 4).to_be_bytes()[3]),
        3 if bits.trailing_zeros() >= 2 => bytes.extend_from_slice(&(bits >> 2).to_be_bytes()[2..]),
        _ => return Err("the base64 breaks off within a byte; send it whole".to_owned()),
    }
    Ok(bytes)
}

fn value(letter: u8) -> Option<u32> {
    let value = match letter {
        b'A'..=b'Z' => letter - b'A',
        b'a'..=b'z' => letter - b'a' + 26,
        b'0'..=b'9' => letter - b'0' + 52,
        b'+' => 62,
        b'/' => 63,
        _ => return None,
    };
    Some(value.into())
}
