//! Robustness: any input gives a result or faults, never a panic or a number that is not finite.

mod creases;
mod maps;
mod mutations;
mod push_back;
mod soups;
mod special_floats;
mod wild;
