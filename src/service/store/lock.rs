//! How the locks of the stores are taken.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// Every change under these locks is complete before anything can panic, so a poisoned lock guards sound values.
pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
