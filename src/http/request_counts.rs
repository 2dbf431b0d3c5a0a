//! Counts of answered requests, and of the bytes of their answers.

use std::collections::BTreeMap;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use axum::http::Method;

use crate::service::lock::lock;

/// The number of answers of one route by method and status.
type RouteCounts = BTreeMap<(&'static str, u16), u64>;

/// The number of answers by route, method and status. All three are closed sets, so that no client can make the table
/// grow.
#[derive(Debug, Default)]
pub(super) struct RequestCounts {
    answers: Mutex<BTreeMap<String, RouteCounts>>,
    sent_bytes: AtomicU64,
}

impl RequestCounts {
    /// Counts an answer.
    pub(super) fn count(&self, method: &Method, route: &str, status: u16) {
        let method = ["GET", "HEAD", "POST", "DELETE", "OPTIONS"].into_iter().find(|known| method == known);
        let kind = (method.unwrap_or("other"), status);
        let mut table = lock(&self.answers);
        if let Some(n) = table.get_mut(route).and_then(|of_route| of_route.get_mut(&kind)) {
            *n += 1;
            return;
        }
        table.entry(route.to_owned()).or_default().insert(kind, 1);
    }

    /// Counts bytes of an answer's body.
    pub(super) fn sent(&self, bytes: usize) {
        self.sent_bytes.fetch_add(bytes as u64, Ordering::Relaxed);
    }

    /// Returns the number of bytes of all answers, without their headers.
    pub(super) fn sent_bytes(&self) -> u64 {
        self.sent_bytes.load(Ordering::Relaxed)
    }

    /// Calls `tell` with method, route, status and count of each entry, in order.
    pub(super) fn each(&self, mut tell: impl FnMut(&str, &str, u16, u64)) {
        let table = lock(&self.answers);
        for (route, of_route) in table.iter() {
            of_route.iter().for_each(|((method, status), n)| tell(method, route, *status, *n));
        }
    }
}
