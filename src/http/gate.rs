//! The gate: who asks, by the key that the request shows or that signed its address, and whether that key allows it.

use std::collections::HashMap;
use std::path::Path;
use std::sync::{Arc, PoisonError, RwLock};
use std::time::Duration;

use axum::http::{HeaderMap, Method, header, request};

use super::client::{Caller, Shown};
use super::problem::{self, Problem};
use crate::config::keys::{KeyEntry, KeyFile, KeyFileError, LINKS, Link, LinkFault, Role, SHARED, Token, has_job};
use crate::service::clock::Clock;
use crate::service::job_key::Tenant;
use crate::service::peer::Peer;

/// How often the keys are read again. Half of it reads twice as often; twice of it lets a revoked key work for a second
/// more.
const READ_AGAIN: Duration = Duration::from_secs(1);

/// What is open to everybody, whether there are keys or not: how the service is, and what it knows.
const OPEN: [&str; 4] = ["/", "/livez", "/readyz", "/openapi.json"];
const OPEN_BELOW: [&str; 6] = ["/docs", "/play", "/v1/presets", "/v1/operators", "/v1/formats", "/v1/readers"];
/// Where a GET has a job done.
const WORKS_BELOW: [&str; 2] = ["/v1/render", "/kroki/"];

/// What a request needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Need {
    /// Nothing.
    Nothing,
    /// A key of this role, or of one that allows more.
    Role(Role),
    /// A signature in the address, and behind it a job to be done, or not.
    Signature { works: bool },
}

/// The keys that are let in; `None` where there are none at all, and everybody is.
type Ring = Option<HashMap<String, KeyEntry>>;

/// The gate of a service.
#[derive(Debug)]
pub struct Gate {
    file: Option<KeyFile>,
    ring: RwLock<Arc<Ring>>,
    clock: Arc<dyn Clock>,
}

impl Gate {
    /// The gate of a service whose keys stand in this folder, where it has one.
    ///
    /// # Errors
    /// When there are keys that cannot be read: nobody should be let in by mistake.
    pub fn open(data_dir: &Path, clock: Arc<dyn Clock>) -> Result<Self, KeyFileError> {
        let file = (data_dir != Path::new("")).then(|| KeyFile::of(data_dir));
        let ring = file.as_ref().map(read).transpose()?.flatten();
        Ok(Self { file, ring: RwLock::new(Arc::new(ring)), clock })
    }

    fn ring(&self) -> Arc<Ring> {
        self.ring.read().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Whether there are keys, so that who has none is not let in.
    pub fn is_shut(&self) -> bool {
        self.ring().is_some()
    }

    /// How many keys there are.
    pub fn n_keys(&self) -> usize {
        self.ring().as_ref().as_ref().map_or(0, HashMap::len)
    }

    /// Reads the keys again, for as long as the service lives. Keys that cannot be read, or whose file is gone, stay as
    /// they were.
    pub async fn keep_current(&self) {
        let Some(file) = self.file.clone() else { return };
        let mut trouble = None;
        loop {
            self.clock.sleep(READ_AGAIN).await;
            let of_thread = file.clone();
            let read = tokio::task::spawn_blocking(move || read(&of_thread)).await;
            let told = match read {
                Ok(Ok(None)) if self.is_shut() => {
                    Some(format!("{} is gone; the keys stay as they were", file.path().display()))
                }
                Ok(Ok(ring)) => {
                    self.take(ring);
                    None
                }
                Ok(Err(error)) => Some(format!("{error}; the keys stay as they were")),
                Err(error) => Some(error.to_string()),
            };
            if told != trouble {
                told.iter().for_each(|told| tracing::error!("{told}"));
                trouble = told;
            }
        }
    }

    fn take(&self, ring: Ring) {
        if *self.ring() != ring {
            tracing::info!(keys = ring.as_ref().map_or(0, HashMap::len), "the keys have changed");
            *self.ring.write().unwrap_or_else(PoisonError::into_inner) = Arc::new(ring);
        }
    }

    /// Who sends a request from an address, and whether that is allowed.
    pub(super) fn who(&self, request: &request::Parts, address: Peer) -> Caller {
        let caller = |peer, shown, refused| Caller { peer, shown, refused };
        let (need, ring) = (needed(&request.method, request.uri.path()), self.ring());
        let now_s = self.clock.wall().as_secs();
        let judged = match (need, ring.as_ref()) {
            (Need::Signature { .. }, None) => Err(no_keys_here()),
            (Need::Signature { works }, Some(keys)) => signed(keys, request, works, now_s),
            (Need::Nothing, _) | (_, None) => return caller(address, Shown::Nothing, None),
            (Need::Role(role), Some(keys)) => shown(keys, &request.headers, role, now_s),
        };
        match judged {
            Ok((key, shown)) => caller(Peer::of_key(key.number(), tenant(key)), shown, None),
            Err(problem) => caller(address, Shown::Nothing, Some(problem)),
        }
    }
}

fn read(file: &KeyFile) -> Result<Ring, KeyFileError> {
    let keys = file.read()?;
    Ok(keys.map(|keys| keys.into_iter().map(|key| (key.id.clone(), key)).collect()))
}

/// The tenant of a key; its keys share with each other alone, unless it is the one that shares with everybody.
fn tenant(key: &KeyEntry) -> Tenant {
    if key.tenant == SHARED { Tenant::ANYONE } else { Tenant::named(&key.tenant) }
}

/// What a request needs, by its method and address. What is not known here needs a key.
pub(super) fn needed(method: &Method, path: &str) -> Need {
    let is_below = |place: &&str| path.strip_prefix(place).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'));
    let reads = [Method::GET, Method::HEAD].contains(method);
    if let Some(rest) = path.strip_prefix(LINKS) {
        let works = rest.splitn(3, '/').nth(2).is_some_and(has_job);
        return Need::Signature { works };
    }
    // asked by browsers before the request itself, without its key
    if *method == Method::OPTIONS || reads && (OPEN.contains(&path) || OPEN_BELOW.iter().any(is_below)) {
        return Need::Nothing;
    }
    match path {
        "/metrics" => Need::Role(Role::Admin),
        _ if reads && !WORKS_BELOW.iter().any(|place| path.starts_with(place)) => Need::Role(Role::Read),
        _ => Need::Role(Role::Render),
    }
}

/// The key that a request shows.
fn shown<'a>(
    keys: &'a HashMap<String, KeyEntry>,
    headers: &HeaderMap,
    role: Role,
    now_s: u64,
) -> Result<(&'a KeyEntry, Shown), Problem> {
    let refused = |detail: &str| Problem::new(problem::UNAUTHORIZED, detail);
    let Some(written) = headers.get(header::AUTHORIZATION) else {
        return Err(refused("the request shows no key; send the header \"Authorization: Bearer planish_...\""));
    };
    let token = written.to_str().ok().and_then(|text| text.split_once(' '));
    let token = token.filter(|(scheme, _)| scheme.eq_ignore_ascii_case("bearer"));
    let token = token.and_then(|(_, token)| Token::parse(token.trim()));
    let token = token.ok_or_else(|| refused("Authorization holds no key; send it as \"Bearer planish_...\""))?;
    let unknown = || refused("the key is not known here, or was revoked; ask the operator for another");
    let key = keys.get(token.id()).filter(|key| key.is(&token)).ok_or_else(unknown)?;
    if key.has_expired(now_s) {
        return Err(refused("the key has expired; ask the operator for another"));
    }
    if key.role < role {
        let (own, needs) = (key.role.name(), role.name());
        let detail = format!("the key has the role {own}, and this takes {needs}; use a key with that role");
        return Err(Problem::new(problem::FORBIDDEN, detail));
    }
    Ok((key, Shown::Key(key.requests_per_minute, key.in_flight)))
}

/// The key that has signed the address of a request.
fn signed<'a>(
    keys: &'a HashMap<String, KeyEntry>,
    request: &request::Parts,
    works: bool,
    now_s: u64,
) -> Result<(&'a KeyEntry, Shown), Problem> {
    let refused = |detail: &str| Problem::new(problem::BAD_LINK, detail);
    if ![Method::GET, Method::HEAD].contains(&request.method) {
        return Err(refused("a signed address can be read alone; send GET"));
    }
    if request.uri.query().is_some() {
        return Err(refused("a signed address has no query, as that would not be signed; leave out what follows ?"));
    }
    let form = "the address is no signed one, /v1/r/{key id}.{signature}/{expiry}/{what it opens}; sign it again";
    let link = Link::parse(request.uri.path()).map_err(|_| refused(form))?;
    let altered = "the signature is not that of this address, or its key was revoked; have it signed again";
    // without such a key as much is computed as with it
    let key = keys.get(&link.id);
    let checked = link.check(key.map_or("", |key| &key.link), now_s);
    let key = key.ok_or_else(|| refused(altered))?;
    match checked {
        Err(LinkFault::Expired) => Err(refused("the time of the signed address is over; have it signed again")),
        Err(LinkFault::Signature | LinkFault::Form) => Err(refused(altered)),
        Ok(()) if key.has_expired(now_s) => Err(refused("the key that signed the address has expired")),
        Ok(()) if works && key.role < Role::Render => {
            Err(refused("the key that signed the address may read only; sign it with one of the role render"))
        }
        Ok(()) => Ok((key, Shown::Link(link.expires, key.requests_per_minute, key.in_flight))),
    }
}

fn no_keys_here() -> Problem {
    let detail = "this server has no keys, so no address can be signed for it; ask by /v1/render?job=... instead";
    Problem::new(problem::BAD_LINK, detail)
}
