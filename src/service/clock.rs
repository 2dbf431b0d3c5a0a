//! Time as a trait: the service reads an injected clock, so that tests can set the time.

use std::fmt;
use std::future::Future;
use std::pin::Pin;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant, SystemTime};

use tokio::sync::Notify;

/// A clock.
pub trait Clock: fmt::Debug + Send + Sync {
    /// Returns a monotonic time that starts at the wall-clock time of the process start. Wall-clock times recorded by
    /// an earlier process therefore precede it.
    fn now(&self) -> Duration;

    /// Returns the time since 1970, for times that several processes share; it may jump.
    fn wall(&self) -> Duration;

    /// Waits for the given duration.
    fn sleep(&self, time: Duration) -> Pin<Box<dyn Future<Output = ()> + Send + '_>>;
}

/// The machine's monotonic clock.
#[derive(Debug)]
pub struct Monotonic {
    start: Instant,
    /// The wall-clock time at `start`, since 1970.
    wall: Duration,
}

impl Default for Monotonic {
    fn default() -> Self {
        Self {
            start: Instant::now(),
            wall: SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default(),
        }
    }
}

impl Clock for Monotonic {
    fn now(&self) -> Duration {
        self.wall.saturating_add(self.start.elapsed())
    }

    fn wall(&self) -> Duration {
        SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default()
    }

    fn sleep(&self, time: Duration) -> Pin<Box<dyn Future<Output = ()> + Send + '_>> {
        Box::pin(tokio::time::sleep(time))
    }
}

/// A clock for tests, which moves only when told to.
#[derive(Debug, Default)]
pub struct Manual {
    nanos: AtomicU64,
    moved: Notify,
}

impl Manual {
    /// Moves the clock forward.
    pub fn advance(&self, by: Duration) {
        self.nanos.fetch_add(u64::try_from(by.as_nanos()).unwrap_or(u64::MAX), Ordering::SeqCst);
        self.moved.notify_waiters();
    }
}

impl Clock for Manual {
    fn now(&self) -> Duration {
        Duration::from_nanos(self.nanos.load(Ordering::SeqCst))
    }

    fn wall(&self) -> Duration {
        self.now()
    }

    fn sleep(&self, time: Duration) -> Pin<Box<dyn Future<Output = ()> + Send + '_>> {
        let until = self.now().saturating_add(time);
        Box::pin(async move {
            loop {
                // registered before the time is read, so that no advance is missed
                let moved = self.moved.notified();
                if self.now() >= until {
                    return;
                }
                moved.await;
            }
        })
    }
}
