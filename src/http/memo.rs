//! The memo of recent requests: from the identity of a request to the key of its result, so that a repeated request is
//! neither parsed nor checked again. It holds keys only; the result itself must still be in the cache.

use std::collections::HashMap;
use std::sync::{Arc, Mutex};

use axum::http::{HeaderMap, header};

use super::address::address;
use super::content::Notation;
use crate::job::Job;
use crate::job::ResolvedLevel;
use crate::job::key::{Key, content};
use crate::service::job_key::Tenant;
use crate::service::lock::lock;

/// Maximum length of a request that is remembered, in bytes. Twice of it hashes and compares longer requests for
/// answers that take longer anyway; half of it parses more of the small ones again.
const MAX_REMEMBERED_BYTES: usize = 64 << 10;
/// Maximum number of requests that are remembered; when it is reached, all are forgotten. Half of it forgets twice as
/// often; twice of it may hold twice the memory.
const MAX_REMEMBERED_REQUESTS: usize = 16_384;

/// What is hashed of most requests beside their bodies, in bytes. Half of it moves some that a browser sends; twice of
/// it asks for more than is used.
const USUAL_HEADERS_BYTES: usize = 256;

/// The requests whose jobs were admitted, by their identity.
#[derive(Debug, Default)]
pub struct Memo(Mutex<HashMap<Key, RememberedRequest>>);

/// The result to which a request led, as far as it is remembered.
#[derive(Debug, Clone)]
pub(super) struct RememberedRequest {
    /// The key of the result.
    pub(super) key: Key,
    /// The address of the result.
    pub(super) address: Arc<str>,
    /// The level and the bound that a tolerance or "auto" led to.
    pub(super) reached: Option<ResolvedLevel>,
}

impl RememberedRequest {
    /// Creates the entry of a job with one output.
    pub(super) fn of(job: &Job) -> Self {
        let (key, output) = (job.keys()[0], &job.outputs[0]);
        Self { key, address: address(key, output.format).into(), reached: job.reached }
    }
}

/// Returns the identity of a request: a hash of its tenant, its body, the query if that contains a part of the job, and
/// `Accept`; `None` if the body is too long.
pub(super) fn identity(tenant: Tenant, headers: &HeaderMap, notation: &Notation, body: &[u8]) -> Option<Key> {
    if body.len() > MAX_REMEMBERED_BYTES {
        return None;
    }
    let mut bytes = Vec::with_capacity(body.len() + USUAL_HEADERS_BYTES);
    bytes.extend_from_slice(&(body.len() as u64).to_le_bytes());
    bytes.extend_from_slice(body);
    if let Notation::File(reader, query) = notation {
        bytes.extend_from_slice(format!("\n{}\n{query}\n", reader.name).as_bytes());
    }
    Some(accepting(tenant, headers, bytes))
}

/// Returns the identity of a request whose address contains the job.
pub(super) fn link_identity(tenant: Tenant, headers: &HeaderMap, address: &str) -> Key {
    // distinct from all identities of bodies: these letters, read as the length of a body, exceed every body
    accepting(tenant, headers, format!("address\n{address}\n").into_bytes())
}

/// Returns the hash of these bytes, the tenant and `Accept`; with the tenant, no client learns what others have
/// requested.
fn accepting(tenant: Tenant, headers: &HeaderMap, mut bytes: Vec<u8>) -> Key {
    bytes.extend_from_slice(&tenant.0.to_le_bytes());
    for value in headers.get_all(header::ACCEPT) {
        bytes.extend_from_slice(value.as_bytes());
        bytes.push(b',');
    }
    content(&bytes)
}

impl Memo {
    /// Returns what is remembered of a request.
    pub(super) fn get(&self, request: &Key) -> Option<RememberedRequest> {
        lock(&self.0).get(request).cloned()
    }

    /// Returns the number of remembered requests.
    pub fn n_requests(&self) -> usize {
        lock(&self.0).len()
    }

    /// Remembers a request whose job was admitted, now or when its result was made.
    pub(super) fn put(&self, request: Key, known: RememberedRequest) {
        let mut requests = lock(&self.0);
        if requests.len() >= MAX_REMEMBERED_REQUESTS {
            requests.clear();
        }
        requests.insert(request, known);
    }
}
