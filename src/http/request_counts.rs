//! How often requests were answered, and with how many bytes.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

use axum::http::Method;

/// Requests by method, route and status: closed sets all three, so that no client can make the table grow.
#[derive(Debug, Default)]
pub(super) struct Requests {
    answers: Mutex<BTreeMap<(&'static str, String, u16), u64>>,
    sent_bytes: AtomicU64,
}

impl Requests {
    /// Counts an answer.
    pub(super) fn count(&self, method: &Method, route: &str, status: u16) {
        let method = ["GET", "HEAD", "POST", "DELETE", "OPTIONS"].into_iter().find(|known| method == known);
        let mut table = self.answers.lock().unwrap_or_else(PoisonError::into_inner);
        *table.entry((method.unwrap_or("other"), route.to_owned(), status)).or_default() += 1;
    }

    /// Counts bytes of an answer.
    pub(super) fn sent(&self, bytes: usize) {
        self.sent_bytes.fetch_add(bytes as u64, Ordering::Relaxed);
    }

    /// Bytes of all answers, without their heads.
    pub(super) fn sent_bytes(&self) -> u64 {
        self.sent_bytes.load(Ordering::Relaxed)
    }

    /// Tells method, route, status and number of all that were counted, in their order.
    pub(super) fn each(&self, mut tell: impl FnMut(&str, &str, u16, u64)) {
        let table = self.answers.lock().unwrap_or_else(PoisonError::into_inner);
        table.iter().for_each(|((method, route, status), n)| tell(method, route, *status, *n));
    }
}
