//! What was answered, counted.

use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

use axum::http::Method;

/// Requests by method, route and status: closed sets all three, so that no client can make the table grow.
#[derive(Debug, Default)]
pub(super) struct RequestCounts(Mutex<Table>);

/// By method, route and status.
type Table = BTreeMap<(&'static str, String, u16), u64>;

impl RequestCounts {
    /// The counts.
    pub(super) fn table(&self) -> MutexGuard<'_, Table> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Counts an answer.
    pub(super) fn count(&self, method: &Method, route: &str, status: u16) {
        let method = ["GET", "HEAD", "POST", "DELETE", "OPTIONS"].into_iter().find(|known| method == known);
        *self.table().entry((method.unwrap_or("other"), route.to_owned(), status)).or_default() += 1;
    }
}
