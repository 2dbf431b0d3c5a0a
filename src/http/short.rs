//! The short way: a plain request that the router has answered before is answered again without the router, with the
//! same headers and bytes, as long as the same artifact is in memory.

use std::collections::HashMap;
use std::sync::{Arc, Mutex};

use axum::body::Bytes;
use axum::http::{HeaderMap, HeaderValue, Method, Response, StatusCode, header, request};

use super::address::{RENDER, is_link};
use super::{memo, negotiate};
use crate::job::key::Key;
use crate::service::job_key::Tenant;
use crate::service::lock::lock;
use crate::service::store::Manifest;
use crate::service::tiers::Tiers;
use crate::service::variant::Coding;

/// Maximum number of answers whose headers are remembered; when it is reached, all are forgotten. Each takes about 2
/// KiB, and 6 KiB at most, with its warnings. Twice of it may hold 24 MiB; half of it forgets twice as often, and a
/// forgotten answer passes the router once.
const MAX_ANSWERS: usize = 2048;

/// The path of artifacts.
const ARTIFACTS: &str = "/v1/artifacts/";
/// Hexadecimal digits of a key.
const KEY_DIGITS: usize = 64;

/// The resource that a plain request names.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum PlainResource {
    /// The artifact of a key for a tenant, by its address, in the preferred coding.
    Artifact(Tenant, Key, Option<Coding>),
    /// The result of a request with this [identity](super::memo::identity), in the preferred coding.
    Render(Key, Option<Coding>),
}

/// The remembered answers of the router to plain requests.
#[derive(Debug, Default)]
pub struct Short(Mutex<HashMap<PlainResource, Arc<KeptHeaders>>>);

/// An extension of an answer: it consists of this whole artifact, which was in the cache, and its memory is not
/// charged.
#[derive(Debug, Clone)]
pub(super) struct Plain(pub(super) Arc<Manifest>);

/// The headers of an answer, its artifact, and the origin of the page that sent the request.
#[derive(Debug)]
struct KeptHeaders {
    manifest: Arc<Manifest>,
    origin: Option<HeaderValue>,
    headers: HeaderMap,
}

impl PlainResource {
    /// Returns the route that would have answered the request.
    pub(super) fn route(self) -> &'static str {
        match self {
            Self::Artifact(..) => "/v1/artifacts/{file}",
            Self::Render(..) => RENDER,
        }
    }

    /// Returns what a request of a tenant names by its address alone: an artifact, or the result of a job in the
    /// address.
    pub(super) fn get(request: &request::Parts, tenant: Tenant) -> Option<Self> {
        let (address, headers) = (&request.uri, &request.headers);
        if request.method != Method::GET || !is_plain(headers) {
            return None;
        }
        if let Some(key) = address.path().strip_prefix(ARTIFACTS).and_then(|file| file.get(..KEY_DIGITS)) {
            return Some(Self::Artifact(tenant, Key::parse(key)?, negotiate::coding(headers)));
        }
        let identity = || memo::link_identity(tenant, headers, &address.to_string());
        is_link(address).then(|| Self::Render(identity(), negotiate::coding(headers)))
    }

    /// Returns what a POST request names whose body and `Accept` have this identity.
    pub(super) fn render(request: &request::Parts, identity: Option<Key>) -> Option<Self> {
        let identity = identity.filter(|_| is_plain(&request.headers))?;
        Some(Self::Render(identity, negotiate::coding(&request.headers)))
    }
}

/// Returns whether a request has no header that would change its answer from the router when the result is in the
/// cache, except `Accept-Encoding`, `Host`, `Origin` and the headers of the request's identity.
fn is_plain(headers: &HeaderMap) -> bool {
    ![header::IF_NONE_MATCH, header::RANGE].iter().any(|name| headers.contains_key(name))
}

impl Short {
    /// Returns the number of remembered answers.
    pub fn n_answers(&self) -> usize {
        lock(&self.0).len()
    }

    /// Returns the remembered answer to a request, if its artifact is in memory. The caller has checked the host.
    pub(super) fn answer(
        &self,
        tiers: &Tiers,
        asked: &PlainResource,
        request: &request::Parts,
    ) -> Option<Response<Bytes>> {
        let head = lock(&self.0).get(asked).cloned()?;
        let address = head.headers.get(header::CONTENT_LOCATION);
        let is_there =
            matches!(asked, PlainResource::Render(..)) || address.is_some_and(|known| known == request.uri.path());
        if !is_there || head.origin.as_ref() != request.headers.get(header::ORIGIN) {
            return None;
        }
        let mut response = Response::new(tiers.whole_at_hand(&head.manifest)?);
        *response.headers_mut() = head.headers.clone();
        Some(response)
    }

    /// Remembers the router's answer to a page of this origin, if it can be sent again.
    pub(super) fn remember<B>(&self, asked: PlainResource, origin: Option<HeaderValue>, response: &mut Response<B>) {
        let Some(Plain(manifest)) = response.extensions_mut().remove() else { return };
        if response.status() != StatusCode::OK {
            return;
        }
        let head = Arc::new(KeptHeaders { manifest, origin, headers: response.headers().clone() });
        let mut answers = lock(&self.0);
        if answers.len() >= MAX_ANSWERS {
            answers.clear();
        }
        answers.insert(asked, head);
    }
}
