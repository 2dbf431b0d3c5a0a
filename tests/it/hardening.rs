//! What the service survives: slow, silent, lying and greedy clients, overload, and its own end.
#![allow(clippy::unwrap_used, reason = "a test may fail where it stands")]

mod addresses;
mod bodies;
mod disk;
mod disk_full;
mod disk_slow;
mod overload;
mod parsing;
mod shutdown;
mod slow;
