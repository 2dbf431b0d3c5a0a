//! Parsing of values in the form that users write: sizes with units, durations, addresses. Every error shows an
//! example.

use std::net::SocketAddr;
use std::path::PathBuf;

use super::levels::LogLevels;
use super::origins::CorsOrigins;
use crate::fault::shortened;
use crate::math::amounts::thousands;

/// Units of sizes in bytes, binary and decimal ones, the largest first within each kind.
const SIZES: &[(&str, u64)] = &[
    ("PiB", 1 << 50),
    ("TiB", 1 << 40),
    ("GiB", 1 << 30),
    ("MiB", 1 << 20),
    ("KiB", 1 << 10),
    ("PB", 1_000_000_000_000_000),
    ("TB", 1_000_000_000_000),
    ("GB", 1_000_000_000),
    ("MB", 1_000_000),
    ("kB", 1000),
    ("B", 1),
];
/// Units of durations, in seconds.
const TIMES: &[(&str, u64)] = &[("d", 86_400), ("h", 3600), ("min", 60), ("s", 1)];

/// A type that the value of a setting can have.
pub(super) trait SettingValue: Sized {
    /// Reads a value; numbers count `unit`.
    fn read(text: &str, unit: &str) -> Result<Self, String>;
}

impl SettingValue for u64 {
    fn read(text: &str, unit: &str) -> Result<Self, String> {
        match unit {
            "bytes" | "bytes a second" => with_unit(text, SIZES).ok_or_else(|| {
                wrong(text, "is no size; write it like 64MiB, 500kB or 1.5GiB, or as a number of bytes")
            }),
            "seconds" => with_unit(text, TIMES)
                .ok_or_else(|| wrong(text, "is no time; write it like 30s, 5min or 2h, or as a number of seconds")),
            _ => with_unit(text, &[])
                .ok_or_else(|| wrong(text, "is no whole number; write it like 20000000 or 20_000_000")),
        }
    }
}

impl SettingValue for usize {
    fn read(text: &str, unit: &str) -> Result<Self, String> {
        u64::read(text, unit)?.try_into().map_err(|_| wrong(text, "is too large; write it like 256"))
    }
}

impl SettingValue for SocketAddr {
    fn read(text: &str, _: &str) -> Result<Self, String> {
        let local = text.strip_prefix("localhost").unwrap_or(text);
        let local = local.strip_prefix(':').filter(|port| !port.is_empty()).map(|port| format!("127.0.0.1:{port}"));
        let remedy = "is no address to listen on; write it like 127.0.0.1:8080, localhost:8080 or :8080 for this \
                      machine alone, [::1]:8080, or 0.0.0.0:8080 for every network";
        local.as_deref().unwrap_or(text).parse().map_err(|_| wrong(text, remedy))
    }
}

impl SettingValue for bool {
    fn read(text: &str, _: &str) -> Result<Self, String> {
        text.parse().map_err(|_| wrong(text, "is neither true nor false; write it like true"))
    }
}

impl SettingValue for PathBuf {
    fn read(text: &str, _: &str) -> Result<Self, String> {
        Ok(text.into())
    }
}

impl SettingValue for String {
    fn read(text: &str, _: &str) -> Result<Self, String> {
        Ok(text.to_owned())
    }
}

impl SettingValue for CorsOrigins {
    fn read(text: &str, _: &str) -> Result<Self, String> {
        text.parse()
    }
}

impl SettingValue for LogLevels {
    fn read(text: &str, _: &str) -> Result<Self, String> {
        text.parse()
    }
}

/// Reads a duration, with or without a unit, and returns it in seconds.
///
/// # Errors
/// What is wrong with the duration.
pub fn seconds(text: &str) -> Result<u64, String> {
    u64::read(text, "seconds")
}

fn wrong(text: &str, remedy: &str) -> String {
    format!("\"{}\" {remedy}", shortened(text))
}

/// Reads a whole number, or one of at most 9 decimal places with a unit, in upper or lower case. A fraction below one
/// of the smallest unit is dropped.
fn with_unit(text: &str, units: &[(&str, u64)]) -> Option<u64> {
    let text = text.trim();
    let (digits, unit) = text.split_at(text.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(text.len()));
    let (digits, unit) = (digits.trim_end(), unit.trim());
    let known = || units.iter().find(|(name, _)| name.eq_ignore_ascii_case(unit)).map(|(_, factor)| *factor);
    let factor = if unit.is_empty() { 1 } else { known()? };
    let (whole, places) = match digits.split_once('.') {
        Some((whole, places)) if !unit.is_empty() && (1..=9).contains(&places.len()) => (whole, places),
        Some(_) => return None,
        None => (digits, ""),
    };
    let whole = whole.replace('_', "");
    let is_number = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    if whole.is_empty() || !is_number(&whole) || !is_number(places) {
        return None;
    }
    let places_factor = 10_u128.pow(u32::try_from(places.len()).ok()?);
    let mantissa: u128 = format!("{whole}{places}").parse().ok()?;
    (mantissa.checked_mul(factor.into())? / places_factor).try_into().ok()
}

/// Formats a number for messages and the help; sizes are in the largest binary unit of which they are a multiple.
pub(super) fn shown(n: u64, unit: &str) -> String {
    if !["bytes", "bytes a second"].contains(&unit) {
        return thousands(n.into());
    }
    let fits = |(name, size): &&(&str, u64)| name.ends_with("iB") && n > 0 && n.is_multiple_of(*size);
    match SIZES.iter().find(fits) {
        Some((name, size)) => format!("{} {name}", thousands((n / size).into())),
        None if n == 1 => "1 byte".to_owned(),
        None => format!("{} bytes", thousands(n.into())),
    }
}
