//! What the service survives: slow, silent, lying and greedy clients, overload, and its own end.
#![allow(clippy::unwrap_used, reason = "a test may fail where it stands")]

mod addresses;
mod bodies;
mod cost;
mod overload;
mod searches;
mod shutdown;
mod slow;
