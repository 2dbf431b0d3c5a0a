//! Counts of answered requests, and of the bytes of their answers.

use std::collections::BTreeMap;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use axum::http::Method;

use crate::service::lock::lock;

/// The number of answers to requests of one method by route and status.
type RouteCounts = BTreeMap<String, BTreeMap<u16, u64>>;

/// The number of answers by method, route and status. All three are closed sets, so that no client can make the table
/// grow.
#[derive(Debug, Default)]
pub(super) struct RequestCounts {
    answers: Mutex<BTreeMap<&'static str, RouteCounts>>,
    sent_bytes: AtomicU64,
}

impl RequestCounts {
    /// Counts an answer.
    pub(super) fn count(&self, method: &Method, route: &str, status: u16) {
        let method = ["GET", "HEAD", "POST", "DELETE", "OPTIONS"].into_iter().find(|known| method == known);
        let mut table = lock(&self.answers);
        let routes = table.entry(method.unwrap_or("other")).or_default();
        if let Some(n) = routes.get_mut(route).and_then(|counts| counts.get_mut(&status)) {
            *n += 1;
            return;
        }
        routes.entry(route.to_owned()).or_default().insert(status, 1);
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
        for (method, routes) in table.iter() {
            for (route, counts) in routes {
                counts.iter().for_each(|(status, n)| tell(method, route, *status, *n));
            }
        }
    }
}
