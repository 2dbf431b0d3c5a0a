//! The least pace of a transfer: slow at first is fine, slow for ever is not.

use std::time::Duration;

/// How slow a transfer may be: for `grace` as slow as it likes, after that at `least_rate` on average.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Pace {
    /// Time that a transfer has in any case.
    pub(super) grace: Duration,
    /// Bytes a second.
    pub(super) least_rate: u64,
}

impl Pace {
    /// How long a transfer may have taken when so many bytes are through: `grace + bytes / least_rate`.
    pub(super) fn allows(&self, bytes: u64) -> Duration {
        let millis = bytes.saturating_mul(1000) / self.least_rate.max(1);
        // a day is longer than any transfer, and can be added to any time
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
        // what the system holds for a client is read out at the least rate in about a minute
        assert_eq!(pace.allows(1 << 20), Duration::from_secs(15 + 64));
        assert!(pace.allows(u64::MAX) <= Duration::from_hours(24), "any length can be added to any time");
    }
}
