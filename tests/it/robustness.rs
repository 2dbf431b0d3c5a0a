//! Whatever comes in, a result or faults come out: never a panic, never a number that is not finite.

mod creases;
mod maps;
mod mutations;
mod push_back;
mod soups;
mod special_floats;
mod wild;
