//! Traces (W3C Trace Context): the id of a request in the log, in the answer and at the client.

use std::hash::{BuildHasher, RandomState};
use std::sync::LazyLock;
use std::sync::atomic::{AtomicU64, Ordering};

use axum::http::{HeaderMap, HeaderName, HeaderValue};

/// The header that carries a trace from one service to the next.
const TRACEPARENT: HeaderName = HeaderName::from_static("traceparent");

tokio::task_local! {
    /// The trace of the request that this task answers.
    static CURRENT_TRACE: Trace;
}

/// The trace of a request.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Trace {
    /// 32 hexadecimal digits: the trace id of the request if it has one, else a new one.
    id: String,
    /// The flags of the request's trace, if it has one.
    flags: Option<String>,
}

impl Trace {
    /// Reads the trace of a request, or starts a new one.
    pub(super) fn of(headers: &HeaderMap) -> Self {
        let named = headers.get(TRACEPARENT).and_then(|value| value.to_str().ok()).and_then(parsed);
        match named {
            Some((id, flags)) => Self { id: id.to_owned(), flags: Some(flags.to_owned()) },
            None => Self { id: new_id(), flags: None },
        }
    }

    /// Returns the trace id.
    pub(super) fn id(&self) -> &str {
        &self.id
    }

    /// Adds the trace with a new span id to an answer, if the request had a trace.
    pub(super) fn add_headers(&self, headers: &mut HeaderMap) {
        if let Some(flags) = &self.flags {
            let value = format!("00-{}-{}-{flags}", self.id, &new_id()[..16]);
            headers.extend(HeaderValue::try_from(value).map(|value| (TRACEPARENT, value)));
        }
    }

    /// Runs a future as a part of this trace.
    pub(super) async fn within<T>(self, work: impl Future<Output = T>) -> T {
        CURRENT_TRACE.scope(self, work).await
    }
}

/// Returns the trace id of the current request, or a new id outside requests.
pub(super) fn current_id() -> String {
    CURRENT_TRACE.try_with(|trace| trace.id.clone()).unwrap_or_else(|_| new_id())
}

/// Returns id and flags of `version-id-parent-flags`, or `None` if the header is invalid.
fn parsed(text: &str) -> Option<(&str, &str)> {
    let is_hex = |text: &str, n| text.len() == n && text.bytes().all(|b| matches!(b, b'0'..=b'9' | b'a'..=b'f'));
    let is_some = |text: &str| text.bytes().any(|b| b != b'0');
    let mut parts = text.split('-');
    let (version, id, parent, flags) = (parts.next()?, parts.next()?, parts.next()?, parts.next()?);
    let is_whole = is_hex(version, 2) && is_hex(id, 32) && is_hex(parent, 16) && is_hex(flags, 2);
    // later versions may have more fields after the flags
    let is_known = version != "ff" && (version != "00" || parts.next().is_none());
    (is_whole && is_known && is_some(id) && is_some(parent)).then_some((id, flags))
}

/// Returns 32 hexadecimal digits that look random, as the recommendation asks for: a trace id, and a span id in its
/// first half alone. Ids of one process differ as far as hashes of 64 bits do.
fn new_id() -> String {
    static TRACE_COUNTER: AtomicU64 = AtomicU64::new(0);
    static KEYED: LazyLock<[RandomState; 2]> = LazyLock::new(Default::default);
    let count = TRACE_COUNTER.fetch_add(1, Ordering::Relaxed);
    let [first, second] = [0, 1].map(|half: usize| KEYED[half].hash_one(count));
    format!("{first:016x}{second:016x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_trace_is_read_as_the_recommendation_has_it() {
        let (id, parent) = ("4bf92f3577b34da6a3ce929d0e0e4736", "00f067aa0ba902b7");
        let of = |text: &str| parsed(text).map(|(id, flags)| (id.to_owned(), flags.to_owned()));
        let known = Some((id.to_owned(), "01".to_owned()));
        assert_eq!(of(&format!("00-{id}-{parent}-01")), known);
        assert_eq!(of(&format!("cc-{id}-{parent}-01-what-comes")), known);
        for wrong in [
            format!("00-{id}-{parent}-01-more"),
            format!("ff-{id}-{parent}-01"),
            format!("00-{}-{parent}-01", "0".repeat(32)),
            format!("00-{id}-{}-01", "0".repeat(16)),
            format!("00-{}-{parent}-01", id.to_uppercase()),
            format!("00-{id}-{parent}"),
            format!("00-{id}\"-{parent}-01"),
            String::new(),
        ] {
            assert_eq!(of(&wrong), None, "{wrong}");
        }
    }
}
