//! Bytes on their way to clients: what they hold of the account comes back when the last of them is gone.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError, Weak};

use bytes::Bytes;

use super::account::Full;
use super::peer::Paid;
use super::store::Manifest;
use crate::job::key::Key;

/// Answers up to this length take nothing: with one a connection they are bounded by the connections.
/// Twice of it may hold twice as much beside the account for each connection; half of it takes more small answers from
/// the account.
const FREE_BYTES: u64 = 64 << 10;

/// Whether answers with an artifact in memory take nothing from the account.
pub fn is_free(manifest: &Manifest) -> bool {
    manifest.length <= FREE_BYTES
}

/// Bytes together with whatever pays for their memory.
#[derive(Debug)]
pub struct Lent<T> {
    bytes: Bytes,
    _paid: T,
}

impl<T: Send + 'static> Lent<T> {
    /// Lends bytes; what pays for them is dropped with their last part, wherever that is.
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

/// The artifacts in memory that are being answered, each paid for once: while a client reads one, it may leave the
/// cache, but not the memory.
#[derive(Debug, Default)]
pub struct InFlight {
    artifacts: Mutex<HashMap<Key, Weak<Paid>>>,
}

impl InFlight {
    /// Pays for an artifact in memory as long as it is answered, with `pay`; `None` for small ones, which are free.
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
        let mut artifacts = self.artifacts.lock().unwrap_or_else(PoisonError::into_inner);
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
