//! The gate: identifies a client by the key that its request shows or that signed its address, and checks that the key
//! permits the request.

use std::collections::HashMap;
use std::path::Path;
use std::sync::{Arc, PoisonError, RwLock};
use std::time::Duration;

use axum::http::{HeaderMap, Method, header, request};

use super::client::{Caller, Credentials};
use super::problem::{self, Problem};
use crate::config::keys::{KeyEntry, KeyFile, KeyFileError, KeyRole, LINKS, Link, LinkFault, SHARED, Token, has_job};
use crate::service::clock::Clock;
use crate::service::job_key::Tenant;
use crate::service::peer::Peer;

/// Interval between two readings of the keys. Half of it reads twice as often; twice of it lets a revoked key work for
/// a second longer.
const KEYS_INTERVAL: Duration = Duration::from_secs(1);

/// Paths that are public whether there are keys or not: the state of the service, and its catalogue.
const PUBLIC_PATHS: [&str; 4] = ["/", "/livez", "/readyz", "/openapi.json"];
const PUBLIC_PREFIXES: [&str; 6] = ["/docs", "/play", "/v1/presets", "/v1/operators", "/v1/formats", "/v1/readers"];
/// Prefixes of paths where a GET computes a job.
const WORK_PREFIXES: [&str; 2] = ["/v1/render", "/kroki/"];

/// The permission that a request needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Need {
    /// No permission is needed.
    Nothing,
    /// A key of this role, or of one that allows more.
    Role(KeyRole),
    /// A signed address; `works` says whether the request computes a job.
    Signature { works: bool },
}

/// The valid keys by id; `None` if there is no key file, so that everybody is let in.
type KeyRing = Option<HashMap<String, KeyEntry>>;

/// The gate of a service.
#[derive(Debug)]
pub struct Gate {
    file: Option<KeyFile>,
    ring: RwLock<Arc<KeyRing>>,
    clock: Arc<dyn Clock>,
}

impl Gate {
    /// Opens the gate with the keys in this folder; an empty path means that there is none.
    ///
    /// # Errors
    /// When there are keys that cannot be read, so that nobody is let in by mistake.
    pub fn open(data_dir: &Path, clock: Arc<dyn Clock>) -> Result<Self, KeyFileError> {
        let file = (data_dir != Path::new("")).then(|| KeyFile::of(data_dir));
        let ring = file.as_ref().map(read).transpose()?.flatten();
        Ok(Self { file, ring: RwLock::new(Arc::new(ring)), clock })
    }

    fn ring(&self) -> Arc<KeyRing> {
        self.ring.read().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Returns whether there are keys, so that clients need one.
    pub fn is_shut(&self) -> bool {
        self.ring().is_some()
    }

    /// Returns the number of keys.
    pub fn n_keys(&self) -> usize {
        self.ring().as_ref().as_ref().map_or(0, HashMap::len)
    }

    /// Reads the keys again at regular intervals, for as long as the service lives. If they cannot be read, or the file
    /// is gone, the previous keys stay valid.
    pub async fn keep_current(&self) {
        let Some(file) = self.file.clone() else { return };
        let mut trouble = None;
        loop {
            self.clock.sleep(KEYS_INTERVAL).await;
            let of_thread = file.clone();
            let read = tokio::task::spawn_blocking(move || read(&of_thread)).await;
            let message = match read {
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
            if message != trouble {
                message.iter().for_each(|message| tracing::error!("{message}"));
                trouble = message;
            }
        }
    }

    fn take(&self, ring: KeyRing) {
        if *self.ring() != ring {
            tracing::info!(keys = ring.as_ref().map_or(0, HashMap::len), "the keys have changed");
            *self.ring.write().unwrap_or_else(PoisonError::into_inner) = Arc::new(ring);
        }
    }

    /// Identifies the client of a request, and checks its permission. `address` is the peer by IP address.
    pub(super) fn who(&self, request: &request::Parts, address: Peer) -> Caller {
        let caller = |peer, shown, refused| Caller { peer, shown, refused };
        let (need, ring) = (needed(&request.method, request.uri.path()), self.ring());
        let now_s = || self.clock.wall().as_secs();
        let judged = match (need, ring.as_ref()) {
            (Need::Signature { .. }, None) => Err(no_keys_here()),
            (Need::Signature { works }, Some(keys)) => signed(keys, request, works, now_s()),
            (Need::Nothing, _) | (_, None) => return caller(address, Credentials::Nothing, None),
            (Need::Role(role), Some(keys)) => shown(keys, &request.headers, role, now_s()),
        };
        match judged {
            Ok((key, shown)) => caller(Peer::of_key(key.number(), tenant(key)), shown, None),
            Err(problem) => caller(address, Credentials::Nothing, Some(problem)),
        }
    }
}

fn read(file: &KeyFile) -> Result<KeyRing, KeyFileError> {
    let keys = file.read()?;
    Ok(keys.map(|keys| keys.into_iter().map(|key| (key.id.clone(), key)).collect()))
}

/// Returns the tenant of a key. Keys of a tenant share with each other only, except those of the shared tenant, who
/// share with everybody.
fn tenant(key: &KeyEntry) -> Tenant {
    if key.tenant == SHARED { Tenant::ANYONE } else { Tenant::named(&key.tenant) }
}

/// Returns the permission that a request needs, by its method and path. Unknown paths need a key.
pub(super) fn needed(method: &Method, path: &str) -> Need {
    let is_below = |place: &&str| path.strip_prefix(place).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'));
    let reads = [Method::GET, Method::HEAD].contains(method);
    if let Some(rest) = path.strip_prefix(LINKS) {
        let works = rest.splitn(3, '/').nth(2).is_some_and(has_job);
        return Need::Signature { works };
    }
    // browsers send OPTIONS before the request itself, without its key
    if *method == Method::OPTIONS || reads && (PUBLIC_PATHS.contains(&path) || PUBLIC_PREFIXES.iter().any(is_below)) {
        return Need::Nothing;
    }
    match path {
        "/metrics" => Need::Role(KeyRole::Admin),
        _ if reads && !WORK_PREFIXES.iter().any(|place| path.starts_with(place)) => Need::Role(KeyRole::Read),
        _ => Need::Role(KeyRole::Render),
    }
}

/// Checks the key in the header `Authorization`.
fn shown<'a>(
    keys: &'a HashMap<String, KeyEntry>,
    headers: &HeaderMap,
    role: KeyRole,
    now_s: u64,
) -> Result<(&'a KeyEntry, Credentials), Problem> {
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
    Ok((key, Credentials::Key(key.requests_per_minute, key.in_flight)))
}

/// Checks the signature of the address of a request, and returns the key that made it.
fn signed<'a>(
    keys: &'a HashMap<String, KeyEntry>,
    request: &request::Parts,
    works: bool,
    now_s: u64,
) -> Result<(&'a KeyEntry, Credentials), Problem> {
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
    // the signature is computed even for an unknown key, so that timing does not show which keys exist
    let key = keys.get(&link.id);
    let checked = link.check(key.map_or("", |key| &key.link), now_s);
    let key = key.ok_or_else(|| refused(altered))?;
    match checked {
        Err(LinkFault::Expired) => Err(refused("the time of the signed address is over; have it signed again")),
        Err(LinkFault::Signature | LinkFault::Form) => Err(refused(altered)),
        Ok(()) if key.has_expired(now_s) => Err(refused("the key that signed the address has expired")),
        Ok(()) if works && key.role < KeyRole::Render => {
            Err(refused("the key that signed the address may read only; sign it with one of the role render"))
        }
        Ok(()) => Ok((key, Credentials::Link(link.expires, key.requests_per_minute, key.in_flight))),
    }
}

fn no_keys_here() -> Problem {
    let detail = "this server has no keys, so no address can be signed for it; ask by /v1/render?job=... instead";
    Problem::new(problem::BAD_LINK, detail)
}
