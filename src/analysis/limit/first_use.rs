//! Numbers in the order of first use.

use crate::shape::topology::{NONE, index};

/// Numbers up to this many are found by looking through them.
/// It only decides which way is taken: with half of it neighbourhoods of faces are hashed sooner, with twice of it more
/// numbers are compared one by one. The order is the same.
const FEW: usize = 16;

/// Things in the order of first use, which is their number.
///
/// A table finds them by their hash, whatever the number of all things: what a patch takes depends on its size alone.
#[derive(Default)]
pub(super) struct FirstUse {
    pub(super) order: Vec<u32>,
    /// Numbers, or [`NONE`], each at or after the place of its hash; twice as many places as numbers at least, a power
    /// of 2.
    places: Vec<u32>,
}

impl FirstUse {
    /// The number of `thing`, and whether it is a new one.
    pub(super) fn number(&mut self, thing: u32) -> (u32, bool) {
        let n = self.order.len();
        if n < FEW {
            if let Some(known) = self.order.iter().position(|&other| other == thing) {
                return (index(known), false);
            }
            self.order.push(thing);
            return (index(n), true);
        }
        if 2 * n >= self.places.len() {
            self.grow();
        }
        let place = self.place(thing);
        if self.places[place] != NONE {
            return (self.places[place], false);
        }
        self.places[place] = index(n);
        self.order.push(thing);
        (index(n), true)
    }

    /// Where the number of a thing stands, or is to stand.
    fn place(&self, thing: u32) -> usize {
        let last = self.places.len() - 1;
        // neighbours have similar numbers: the golden ratio spreads them (Knuth, volume 3, section 6.4)
        let hash = thing.wrapping_mul(0x9E37_79B9);
        let mut place = hash.rotate_left(self.places.len().trailing_zeros()) as usize & last;
        while self.places[place] != NONE && self.order[self.places[place] as usize] != thing {
            place = (place + 1) & last;
        }
        place
    }

    fn grow(&mut self) {
        self.places = vec![NONE; (4 * self.order.len()).next_power_of_two()];
        for n in 0..self.order.len() {
            let place = self.place(self.order[n]);
            self.places[place] = index(n);
        }
    }
}
