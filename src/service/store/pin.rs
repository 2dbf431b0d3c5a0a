//! Artifacts that must not leave: running jobs or open downloads need them.

use std::sync::Arc;

use super::interface::Store;
use crate::job::key::Key;

/// Keeps an artifact in its store until it is dropped.
#[derive(Debug)]
pub struct Pin {
    store: Arc<dyn Store>,
    key: Key,
}

impl Pin {
    /// Pins an artifact, if it is there. Never waits.
    pub fn new(store: &Arc<dyn Store>, key: Key) -> Option<Self> {
        store.pin(&key).then(|| Self { store: store.clone(), key })
    }
}

impl Drop for Pin {
    fn drop(&mut self) {
        self.store.unpin(&self.key);
    }
}
