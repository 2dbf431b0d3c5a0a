//! The job: what is to be made, under which limits, by which key; pure, without I/O, clock or randomness.

pub mod key;
