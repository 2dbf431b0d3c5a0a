//! Time, injected: the service asks a clock, so that tests can turn it.

use std::fmt;
use std::future::Future;
use std::pin::Pin;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant, SystemTime};

use tokio::sync::Notify;

/// A clock.
pub trait Clock: fmt::Debug + Send + Sync {
    /// Time that passes evenly and never goes back, counted on from the wall clock as it stood at the start. What an
    /// earlier process wrote down by the wall clock therefore lies before it.
    fn now(&self) -> Duration;

    /// Time since 1970, for what has to be told across processes; may jump.
    fn wall(&self) -> Duration;

    /// Waits until so much time has passed.
    fn sleep(&self, time: Duration) -> Pin<Box<dyn Future<Output = ()> + Send + '_>>;
}

/// The machine's monotonic clock.
#[derive(Debug)]
pub struct Monotonic {
    start: Instant,
    /// What the wall clock said then.
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

/// A clock that stands still until it is moved.
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
                // whoever moves the clock from here on is heard
                let moved = self.moved.notified();
                if self.now() >= until {
                    return;
                }
                moved.await;
            }
        })
    }
}
