//! A bounded map in order of use: the least recently used entries are evicted first.

use std::collections::{BTreeMap, HashMap};

use super::error::StoreError;
use super::interface::Usage;
use crate::job::key::Key;

/// Maximum number of entries of one store, whatever its capacity: their manifests stay in memory, at about 500 bytes
/// each, 256 MiB in all. Half or twice of it would halve or double that memory and the number of small artifacts kept.
pub const MAX_ARTIFACTS: usize = 1 << 19;

/// A bounded map that knows the order of use. Looking up, inserting and evicting take `O(log n)`, plus the number of
/// pinned entries that an eviction passes over.
#[derive(Debug)]
pub(in crate::service) struct Shelf<V> {
    entries: HashMap<Key, CachedValue<V>>,
    /// Keys by the number of their last use; uses are numbered from 1, and each number occurs once.
    order: BTreeMap<u64, Key>,
    /// Number of pins of each key that must not be evicted.
    pinned: HashMap<Key, usize>,
    next_use: u64,
    bytes: u64,
    capacity: u64,
    evicted: u64,
    damaged: u64,
}

#[derive(Debug)]
struct CachedValue<V> {
    value: V,
    cost: u64,
    last_use: u64,
}

impl<V> Shelf<V> {
    /// Creates an empty shelf for entries that cost `capacity` bytes in total.
    pub(in crate::service) fn new(capacity: u64) -> Self {
        let (entries, order, pinned) = (HashMap::new(), BTreeMap::new(), HashMap::new());
        Self { entries, order, pinned, next_use: 1, bytes: 0, capacity, evicted: 0, damaged: 0 }
    }

    /// Returns the value of `key` and counts this as a use.
    pub(in crate::service) fn touch(&mut self, key: &Key) -> Option<&V> {
        self.touch_mut(key).map(|value| &*value)
    }

    /// Returns the value of `key` for a change, and counts this as a use. A change that affects the cost of the entry
    /// is followed by [`set_cost`](Self::set_cost).
    pub(in crate::service) fn touch_mut(&mut self, key: &Key) -> Option<&mut V> {
        let entry = self.entries.get_mut(key)?;
        if entry.last_use + 1 < self.next_use {
            self.order.remove(&entry.last_use);
            self.order.insert(self.next_use, *key);
            entry.last_use = self.next_use;
            self.next_use += 1;
        }
        Some(&mut entry.value)
    }

    /// Sets the cost of an entry whose value has changed. If it has become larger, the entries may cost more than the
    /// capacity until the next [`evict_for`](Self::evict_for).
    pub(in crate::service) fn set_cost(&mut self, key: &Key, cost: u64) {
        if let Some(entry) = self.entries.get_mut(key) {
            self.bytes = self.bytes - entry.cost + cost;
            entry.cost = cost;
        }
    }

    /// Returns the value of `key` without counting a use.
    pub(in crate::service) fn peek(&self, key: &Key) -> Option<&V> {
        self.entries.get(key).map(|entry| &entry.value)
    }

    /// Removes and returns the least recently used entry, unless an entry of this cost fits already, or would not fit
    /// beside those that are pinned, so that nothing is evicted in vain.
    pub(in crate::service) fn evict_for(&mut self, cost: u64) -> Option<(Key, V)> {
        let pinned: u64 = self.pinned.keys().filter_map(|key| self.entries.get(key)).map(|entry| entry.cost).sum();
        if self.has_room(cost) || pinned.saturating_add(cost) > self.capacity {
            return None;
        }
        self.evict_oldest().map(|(key, _, value)| (key, value))
    }

    /// Returns whether an entry of this cost fits.
    pub(in crate::service) fn has_room(&self, cost: u64) -> bool {
        self.bytes.saturating_add(cost) <= self.capacity && self.entries.len() < MAX_ARTIFACTS
    }

    /// Protects an entry from eviction; pins are counted. Returns false if there is no such entry.
    pub(in crate::service) fn pin(&mut self, key: &Key) -> bool {
        let is_here = self.entries.contains_key(key);
        if is_here {
            *self.pinned.entry(*key).or_default() += 1;
        }
        is_here
    }

    /// Undoes one [`pin`](Self::pin).
    pub(in crate::service) fn unpin(&mut self, key: &Key) {
        if let Some(pins) = self.pinned.get_mut(key) {
            *pins -= 1;
            if *pins == 0 {
                self.pinned.remove(key);
            }
        }
    }

    /// Removes the least recently used entry that is not pinned; returns its key, its cost and its value.
    pub(in crate::service) fn evict_oldest(&mut self) -> Option<(Key, u64, V)> {
        let key = *self.order.values().find(|key| !self.pinned.contains_key(key))?;
        let cost = self.entries.get(&key)?.cost;
        let value = self.remove(&key)?;
        self.evicted += 1;
        Some((key, cost, value))
    }

    /// Inserts an entry as the most recently used one and returns the entry that it replaces. The caller must have made
    /// room with [`evict_for`](Self::evict_for).
    pub(in crate::service) fn insert(&mut self, key: Key, cost: u64, value: V) -> Option<V> {
        let replaced = self.remove(&key);
        let last_use = self.next_use;
        self.next_use += 1;
        self.bytes += cost;
        self.order.insert(last_use, key);
        self.entries.insert(key, CachedValue { value, cost, last_use });
        replaced
    }

    /// Removes an entry and returns its value.
    pub(in crate::service) fn remove(&mut self, key: &Key) -> Option<V> {
        let entry = self.entries.remove(key)?;
        self.order.remove(&entry.last_use);
        self.bytes -= entry.cost;
        Some(entry.value)
    }

    /// Counts entries that were found damaged.
    pub(in crate::service) fn count_damaged(&mut self, n: u64) {
        self.damaged += n;
    }

    /// Returns the keys whose last use has the number `since` or a later one, with that number, oldest first.
    pub(in crate::service) fn used_since(&self, since: u64) -> impl Iterator<Item = (Key, u64)> {
        self.order.range(since..).map(|(&last_use, &key)| (key, last_use))
    }

    /// Returns the number that the next use will have.
    pub(in crate::service) fn next_use(&self) -> u64 {
        self.next_use
    }

    /// Returns the counts and sizes of the shelf.
    pub(in crate::service) fn usage(&self) -> Usage {
        Usage {
            artifacts: self.entries.len() as u64,
            bytes: self.bytes,
            capacity: self.capacity,
            evicted: self.evicted,
            damaged: self.damaged,
            away: false,
        }
    }
}

/// Refuses an artifact larger than half of `capacity`: one artifact must not evict all others.
pub(in crate::service) fn admit(cost: u64, capacity: u64) -> Result<(), StoreError> {
    let largest = capacity / 2;
    if cost > largest { Err(StoreError::TooLarge { capacity: largest }) } else { Ok(()) }
}
