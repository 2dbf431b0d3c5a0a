//! The minimum pace of a transfer: it may be slow at first, but not for ever.

use std::time::Duration;

/// The minimum pace of a transfer: any pace for the time `grace`, then at least `least_rate` on average.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Pace {
    /// Time that a transfer has in any case.
    pub(super) grace: Duration,
    /// Minimum rate in bytes per second.
    pub(super) least_rate: u64,
}

impl Pace {
    /// Returns the maximum duration of a transfer that has moved `bytes` bytes: `grace + bytes / least_rate`.
    pub(super) fn allows(&self, bytes: u64) -> Duration {
        let millis = bytes.saturating_mul(1000) / self.least_rate.max(1);
        // a day is longer than any transfer, and adding it to a time does not overflow
        self.grace.saturating_add(Duration::from_millis(millis)).min(Duration::from_hours(24))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn l_a_reader_at_twenty_kilobytes_a_second_is_never_cut_and_one_that_stops_is() {
        let pace = Pace { grace: Duration::from_secs(15), least_rate: 16 << 10 };
        for seconds in [1, 15, 16, 60, 3600] {
            assert!(pace.allows(20_000 * seconds) > Duration::from_secs(seconds), "{seconds} s");
        }
        // the bytes that the system buffers for a client are read at the minimum rate in about a minute
        assert_eq!(pace.allows(1 << 20), Duration::from_secs(15 + 64));
        assert!(pace.allows(u64::MAX) <= Duration::from_hours(24), "any length can be added to any time");
    }
}
