//! What was asked lately: from the bytes of a request to the key of its result, so that a request that comes again is
//! neither parsed nor checked again. It holds keys only; the result itself must still be at hand.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use axum::http::{HeaderMap, header};

use super::address::address;
use super::content::Notation;
use crate::job::Job;
use crate::job::Resolved;
use crate::job::key::{Key, content};
use crate::service::job_key::Tenant;

/// Longest request that is remembered, bytes.
/// Twice of it compares and hashes longer requests for answers that take longer anyway; half of it reads more of the
/// small ones again.
const MAX_BYTES: usize = 64 << 10;
/// Most requests remembered; when there are more, all are forgotten.
/// Half of it forgets twice as often; twice of it may hold twice the memory.
const MAX_REQUESTS: usize = 16_384;

/// Requests whose jobs were admitted.
#[derive(Debug, Default)]
pub struct Memo(Mutex<HashMap<Key, Known>>);

/// What is known of a request.
#[derive(Debug, Clone)]
pub(super) struct Known {
    /// Key of the result.
    pub(super) key: Key,
    /// Its address.
    pub(super) address: Arc<str>,
    /// What a tolerance led to.
    pub(super) reached: Option<Resolved>,
}

impl Known {
    /// What is known of a job with one output.
    pub(super) fn of(job: &Job) -> Self {
        let (key, output) = (job.keys()[0], &job.outputs[0]);
        Self { key, address: address(key, output.format).into(), reached: job.reached }
    }
}

/// The identity of a request: its tenant, its body, the query where that says a part of the job, and the header that
/// can change their meaning.
pub(super) fn identity(tenant: Tenant, headers: &HeaderMap, notation: &Notation, body: &[u8]) -> Option<Key> {
    if body.len() > MAX_BYTES {
        return None;
    }
    let mut bytes = (body.len() as u64).to_le_bytes().to_vec();
    bytes.extend_from_slice(body);
    if let Notation::File(reader, query) = notation {
        bytes.extend_from_slice(format!("\n{}\n{query}\n", reader.name).as_bytes());
    }
    Some(accepting(tenant, headers, bytes))
}

/// The identity of a request whose address says the job.
pub(super) fn link_identity(tenant: Tenant, headers: &HeaderMap, address: &str) -> Key {
    // no body is as long as these letters say where its length would stand
    accepting(tenant, headers, format!("address\n{address}\n").into_bytes())
}

/// The identity of what these bytes ask for, `Accept`, and the tenant: what others have asked for is not known.
fn accepting(tenant: Tenant, headers: &HeaderMap, mut bytes: Vec<u8>) -> Key {
    bytes.extend_from_slice(&tenant.0.to_le_bytes());
    for value in headers.get_all(header::ACCEPT) {
        bytes.extend_from_slice(value.as_bytes());
        bytes.push(b',');
    }
    content(&bytes)
}

impl Memo {
    /// What is known of a request.
    pub(super) fn get(&self, request: &Key) -> Option<Known> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get(request).cloned()
    }

    /// How many requests are remembered.
    pub fn len(&self) -> usize {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).len()
    }

    /// Whether no request is remembered.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Remembers a request whose job was admitted, now or when its result was made.
    pub(super) fn put(&self, request: Key, known: Known) {
        let mut requests = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if requests.len() >= MAX_REQUESTS {
            requests.clear();
        }
        requests.insert(request, known);
    }
}
