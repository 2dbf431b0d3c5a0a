//! How often requests were answered.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use axum::http::Method;

/// Requests by method, route and status: closed sets all three, so that no client can make the table grow.
#[derive(Debug, Default)]
pub(super) struct Requests(Mutex<BTreeMap<(&'static str, String, u16), u64>>);

impl Requests {
    /// Counts an answer.
    pub(super) fn count(&self, method: &Method, route: &str, status: u16) {
        let method = ["GET", "HEAD", "POST", "DELETE", "OPTIONS"].into_iter().find(|known| method == known);
        let mut table = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        *table.entry((method.unwrap_or("other"), route.to_owned(), status)).or_default() += 1;
    }

    /// Tells method, route, status and number of all that were counted, in their order.
    pub(super) fn each(&self, mut tell: impl FnMut(&str, &str, u16, u64)) {
        let table = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        table.iter().for_each(|((method, route, status), n)| tell(method, route, *status, *n));
    }
}
