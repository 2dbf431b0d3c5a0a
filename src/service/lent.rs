//! Bytes being sent to clients: the memory charged for them is given back when the last reference is dropped.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, Weak};

use bytes::Bytes;

use super::account::Full;
use super::lock::lock;
use super::peer::Paid;
use super::store::Manifest;
use crate::job::key::Key;

/// Responses up to this length are not charged to the account: with one response per connection, the number of
/// connections bounds them. Twice of it would let each connection hold twice as much outside the account; half of it
/// would charge more small responses.
const FREE_BYTES: u64 = 64 << 10;

/// Returns whether responses with an artifact in memory are not charged to the account.
pub fn is_free(manifest: &Manifest) -> bool {
    manifest.length <= FREE_BYTES
}

/// Bytes together with the guard that pays for their memory.
#[derive(Debug)]
pub struct Lent<T> {
    bytes: Bytes,
    _paid: T,
}

impl<T: Send + 'static> Lent<T> {
    /// Combines bytes with the guard that pays for them; the guard is dropped with the last slice of the bytes.
    #[expect(clippy::new_ret_no_self, reason = "it is only ever an owner of bytes")]
    pub fn new(bytes: Bytes, paid: T) -> Bytes {
        Bytes::from_owner(Self { bytes, _paid: paid })
    }
}

impl<T> AsRef<[u8]> for Lent<T> {
    fn as_ref(&self) -> &[u8] {
        &self.bytes
    }
}

/// The artifacts in memory that are being sent, each charged once: while a client reads an artifact it may leave the
/// cache, but still occupies memory.
#[derive(Debug, Default)]
pub struct InFlight {
    artifacts: Mutex<HashMap<Key, Weak<Paid>>>,
}

impl InFlight {
    /// Charges an artifact in memory with `pay` for as long as it is being sent; returns `None` for small ones, which
    /// are free.
    ///
    /// # Errors
    /// [`Full`].
    pub fn hold(
        &self,
        manifest: &Manifest,
        pay: impl FnOnce(u64) -> Result<Paid, Full>,
    ) -> Result<Option<Arc<Paid>>, Full> {
        if is_free(manifest) {
            return Ok(None);
        }
        let mut artifacts = lock(&self.artifacts);
        if let Some(paid) = artifacts.get(&manifest.content).and_then(Weak::upgrade) {
            return Ok(Some(paid));
        }
        let paid = Arc::new(pay(manifest.length)?);
        if artifacts.len() >= 64 && artifacts.len().is_power_of_two() {
            artifacts.retain(|_, paid| paid.strong_count() > 0);
        }
        artifacts.insert(manifest.content, Arc::downgrade(&paid));
        Ok(Some(paid))
    }
}
