//! Numbers in the order of first use.

use std::collections::BTreeMap;

use crate::shape::topology::{NONE, index};

/// Of so many things each has a place for its number.
const MANY: usize = 1 << 14;
/// Of more, numbers up to this many are found by looking through them.
const FEW: usize = 128;

/// Things in the order of first use, which is their number.
pub(super) struct Numbers {
    pub(super) order: Vec<u32>,
    /// The number of each thing, or [`NONE`]; nothing where there are too many things.
    places: Vec<u32>,
    /// Filled there once there are more than a few.
    tree: BTreeMap<u32, u32>,
}

impl Numbers {
    /// None yet, for `n` things.
    pub(super) fn of(n: usize) -> Self {
        let places = if n <= MANY { vec![NONE; n] } else { Vec::new() };
        Self { order: Vec::new(), places, tree: BTreeMap::new() }
    }

    /// The number of `thing`, and whether it is a new one.
    pub(super) fn number(&mut self, thing: u32) -> (u32, bool) {
        let n = self.order.len();
        if let Some(known) = self.known(thing) {
            return (known, false);
        }
        self.order.push(thing);
        if let Some(place) = self.places.get_mut(thing as usize) {
            *place = index(n);
        } else if n == FEW {
            self.tree = self.order.iter().enumerate().map(|(i, &other)| (other, index(i))).collect();
        } else if n > FEW {
            self.tree.insert(thing, index(n));
        }
        (index(n), true)
    }

    fn known(&self, thing: u32) -> Option<u32> {
        if let Some(&place) = self.places.get(thing as usize) {
            return (place != NONE).then_some(place);
        }
        if self.order.len() <= FEW {
            self.order.iter().position(|&other| other == thing).map(index)
        } else {
            self.tree.get(&thing).copied()
        }
    }
}
