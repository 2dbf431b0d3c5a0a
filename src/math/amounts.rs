//! Formats numbers and byte counts for people.

/// Returns a number with its digits in groups of three.
pub fn thousands(n: u128) -> String {
    let digits = n.to_string();
    let mut grouped = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            grouped.push(',');
        }
        grouped.push(digit);
    }
    grouped
}

/// Returns a number of bytes in a suitable unit.
pub fn in_bytes(n: u128) -> String {
    const UNITS: [&str; 6] = ["bytes", "KiB", "MiB", "GiB", "TiB", "PiB"];
    let unit = (0..UNITS.len() - 1).find(|&unit| n >> (10 * (unit + 1)) == 0).unwrap_or(UNITS.len() - 1);
    if unit == 0 {
        return format!("{n} bytes");
    }
    let tenths = n.saturating_mul(10) >> (10 * unit);
    format!("{}.{} {}", thousands(tenths / 10), tenths % 10, UNITS[unit])
}
