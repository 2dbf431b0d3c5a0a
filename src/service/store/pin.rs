//! Pins: artifacts that must not be evicted, because running jobs or open downloads need them.

use std::sync::Arc;

use super::interface::Store;
use crate::job::key::Key;

/// Protects an artifact from eviction until it is dropped.
#[derive(Debug)]
pub struct Pin {
    store: Arc<dyn Store>,
    key: Key,
}

impl Pin {
    /// Pins an artifact; returns `None` if it is not stored. Never blocks.
    pub fn new(store: &Arc<dyn Store>, key: Key) -> Option<Self> {
        store.pin(&key).then(|| Self { store: store.clone(), key })
    }
}

impl Drop for Pin {
    fn drop(&mut self) {
        self.store.unpin(&self.key);
    }
}
