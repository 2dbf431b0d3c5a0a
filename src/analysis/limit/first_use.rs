//! Numbers things in the order of their first use.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::hash::{BuildHasherDefault, Hasher};

use crate::shape::topology::index;

/// A set of things, each numbered by the order of its first use.
///
/// Lookup is by hash and independent of the number of things in the whole net, so the cost of a disc depends on its
/// size only.
#[derive(Default)]
pub(super) struct FirstUse {
    pub(super) order: Vec<u32>,
    numbers: HashMap<u32, u32, BuildHasherDefault<FibonacciHasher>>,
}

impl FirstUse {
    /// Returns the number of `thing`, and whether it is new.
    pub(super) fn number(&mut self, thing: u32) -> (u32, bool) {
        match self.numbers.entry(thing) {
            Entry::Occupied(known) => (*known.get(), false),
            Entry::Vacant(new) => {
                self.order.push(thing);
                (*new.insert(index(self.order.len() - 1)), true)
            }
        }
    }
}

/// A multiplicative hash: the golden ratio spreads the similar numbers of neighbours (Knuth, volume 3, section 6.4).
#[derive(Default)]
struct FibonacciHasher(u64);

impl Hasher for FibonacciHasher {
    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|&byte| self.write_u32(byte.into()));
    }

    fn write_u32(&mut self, thing: u32) {
        self.0 = (self.0 ^ u64::from(thing)).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    }

    fn finish(&self) -> u64 {
        self.0
    }
}
