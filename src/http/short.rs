//! The short way: a plain request whose answer the router has given before is answered again without it, with the same
//! headers and bytes, as long as the very same artifact is in memory.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use axum::body::Bytes;
use axum::http::{HeaderMap, HeaderValue, Method, Response, StatusCode, header, request};

use super::address::{RENDER, is_link};
use super::{memo, negotiate};
use crate::job::key::Key;
use crate::service::job_key::Tenant;
use crate::service::store::Manifest;
use crate::service::tiers::Tiers;
use crate::service::variant::Coding;

/// Most answers whose headers are remembered; when there are more, all are forgotten.
/// Each takes about 2 KiB, and 6 KiB at most, with its warnings. Twice of it may hold 24 MiB; half of it forgets twice
/// as often, and what is forgotten takes the long way once.
const MAX_ANSWERS: usize = 2048;

/// Where artifacts have their addresses.
const ARTIFACTS: &str = "/v1/artifacts/";
/// Digits of a key.
const KEY_DIGITS: usize = 64;

/// What a plain request asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Asked {
    /// The artifact of a key for a tenant, by its address, in the coding that is liked best.
    Artifact(Tenant, Key, Option<Coding>),
    /// The result of a request of this [identity](super::memo::identity), in the coding that is liked best.
    Render(Key, Option<Coding>),
}

/// The answers that the router has given to plain requests.
#[derive(Debug, Default)]
pub struct Short(Mutex<HashMap<Asked, Arc<Head>>>);

/// Says of an answer that it is the whole of this artifact, which was there, and owes nothing for its memory.
#[derive(Debug, Clone)]
pub(super) struct Plain(pub(super) Arc<Manifest>);

/// The headers of an answer, the artifact they are about, and the origin of the page that asked.
#[derive(Debug)]
struct Head {
    manifest: Arc<Manifest>,
    origin: Option<HeaderValue>,
    headers: HeaderMap,
}

impl Asked {
    /// The route that would have answered it.
    pub(super) fn route(self) -> &'static str {
        match self {
            Self::Artifact(..) => "/v1/artifacts/{file}",
            Self::Render(..) => RENDER,
        }
    }

    /// What a request of a tenant asks for by its address alone: an artifact, or the result of a job that stands in it.
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

    /// The result that a request asks for whose body and `Accept` have this identity.
    pub(super) fn render(request: &request::Parts, identity: Option<Key>) -> Option<Self> {
        let identity = identity.filter(|_| is_plain(&request.headers))?;
        Some(Self::Render(identity, negotiate::coding(&request.headers)))
    }
}

/// Whether none of the headers is there that the way through the router heeds when the result is at hand, but for those
/// of a request's identity, `Accept-Encoding`, `Host`, and `Origin`.
fn is_plain(headers: &HeaderMap) -> bool {
    ![header::IF_NONE_MATCH, header::RANGE].iter().any(|name| headers.contains_key(name))
}

impl Short {
    /// How many answers are remembered.
    pub fn len(&self) -> usize {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).len()
    }

    /// Whether no answer is remembered.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The answer to a request that names a host of ours, where the router has given it before.
    pub(super) fn answer(&self, tiers: &Tiers, asked: &Asked, request: &request::Parts) -> Option<Response<Bytes>> {
        let head = self.0.lock().unwrap_or_else(PoisonError::into_inner).get(asked).cloned()?;
        let address = head.headers.get(header::CONTENT_LOCATION);
        let is_there = matches!(asked, Asked::Render(..)) || address.is_some_and(|known| known == request.uri.path());
        if !is_there || head.origin.as_ref() != request.headers.get(header::ORIGIN) {
            return None;
        }
        let mut response = Response::new(tiers.whole_at_hand(&head.manifest)?);
        *response.headers_mut() = head.headers.clone();
        Some(response)
    }

    /// Remembers the answer that the router gave to a page of this origin, where it can be given again.
    pub(super) fn remember<B>(&self, asked: Asked, origin: Option<HeaderValue>, response: &mut Response<B>) {
        let Some(Plain(manifest)) = response.extensions_mut().remove() else { return };
        if response.status() != StatusCode::OK {
            return;
        }
        let head = Arc::new(Head { manifest, origin, headers: response.headers().clone() });
        let mut answers = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if answers.len() >= MAX_ANSWERS {
            answers.clear();
        }
        answers.insert(asked, head);
    }
}
